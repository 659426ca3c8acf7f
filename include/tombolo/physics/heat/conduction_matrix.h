// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/formulations/particles/pair_interactions.h>
#include <tombolo/model/model.h>
#include <tombolo/state/dependent_nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <vector>

namespace tombolo
{
  /** Points that conduct between nodes: with g = √(V k) ∇N, K_IJ = Σ g_I·g_J. Averages over
   * particles: with v = √c φ, L_IJ = Σ (Σ_K v_K) v_I δ_IJ - v_I v_J. */
  template <int dim>
  struct ConductingPoints
  {
    std::vector<std::size_t> start = {0};
    std::vector<unsigned int> nodes; ///< local numbers, no images
    std::vector<dealii::Tensor<1, dim>> gradients;
    std::vector<double> values;
    std::vector<double> sums; ///< of values, by point

    /** All of this rank. */
    ConductingPoints(const Model<dim> &model, const NodalVector &field)
    {
      add_cells(model, field);
      add_particle_points(model, field);
    }

  private:
    void add(const unsigned int node, const dealii::Tensor<1, dim> &gradient, const double value)
    {
      nodes.push_back(node);
      gradients.push_back(gradient);
      values.push_back(value);
    }
    void complete_point()
    {
      double sum = 0;
      for (std::size_t k = start.back(); k < nodes.size(); ++k)
        sum += values[k];
      sums.push_back(sum);
      start.push_back(nodes.size());
    }

    /** The 2^dim points of a cell with these corners (lexicographic). */
    void add_cell(const std::array<unsigned int, 1u << dim> &corners, const NodalVector &position,
                  const NodalVector &field, const TemperatureTable &conductivity)
    {
      constexpr unsigned int n = 1u << dim;
      static const dealii::QGauss<dim> quadrature(2);
      for (unsigned int q = 0; q < quadrature.size(); ++q)
      {
        std::array<dealii::Tensor<1, dim>, n> gradients; // in the unit cell
        dealii::Tensor<2, dim> jacobian;
        double temperature = 0;
        for (unsigned int k = 0; k < n; ++k)
        {
          gradients[k] =
              dealii::GeometryInfo<dim>::d_linear_shape_function_gradient(quadrature.point(q), k);
          jacobian += outer_product(vector_of<dim>(position.node(corners[k])), gradients[k]);
          temperature +=
              dealii::GeometryInfo<dim>::d_linear_shape_function(quadrature.point(q), k) *
              *field.node(corners[k]);
        }
        const double volume = quadrature.weight(q) * std::abs(determinant(jacobian));
        const dealii::Tensor<2, dim> inverse =
            std::sqrt(volume * conductivity.value(temperature)) * transpose(invert(jacobian));
        for (unsigned int k = 0; k < n; ++k)
          add(corners[k], inverse * gradients[k], 0.);
        complete_point();
      }
    }

    void add_cells(const Model<dim> &model, const NodalVector &field)
    {
      constexpr unsigned int n_corners = 1u << dim;
      const Nodes<dim> &nodes = *model.nodes;
      const NodePartition &partition = *field.partition();
      const unsigned int n = nodes.degree() + 1;
      std::vector<dealii::types::global_dof_index> cell_nodes;
      std::vector<unsigned int> n_cells(model.parts.size(), 0); // of this rank so far, by part
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        const unsigned int index = model.part_cells->part_of(cell);
        const Part<dim> &part = model.parts[index];
        if (part.formulation->is_removed(n_cells[index]++))
          continue;
        const TemperatureTable &conductivity = part.heat->conductivity();
        if (part.particles != nullptr || conductivity.largest() == 0.)
          continue;
        nodes.cell_nodes(cell, cell_nodes);
        std::array<unsigned int, n_corners> corners;
        for (unsigned int k = 0; k < (dim == 3 ? n - 1 : 1); ++k)
          for (unsigned int j = 0; j + 1 < n; ++j)
            for (unsigned int i = 0; i + 1 < n; ++i)
            {
              for (unsigned int c = 0; c < n_corners; ++c)
                corners[c] = partition.local_index(
                    cell_nodes[(i + (c & 1u)) +
                               n * ((j + ((c >> 1) & 1u)) + n * (k + ((c >> 2) & 1u)))]);
              add_cell(corners, model.state.position, field, conductivity);
            }
      }
    }

