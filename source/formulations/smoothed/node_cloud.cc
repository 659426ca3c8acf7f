// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/node_cloud.h>

#include <tombolo/approximation/particle_ghosts.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/formulations/smoothed/void_cells.h>
#include <tombolo/mesh/bodies.h>
#include <tombolo/mesh/cells_of_part.h>

#include <deal.II/base/mpi.h>

#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** By how much supports are to be widened, so that one that reaches into a cell reaches one of
     * its corners. Collective. */
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
      return Utilities::MPI::max(largest, own.communicator()) *
             Utilities::MPI::max(inverse_of_support, own.communicator());
    }

    /** The nodes of other ranks whose supports reach cells of this rank. The corners of the cells
     * go along as points without a support, since cells can lie beyond the nodes that their rank
     * owns. Collective. */
    template <int dim>
    RemoteParticles find_remote_nodes(const ParticleSet<dim> &own,
                                      const std::vector<SmoothedCell<dim>> &cells,
                                      const types::global_dof_index n_nodes)
    {
      std::vector<types::global_dof_index> numbers = own.nodes();
      std::vector<double> positions = own.padded_initial_positions();
      std::vector<double> supports = own.initial_supports();
      for (const SmoothedCell<dim> &cell : cells)
        for (const Point<dim> &corner : cell.corners)
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
    partition_of(const ParticleSet<dim> &own, const std::vector<types::global_dof_index> &nodes,
                 const types::global_dof_index n_nodes)
    {
      IndexSet required(n_nodes);
      required.add_indices(nodes.begin(), nodes.end());
      return own.partition(required, {});
    }

    /** Collective. */
    template <int dim>
    void find_void_nodes(const PartSetup<dim> &setup, const ParticleSet<dim> &own,
                         const std::vector<SmoothedCell<dim>> &cells,
                         const std::vector<types::global_dof_index> &nodes,
                         std::vector<bool> &of_nodes)
    {
      if (setup.void_cells == nullptr)
        return;
      NodalVector n_full;
      const auto partition = partition_of(own, nodes, setup.nodes->dof_handler().n_dofs());
      n_full.reinit(partition, Quantity::scalar);
      for (const SmoothedCell<dim> &cell : cells)
        for (const types::global_dof_index node : cell.nodes)
          *n_full.node(partition->local_index(node)) += cell.is_void ? 0. : 1.;
      n_full.sum_over_ranks();
      for (const types::global_dof_index node : nodes)
        of_nodes.push_back(*n_full.node(partition->local_index(node)) == 0.);
    }

    /** Collective. */
    template <int dim>
    void find_bodies(const PartSetup<dim> &setup, const ParticleSet<dim> &own,
                     const std::vector<types::global_dof_index> &nodes,
                     std::vector<double> &of_nodes)
    {
      const Bodies<dim> bodies(*setup.nodes);
      if (bodies.n_bodies() == 1)
        return;
      const auto partition = partition_of(own, nodes, setup.nodes->dof_handler().n_dofs());
      const NodalVector body =
          scalar_field(partition, [&](const unsigned int i)
                       { return static_cast<double>(bodies.body_of(partition->global_index(i))); });
      for (const types::global_dof_index node : nodes)
        of_nodes.push_back(*body.node(partition->local_index(node)));
    }
  } // namespace

  template <int dim>
  std::vector<SmoothedCell<dim>> smoothed_cells_of(const PartSetup<dim> &setup)
  {
    std::vector<SmoothedCell<dim>> result;
    std::vector<Point<dim>> points;
    for (const auto &cell : cells_of_part(*setup.nodes, *setup.part_cells, setup.index))
    {
      SmoothedCell<dim> found;
      setup.nodes->cell_nodes(cell, found.nodes);
      setup.nodes->cell_points(cell, points);
      std::copy(points.begin(), points.end(), found.corners.begin());
      const auto is_void = [&setup](const typename Nodes<dim>::Cell &of_part)
      { return setup.void_cells != nullptr && setup.void_cells->is_void(of_part); };
      found.is_void = is_void(cell);
      for (const unsigned int face : cell->face_indices())
      {
        found.boundary_ids[face] = cell->face(face)->boundary_id();
        if (found.is_void)
          continue;
        // The size of cells changes inside of the part only.
        const bool is_at_end = cell->at_boundary(face) ||
                               (!cell->face(face)->has_children() &&
                                setup.part_cells->part_of(cell->neighbor(face)) != setup.index);
        found.is_towards_void[face] =
            !is_at_end && !cell->face(face)->has_children() && is_void(cell->neighbor(face));
        found.is_on_boundary[face] = is_at_end || found.is_towards_void[face];
      }
      found.refined_faces = refined_faces_of<dim>(cell);
      found.refined_edges = refined_edges_of<dim>(cell);
      result.push_back(std::move(found));
    }
    return result;
  }

  template <int dim>
  NodeCloud<dim>::NodeCloud(const PartSetup<dim> &setup, const double dilation,
                            const std::vector<SmoothedCell<dim>> &cells)
  {
    ParticleSet<dim> own;
    own.collect(setup, dilation,
                [&setup](const typename Nodes<dim>::Cell &cell)
                { return setup.part_cells->part_of(cell) == setup.index; });
    const RemoteParticles remote =
        find_remote_nodes(own, cells, setup.nodes->dof_handler().n_dofs());
    const std::vector<double> own_positions = own.padded_initial_positions();
    const auto append = [this](const std::size_t i, const types::global_dof_index number,
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
    find_bodies(setup, own, node, body);
    find_void_nodes(setup, own, cells, node, is_void);
  }

  template <int dim>
  unsigned int NodeCloud<dim>::place_of(const types::global_dof_index number) const
  {
    const auto found = std::lower_bound(node.begin(), node.end(), number);
    Assert(found != node.end() && *found == number, ExcInternalError());
    return static_cast<unsigned int>(found - node.begin());
  }

  template <int dim>
  std::vector<BoundingBox<dim>> NodeCloud<dim>::boxes() const
  {
    std::vector<BoundingBox<dim>> result;
    for (std::size_t i = 0; i < node.size(); ++i)
    {
      Point<dim> lower, upper;
      for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] = position[i * node_stride + d] - support[i * node_stride + d];
        upper[d] = position[i * node_stride + d] + support[i * node_stride + d];
      }
      result.push_back(BoundingBox<dim>({lower, upper}));
    }
    return result;
  }

  template struct NodeCloud<2>;
  template struct NodeCloud<3>;
  template std::vector<SmoothedCell<2>> smoothed_cells_of<2>(const PartSetup<2> &);
  template std::vector<SmoothedCell<3>> smoothed_cells_of<3>(const PartSetup<3> &);
} // namespace tombolo
