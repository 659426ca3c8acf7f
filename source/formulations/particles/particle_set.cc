// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_set.h>

#include <tombolo/approximation/support_size.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <unordered_map>

namespace tombolo
{
  namespace
  {
    /** The cells between nodes of a cell of some degree: lists of 2^dim lexicographic indices. */
    template <int dim>
    std::vector<std::vector<unsigned int>> subcells(const unsigned int degree)
    {
      const unsigned int n = degree + 1;
      std::vector<std::vector<unsigned int>> result;
      for (unsigned int k = 0; k < (dim == 3 ? degree : 1); ++k)
        for (unsigned int j = 0; j < degree; ++j)
          for (unsigned int i = 0; i < degree; ++i)
          {
            std::vector<unsigned int> corners;
            for (unsigned int corner = 0; corner < (1u << dim); ++corner)
            {
              const unsigned int x = i + (corner & 1u);
              const unsigned int y = j + ((corner >> 1) & 1u);
              const unsigned int z = dim == 3 ? k + ((corner >> 2) & 1u) : 0;
              corners.push_back(x + n * (y + n * z));
            }
            result.push_back(corners);
          }
      return result;
    }

    /** All nodes of the selected cells that this rank has, in the order of their appearance. */
    struct CollectedNodes
    {
      std::unordered_map<types::global_dof_index, unsigned int> index_of_node;
      std::vector<double> positions, masses, half_widths; ///< node_stride, 1 and node_stride each
    };

    template <int dim>
    CollectedNodes collect_nodes(const Nodes<dim> &nodes, const double density,
                                 const CellSelection<dim> &is_taken)
    {
      CollectedNodes collected;
      const std::size_t n_owned = nodes.owned().n_elements();
      collected.index_of_node.reserve(n_owned);
      collected.positions.reserve(node_stride * n_owned);
      collected.masses.reserve(n_owned);
      std::vector<unsigned int> corners;
      const auto subcell_nodes = subcells<dim>(nodes.degree());
      std::unique_ptr<Quadrature<dim>> quadrature;
      if (nodes.degree() == 1)
        quadrature = std::make_unique<QGauss<dim>>(2);
      else
        quadrature = std::make_unique<QGaussLobatto<dim>>(nodes.degree() + 1);
      FEValues<dim> fe_values(nodes.dof_handler().get_fe(), *quadrature,
                              update_values | update_JxW_values);
      std::vector<types::global_dof_index> cell_nodes, hierarchic_nodes(fe_values.dofs_per_cell);
      std::vector<Point<dim>> cell_points;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      {
        if (cell->is_artificial() || !is_taken(cell))
          continue;
        nodes.cell_nodes(cell, cell_nodes);
        nodes.cell_points(cell, cell_points);
        std::vector<unsigned int> indices;
        for (unsigned int k = 0; k < cell_nodes.size(); ++k)
        {
          const auto [entry, is_new] = collected.index_of_node.try_emplace(
              cell_nodes[k], static_cast<unsigned int>(collected.masses.size()));
          if (is_new)
          {
            for (unsigned int c = 0; c < node_stride; ++c)
              collected.positions.push_back(c < dim ? cell_points[k][c] : 0.);
            collected.masses.push_back(0.);
          }
          indices.push_back(entry->second);
        }
        for (const auto &subcell : subcell_nodes)
          for (const unsigned int corner : subcell)
            corners.push_back(indices[corner]);
        fe_values.reinit(cell);
        cell->get_dof_indices(hierarchic_nodes);
        for (unsigned int k = 0; k < fe_values.dofs_per_cell; ++k)
        {
          const auto found = std::find(cell_nodes.begin(), cell_nodes.end(), hierarchic_nodes[k]);
          double &mass = collected.masses[indices[std::size_t(found - cell_nodes.begin())]];
          for (const unsigned int q : fe_values.quadrature_point_indices())
            mass += density * fe_values.shape_value(k, q) * fe_values.JxW(q);
        }
      }
      collected.half_widths.assign(collected.positions.size(), 0.);
      SupportSize::accumulate<dim>(corners, 1u << dim, collected.positions.data(),
                                   collected.half_widths.data());
      return collected;
    }

    /** Widens supports of nodes on which others depend so that they reach each other. */
    template <int dim>
    void widen_supports(const Nodes<dim> &nodes, CollectedNodes &collected)
    {
      const auto node_positions = nodes.points_depended_on();
      for (const DependentNode &row : nodes.dependent_nodes())
      {
        if (collected.index_of_node.count(row.node) == 0)
          continue;
        std::vector<unsigned int> ends(row.weights.size());
        std::iota(ends.begin(), ends.end(), 0u);
        std::vector<double> positions, half_widths(ends.size() * node_stride, 0.);
        for (const auto &weight : row.weights)
          for (unsigned int d = 0; d < node_stride; ++d)
            positions.push_back(d < dim ? node_positions.at(weight.first)[d] : 0.);
        SupportSize::accumulate<dim>(ends, static_cast<unsigned int>(ends.size()), positions.data(),
                                     half_widths.data());
        for (const unsigned int end : ends)
          if (const auto found = collected.index_of_node.find(row.weights[end].first);
              found != collected.index_of_node.end())
            for (unsigned int d = 0; d < dim; ++d)
            {
              double &half_width = collected.half_widths[found->second * node_stride + d];
              half_width = std::max(half_width, half_widths[end * node_stride + d]);
            }
      }
    }

