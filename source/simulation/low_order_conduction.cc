#include <tombolo/simulation/low_order_conduction.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <array>
#include <vector>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Conduction of a cell with these corners (lexicographic), for k = 1. */
    template <int dim>
    FullMatrix<double> conduction_of_cell(const std::array<Point<dim>, 1u << dim> &corners)
    {
      constexpr unsigned int n = 1u << dim;
      static const QGauss<dim> quadrature(2);
      FullMatrix<double> result(n, n);
      for (unsigned int q = 0; q < quadrature.size(); ++q)
      {
        std::array<Tensor<1, dim>, n> gradients; // in the unit cell
        for (unsigned int k = 0; k < n; ++k)
          for (unsigned int d = 0; d < dim; ++d)
          {
            double derivative = 1.;
            for (unsigned int e = 0; e < dim; ++e)
            {
              const bool is_upper = ((k >> e) & 1u) != 0;
              const double x = quadrature.point(q)[e];
              derivative *= e == d ? (is_upper ? 1. : -1.) : (is_upper ? x : 1. - x);
            }
            gradients[k][d] = derivative;
          }
        Tensor<2, dim> jacobian;
        for (unsigned int k = 0; k < n; ++k)
          jacobian += outer_product(Tensor<1, dim>(corners[k]), gradients[k]);
        const double volume = quadrature.weight(q) * std::abs(determinant(jacobian));
        const Tensor<2, dim> inverse = transpose(invert(jacobian));
        for (auto &gradient : gradients)
          gradient = inverse * gradient;
        for (unsigned int k = 0; k < n; ++k)
          for (unsigned int l = 0; l < n; ++l)
            result(k, l) += volume * (gradients[k] * gradients[l]);
      }
      return result;
    }
  } // namespace

  template <int dim>
  void assemble_low_order_conduction(const Scene<dim> &scene, const double factor,
                                     const NodalVector &diagonal,
                                     TrilinosWrappers::SparseMatrix &matrix)
  {
    constexpr unsigned int n_corners = 1u << dim;
    const Nodes<dim> &nodes = *scene.nodes;
    const NodePartition &partition = *diagonal.partition();
    const unsigned int n = nodes.degree() + 1;

    // Ghosts need to know of prescribed temperatures.
    NodalVector is_constrained;
    is_constrained.reinit(diagonal.partition(), 1);
    for (const unsigned int node : scene.heat->conditions.constrained_nodes())
      *is_constrained.node(node) = 1.;
    is_constrained.update_ghosts();

    const auto for_subcells = [&](const auto &act)
    {
      std::vector<types::global_dof_index> cell_nodes;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        nodes.cell_nodes(cell, cell_nodes);
        std::vector<types::global_dof_index> corners(n_corners);
        for (unsigned int k = 0; k < (dim == 3 ? n - 1 : 1); ++k)
          for (unsigned int j = 0; j + 1 < n; ++j)
            for (unsigned int i = 0; i + 1 < n; ++i)
            {
              for (unsigned int c = 0; c < n_corners; ++c)
                corners[c] = cell_nodes[(i + (c & 1u)) +
                                        n * ((j + ((c >> 1) & 1u)) + n * (k + ((c >> 2) & 1u)))];
              act(scene.part_cells->part_of(cell), corners);
            }
      }
    };

    TrilinosWrappers::SparsityPattern pattern(partition.owned(), partition.owned(),
                                              nodes.relevant(), partition.communicator());
    for_subcells(
        [&](const unsigned int, const std::vector<types::global_dof_index> &corners)
        {
          for (const auto row : corners)
            pattern.add_entries(row, corners.begin(), corners.end());
        });
    pattern.compress();
    matrix.reinit(pattern);
    for_subcells(
        [&](const unsigned int part, const std::vector<types::global_dof_index> &corners)
        {
          std::array<Point<dim>, n_corners> places;
          for (unsigned int c = 0; c < n_corners; ++c)
          {
            const double *const x = scene.state.position.node(partition.local_index(corners[c]));
            for (unsigned int d = 0; d < dim; ++d)
              places[c][d] = x[d];
          }
          FullMatrix<double> of_cell = conduction_of_cell<dim>(places);
          const ThermalProperties &properties = *scene.parts[part].heat;
          of_cell *= factor * properties.conductivity().value(properties.initial_temperature());
          for (unsigned int k = 0; k < n_corners; ++k)
            for (unsigned int l = 0; l < n_corners; ++l)
              if (*is_constrained.node(partition.local_index(corners[k])) > 0. ||
                  *is_constrained.node(partition.local_index(corners[l])) > 0.)
                of_cell(k, l) = 0.;
          matrix.add(corners, of_cell);
        });
    for (unsigned int i = 0; i < partition.n_owned(); ++i)
    {
      const auto node = partition.global_index(i);
      matrix.add(node, node, *is_constrained.node(i) > 0. ? 1. : *diagonal.node(i));
    }
    matrix.compress(VectorOperation::add);
  }

  template void assemble_low_order_conduction<2>(const Scene<2> &, double, const NodalVector &,
                                                 TrilinosWrappers::SparseMatrix &);
  template void assemble_low_order_conduction<3>(const Scene<3> &, double, const NodalVector &,
                                                 TrilinosWrappers::SparseMatrix &);
} // namespace tombolo
