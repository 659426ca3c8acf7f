// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/moving_least_squares.h>

#include <tombolo/approximation/row_sharing.h>
#include <tombolo/base/simd/node_lanes.h>

#include <deal.II/lac/lapack_full_matrix.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int n_gradient = Stencils::n_gradient;

    /** Of n_lanes places of node_stride doubles, components 0 ... dim-1. */
    template <int dim>
    void load_transposed(const double *const place[n_lanes], const std::size_t offset,
                         Lanes (&component)[dim])
    {
      NodeLanes node[n_lanes];
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        node[lane] = load_node(place[lane] + offset);
      nodes_to_lanes(node, component);
    }

    /** LDLᵀ factors of n_lanes symmetric matrices of n × n, one in each lane. */
    template <int n>
    struct Factors
    {
      Lanes lower[n][n]; ///< L below the diagonal
      Lanes inverse_pivot[n];
      Lanes pivot[n];

      /** @p a holds the lower triangle. */
      void factorize(const Lanes (&a)[n][n])
      {
        for (int j = 0; j < n; ++j)
        {
          Lanes scaled[n]; // L_jk D_k
          Lanes d = a[j][j];
          for (int k = 0; k < j; ++k)
          {
            scaled[k] = lower[j][k] * pivot[k];
            d -= lower[j][k] * scaled[k];
          }
          pivot[j] = d;
          inverse_pivot[j] = 1. / d;
          for (int i = j + 1; i < n; ++i)
          {
            Lanes sum = a[i][j];
            for (int k = 0; k < j; ++k)
              sum -= lower[i][k] * scaled[k];
            lower[i][j] = sum * inverse_pivot[j];
          }
        }
      }

      void solve(Lanes (&b)[n]) const
      {
        for (int i = 1; i < n; ++i)
          for (int k = 0; k < i; ++k)
            b[i] -= lower[i][k] * b[k];
        for (int i = 0; i < n; ++i)
          b[i] *= inverse_pivot[i];
        for (int i = n - 2; i >= 0; --i)
          for (int k = i + 1; k < n; ++k)
            b[i] -= lower[k][i] * b[k];
      }
    };

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
    shape.gradient.resize_fast(n_entries * n_gradient + 1);
    shape.gradient[n_entries * n_gradient] = 0.;
    for (unsigned int row = 0; row < n_rows; row += n_lanes)
      compute_batch(row, n_rows, shape, shape.value.data() + shape.row_start[row],
                    shape.gradient.data() + shape.row_start[row] * n_gradient);
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
      gradient.resize_fast((shape.row_start[end] - begin_entry) * n_gradient);
      compute_batch(first, n_rows, shape, value.data(), gradient.data());
      for (unsigned int row = first; row < end; ++row)
      {
        const std::size_t entry = shape.row_start[row] - begin_entry;
        const auto n = static_cast<unsigned int>(shape.row_start[row + 1] - shape.row_start[row]);
        shape.coefficient_start[row] =
            sharing.add(n, value.data() + entry, gradient.data() + n_gradient * entry);
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
    const unsigned int n_rows = std::min(n_lanes, end_row - first_row);
    const std::size_t first_entry = shape.row_start[first_row];

    // Short rows are filled up with a neighbour outside its own support, which weighs nothing.
    const unsigned int *neighbours[n_lanes];
    std::size_t start[n_lanes];
    unsigned int length[n_lanes];
    NodeRecord outside[n_lanes];
    const double *center_record[n_lanes];
    unsigned int longest = 0, shortest = std::numeric_limits<unsigned int>::max();
    for (unsigned int lane = 0; lane < n_lanes; ++lane)
    {
      const unsigned int row = first_row + std::min(lane, n_rows - 1);
      start[lane] = shape.row_start[row] - first_entry;
      length[lane] = static_cast<unsigned int>(shape.row_start[row + 1] - shape.row_start[row]);
      neighbours[lane] = shape.neighbour.data() + shape.row_start[row];
      const NodeRecord &center = records[shape.particle_node[row]];
      center_record[lane] = center.position;
      longest = std::max(longest, length[lane]);
      shortest = std::min(shortest, length[lane]);
    }
    if (shortest != longest)
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        outside[lane] = records[shape.particle_node[first_row + std::min(lane, n_rows - 1)]];
        outside[lane].position[0] += 4. / outside[lane].inverse_support[0];
      }

    const std::size_t n_values = std::size_t(longest) * dim * n_lanes;
    if (coordinate.size() < n_values)
      for (auto *buffer : {&coordinate, &offset, &inverse_support, &weight, &weight_slope})
        buffer->resize_fast(n_values);
    if (result.size() < std::size_t(longest) * n_lanes)
      result.resize_fast(std::size_t(longest) * n_lanes);

    Lanes center[dim], scale[dim];
    load_transposed(center_record, 0, center);
    load_transposed(center_record, node_stride, scale);
    for (unsigned int slot = 0; slot < longest; ++slot)
    {
      const double *record[n_lanes];
      if (slot < shortest)
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          record[lane] = records[neighbours[lane][slot]].position;
      else
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          record[lane] = slot < length[lane] ? records[neighbours[lane][slot]].position
                                             : outside[lane].position;
      Lanes x[dim], inverse[dim];
      load_transposed(record, 0, x);
      load_transposed(record, node_stride, inverse);
      for (unsigned int d = 0; d < dim; ++d)
      {
        const std::size_t i = (std::size_t(slot) * dim + d) * n_lanes;
        const Lanes difference = x[d] - center[d];
        store_lanes(difference * inverse[d], &coordinate[i]);
        store_lanes(difference * scale[d], &offset[i]);
        store_lanes(inverse[d], &inverse_support[i]);
      }
    }

    chosen_kernel->evaluate(n_values, coordinate.data(), weight.data(), weight_slope.data());

    // M, and the products w_J and ∂_k w_J in place of their factors.
    Lanes moment[n][n] = {};
    for (unsigned int slot = 0; slot < longest; ++slot)
    {
      const std::size_t i = std::size_t(slot) * dim * n_lanes;
      Lanes q[n], factor[dim], slope[dim];
      for (unsigned int d = 0; d < dim; ++d)
      {
        q[d + 1] = load_lanes(&offset[i + d * n_lanes]);
        factor[d] = load_lanes(&weight[i + d * n_lanes]);
        slope[d] = -load_lanes(&weight_slope[i + d * n_lanes]) *
                   load_lanes(&inverse_support[i + d * n_lanes]);
      }
      Lanes w;
      if (dim == 2)
      {
        w = factor[0] * factor[1];
        slope[0] *= factor[1];
        slope[1] *= factor[0];
      }
      else
      {
        constexpr unsigned int z = dim - 1;
        const Lanes xy = factor[0] * factor[1];
        w = xy * factor[z];
        slope[0] *= factor[1] * factor[z];
        slope[1] *= factor[0] * factor[z];
        slope[z] *= xy;
      }
      store_lanes(w, &result[std::size_t(slot) * n_lanes]);
      for (unsigned int d = 0; d < dim; ++d)
        store_lanes(slope[d], &weight_slope[i + d * n_lanes]);
      moment[0][0] += w;
      for (int k = 1; k < n; ++k)
      {
        const Lanes wq = w * q[k];
        moment[k][0] += wq;
        for (int l = 1; l <= k; ++l)
          moment[k][l] += wq * q[l];
      }
    }

    Factors<n> factors;
    factors.factorize(moment);

    Lanes c[n] = {};
    c[0] += 1.;
    factors.solve(c);

    // b_k = M⁻¹ (e_k / a_I,k - Σ_J ∂_k w_J (c · q_J) q_J)
    Lanes b[dim][n] = {};
    for (unsigned int slot = 0; slot < longest; ++slot)
    {
      const std::size_t i = std::size_t(slot) * dim * n_lanes;
      Lanes q[n];
      Lanes cq = c[0];
      for (unsigned int d = 0; d < dim; ++d)
      {
        q[d + 1] = load_lanes(&offset[i + d * n_lanes]);
        cq += c[d + 1] * q[d + 1];
      }
      for (unsigned int d = 0; d < dim; ++d)
      {
        const Lanes t = load_lanes(&weight_slope[i + d * n_lanes]) * cq;
        b[d][0] -= t;
        for (int k = 1; k < n; ++k)
          b[d][k] -= t * q[k];
      }
    }
    for (unsigned int d = 0; d < dim; ++d)
    {
      b[d][d + 1] += scale[d];
      factors.solve(b[d]);
    }

    for (unsigned int slot = 0; slot < longest; ++slot)
    {
      const std::size_t i = std::size_t(slot) * dim * n_lanes;
      const Lanes w = load_lanes(&result[std::size_t(slot) * n_lanes]);
      Lanes cq = c[0];
      Lanes bq[dim];
      for (unsigned int d = 0; d < dim; ++d)
        bq[d] = b[d][0];
      for (unsigned int k = 0; k < dim; ++k)
      {
        const Lanes q = load_lanes(&offset[i + k * n_lanes]);
        cq += c[k + 1] * q;
        for (unsigned int d = 0; d < dim; ++d)
          bq[d] += b[d][k + 1] * q;
      }
      store_lanes(cq * w, &result[std::size_t(slot) * n_lanes]);
      Lanes g[dim];
      for (unsigned int d = 0; d < dim; ++d)
        g[d] = bq[d] * w + load_lanes(&weight_slope[i + d * n_lanes]) * cq;
      NodeLanes node[n_lanes];
      lanes_to_nodes(g, node);
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        if (slot < length[lane])
          std::memcpy(gradient + (start[lane] + slot) * n_gradient, &node[lane],
                      n_gradient * sizeof(double));
    }
    for (unsigned int lane = 0; lane < n_rows; ++lane)
    {
      double *const of_row = value + start[lane];
      for (unsigned int slot = 0; slot < length[lane]; ++slot)
        of_row[slot] = result[std::size_t(slot) * n_lanes + lane];
    }

    // The ratio of the pivots bounds the condition from below, and is NaN or negative where the
    // matrix is singular.
    for (unsigned int lane = 0; lane < n_rows; ++lane)
    {
      double smallest = factors.pivot[0][lane], largest = smallest;
      for (int k = 1; k < n; ++k)
      {
        const double pivot = factors.pivot[k][lane];
        smallest = pivot > smallest ? smallest : pivot;
        largest = pivot > largest ? pivot : largest;
      }
      if (smallest * largest_condition > largest)
        continue;
      const unsigned int row = first_row + lane;
      std::vector<const NodeRecord *> row_neighbours;
      for (unsigned int slot = 0; slot < length[lane]; ++slot)
        row_neighbours.push_back(&records[neighbours[lane][slot]]);
      const NodeRecord &own = records[shape.particle_node[row]];
      double matrix[n][n];
      BasisDefect defect{row, 0, 0.};
      moment_matrix(own.position, own.inverse_support, row_neighbours, 1., matrix,
                    defect.n_neighbours);
      defect.condition = condition_number(matrix);
      defects.push_back(defect);
      set_shepard(center_record[lane], neighbours[lane], length[lane], value + start[lane]);
      std::fill_n(gradient + start[lane] * n_gradient, std::size_t(length[lane]) * n_gradient, 0.);
    }
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

  template <int dim>
  std::size_t MovingLeastSquares<dim>::memory_consumption() const
  {
    std::size_t bytes = records.capacity() * sizeof(NodeRecord);
    for (const auto *buffer :
         {&coordinate, &offset, &inverse_support, &weight, &weight_slope, &result})
      bytes += buffer->memory_consumption();
    return bytes;
  }

  template class MovingLeastSquares<2>;
  template class MovingLeastSquares<3>;
} // namespace tombolo