    /** Distributes the masses of nodes that depend on others to these. Collective. */
    template <int dim>
    void move_masses(const PartSetup<dim> &setup, CollectedNodes &collected)
    {
      const Nodes<dim> &nodes = *setup.nodes;
      const auto partition = partition_of(nodes, nodes.relevant());
      NodalVector masses, before;
      masses.reinit(partition, Quantity::scalar);
      for (const auto &[node, index] : collected.index_of_node)
        if (nodes.owned().is_element(node))
          *masses.node(partition->local_index(node)) = collected.masses[index];
      before = masses.copy();
      before.update_ghosts();
      const NodePartition::DependentNodes &dependent = partition->dependent_nodes();
      std::string failure;
      for (std::size_t row = 0; row < dependent.node.size(); ++row)
        for (std::size_t k = dependent.start[row]; k < dependent.start[row + 1]; ++k)
          if (*masses.node(dependent.node[row]) > 0. &&
              *before.node(dependent.weights[k].first) == 0.)
          {
            Point<dim> position;
            const double *const x =
                &collected.positions[collected.index_of_node.at(
                                         partition->global_index(dependent.node[row])) *
                                     node_stride];
            std::copy_n(x, dim, position.begin_raw());
            failure =
                "Section Mesh, entry \"Refine where\": at " + position_text(position) +
                " a node of a cell of the particle part \"" + setup.name +
                "\" lies in the middle of a face or edge of a large cell that ends beyond the "
                "part. Let the part and the small cells end at the same large cells.";
          }
      throw_on_all_ranks<InputError>(failure, setup.communicator);
      masses.condense();
      for (const auto &[node, index] : collected.index_of_node)
        if (nodes.owned().is_element(node))
          collected.masses[index] = *masses.node(partition->local_index(node));
    }
  } // namespace

  template <int dim>
  std::vector<double> ParticleSet<dim>::collect(const PartSetup<dim> &setup, const double dilation,
                                                const CellSelection<dim> &is_taken,
                                                const DependentNodes dependent_nodes)
  {
    mesh_nodes = setup.nodes;
    mpi_communicator = setup.communicator;
    const double density = setup.material->density();
    CollectedNodes collected = collect_nodes<dim>(*mesh_nodes, density, is_taken);
    const bool give_way =
        dependent_nodes == DependentNodes::give_way && mesh_nodes->has_dependent_nodes();
    if (give_way)
    {
      widen_supports(*mesh_nodes, collected);
      move_masses(setup, collected);
    }

    std::vector<double> masses;
    numbers.clear();
    positions.clear();
    volumes.clear();
    supports.clear();
    spacing = std::numeric_limits<double>::max();
    for (const types::global_dof_index node : mesh_nodes->owned())
    {
      const auto found = collected.index_of_node.find(node);
      if (found == collected.index_of_node.end() ||
          (give_way && mesh_nodes->dependent_node(node) != nullptr))
        continue;
      const unsigned int index = found->second;
      numbers.push_back(node);
      masses.push_back(collected.masses[index]);
      volumes.push_back(collected.masses[index] / density);
      Point<dim> point;
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double half_width = collected.half_widths[index * node_stride + d];
        point[d] = collected.positions[index * node_stride + d];
        spacing = std::min(spacing, half_width);
        supports.push_back(dilation * half_width);
      }
      for (unsigned int d = dim; d < node_stride; ++d)
        supports.push_back(0.);
      positions.push_back(point);
    }
    return masses;
  }

  template <int dim>
  std::vector<std::uint64_t> ParticleSet<dim>::persistent_ids() const
  {
    std::vector<std::uint64_t> ids;
    for (const types::global_dof_index node : numbers)
      ids.push_back(mesh_nodes->persistent_ids()[mesh_nodes->owned().index_within_set(node)]);
    return ids;
  }

  template <int dim>
  std::vector<double> ParticleSet<dim>::padded_initial_positions() const
  {
    std::vector<double> result(numbers.size() * node_stride, 0.);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        result[i * node_stride + d] = positions[i][d];
    return result;
  }

  template <int dim>
  std::shared_ptr<const NodePartition>
  ParticleSet<dim>::partition(const IndexSet &required, const std::vector<ImageNode> &images) const
  {
    return std::make_shared<const NodePartition>(mesh_nodes->owned(), required, mpi_communicator,
                                                 mesh_nodes->images(), images);
  }

  template class ParticleSet<2>;
  template class ParticleSet<3>;
} // namespace tombolo
