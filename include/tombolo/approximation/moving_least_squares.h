// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>
#include <tombolo/approximation/row_sharing.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/vectorization.h>

#include <deal.II/lac/lapack_full_matrix.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

namespace tombolo
{
  /** A particle whose neighbours do not carry the linear basis. */
  struct BasisDefect
  {
    unsigned int row;          ///< index into Stencils::particle_node
    unsigned int n_neighbours; ///< with a weight above zero, the particle itself included
    /** Condition of the moment matrix in coordinates over the support; infinite: singular. */
    double condition;
  };

  namespace internal
  {
    /** Of n_lanes records of node_stride doubles, components 0 ... dim-1. */
    template <int dim>
    void load_transposed(const double *const record[n_lanes], const std::size_t offset,
                         Lanes (&component)[dim])
    {
      NodeLanes node[n_lanes];
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        node[lane] = load_node(record[lane] + offset);
      nodes_to_lanes(node, component);
    }

    /** n_lanes rows that are computed together, one in each lane, and the intermediate values of
     * their neighbours: for each slot (the k-th neighbour of all rows) and axis one Lanes. */
    template <int dim>
    struct RowBatch
    {
      static constexpr int n = dim + 1;
      static constexpr unsigned int n_of_record = 2 * node_stride; ///< position, inverse support

      unsigned int n_rows, longest, shortest;
      const unsigned int *neighbours[n_lanes];
      std::size_t start[n_lanes]; ///< of the row's coefficients, from those of the first row
      unsigned int length[n_lanes];
      const double *center_record[n_lanes];
      alignas(64) double outside[n_lanes][n_of_record];
      Lanes center[dim], scale[dim]; ///< x_I and 1/a_I
      double *offset, *inverse_support, *weight, *slope, *result;

      void set_rows(const unsigned int first_row, const unsigned int end_row, const Stencils &shape,
                    const double *records)
      {
        n_rows = std::min(n_lanes, end_row - first_row);
        longest = 0;
        shortest = std::numeric_limits<unsigned int>::max();
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
        {
          const unsigned int row = first_row + std::min(lane, n_rows - 1);
          start[lane] = shape.row_start[row] - shape.row_start[first_row];
          length[lane] = static_cast<unsigned int>(shape.row_start[row + 1] - shape.row_start[row]);
          neighbours[lane] = shape.neighbour.data() + shape.row_start[row];
          center_record[lane] = records + std::size_t(shape.particle_node[row]) * n_of_record;
          longest = std::max(longest, length[lane]);
          shortest = std::min(shortest, length[lane]);
        }
        // Short rows are filled up with a neighbour outside its own support, which weighs
        // nothing.
        if (shortest != longest)
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
          {
            std::copy_n(center_record[lane], n_of_record, outside[lane]);
            outside[lane][0] += 4. / outside[lane][node_stride];
          }
      }