    void add_particle_points(const Model<dim> &model, const NodalVector &field)
    {
      const NodePartition &partition = *field.partition();
      const unsigned int n_here = partition.n_owned() + partition.n_ghosts();
      for (const Part<dim> &part : model.parts)
      {
        const TemperatureTable &conductivity = part.heat->conductivity();
        if (part.particles == nullptr || conductivity.largest() == 0.)
          continue;
        // A pair is a point, too: its conductance is a gradient along an axis of its own.
        const PairInteractions<dim> *const pairs = part.particles->pairs();
        const auto add_pair =
            [&](const unsigned int i, const unsigned int j, const double conductance)
        {
          dealii::Tensor<1, dim> gradient;
          gradient[0] = std::sqrt(conductance);
          add(i, gradient, 0.);
          add(j < n_here ? j : partition.images()[j - n_here].source, -gradient, 0.);
          complete_point();
        };
        if (pairs != nullptr && pairs->visit_conductances(model.state.position, field, add_pair))
          continue;
        Stencils &shape = part.particles->stencils();
        if (!shape.inverse_deformation_is_current)
          NodalSmoothing::update_inverse_deformation<dim>(model.state.position.data(), shape);
        const double capacity = part.heat->capacity().value(part.heat->initial_temperature());
        const double *const volumes =
            model.has_mechanics ? part.formulation->points().component(MaterialPoints::volume, 0)
                                : nullptr;
        for (unsigned int row = 0; row < shape.n_particles(); ++row)
        {
          if (shape.is_rigid(row))
            continue;
          const unsigned int node = shape.particle_node[row];
          const double volume = volumes != nullptr
                                    ? volumes[row]
                                    : part.particles->particle_set().initial_volumes()[row];
          const double factor = std::sqrt(volume * conductivity.value(*field.node(node)));
          const double root = std::sqrt(shape.mass[row] * capacity);
          const double *const rows =
              shape.inverse_deformation.data() + 3 * node_stride * std::size_t(row);
          dealii::Tensor<1, dim> sum;
          const std::size_t begin = nodes.size();
          const Stencils::Row stencil = shape.row(row);
          for (unsigned int k = 0; k < stencil.size; ++k)
          {
            dealii::Tensor<1, dim> gradient; // √(V k) F⁻ᵀ∇φ
            for (unsigned int a = 0; a < dim; ++a)
              for (unsigned int b = 0; b < dim; ++b)
                gradient[a] += factor * rows[b * node_stride + a] *
                               stencil.gradient[k * Stencils::n_gradient + b];
            const unsigned int neighbour = stencil.neighbour[k];
            sum += gradient;
            add(neighbour < n_here ? neighbour : partition.images()[neighbour - n_here].source,
                gradient, root * stencil.value[k]);
          }
          // Σ∇φ = 0 but for round-off, which cancels in the differences of add_conduction().
          for (std::size_t k = begin; k < nodes.size(); ++k)
            if (nodes[k] == node)
            {
              gradients[k] -= sum;
              break;
            }
          complete_point();
        }
      }
    }
  };

  /** The entries of each node in a list of points. */
  struct NodeEntries
  {
    struct PointEntry
    {
      unsigned int point;
      unsigned int entry; ///< of that point
    };

    /** Those of node i are entries[start[i]] ... entries[start[i + 1] - 1], in ascending order. */
    std::vector<std::size_t> start;
    std::vector<PointEntry> entries;

    template <int dim>
    NodeEntries(const ConductingPoints<dim> &points, const unsigned int n_nodes)
        : start(n_nodes + 1, 0), entries(points.nodes.size())
    {
      for (const unsigned int node : points.nodes)
        ++start[node + 1];
      for (unsigned int i = 0; i < n_nodes; ++i)
        start[i + 1] += start[i];
      std::vector<std::size_t> next(start.begin(), start.end() - 1);
      const std::size_t n_points = points.start.size() - 1;
      for (std::size_t point = 0; point < n_points; ++point)
        for (std::size_t k = points.start[point]; k < points.start[point + 1]; ++k)
          entries[next[points.nodes[k]]++] = {static_cast<unsigned int>(point),
                                              static_cast<unsigned int>(k - points.start[point])};
    }
  };

  /** 1 at nodes with prescribed temperatures, but for dependent ones, ghosts included; elsewhere
   * 0. Collective. */
  template <int dim>
  NodalVector constrained_nodes_of(const Model<dim> &model,
                                   const std::shared_ptr<const NodePartition> &partition)
  {
    std::vector<bool> is_constrained(partition->n_owned(), false);
    for (const unsigned int node : model.heat->conditions.constrained_nodes())
      is_constrained[node] = true;
    for (const unsigned int node : partition->dependent_nodes().node)
      is_constrained[node] = false;
    return scalar_field(partition, [&](const unsigned int i) { return is_constrained[i]; });
  }

  /** This rank's share of the rows of the matrix, one at a time: the sums of its points in the rows
   * of its nodes and ghosts, and the diagonal of its own nodes. */
  template <int dim>
  class ConductionRows
  {
  public:
    ConductionRows(const Model<dim> &model, const NodalVector &field, const double factor,
                   const double averaging, const NodalVector &diagonal,
                   const NodalVector &is_constrained)
        : factor(factor), averaging(averaging), diagonal(diagonal),
          partition(*diagonal.partition()), is_constrained(is_constrained), points(model, field),
          node_entries(points, n_rows()), column_values(n_rows(), 0.), is_column(n_rows(), false)
    {}

    unsigned int n_rows() const
    {
      return partition.n_owned() + partition.n_ghosts();
    }

    /** Sets columns and values; there are none where this rank adds nothing. */
    void find(const unsigned int row)
    {
      local_columns.clear();
      if (row < partition.n_owned())
      {
        local_columns.push_back(row);
        is_column[row] = true;
        column_values[row] = *is_constrained.node(row) > 0. ? 1. : *diagonal.node(row);
      }
      if (!(*is_constrained.node(row) > 0.))
        add_points(row);
      columns.clear();
      values.clear();
      for (const unsigned int column : local_columns)
      {
        columns.push_back(partition.global_index(column));
        values.push_back(column_values[column]);
        column_values[column] = 0.;
        is_column[column] = false;
      }
    }

    std::vector<dealii::types::global_dof_index> columns; ///< global numbers
    std::vector<double> values;

  private:
    void add_points(const unsigned int row)
    {
      for (std::size_t i = node_entries.start[row]; i < node_entries.start[row + 1]; ++i)
      {
        const auto [point, entry] = node_entries.entries[i];
        const std::size_t begin = points.start[point];
        const dealii::Tensor<1, dim> own = factor * points.gradients[begin + entry];
        const double own_value = averaging * points.values[begin + entry];
        column_values[row] += own_value * points.sums[point];
        for (std::size_t k = begin; k < points.start[point + 1]; ++k)
        {
          const unsigned int column = points.nodes[k];
          if (!is_column[column])
          {
            if (*is_constrained.node(column) > 0.)
              continue;
            is_column[column] = true;
            local_columns.push_back(column);
          }
          column_values[column] += own * points.gradients[k] - own_value * points.values[k];
        }
      }
    }

    const double factor, averaging;
    const NodalVector &diagonal;
    const NodePartition &partition;
    const NodalVector &is_constrained;
    const ConductingPoints<dim> points;
    const NodeEntries node_entries;

    // Of the row, by local number; zero and false between rows.
    std::vector<double> column_values;
    std::vector<bool> is_column;
    std::vector<unsigned int> local_columns;
  };

  /** Carries the numbers of sublattices from cell to cell. */
  template <int dim>
  class SublatticeNumbering
  {
  public:
    static constexpr unsigned int n_corners = 1u << dim;
    static constexpr unsigned int unknown = n_corners;

    explicit SublatticeNumbering(const Nodes<dim> &nodes)
        : nodes(nodes), relevant(nodes.relevant()), number(relevant.n_elements(), unknown),
          is_done(nodes.dof_handler().get_triangulation().n_active_cells(), false)
    {
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
        if (is_open(cell))
          number_connected_cells(cell);
    }

    /** unknown where no cell of this rank has the node. */
    unsigned int number_of(const dealii::types::global_dof_index node) const
    {
      return number[relevant.index_within_set(node)];
    }

  private:
    using Cell = typename Nodes<dim>::Cell;

    bool is_open(const Cell &cell) const
    {
      return cell->is_locally_owned() && !is_done[cell->active_cell_index()];
    }

    unsigned int &number_of_corner(const unsigned int corner)
    {
      return number[relevant.index_within_set(cell_nodes[corner])];
    }

    void number_connected_cells(const Cell &first)
    {
      number_cell(first, dealii::numbers::invalid_unsigned_int);
      std::deque<Cell> front{first};
      while (!front.empty())
      {
        const Cell cell = front.front();
        front.pop_front();
        for (const unsigned int face : cell->face_indices())
        {
          if (cell->at_boundary(face) || !cell->neighbor(face)->is_active() ||
              cell->neighbor_is_coarser(face))
            continue;
          const Cell neighbour = cell->neighbor(face);
          if (!is_open(neighbour))
            continue;
          number_cell(neighbour, cell->neighbor_of_neighbor(face));
          front.push_back(neighbour);
        }
      }
    }

    /** Numbers the corners of a cell by those of its @p face; by its own axes if it has none. */
    void number_cell(const Cell &cell, const unsigned int face)
    {
      is_done[cell->active_cell_index()] = true;
      nodes.cell_nodes(cell, cell_nodes);
      // Corners are numbered by the bits of their indices along the cell's axes. In a neighbour
      // the axes of the common face keep their bits; the other axis gets the remaining bit.
      unsigned int origin = 0, bits[3] = {1u, 2u, 4u};
      if (face != dealii::numbers::invalid_unsigned_int)
      {
        const unsigned int normal = face / 2;
        const unsigned int corner = (face % 2) << normal;
        unsigned int left = n_corners - 1;
        for (unsigned int d = 0; d < dim; ++d)
          if (d != normal)
          {
            bits[d] = number_of_corner(corner) ^ number_of_corner(corner | (1u << d));
            left &= ~bits[d];
          }
        bits[normal] = left;
        origin = number_of_corner(corner) ^ ((face % 2) != 0 ? left : 0u);
      }
      for (unsigned int corner = 0; corner < n_corners; ++corner)
        if (number_of_corner(corner) == unknown)
        {
          unsigned int result = origin;
          for (unsigned int d = 0; d < dim; ++d)
            if (((corner >> d) & 1u) != 0)
              result ^= bits[d];
          number_of_corner(corner) = result % n_corners;
        }
    }

    const Nodes<dim> &nodes;
    const dealii::IndexSet &relevant;
    std::vector<unsigned int> number; ///< by relevant node
    std::vector<bool> is_done;        ///< by active cell
    std::vector<dealii::types::global_dof_index> cell_nodes;
  };

  /**
   * The matrix diag(@p diagonal) + @p factor K + @p averaging L with the conduction of the scene
   * without smoothing, K_IJ = Σ_q V_q k_q ∇N_I(x_q)·∇N_J(x_q): over the particles with their shape
   * functions, over the quadrature points of elements with theirs (of degree 1; those of higher
   * degree count as that many cells between neighbouring nodes), in the present positions and with
   * the conductivities at
   * @p field (node_stride, current ghosts). Where smoothing is `none`, elements have degree 1 and
   * there is no trace bridge, it is that of ThermalModel::apply_conduction() without films. L is
   * the capacity of the part that averaging over the particles removes, diag(Φᵀc) - Φᵀ diag(c) Φ.
   * Rows and columns of nodes with prescribed temperatures, and of nodes that hang on faces of
   * elements, are those of the unit matrix; the conduction of hanging nodes counts at those between
   * which they lie.
   * @p diagonal is scalar, owned values. Collective.
   */
  template <int dim>
  void assemble_conduction_matrix(const Model<dim> &model, const NodalVector &field,
                                  const double factor, const double averaging,
                                  const NodalVector &diagonal,
                                  dealii::TrilinosWrappers::SparseMatrix &matrix)
  {
    const NodePartition &partition = *diagonal.partition();
    const NodalVector is_constrained = constrained_nodes_of(model, diagonal.partition());
    NodalVector free_diagonal(diagonal.partition(), Quantity::scalar);
    free_diagonal.copy_from(diagonal);
    for (const unsigned int node : partition.dependent_nodes().node)
      *free_diagonal.node(node) = 0.;
    ConductionRows<dim> rows(model, field, factor, averaging, free_diagonal, is_constrained);

    const DependentRows dependent(is_constrained);
    dealii::IndexSet writable = partition.owned();
    writable.add_indices(partition.ghosts());
    for (unsigned int row = 0; row < rows.n_rows(); ++row)
      for (const auto &[node, weight] : dependent.weights(partition.global_index(row)))
        writable.add_index(node);
    writable.compress();
    constexpr unsigned int entries_per_row = 0; // unknown; they are allocated as they come
    dealii::TrilinosWrappers::SparsityPattern pattern(
        partition.owned(), partition.owned(), writable, partition.communicator(), entries_per_row);
    // Calls the function with the row of the matrix and the factor of its values.
    const auto for_rows = [&](const auto &add)
    {
      for (unsigned int row = 0; row < rows.n_rows(); ++row)
      {
        const dealii::types::global_dof_index number = partition.global_index(row);
        rows.find(row);
        if (rows.columns.empty())
          continue;
        dependent.condense_columns(rows.columns, rows.values);
        for (const auto &[node, weight] : dependent.weights(number))
          add(node, weight, rows.columns, rows.values);
        if (dependent.depends(number) && row < partition.n_owned())
          add(number, 1., std::vector<dealii::types::global_dof_index>{number},
              std::vector<double>{1.});
      }
    };
    for_rows([&](const auto row, const double, const auto &columns, const auto &)
             { pattern.add_entries(row, columns.begin(), columns.end()); });
    pattern.compress();
    matrix.reinit(pattern);
    for_rows(
        [&](const auto row, const double weight, const auto &columns, std::vector<double> values)
        {
          for (double &value : values)
            value *= weight;
          matrix.add(row, static_cast<unsigned int>(values.size()), columns.data(), values.data());
        });
    matrix.compress(dealii::VectorOperation::add);
  }

  /**
   * Indicators of the sublattices of twice the spacing of each owned node, [sublattice][node]:
   * 2^dim of them. Nodal gradients are differences across a particle and within one sublattice, so
   * that a constant on one of them conducts nearly nothing. Numbers are carried from cell to cell
   * across faces of this rank. Degree 1.
   */
  template <int dim>
  std::vector<std::vector<bool>> sublattices(const Model<dim> &model)
  {
    const Nodes<dim> &nodes = *model.nodes;
    Assert(nodes.degree() == 1, dealii::ExcInternalError());
    using Numbering = SublatticeNumbering<dim>;
    const Numbering numbering(nodes);
    std::vector<std::vector<bool>> result(Numbering::n_corners,
                                          std::vector<bool>(nodes.owned().n_elements(), false));
    for (unsigned int i = 0; i < nodes.owned().n_elements(); ++i)
    {
      const unsigned int sublattice = numbering.number_of(nodes.owned().nth_index_in_set(i));
      result[sublattice == Numbering::unknown ? 0 : sublattice][i] = true;
    }
    return result;
  }
} // namespace tombolo
