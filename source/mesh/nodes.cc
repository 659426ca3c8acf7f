// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_tools.h>
#include <deal.II/grid/grid_tools.h>

#include <tombolo/mesh/nodes.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace tombolo
{
  namespace
  {
    /** The numbers of the support points of a cell, lexicographic, on the lattice of support points
     * of the finest level of the whole mesh, so that cells of all levels agree on them. It has
     * @p n_along points along each axis of a coarse cell. */
    template <int dim>
    std::vector<std::uint64_t>
    lattice_numbers(const dealii::CellId &cell, const unsigned int degree,
                    const unsigned int finest_level, const std::uint64_t n_along)
    {
      const auto children = cell.get_child_indices();
      std::array<std::uint64_t, dim> corner = {};
      for (const auto child : children)
        for (int d = 0; d < dim; ++d)
          corner[d] = 2 * corner[d] + ((static_cast<unsigned int>(child) >> d) & 1u);
      const std::uint64_t stride = std::uint64_t(1) << (finest_level - children.size());
      std::vector<std::uint64_t> numbers(dealii::Utilities::fixed_power<dim>(degree + 1),
                                         cell.get_coarse_cell_id() *
                                             dealii::Utilities::fixed_power<dim>(n_along));
      for (unsigned int k = 0; k < numbers.size(); ++k)
      {
        std::uint64_t weight = stride;
        unsigned int rest = k;
        for (int d = 0; d < dim; ++d)
        {
          numbers[k] += weight * (corner[d] * degree + rest % (degree + 1));
          weight *= n_along;
          rest /= degree + 1;
        }
      }
      return numbers;
    }
  } // namespace

  template <int dim>
  Nodes<dim>::Nodes(const Mesh<dim> &mesh, const unsigned int degree)
      : finite_element(std::make_unique<dealii::FE_Q<dim>>(degree)), handler(mesh.triangulation),
        lexicographic_to_hierarchic(
            dealii::FETools::lexicographic_to_hierarchic_numbering<dim>(degree))
  {
    const unsigned int n = degree + 1;
    indices_by_face.resize(dealii::GeometryInfo<dim>::faces_per_cell);
    for (unsigned int f = 0; f < indices_by_face.size(); ++f)
      for (unsigned int k = 0; k < lexicographic_to_hierarchic.size(); ++k)
      {
        const unsigned int index[3] = {k % n, (k / n) % n, k / (n * n)};
        if (index[f / 2] == (f % 2 == 0 ? 0 : degree))
          indices_by_face[f].push_back(k);
      }

    handler.distribute_dofs(*finite_element);
    owned_nodes = handler.locally_owned_dofs();
    relevant_nodes = dealii::DoFTools::extract_locally_active_dofs(handler);

    const unsigned int finest_level = mesh.triangulation.n_global_levels() - 1;
    const std::uint64_t n_along = std::uint64_t(degree) * (std::uint64_t(1) << finest_level) + 1;
    AssertThrow(mesh.triangulation.n_cells(0) <= std::numeric_limits<std::uint64_t>::max() /
                                                     dealii::Utilities::fixed_power<dim>(n_along),
                dealii::ExcMessage("The persistent node numbers of this mesh exceed 64 bits."));
    ids.assign(owned_nodes.n_elements(), std::numeric_limits<std::uint64_t>::max());
    std::vector<dealii::types::global_dof_index> nodes;
    // All cells around an owned node are owned or ghost cells of this rank.
    for (const auto &cell : handler.active_cell_iterators())
      if (!cell->is_artificial())
      {
        cell_nodes(cell, nodes);
        const auto numbers = lattice_numbers<dim>(cell->id(), degree, finest_level, n_along);
        for (unsigned int k = 0; k < nodes.size(); ++k)
          if (owned_nodes.is_element(nodes[k]))
          {
            auto &id = ids[owned_nodes.index_within_set(nodes[k])];
            id = std::min(id, numbers[k]);
          }
      }
  }

  template <int dim>
  void Nodes<dim>::cell_nodes(const Cell &cell,
                              std::vector<dealii::types::global_dof_index> &nodes) const
  {
    std::vector<dealii::types::global_dof_index> hierarchic(finite_element->n_dofs_per_cell());
    cell->get_dof_indices(hierarchic);
    nodes.resize(hierarchic.size());
    for (unsigned int k = 0; k < nodes.size(); ++k)
      nodes[k] = hierarchic[lexicographic_to_hierarchic[k]];
  }

  template <int dim>
  void Nodes<dim>::cell_points(const Cell &cell, std::vector<dealii::Point<dim>> &points) const
  {
    points.resize(finite_element->n_dofs_per_cell());
    for (unsigned int k = 0; k < points.size(); ++k)
    {
      dealii::Point<dim> point;
      if (degree() == 1)
        point += dealii::Tensor<1, dim>(cell->vertex(k));
      else
      {
        const dealii::Point<dim> unit =
            finite_element->unit_support_point(lexicographic_to_hierarchic[k]);
        for (const auto vertex : cell->vertex_indices())
          point += dealii::GeometryInfo<dim>::d_linear_shape_function(unit, vertex) *
                   dealii::Tensor<1, dim>(cell->vertex(vertex));
      }
      points[k] = point;
    }
  }

  template <int dim>
  void Nodes<dim>::set_dependent_nodes(std::vector<DependentNode> rows)
  {
    dependent = std::move(rows);
    are_any_dependent = dealii::Utilities::MPI::max(dependent.empty() ? 0 : 1, communicator()) == 1;
  }

  template <int dim>
  const DependentNode *Nodes<dim>::dependent_node(const dealii::types::global_dof_index node) const
  {
    const auto found =
        std::lower_bound(dependent.begin(), dependent.end(), node,
                         [](const DependentNode &row, const dealii::types::global_dof_index other)
                         { return row.node < other; });
    return found != dependent.end() && found->node == node ? &*found : nullptr;
  }

  template <int dim>
  std::map<dealii::types::global_dof_index, dealii::Point<dim>>
  Nodes<dim>::points_depended_on() const
  {
    std::map<dealii::types::global_dof_index, dealii::Point<dim>> result;
    for (const DependentNode &row : dependent)
      for (const auto &weight : row.weights)
        result[weight.first];
    for (const auto &cell : handler.active_cell_iterators())
      if (!result.empty() && !cell->is_artificial())
        for (const unsigned int v : cell->vertex_indices())
          if (const auto found = result.find(cell->vertex_dof_index(v, 0)); found != result.end())
            found->second = cell->vertex(v);
    return result;
  }

  template <int dim>
  bool Nodes<dim>::is_outer_face(const Cell &cell, const unsigned int face) const
  {
    const auto cell_face = cell->face(face);
    if (!cell_face->at_boundary())
      return false;
    unsigned int mirrors = ~0u;
    for (const unsigned int v : cell_face->vertex_indices())
      mirrors &= images_of_body->at(cell_face->vertex(v), 1e-6 * cell->diameter());
    return mirrors == 0;
  }

  template <int dim>
  std::string Nodes<dim>::outer_face_text() const
  {
    return "face of the boundary" +
           (images_of_body->empty() ? std::string() : " outside of " + Images::words(false));
  }

  template <int dim>
  void update_ghost_flags(const Nodes<dim> &nodes, std::vector<bool> &flags)
  {
    using Cell = typename Nodes<dim>::Cell;
    dealii::GridTools::exchange_cell_data_to_ghosts<std::uint8_t, dealii::DoFHandler<dim>>(
        nodes.dof_handler(),
        [&](const Cell &cell) { return std::uint8_t(flags[cell->active_cell_index()] ? 1 : 0); },
        [&](const Cell &cell, const std::uint8_t &flag)
        { flags[cell->active_cell_index()] = flag != 0; });
  }

  template <int dim>
  double largest_cell_diameter(const Nodes<dim> &nodes)
  {
    return dealii::Utilities::MPI::max(
        dealii::GridTools::maximal_cell_diameter(nodes.dof_handler().get_triangulation()),
        nodes.communicator());
  }

  template class Nodes<2>;
  template class Nodes<3>;
  template void update_ghost_flags(const Nodes<2> &, std::vector<bool> &);
  template void update_ghost_flags(const Nodes<3> &, std::vector<bool> &);
  template double largest_cell_diameter(const Nodes<2> &);
  template double largest_cell_diameter(const Nodes<3> &);
} // namespace tombolo
