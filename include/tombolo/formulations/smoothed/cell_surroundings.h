// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/particle_ghosts.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/mesh/bodies.h>

#include <deal.II/base/mpi.h>
#include <deal.II/numerics/rtree.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <memory>
#include <tuple>
#include <vector>

namespace tombolo
{
  namespace internal
  {
    /** What widens supports so that one that reaches into a cell reaches a corner. Collective. */
    template <int dim>
    double skin_over_cells(const ParticleSet<dim> &own, const std::vector<SmoothedCell<dim>> &cells)
    {
      double largest = 0., inverse_of_support = 0.;
      for (const SmoothedCell<dim> &cell : cells)
        for (unsigned int d = 0; d < dim; ++d)
          largest = std::max(largest, cell.box().side_length(d));
      for (unsigned int i = 0; i < own.size(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          inverse_of_support = std::max(
              inverse_of_support, 1. / own.initial_supports()[std::size_t(i) * node_stride + d]);
      return dealii::Utilities::MPI::max(largest, own.communicator()) *
             dealii::Utilities::MPI::max(inverse_of_support, own.communicator());
    }

    /** The nodes of other ranks whose supports reach cells here. Corners of the cells go along as
     * points without a support, since cells can lie beyond the nodes of their rank. Collective. */
    template <int dim>
    RemoteParticles find_remote_nodes(const ParticleSet<dim> &own,
                                      const std::vector<SmoothedCell<dim>> &cells,
                                      const dealii::types::global_dof_index n_nodes)
    {
      std::vector<dealii::types::global_dof_index> numbers = own.nodes();
      std::vector<double> positions = own.padded_initial_positions();
      std::vector<double> supports = own.initial_supports();
      for (const SmoothedCell<dim> &cell : cells)
        for (const dealii::Point<dim> &corner : cell.corners)
        {
          numbers.push_back(n_nodes);
          for (unsigned int d = 0; d < node_stride; ++d)
            positions.push_back(d < dim ? corner[d] : 0.);
          supports.insert(supports.end(), node_stride, 0.);
        }
      RemoteParticles found =
          ParticleGhosts<dim>().exchange(numbers, positions.data(), supports.data(),
                                         skin_over_cells(own, cells), own.communicator());
      // Points without a support come last, by their number.
      const auto end = std::lower_bound(found.node.begin(), found.node.end(), n_nodes);
      found.node.erase(end, found.node.end());
      found.position.resize(found.node.size() * node_stride);
      found.support.resize(found.node.size() * node_stride);
      return found;
    }

    /** Collective. */
    template <int dim>
    std::shared_ptr<const NodePartition>
    partition_of(const ParticleSet<dim> &own,
                 const std::vector<dealii::types::global_dof_index> &nodes,
                 const dealii::types::global_dof_index n_nodes)
    {
      dealii::IndexSet required(n_nodes);
      required.add_indices(nodes.begin(), nodes.end());
      return own.partition(required, {});
    }

    /** Collective. */
    template <int dim>
    void find_void_nodes(const PartSetup<dim> &setup, const ParticleSet<dim> &own,
                         const std::vector<SmoothedCell<dim>> &cells,
                         const std::vector<dealii::types::global_dof_index> &nodes,
                         std::vector<bool> &void_flags)
    {
      if (setup.void_cells == nullptr)
        return;
      NodalVector n_full;
      const auto partition = partition_of(own, nodes, setup.nodes->dof_handler().n_dofs());
      n_full.reinit(partition, Quantity::scalar);
      for (const SmoothedCell<dim> &cell : cells)
        for (const dealii::types::global_dof_index node : cell.nodes)
          *n_full.node(partition->local_index(node)) += cell.is_void ? 0. : 1.;
      n_full.sum_over_ranks();
      for (const dealii::types::global_dof_index node : nodes)
        void_flags.push_back(*n_full.node(partition->local_index(node)) == 0.);
    }

    /** Collective. */
    template <int dim>
    void find_bodies(const PartSetup<dim> &setup, const ParticleSet<dim> &own,
                     const std::vector<dealii::types::global_dof_index> &nodes,
                     std::vector<double> &node_bodies)
    {
      const Bodies<dim> bodies(*setup.nodes);
      if (bodies.n_bodies() == 1)
        return;
      const auto partition = partition_of(own, nodes, setup.nodes->dof_handler().n_dofs());
      const NodalVector body =
          scalar_field(partition, [&](const unsigned int i)
                       { return static_cast<double>(bodies.body_of(partition->global_index(i))); });
      for (const dealii::types::global_dof_index node : nodes)
        node_bodies.push_back(*body.node(partition->local_index(node)));
    }

    /** The two corners of a facet on a face. */
    template <int dim>
    std::array<unsigned int, 2> ends_of(const typename SubCells<dim>::Facet &facet)
    {
      std::array<unsigned int, 2> result;
      for (unsigned int end = 0; end < 2; ++end)
        result[end] = static_cast<unsigned int>(
            std::find(facet.vertices[end].begin(), facet.vertices[end].end(), 1.) -
            facet.vertices[end].begin());
      return result;
    }
  } // namespace internal

  /** The nodes of a part that can be neighbours of points in its cells here, ascending. */
  template <int dim>
  struct NodeCloud
  {
    /** Half widths are @p dilation times the largest distance within a cell by axis. Collective. */
    NodeCloud(const PartSetup<dim> &setup, const double dilation,
              const std::vector<SmoothedCell<dim>> &cells)
    {
      ParticleSet<dim> own;
      own.collect(setup, dilation,
                  [&setup](const typename Nodes<dim>::Cell &cell)
                  { return setup.part_cells->part_of(cell) == setup.index; });
      const RemoteParticles remote =
          internal::find_remote_nodes(own, cells, setup.nodes->dof_handler().n_dofs());
      const std::vector<double> own_positions = own.padded_initial_positions();
      const auto append = [this](const std::size_t i, const dealii::types::global_dof_index number,
                                 const std::vector<double> &positions,
                                 const std::vector<double> &supports)
      {
        node.push_back(number);
        for (unsigned int d = 0; d < node_stride; ++d)
        {
          position.push_back(positions[i * node_stride + d]);
          support.push_back(supports[i * node_stride + d]);
        }
      };
      std::size_t next = 0;
      for (std::size_t i = 0; i < own.size(); ++i)
      {
        for (; next < remote.node.size() && remote.node[next] < own.nodes()[i]; ++next)
          append(next, remote.node[next], remote.position, remote.support);
        append(i, own.nodes()[i], own_positions, own.initial_supports());
      }
      for (; next < remote.node.size(); ++next)
        append(next, remote.node[next], remote.position, remote.support);
      internal::find_bodies(setup, own, node, body);
      internal::find_void_nodes(setup, own, cells, node, is_void);
    }

    unsigned int index_of(const dealii::types::global_dof_index number) const
    {
      const auto found = std::lower_bound(node.begin(), node.end(), number);
      Assert(found != node.end() && *found == number, dealii::ExcInternalError());
      return static_cast<unsigned int>(found - node.begin());
    }

    /** The supports. */
    std::vector<dealii::BoundingBox<dim>> boxes() const
    {
      std::vector<dealii::BoundingBox<dim>> result;
      for (std::size_t i = 0; i < node.size(); ++i)
      {
        dealii::Point<dim> lower, upper;
        for (unsigned int d = 0; d < dim; ++d)
        {
          lower[d] = position[i * node_stride + d] - support[i * node_stride + d];
          upper[d] = position[i * node_stride + d] + support[i * node_stride + d];
        }
        result.push_back(dealii::BoundingBox<dim>({lower, upper}));
      }
      return result;
    }

    std::vector<dealii::types::global_dof_index> node;
    std::vector<double> position, support; ///< node_stride each [L]
    std::vector<double> body;              ///< its number in Bodies; empty: there is one
    std::vector<bool> is_void;             ///< whether all of its cells are void; empty: none is
  };

  /** Facets (SubCells) of two full cells of this rank; none of cells beside smaller ones. */
  template <int dim>
  class SharedFacets
  {
  public:
    static constexpr unsigned int none = static_cast<unsigned int>(-1);

    explicit SharedFacets(const std::vector<SmoothedCell<dim>> &cells)
        : numbers(cells.size() * SubCells<dim>::facets().size(), none)
    {
      std::vector<Face> faces;
      for (unsigned int c = 0; c < cells.size(); ++c)
        for (unsigned int face = 0; face < dealii::GeometryInfo<dim>::faces_per_cell; ++face)
        {
          if (cells[c].is_void || cells[c].has_further_nodes() || cells[c].is_on_boundary[face])
            continue;
          Face next;
          unsigned int n = 0;
          for (unsigned int k = 0; k < SubCells<dim>::n_corners; ++k)
            if (SubCells<dim>::is_on_face(k, face))
              next.nodes[n++] = cells[c].nodes[k];
          std::sort(next.nodes.begin(), next.nodes.end());
          next.cell = c;
          next.face = face;
          faces.push_back(next);
        }
      std::sort(faces.begin(), faces.end());
      for (std::size_t k = 1; k < faces.size(); ++k)
        if (faces[k - 1].nodes == faces[k].nodes)
          match(cells, faces[k - 1], faces[k]);
    }

    /** The number that a facet has in both cells, or none. */
    unsigned int number(const std::size_t cell, const std::size_t facet) const
    {
      return numbers[cell * SubCells<dim>::facets().size() + facet];
    }

    unsigned int size() const
    {
      return n_shared;
    }

  private:
    struct Face
    {
      std::array<dealii::types::global_dof_index, dealii::GeometryInfo<dim>::vertices_per_face>
          nodes; // ascending
      unsigned int cell, face;

      bool operator<(const Face &other) const
      {
        return std::tie(nodes, cell) < std::tie(other.nodes, other.cell);
      }
    };

    void match(const std::vector<SmoothedCell<dim>> &cells, const Face &first, const Face &second)
    {
      const auto &all = SubCells<dim>::facets();
      const auto nodes_of = [&](const Face &face, const std::size_t facet)
      {
        const auto ends = internal::ends_of<dim>(all[facet]);
        return std::minmax({cells[face.cell].nodes[ends[0]], cells[face.cell].nodes[ends[1]]});
      };
      for (std::size_t f = 0; f < all.size(); ++f)
        for (std::size_t g = 0; g < all.size() && all[f].face == first.face; ++g)
          if (all[g].face == second.face && nodes_of(first, f) == nodes_of(second, g))
            numbers[first.cell * all.size() + f] = numbers[second.cell * all.size() + g] =
                n_shared++;
    }

    std::vector<unsigned int> numbers; // by cell and facet
    unsigned int n_shared = 0;
  };

  /** The cells of a part and the nodes whose supports reach them, in the initial configuration. */
  template <int dim>
  class CellSurroundings
  {
  public:
    /** Collective. */
    CellSurroundings(const PartSetup<dim> &setup, const double dilation)
        : cells(smoothed_cells_of(setup)), cloud(setup, dilation, cells), shared_facets(cells),
          first(1, 0)
    {
      const std::vector<dealii::BoundingBox<dim>> boxes = cloud.boxes();
      const auto tree = dealii::pack_rtree_of_indices(boxes);
      std::vector<std::size_t> found;
      for (const SmoothedCell<dim> &cell : cells)
      {
        found.clear();
        tree.query(boost::geometry::index::intersects(cell.box()), std::back_inserter(found));
        std::sort(found.begin(), found.end());
        reaching.insert(reaching.end(), found.begin(), found.end());
        first.push_back(reaching.size());
      }
    }

    std::vector<SmoothedCell<dim>> cells;
    NodeCloud<dim> cloud;
    SharedFacets<dim> shared_facets;

    /** Nodes of full cells of the body whose supports reach a cell: in the cloud, ascending. */
    void find_neighbours(const std::size_t cell, std::vector<std::size_t> &result) const
    {
      const double body =
          cloud.body.empty() ? 0. : cloud.body[cloud.index_of(cells[cell].nodes.front())];
      result.clear();
      for (std::size_t k = first[cell]; k < first[cell + 1]; ++k)
      {
        const std::size_t i = reaching[k];
        if ((cloud.is_void.empty() || !cloud.is_void[i]) &&
            (cloud.body.empty() || cloud.body[i] == body))
          result.push_back(i);
      }
    }

    /** Whether the support of a node reaches a cell, void ones too; by the index in the cloud. */
    std::vector<bool> reaches_cells() const
    {
      std::vector<bool> result(cloud.node.size(), false);
      for (const unsigned int i : reaching)
        result[i] = true;
      return result;
    }

  private:
    std::vector<unsigned int> reaching; // indices in the cloud, cell by cell
    std::vector<std::size_t> first;     // of each cell
  };
} // namespace tombolo