      /** Differences x_J - x_I over the supports of J (@p coordinate) and of I (offset). */
      void gather(const double *records, double *coordinate)
      {
        load_transposed(center_record, 0, center);
        load_transposed(center_record, node_stride, scale);
        for (unsigned int slot = 0; slot < longest; ++slot)
        {
          const double *record[n_lanes];
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            record[lane] = slot < shortest || slot < length[lane]
                               ? records + std::size_t(neighbours[lane][slot]) * n_of_record
                               : outside[lane];
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
      }

      /** Adds up M, and writes w_J into result and ∂_k w_J instead of their factors. */
      void multiply_weights(Lanes (&moment)[n][n])
      {
        for (unsigned int slot = 0; slot < longest; ++slot)
        {
          const std::size_t i = std::size_t(slot) * dim * n_lanes;
          Lanes q[n], factor[dim], axis_gradient[dim];
          for (unsigned int d = 0; d < dim; ++d)
          {
            q[d + 1] = load_lanes(&offset[i + d * n_lanes]);
            factor[d] = load_lanes(&weight[i + d * n_lanes]);
            axis_gradient[d] = -load_lanes(&slope[i + d * n_lanes]) *
                               load_lanes(&inverse_support[i + d * n_lanes]);
          }
          Lanes w;
          if (dim == 2)
          {
            w = factor[0] * factor[1];
            axis_gradient[0] *= factor[1];
            axis_gradient[1] *= factor[0];
          }
          else
          {
            constexpr unsigned int z = dim - 1;
            const Lanes xy = factor[0] * factor[1];
            w = xy * factor[z];
            axis_gradient[0] *= factor[1] * factor[z];
            axis_gradient[1] *= factor[0] * factor[z];
            axis_gradient[z] *= xy;
          }
          store_lanes(w, &result[std::size_t(slot) * n_lanes]);
          for (unsigned int d = 0; d < dim; ++d)
            store_lanes(axis_gradient[d], &slope[i + d * n_lanes]);
          moment[0][0] += w;
          for (int k = 1; k < n; ++k)
          {
            const Lanes wq = w * q[k];
            moment[k][0] += wq;
            for (int l = 1; l <= k; ++l)
              moment[k][l] += wq * q[l];
          }
        }
      }

      /** Subtracts Σ_J ∂_k w_J (c · q_J) q_J from b_k. */
      void subtract_slopes(const Lanes (&c)[n], Lanes (&b)[dim][n]) const
      {
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
            const Lanes t = load_lanes(&slope[i + d * n_lanes]) * cq;
            b[d][0] -= t;
            for (int k = 1; k < n; ++k)
              b[d][k] -= t * q[k];
          }
        }
      }

