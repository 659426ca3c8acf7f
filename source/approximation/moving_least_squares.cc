// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/moving_least_squares.h>

#include <tombolo/approximation/factors.h>
#include <tombolo/approximation/row_batch.h>
#include <tombolo/approximation/row_sharing.h>

#include <deal.II/lac/lapack_full_matrix.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    using internal::Factors;
    using internal::RowBatch;
    constexpr unsigned int n_gradient_terms = Stencils::n_gradient;

    /** Condition number of a symmetric positive semidefinite matrix; infinite where singular. */
    template <int n>
    double condition_number(const double (&matrix)[n][n])
    {
      LAPACKFullMatrix<double> a(n, n);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
        {
          if (!std::isfinite(matrix[i][j]))
            return std::numeric_limits<double>::infinity();
          a(i, j) = matrix[i][j];
        }
      a.compute_svd();
      const double largest = a.singular_value(0);
      const double smallest = a.singular_value(n - 1);
      return smallest > 1e-14 * largest ? largest / smallest
                                        : std::numeric_limits<double>::infinity();
    }
  } // namespace

  template <int dim>
  MovingLeastSquares<dim>::MovingLeastSquares(std::shared_ptr<const Kernel> kernel)
      : chosen_kernel(std::move(kernel))
  {}

  template <int dim>
  const std::vector<BasisDefect> &
  MovingLeastSquares<dim>::compute(const std::vector<unsigned int> &nodes, const double *position,
                                   const double *support, Stencils &shape, const bool share_rows)
  {
    defects.clear();
    const unsigned int n_rows = shape.n_particles();
    const std::size_t n_entries = shape.neighbour.size();
    Assert(shape.row_start.size() == n_rows + 1 && shape.row_start[n_rows] == n_entries,
           ExcInternalError());
    shape.inverse_deformation_is_current = false;
    shape.coefficient_start.assign(shape.row_start.begin(), shape.row_start.end() - 1);
    if (nodes.empty())
    {
      shape.value.resize_fast(0);
      shape.gradient.resize_fast(0);
      return defects;
    }

    const std::size_t n_records = *std::max_element(nodes.begin(), nodes.end()) + std::size_t(1);
    if (records.size() < n_records)
      records.resize_fast(n_records);
    for (const unsigned int node : nodes)
    {
      const double *const x = position + std::size_t(node) * node_stride;
      const double *const a = support + std::size_t(node) * node_stride;
      NodeRecord &record = records[node];
      for (unsigned int d = 0; d < dim; ++d)
      {
        record.position[d] = x[d];
        record.inverse_support[d] = 1. / a[d];
      }
      for (unsigned int d = dim; d < node_stride; ++d)
        record.position[d] = record.inverse_support[d] = 0.;
    }
    if (share_rows && compute_shared(shape))
      return defects;
    shape.value.resize_fast(n_entries);
    shape.gradient.resize_fast(n_entries * n_gradient_terms + 1);
    shape.gradient[n_entries * n_gradient_terms] = 0.;
    for (unsigned int row = 0; row < n_rows; row += n_lanes)
      compute_batch(row, n_rows, shape, shape.value.data() + shape.row_start[row],
                    shape.gradient.data() + shape.row_start[row] * n_gradient_terms);
    return defects;
  }

  template <int dim>
  bool MovingLeastSquares<dim>::compute_shared(Stencils &shape)
  {
    // Enough to know whether it is worth it.
    constexpr unsigned int n_tried_rows = 4096;
    RowSharing sharing;
    AlignedVector<double> value, gradient;
    const unsigned int n_rows = shape.n_particles();
    for (unsigned int first = 0; first < n_rows; first += n_lanes)
    {
      const unsigned int end = std::min(first + n_lanes, n_rows);
      const std::size_t begin_entry = shape.row_start[first];
      value.resize_fast(shape.row_start[end] - begin_entry);
      gradient.resize_fast((shape.row_start[end] - begin_entry) * n_gradient_terms);
      compute_batch(first, n_rows, shape, value.data(), gradient.data());
      for (unsigned int row = first; row < end; ++row)
      {
        const std::size_t entry = shape.row_start[row] - begin_entry;
        const auto n = static_cast<unsigned int>(shape.row_start[row + 1] - shape.row_start[row]);
        shape.coefficient_start[row] =
            sharing.add(n, value.data() + entry, gradient.data() + n_gradient_terms * entry);
      }
      if ((end % n_tried_rows == 0 || end == n_rows) &&
          2 * sharing.values().size() > shape.row_start[end])
      {
        defects.clear();
        shape.coefficient_start.assign(shape.row_start.begin(), shape.row_start.end() - 1);
        return false;
      }
    }
    shape.value.resize_fast(sharing.values().size());
    std::copy(sharing.values().begin(), sharing.values().end(), shape.value.begin());
    shape.gradient.resize_fast(sharing.gradients().size() + 1);
    std::copy(sharing.gradients().begin(), sharing.gradients().end(), shape.gradient.begin());
    shape.gradient[sharing.gradients().size()] = 0.;
    return true;
  }

  template <int dim>
  void MovingLeastSquares<dim>::compute_batch(const unsigned int first_row,
                                              const unsigned int end_row, const Stencils &shape,
                                              double *const value, double *const gradient)
  {
    constexpr int n = dim + 1;
    static_assert(sizeof(NodeRecord) == 2 * node_stride * sizeof(double), "as RowBatch reads them");
    RowBatch<dim> batch;
    batch.set_rows(first_row, end_row, shape, records[0].position);
    const std::size_t n_values = std::size_t(batch.longest) * dim * n_lanes;
    if (coordinate.size() < n_values)
      for (auto *buffer : {&coordinate, &offset, &inverse_support, &weight, &weight_slope})
        buffer->resize_fast(n_values);
    if (result.size() < std::size_t(batch.longest) * n_lanes)
      result.resize_fast(std::size_t(batch.longest) * n_lanes);
    batch.offset = offset.data();
    batch.inverse_support = inverse_support.data();
    batch.weight = weight.data();
    batch.slope = weight_slope.data();
    batch.result = result.data();

    batch.gather(records[0].position, coordinate.data());
    chosen_kernel->evaluate(n_values, coordinate.data(), weight.data(), weight_slope.data());
    Lanes moment[n][n] = {};
    batch.multiply_weights(moment);
    Factors<n> factors;
    factors.factorize(moment);
    Lanes c[n] = {};
    c[0] += 1.;
    factors.solve(c);
    Lanes b[dim][n] = {};
    batch.subtract_slopes(c, b);
    for (unsigned int d = 0; d < dim; ++d)
    {
      b[d][d + 1] += batch.scale[d];
      factors.solve(b[d]);
    }
    batch.write(c, b, value, gradient);

    // The trace and the determinant, unlike single pivots, do not depend on the order of axes. They
    // bound the condition by 4 (tr/n)^n/det, which few rows need to be looked at for; it is NaN or
    // negative where the matrix is singular.
    constexpr double suspicious = 1e5;
    Lanes determinant = 1., mean = 0.;
    for (int k = 0; k < n; ++k)
    {
      determinant *= factors.pivot[k];
      mean += moment[k][k] / static_cast<double>(n);
    }
    Lanes power = 1.;
    for (int k = 0; k < n; ++k)
      power *= mean;
    for (unsigned int lane = 0; lane < batch.n_rows; ++lane)
      if (!(suspicious * determinant[lane] > power[lane]))
        check_basis(first_row + lane, shape, value + batch.start[lane],
                    gradient + batch.start[lane] * n_gradient_terms);
  }

  template <int dim>
  void MovingLeastSquares<dim>::check_basis(const unsigned int row, const Stencils &shape,
                                            double *const value, double *const gradient)
  {
    const unsigned int *const neighbours = shape.neighbour.data() + shape.row_start[row];
    const auto length = static_cast<unsigned int>(shape.row_start[row + 1] - shape.row_start[row]);
    std::vector<const NodeRecord *> row_neighbours;
    for (unsigned int slot = 0; slot < length; ++slot)
      row_neighbours.push_back(&records[neighbours[slot]]);
    const NodeRecord &own = records[shape.particle_node[row]];
    double matrix[dim + 1][dim + 1];
    BasisDefect defect{row, 0, 0.};
    moment_matrix(own.position, own.inverse_support, row_neighbours, 1., matrix,
                  defect.n_neighbours);
    defect.condition = condition_number(matrix);
    if (defect.condition <= largest_condition)
      return;
    defects.push_back(defect);
    set_shepard(own.position, neighbours, length, value);
    std::fill_n(gradient, std::size_t(length) * n_gradient_terms, 0.);
  }

  template <int dim>
  void MovingLeastSquares<dim>::set_shepard(const double *center, const unsigned int *neighbours,
                                            const unsigned int n_neighbours, double *value) const
  {
    double sum = 0;
    for (unsigned int k = 0; k < n_neighbours; ++k)
    {
      const NodeRecord &record = records[neighbours[k]];
      std::array<double, padded_to_lanes(dim)> r = {}, w, dw;
      for (unsigned int d = 0; d < dim; ++d)
        r[d] = (record.position[d] - center[d]) * record.inverse_support[d];
      chosen_kernel->evaluate(r.size(), r.data(), w.data(), dw.data());
      value[k] = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        value[k] *= w[d];
      sum += value[k];
    }
    for (unsigned int k = 0; k < n_neighbours; ++k)
      value[k] /= sum;
  }

  template <int dim>
  void MovingLeastSquares<dim>::moment_matrix(const double *center, const double *inverse_scale,
                                              const std::vector<const NodeRecord *> &neighbours,
                                              const double support_factor,
                                              double (&moment)[dim + 1][dim + 1],
                                              unsigned int &n_neighbours) const
  {
    n_neighbours = 0;
    for (auto &line : moment)
      std::fill(std::begin(line), std::end(line), 0.);
    for (const NodeRecord *neighbour : neighbours)
    {
      std::array<double, padded_to_lanes(dim)> r = {}, w, dw;
      std::array<double, dim + 1> q;
      q[0] = 1.;
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double difference = neighbour->position[d] - center[d];
        r[d] = difference * neighbour->inverse_support[d] / support_factor;
        q[d + 1] = difference * inverse_scale[d] / support_factor;
      }
      chosen_kernel->evaluate(r.size(), r.data(), w.data(), dw.data());
      double product = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        product *= w[d];
      n_neighbours += product > 0. ? 1 : 0;
      for (unsigned int i = 0; i <= dim; ++i)
        for (unsigned int j = 0; j <= dim; ++j)
          moment[i][j] += product * q[i] * q[j];
    }
  }

  template <int dim>
  double MovingLeastSquares<dim>::sufficient_support_factor(
      const unsigned int particle, const std::vector<unsigned int> &nodes, const double *position,
      const double *support, const double largest_factor, const double sufficient_condition) const
  {
    const double *const center = position + std::size_t(particle) * node_stride;
    std::vector<NodeRecord> near;
    for (const unsigned int node : nodes)
    {
      NodeRecord record = {};
      bool reaches = true;
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double a = support[std::size_t(node) * node_stride + d];
        record.position[d] = position[std::size_t(node) * node_stride + d];
        record.inverse_support[d] = 1. / a;
        reaches &= std::abs(record.position[d] - center[d]) < largest_factor * a;
      }
      if (reaches)
        near.push_back(record);
    }
    std::vector<const NodeRecord *> neighbours;
    for (const NodeRecord &record : near)
      neighbours.push_back(&record);
    double inverse_scale[dim];
    for (unsigned int d = 0; d < dim; ++d)
      inverse_scale[d] = 1. / support[std::size_t(particle) * node_stride + d];
    for (double factor = 1.; factor <= largest_factor; factor *= 1.05)
    {
      double matrix[dim + 1][dim + 1];
      unsigned int n_neighbours;
      moment_matrix(center, inverse_scale, neighbours, factor, matrix, n_neighbours);
      if (n_neighbours > dim && condition_number(matrix) < sufficient_condition)
        return factor;
    }
    return 0.;
  }

  template <int dim>
  const Kernel &MovingLeastSquares<dim>::kernel() const
  {
    return *chosen_kernel;
  }

  template class MovingLeastSquares<2>;
  template class MovingLeastSquares<3>;
} // namespace tombolo
