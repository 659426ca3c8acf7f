// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/convex_approximation.h>
#include <tombolo/approximation/moved_convex_values.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/smoothed/cell_surroundings.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/formulations/smoothed/sub_cells.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /** The gradients at one point of a cell, by node, and the volume of the point. */
  template <int dim>
  struct SmoothedRow
  {
    std::vector<std::pair<dealii::types::global_dof_index, dealii::Tensor<1, dim>>> entries;
    double volume = 0;
  };

  /** Computes the rows of one cell after the other. */
  template <int dim>
  class SmoothedRowBuilder
  {
  public:
    /** With the present @p position of the nodes, or null. */
    SmoothedRowBuilder(const CellSurroundings<dim> &surroundings,
                       ConvexApproximation<dim> approximation, MovedConvexValues<dim> moved_values,
                       const NodalVector *position)
        : surroundings(surroundings), cloud(surroundings.cloud),
          approximation(std::move(approximation)), moved_values(std::move(moved_values)),
          position(position)
    {
      if (position == nullptr)
        return;
      find_present_cloud();
      shared_values.resize(surroundings.shared_facets.size());
      nodes_of_shared.reserve(8 * shared_values.size()); // as many as a facet has in a lattice
    }

    /** Rows of all points of cell number @p c go behind @p rows. Returns what is wrong, or
     * nothing. */
    std::string add_cell(const std::size_t c, const SmoothedIntegrationRule rule,
                         std::vector<SmoothedRow<dim>> &rows)
    {
      const SmoothedCell<dim> &cell = surroundings.cells[c];
      number_of_cell = c;
      find_neighbours(c);
      find_present_positions(cell);
      return rule == SmoothedIntegrationRule::smoothed ? add_sub_cells(cell, rows)
                                                       : add_point(cell, rows);
    }

  private:
    void find_present_cloud()
    {
      const NodePartition &partition = *position->partition();
      const std::vector<bool> is_there = surroundings.reaches_cells();
      present_cloud.resize(cloud.position.size());
      for (std::size_t i = 0; i < cloud.node.size(); ++i)
        if (is_there[i])
          std::copy_n(position->node(partition.local_index(cloud.node[i])), node_stride,
                      present_cloud.begin() + std::ptrdiff_t(i * node_stride));
    }

    void find_neighbours(const std::size_t c)
    {
      surroundings.find_neighbours(c, hits);
      positions.clear();
      supports.clear();
      for (const std::size_t i : hits)
        for (unsigned int d = 0; d < node_stride; ++d)
        {
          positions.push_back(cloud.position[i * node_stride + d]);
          supports.push_back(cloud.support[i * node_stride + d]);
        }
      values.resize(hits.size());
      gradients.resize(hits.size());
    }

    void find_present_positions(const SmoothedCell<dim> &cell)
    {
      corners = cell.corners;
      if (position == nullptr)
        return;
      for (unsigned int k = 0; k < corners.size(); ++k)
        corners[k] = present_place(cell.nodes[k]);
      present.clear();
      for (const std::size_t i : hits)
      {
        const double *const x = present_cloud.data() + i * node_stride;
        present.insert(present.end(), x, x + node_stride);
      }
    }

    /** Values at a place of the cell. */
    bool evaluate_share(const typename SubCells<dim>::Shares &share, const SmoothedCell<dim> &cell)
    {
      const dealii::Point<dim> x = SubCells<dim>::point_at(share, cell.corners);
      return position == nullptr ? evaluate(x, false)
                                 : evaluate_moved(x, SubCells<dim>::point_at(share, corners));
    }

    /** Values at a place that was somewhere else in the initial configuration. */
    bool evaluate_moved(const dealii::Point<dim> &of_start, const dealii::Point<dim> &now)
    {
      return approximation
          .evaluate_moved(of_start, static_cast<unsigned int>(hits.size()), positions.data(),
                          supports.data(), now, present.data(), values.data())
          .is_inside;
    }

    bool evaluate(const dealii::Point<dim> &x, const bool with_gradients)
    {
      return approximation
          .evaluate(x, static_cast<unsigned int>(hits.size()), positions.data(), supports.data(),
                    values.data(), with_gradients ? gradients.data() : nullptr)
          .is_inside;
    }

    /** Values and gradients at a point that was somewhere else in the initial configuration. */
    bool evaluate_point(const PointOfCell<dim> &of_start, const PointOfCell<dim> &now)
    {
      if (position == nullptr)
        return evaluate(now.place, true);
      return approximation
          .evaluate_moved(of_start.place, static_cast<unsigned int>(hits.size()), positions.data(),
                          supports.data(), now.place, present.data(), values.data(),
                          gradients.data(), of_start.jacobian * dealii::invert(now.jacobian))
          .is_inside;
    }

    /** The row of a point whose neighbours have the coefficients @p sums, over @p volume. */
    SmoothedRow<dim> row_of(const std::vector<dealii::Tensor<1, dim>> &sums,
                            const double volume) const
    {
      const auto counts = [](const dealii::Tensor<1, dim> &sum) { return sum.norm_square() > 0.; };
      SmoothedRow<dim> row;
      row.volume = volume;
      row.entries.reserve(
          static_cast<std::size_t>(std::count_if(sums.begin(), sums.end(), counts)));
      for (std::size_t k = 0; k < hits.size(); ++k)
        if (counts(sums[k]))
          row.entries.emplace_back(cloud.node[hits[k]], sums[k] / volume);
      return row;
    }

    static std::string describe_point(const dealii::Point<dim> &point)
    {
      std::ostringstream text;
      text << "(";
      for (unsigned int d = 0; d < dim; ++d)
        text << (d > 0 ? ", " : "") << point[d];
      text << ")";
      return text.str();
    }

    static std::string outside_of_hull(const dealii::Point<dim> &x)
    {
      return "the point at " + describe_point(x) +
             " is outside of the convex hull of the nodes whose supports reach it: the "
             "approximation "
             "does not exist there. A larger `Dilation` may help.";
    }

    static std::string without_volume(const SmoothedCell<dim> &cell, const double volume)
    {
      return describe_unusable_cell<dim>(cell.centre(), cell.centre(), volume) + ".";
    }

    using Parts = SubCells<dim>;

    /** Neighbours, by their place among the hits, and their values. */
    using Values = std::vector<std::pair<std::size_t, double>>;

    /** Where the values of a facet of two cells are. */
    struct SharedValues
    {
      std::size_t first = 0, n = 0;
    };

    /** Of each sub-cell. */
    struct FacetSums
    {
      std::array<std::vector<dealii::Tensor<1, dim>>, Parts::n_sub_cells>
          areas; // of each neighbour
      std::array<double, Parts::n_sub_cells> volumes{};
    };

    dealii::Point<dim> centroid_of(const typename Parts::Facet &facet) const
    {
      return Parts::point_at(facet.centroid, corners);
    }
    dealii::Point<dim> centroid_of(const GradedFacet<dim> &facet) const
    {
      return facet.centroid();
    }

    /** As Parts::area(), with vertices that several facets have. */
    dealii::Tensor<1, dim> area_of(const typename Parts::Facet &facet, const std::size_t f) const
    {
      const auto &of_facet = facet_vertices().numbers[f];
      const dealii::Tensor<1, dim> a = vertices[of_facet[1]] - vertices[of_facet[0]];
      if constexpr (dim == 2)
        return facet.orientation * dealii::cross_product_2d(a);
      else
        return 0.5 * facet.orientation *
               dealii::cross_product_3d(a, vertices[of_facet[2]] - vertices[of_facet[0]]);
    }
    dealii::Tensor<1, dim> area_of(const GradedFacet<dim> &facet, const std::size_t /*f*/) const
    {
      return facet.area();
    }

    struct FacetVertices
    {
      std::vector<typename Parts::Shares> shares;
      std::vector<std::array<std::size_t, dim>> numbers; // by facet

      FacetVertices()
      {
        for (const auto &facet : Parts::facets())
        {
          numbers.emplace_back();
          for (unsigned int v = 0; v < dim; ++v)
          {
            const auto found = std::find(shares.begin(), shares.end(), facet.vertices[v]);
            numbers.back()[v] = static_cast<std::size_t>(found - shares.begin());
            if (found == shares.end())
              shares.push_back(facet.vertices[v]);
          }
        }
      }
    };

    static const FacetVertices &facet_vertices()
    {
      static const FacetVertices result;
      return result;
    }

    template <typename Facet>
    static bool is_on_boundary(const Facet &facet, const SmoothedCell<dim> &cell)
    {
      return facet.to == Parts::outside && cell.is_on_boundary[facet.face];
    }

    /** Values at the centroids of all facets that are not on the boundary, before
     * evaluate_facet(). */
    void prepare_facets(const std::vector<typename Parts::Facet> &facets,
                        const SmoothedCell<dim> &cell)
    {
      if (position == nullptr)
        return;
      constexpr unsigned int most_places = MovedConvexValues<dim>::most_places;
      moved_values.set_neighbours(static_cast<unsigned int>(hits.size()), positions.data(),
                                  supports.data(), present.data());
      is_known.assign(facets.size(), false);
      known_values.resize(facets.size());
      std::array<std::size_t, most_places> numbers{};
      typename MovedConvexValues<dim>::Places of_start, now;
      unsigned int n = 0;
      for (std::size_t f = 0; f < facets.size(); ++f)
      {
        if (!is_on_boundary(facets[f], cell) && shared_values_of(f) == nullptr)
        {
          numbers[n] = f;
          of_start[n] = Parts::point_at(facets[f].centroid, cell.corners);
          now[n++] = centroid_of(facets[f]);
        }
        if (n < most_places && (n == 0 || f + 1 < facets.size()))
          continue;
        const unsigned int is_found = moved_values.evaluate(n, of_start, now);
        for (unsigned int place = 0; place < n; ++place)
        {
          is_known[numbers[place]] = ((is_found >> place) & 1u) != 0;
          Values &of_facet = known_values[numbers[place]];
          of_facet.clear();
          for (unsigned int k = 0; k < moved_values.n_values(place); ++k)
            of_facet.emplace_back(moved_values.neighbour(place, k), moved_values.value(place, k));
        }
        n = 0;
      }
    }
    void prepare_facets(const std::vector<GradedFacet<dim>> & /*facets*/,
                        const SmoothedCell<dim> & /*cell*/)
    {}

    void take_values()
    {
      facet_values.clear();
      for (std::size_t k = 0; k < hits.size(); ++k)
        if (values[k] != 0.)
          facet_values.emplace_back(k, values[k]);
    }

    /** The values of this facet that the cell before has found, or null. */
    const SharedValues *shared_values_of(const std::size_t f) const
    {
      const unsigned int number = surroundings.shared_facets.number(number_of_cell, f);
      return number == SharedFacets<dim>::none || shared_values[number].n == 0
                 ? nullptr
                 : &shared_values[number];
    }

    void take_shared_values(const SharedValues &shared)
    {
      facet_values.clear();
      std::size_t k = 0;
      for (std::size_t i = shared.first; i < shared.first + shared.n; ++i)
      {
        while (hits[k] != nodes_of_shared[i].first)
          ++k;
        facet_values.emplace_back(k, nodes_of_shared[i].second);
      }
    }

    void share_values(const std::size_t f)
    {
      const unsigned int number = surroundings.shared_facets.number(number_of_cell, f);
      if (number == SharedFacets<dim>::none)
        return;
      shared_values[number] = {nodes_of_shared.size(), facet_values.size()};
      for (const auto &of_node : facet_values)
        nodes_of_shared.emplace_back(hits[of_node.first], of_node.second);
    }

    /** Values at the centroid of facet number @p f, to facet_values. */
    bool evaluate_facet(const typename Parts::Facet &facet, const std::size_t f,
                        const SmoothedCell<dim> &cell)
    {
      if (position == nullptr)
      {
        const bool is_inside = evaluate_share(facet.centroid, cell);
        take_values();
        return is_inside;
      }
      if (const SharedValues *const shared = shared_values_of(f))
      {
        take_shared_values(*shared);
        return true;
      }
      if (is_known[f])
        facet_values.swap(known_values[f]);
      else if (evaluate_share(facet.centroid, cell))
        take_values();
      else
        return false;
      share_values(f);
      return true;
    }
    bool evaluate_facet(const GradedFacet<dim> &facet, const std::size_t f,
                        const SmoothedCell<dim> & /*cell*/)
    {
      const bool is_inside = position == nullptr
                                 ? evaluate(facet.centroid(), false)
                                 : evaluate_moved(graded_of_start[f].centroid(), facet.centroid());
      take_values();
      return is_inside;
    }

    /** The linear interpolation of the nodes of a face, to facet_values. */
    void interpolate_linearly(const typename Parts::Facet &facet, const SmoothedCell<dim> &cell)
    {
      add_shares(facet.centroid, 1., cell);
    }
    void interpolate_linearly(const GradedFacet<dim> &facet, const SmoothedCell<dim> &cell)
    {
      for (const auto &vertex : facet.vertices)
      {
        add_shares(vertex.of_corners, 1. / dim, cell);
        for (const auto &[node, share] : vertex.of_hanging_nodes)
          facet_values.emplace_back(place_among_hits(node), share / dim);
      }
    }

    void add_shares(const typename Parts::Shares &shares, const double factor,
                    const SmoothedCell<dim> &cell)
    {
      for (unsigned int corner = 0; corner < Parts::n_corners; ++corner)
        if (shares[corner] != 0.)
          facet_values.emplace_back(place_among_hits(cell.nodes[corner]), factor * shares[corner]);
    }

    /** Sums over the facets of a cell. Returns what is wrong, or nothing. */
    template <typename Facet>
    std::string add_facets(const SmoothedCell<dim> &cell, const std::vector<Facet> &facets,
                           FacetSums &sums)
    {
      dealii::Point<dim> centre;
      for (const dealii::Point<dim> &corner : corners)
        centre += corner / static_cast<double>(corners.size());
      vertices.clear();
      for (const typename Parts::Shares &shares : facet_vertices().shares)
        vertices.push_back(Parts::point_at(shares, corners));
      prepare_facets(facets, cell);
      for (std::size_t f = 0; f < facets.size(); ++f)
      {
        const Facet &facet = facets[f];
        const dealii::Point<dim> x = centroid_of(facet);
        const dealii::Tensor<1, dim> area = area_of(facet, f);
        const auto add = [&](const unsigned int part, const double sign)
        {
          sums.volumes[part] += sign / dim * (area * (x - centre));
          for (const auto &of_node : facet_values)
            sums.areas[part][of_node.first] += sign * of_node.second * area;
        };
        if (is_on_boundary(facet, cell))
        {
          facet_values.clear();
          interpolate_linearly(facet, cell);
        }
        else if (!evaluate_facet(facet, f, cell))
          return outside_of_hull(x);
        add(facet.from, 1.);
        if (facet.to != Parts::outside)
          add(facet.to, -1.);
      }
      return {};
    }

    std::string add_sub_cells(const SmoothedCell<dim> &cell, std::vector<SmoothedRow<dim>> &rows)
    {
      FacetSums sums;
      for (auto &of_part : sums.areas)
        of_part.resize(hits.size());
      const bool is_plain =
          position == nullptr ? cell.refined_faces.empty() : !cell.has_further_nodes();
      const std::string failure = is_plain ? add_facets(cell, Parts::facets(), sums)
                                           : add_facets(cell, present_graded_facets(cell), sums);
      if (!failure.empty())
        return failure;
      for (unsigned int part = 0; part < Parts::n_sub_cells; ++part)
      {
        if (!(sums.volumes[part] > 0.))
          return without_volume(cell, sums.volumes[part]);
        rows.push_back(row_of(sums.areas[part], sums.volumes[part]));
      }
      return {};
    }

    /** The present facets of a cell with hanging nodes; those of the start go to graded_of_start.
     */
    std::vector<GradedFacet<dim>> present_graded_facets(const SmoothedCell<dim> &cell)
    {
      // Hanging nodes are in the middle of edges at the start.
      if (position == nullptr)
        return graded_facets<dim>(cell.corners, cell.refined_faces);
      graded_of_start = graded_facets<dim>(cell.corners, cell.refined_faces, cell.refined_edges);
      return present_facets(cell, [this](const dealii::types::global_dof_index node)
                            { return present_place(node); });
    }

    dealii::Point<dim> present_place(const dealii::types::global_dof_index node) const
    {
      dealii::Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = position->node(position->partition()->local_index(node))[d];
      return result;
    }

    std::string add_point(const SmoothedCell<dim> &cell, std::vector<SmoothedRow<dim>> &rows)
    {
      const PointOfCell<dim> of_start(cell.corners), now(corners);
      const double volume = dealii::determinant(now.jacobian);
      if (!(volume > 0.))
        return without_volume(cell, volume);
      if (!evaluate_point(of_start, now))
        return outside_of_hull(now.place);
      rows.push_back(row_of(gradients, 1.));
      rows.back().volume = volume;
      return {};
    }

    std::size_t place_among_hits(const dealii::types::global_dof_index node) const
    {
      const auto found = std::lower_bound(hits.begin(), hits.end(), cloud.place_of(node));
      return static_cast<std::size_t>(found - hits.begin());
    }

    const CellSurroundings<dim> &surroundings;
    const NodeCloud<dim> &cloud;
    ConvexApproximation<dim> approximation;
    MovedConvexValues<dim> moved_values;
    const NodalVector *position;
    typename SubCells<dim>::Corners corners;    // present ones
    std::vector<double> present_cloud, present; // of all nodes and of neighbours, likewise
    std::vector<std::size_t> hits; // neighbours of the cell, places in the cloud, ascending
    std::vector<double> positions, supports, values;
    std::vector<dealii::Tensor<1, dim>> gradients;
    std::vector<dealii::Point<dim>> vertices;      // of facets of the cell (FacetVertices)
    std::vector<bool> is_known;                    // of facets, whether their values are
    std::vector<Values> known_values;              // of facets
    Values facet_values;                           // of the present one
    std::vector<GradedFacet<dim>> graded_of_start; // of a cell with hanging nodes
    std::size_t number_of_cell = 0;
    std::vector<SharedValues> shared_values; // of facets of two cells, once one of them has them
    Values nodes_of_shared;                  // places in the cloud
  };
} // namespace tombolo
