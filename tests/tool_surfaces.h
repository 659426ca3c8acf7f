// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surfaces/facet_list.h>
#include <tombolo/contact/surfaces/rigid_profile.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/numbers.h>
#include <deal.II/base/tensor.h>

#include <tombolo/contact/contact_surface.h>

#include <cmath>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    /** A profile with two steps. */
    inline const std::vector<RigidProfile::Point> stepped = {{0., 0.}, {1., 0.}, {1., 2.},
                                                             {3., 2.}, {3., 4.}, {0., 4.}};

    /** The gaps of points at a surface. */
    template <int dim>
    std::vector<double> gaps(const ContactSurface<dim> &surface,
                             const std::vector<dealii::Tensor<1, dim>> &points, const double time)
    {
      const auto n = static_cast<unsigned int>(points.size());
      const auto partition = std::make_shared<const NodePartition>(
          dealii::complete_index_set(n), dealii::IndexSet(n), MPI_COMM_SELF);
      NodalVector position(partition);
      std::vector<unsigned int> nodes;
      for (unsigned int i = 0; i < n; ++i)
      {
        nodes.push_back(i);
        for (unsigned int d = 0; d < dim; ++d)
          position.node(i)[d] = points[i][d];
      }
      std::vector<double> gap;
      surface.evaluate_gaps(position, nodes, time, gap);
      return gap;
    }

    /** A body of revolution about z, of n facets around, its outline as RigidProfile has it. */
    inline FacetList<3> revolved(const std::vector<RigidProfile::Point> &outline,
                                 const unsigned int n)
    {
      FacetList<3> list;
      std::vector<unsigned int> first;
      for (const RigidProfile::Point &point : outline)
      {
        first.push_back(static_cast<unsigned int>(list.vertices.size()));
        for (unsigned int j = 0; j < (point.r > 0. ? n : 1); ++j)
        {
          const double angle = 2. * dealii::numbers::PI * j / n;
          list.vertices.push_back(dealii::Tensor<1, 3>(
              {point.r * std::cos(angle), point.r * std::sin(angle), point.z}));
        }
      }
      for (std::size_t i = 0; i + 1 < outline.size(); ++i)
        for (unsigned int j = 0; j < n; ++j)
        {
          const auto vertex = [&](const std::size_t ring, const unsigned int k)
          { return first[ring] + (outline[ring].r > 0. ? k % n : 0); };
          const unsigned int a = vertex(i, j), b = vertex(i, j + 1), c = vertex(i + 1, j + 1),
                             d = vertex(i + 1, j);
          if (a != b)
            list.facets.push_back({{a, b, c}});
          if (c != d)
            list.facets.push_back({{a, c, d}});
        }
      return list;
    }

    /** A box, two triangles a side. */
    inline FacetList<3> box(const dealii::Tensor<1, 3> &low, const dealii::Tensor<1, 3> &high)
    {
      FacetList<3> list;
      for (unsigned int v = 0; v < 8; ++v)
        list.vertices.push_back(dealii::Tensor<1, 3>(
            {v & 1u ? high[0] : low[0], v & 2u ? high[1] : low[1], v & 4u ? high[2] : low[2]}));
      const unsigned int sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
      for (const auto &side : sides)
      {
        list.facets.push_back({{side[0], side[1], side[2]}});
        list.facets.push_back({{side[0], side[2], side[3]}});
      }
      return list;
    }

    inline FacetList<3> unit_box()
    {
      return box(dealii::Tensor<1, 3>(), dealii::Tensor<1, 3>({1., 1., 1.}));
    }

    /** Two lists as one. */
    inline FacetList<3> together(FacetList<3> first, const FacetList<3> &second)
    {
      const auto n = static_cast<unsigned int>(first.vertices.size());
      first.vertices.insert(first.vertices.end(), second.vertices.begin(), second.vertices.end());
      for (const auto &facet : second.facets)
        first.facets.push_back({{facet.vertex[0] + n, facet.vertex[1] + n, facet.vertex[2] + n}});
      return first;
    }

    inline std::string stl_text(const FacetList<3> &list)
    {
      std::ostringstream text;
      text.precision(17);
      text << "solid tool\n";
      for (const auto &facet : list.facets)
      {
        text << " facet normal 0 0 nan\n  outer loop\n";
        for (const unsigned int v : facet.vertex)
          text << "   vertex " << list.vertices[v] << "\n";
        text << "  endloop\n endfacet\n";
      }
      text << "endsolid tool\n";
      return text.str();
    }

    inline std::string stl_bytes(const FacetList<3> &list)
    {
      std::string bytes(80, ' ');
      bytes.replace(0, 5, "solid");
      const auto add = [&](const void *const value, const std::size_t size)
      { bytes.append(static_cast<const char *>(value), size); };
      const auto n = static_cast<std::uint32_t>(list.facets.size());
      add(&n, 4);
      for (const auto &facet : list.facets)
      {
        bytes.append(12, '\0');
        for (const unsigned int v : facet.vertex)
          for (unsigned int d = 0; d < 3; ++d)
          {
            const auto coordinate = static_cast<float>(list.vertices[v][d]);
            add(&coordinate, 4);
          }
        bytes.append(2, '\0');
      }
      return bytes;
    }

    inline std::string obj_text(const FacetList<3> &list)
    {
      std::ostringstream text;
      text.precision(17);
      for (const auto &vertex : list.vertices)
        text << "v " << vertex << "\n";
      for (const auto &facet : list.facets)
        text << "f " << facet.vertex[0] + 1 << " " << facet.vertex[1] + 1 << " "
             << facet.vertex[2] + 1 << "\n";
      return text.str();
    }
  } // namespace testing
} // namespace tombolo