      /** φ_J = (c · q_J) w_J and ∇φ_J = (b · q_J) w_J + (c · q_J) ∇w_J. */
      void write(const Lanes (&c)[n], const Lanes (&b)[dim][n], double *value,
                 double *gradient) const
      {
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
            g[d] = bq[d] * w + load_lanes(&slope[i + d * n_lanes]) * cq;
          NodeLanes node[n_lanes];
          lanes_to_nodes(g, node);
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            if (slot < length[lane])
              std::memcpy(gradient + (start[lane] + slot) * Stencils::n_gradient, &node[lane],
                          Stencils::n_gradient * sizeof(double));
        }
        for (unsigned int lane = 0; lane < n_rows; ++lane)
          for (unsigned int slot = 0; slot < length[lane]; ++slot)
            value[start[lane] + slot] = result[std::size_t(slot) * n_lanes + lane];
      }
    };
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
  } // namespace internal

  /**
   * Moving least squares with the basis [1, x, y, z] and tensor products of a kernel, at the
   * particles: fills value and gradient of Stencils for given neighbours (eq. 6 of Pan et
   * al. 2019; doc/method.md, section 2),
   *
   * @verbatim
   *   φ_J(x) = q(x)ᵀ M(x)⁻¹ q(x_J) w_J(x)
   *   M(x) = Σ_J w_J(x) q(x_J) q(x_J)ᵀ
   *   w_J(x) = Π_k w((x_J,k - x_k) / a_J,k)
   * @endverbatim
   *
   * with q = [1, (y - x_I)/a_I] about the evaluation point x_I, so that nothing is lost far from
   * the origin, and the full gradient, with c = M⁻¹ e_0,
   *
   * @verbatim
   *   ∇φ_J = (b · q_J) w_J + (c · q_J) ∇w_J
   *   b_k = M⁻¹ (e_k / a_I,k - Σ_J ∂_k w_J (c · q_J) q_J)
   * @endverbatim
   *
   * Neighbours that are outside their own support keep φ = 0, ∇φ = 0. Eight particles go through
   * the lanes of one batch. Buffers are kept: a second call of the same size allocates nothing.
   */
  template <int dim>
  class MovingLeastSquares
  {
  public:
    /** Moment matrices above this condition number are reported, not solved with. */
    static constexpr double largest_condition = 1e8;

    explicit MovingLeastSquares(std::shared_ptr<const Kernel> kernel)
        : chosen_kernel(std::move(kernel))
    {}

    /**
     * Computes value and gradient of all rows from @p position and half widths @p support,
     * node_stride doubles per local node. @p nodes lists the local nodes that occur as particle or
     * neighbour. A particle with a defect has Shepard's functions, w_J/Σw, and no gradient. The
     * reference stays valid until the next call. With @p share_rows, rows that are the same are
     * kept once (RowSharing), where that at least halves what is kept.
     */
    const std::vector<BasisDefect> &compute(const std::vector<unsigned int> &nodes,
                                            const double *position, const double *support,
                                            Stencils &shape, const bool share_rows = false)
    {
      defects.clear();
      const unsigned int n_rows = shape.n_particles();
      const std::size_t n_entries = shape.neighbour.size();
      Assert(shape.row_start.size() == n_rows + 1 && shape.row_start[n_rows] == n_entries,
             dealii::ExcInternalError());
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

    /**
     * The smallest factor, on a scale of 5 % steps up to @p largest_factor, by which all supports
     * would have to grow for the particle at local node @p particle to have a condition below
     * @p sufficient_condition; zero if none does. Searches all @p nodes: for messages.
     */
    double sufficient_support_factor(const unsigned int particle,
                                     const std::vector<unsigned int> &nodes, const double *position,
                                     const double *support, const double largest_factor = 8.,
                                     const double sufficient_condition = 1e4) const
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

    const Kernel &kernel() const
    {
      return *chosen_kernel;
    }

  private:
    static constexpr unsigned int n_gradient_terms = Stencils::n_gradient;

    /** Condition number of a symmetric positive semidefinite matrix; infinite where singular. */
    template <int n>
    static double condition_number(const double (&matrix)[n][n])
    {
      dealii::LAPACKFullMatrix<double> a(n, n);
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

    /** One node as the batches read it: position and inverse support in one cache line. */
    struct alignas(64) NodeRecord
    {
      double position[node_stride];
      double inverse_support[node_stride];
    };

    /** The moment matrix of a particle, row-major, with weights counted in @p n_neighbours. */
    void moment_matrix(const double *center, const double *inverse_scale,
                       const std::vector<const NodeRecord *> &neighbours,
                       const double support_factor, double (&moment)[dim + 1][dim + 1],
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

    /** w_J/Σw about a centre. */
    void set_shepard(const double *center, const unsigned int *neighbours,
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

    /** Rows first_row ... first_row + 7 below @p end_row; their coefficients go to @p value and @p
     * gradient, which begin with those of the first neighbour of first_row. */
    void compute_batch(const unsigned int first_row, const unsigned int end_row,
                       const Stencils &shape, double *const value, double *const gradient)
    {
      constexpr int n = dim + 1;
      static_assert(sizeof(NodeRecord) == 2 * node_stride * sizeof(double),
                    "as RowBatch reads them");
      internal::RowBatch<dim> batch;
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
      internal::Factors<n> factors;
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

      // The trace and the determinant, unlike single pivots, do not depend on the order of axes.
      // They bound the condition by 4 (tr/n)^n/det, which only few rows exceed; it is
      // NaN or negative where the matrix is singular.
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

    /** Sets a row to Shepard's functions where its condition is too large; records the defect. */
    void check_basis(const unsigned int row, const Stencils &shape, double *const value,
                     double *const gradient)
    {
      const unsigned int *const neighbours = shape.neighbour.data() + shape.row_start[row];
      const auto length =
          static_cast<unsigned int>(shape.row_start[row + 1] - shape.row_start[row]);
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

    /** False, and without a result, where too few rows are the same. */
    bool compute_shared(Stencils &shape)
    {
      // Enough to estimate whether it pays.
      constexpr unsigned int n_tried_rows = 4096;
      RowSharing sharing;
      dealii::AlignedVector<double> value, gradient;
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
        if ((end % n_tried_rows == 0 || end == n_rows) && 2 * sharing.size() > shape.row_start[end])
        {
          defects.clear();
          shape.coefficient_start.assign(shape.row_start.begin(), shape.row_start.end() - 1);
          return false;
        }
      }
      sharing.store(shape);
      return true;
    }

    std::shared_ptr<const Kernel> chosen_kernel;
    std::vector<BasisDefect> defects;
    dealii::AlignedVector<NodeRecord> records;
    dealii::AlignedVector<double> coordinate, offset, inverse_support, weight, weight_slope, result;
  };
} // namespace tombolo
