// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>
#include <tombolo/base/simd/eight_doubles.h>
#include <tombolo/base/simd/vector_math.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/point.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Values of ConvexApproximation::evaluate_moved() at up to eight points with the same neighbours,
   * one a lane: the same functions to round-off. Newton's method takes whole steps only; a point
   * where one is not accepted has no values.
   */
  template <int dim>
  class MovedConvexValues
  {
  public:
    static constexpr unsigned int most_points = 8;

    explicit MovedConvexValues(std::shared_ptr<const Kernel> kernel) : kernel(std::move(kernel)) {}

    /** @p n neighbours of all points, with arrays as of ConvexApproximation::evaluate_moved(). */
    void set_neighbours(const unsigned int n, const double *const position,
                        const double *const support, const double *const present)
    {
      constexpr double nowhere = 1e300;
      n_neighbours = (std::size_t(n) + 7) / 8 * 8;
      for (unsigned int d = 0; d < dim; ++d)
      {
        initial[d].assign(n_neighbours, nowhere);
        inverse_support[d].assign(n_neighbours, 1.);
        moved[d].assign(n_neighbours, 0.);
        for (unsigned int k = 0; k < n; ++k)
        {
          initial[d][k] = position[k * node_stride + d];
          inverse_support[d][k] = 1. / support[k * node_stride + d];
          moved[d][k] = present[k * node_stride + d];
        }
      }
      if (numbers.size() >= n_neighbours * most_points)
        return;
      const std::size_t size = n_neighbours * most_points;
      numbers.resize(size);
      for (std::vector<double> *const buffer : {&coordinate, &offset, &factor, &slope})
        buffer->resize(size * dim);
      for (std::vector<double> *const buffer : {&weight, &basis_value})
        buffer->resize(size);
    }

    using Points = std::array<dealii::Point<dim>, most_points>;

    /** At @p n points @p x, now at @p present_x. Returns those that have values, as bits. */
    unsigned int evaluate(const unsigned int n, const Points &x, const Points &present_x)
    {
      // As in ConvexApproximation::minimize().
      constexpr double tolerance = 1e-13, least_decrease = 1e-4, largest = 1e300;
      constexpr unsigned int most_iterations = 30;
      n_rows = 0;
      n_active.fill(0);
      for (unsigned int lane = 0; lane < n; ++lane)
        find_neighbours(lane, x[lane], present_x[lane]);
      find_weights();
      EightDoubles multiplier[dim];
      for (EightDoubles &component : multiplier)
        component = 0.;
      Sums sums = sums_at(multiplier);
      EightDoubles norm = norm_of(sums);
      unsigned int is_found = 0, is_open = (1u << n) - 1;
      for (unsigned int iteration = 0; iteration < most_iterations; ++iteration)
      {
        const unsigned int is_done = is_open & bits_of(norm < tolerance);
        is_found |= is_done;
        is_open &= ~is_done;
        if (is_open == 0)
          break;
        EightDoubles step[dim];
        const EightDoubles predicted = find_step(sums, step);
        // Points that have converged stay.
        const auto is_large = !(norm < tolerance);
        for (unsigned int d = 0; d < dim; ++d)
          std::experimental::where(is_large, multiplier[d]) += step[d];
        const Sums next = sums_at(multiplier);
        const EightDoubles next_norm = norm_of(next);
        is_open &= bits_of(next.total < largest) & bits_of(next.total > 0.) &
                   (bits_of(next.total <= sums.total + least_decrease * predicted) |
                    bits_of(next_norm <= 0.5 * norm));
        sums = next;
        norm = next_norm;
      }
      find_basis(multiplier);
      for (std::size_t first = 0; first < n_rows * most_points; first += most_points)
        store_eight(load_eight(weight.data() + first) * load_eight(basis_value.data() + first) /
                        sums.total,
                    basis_value.data() + first);
      return is_found;
    }

    /** The number of neighbours whose supports reach a point. */
    unsigned int n_values(const unsigned int lane) const
    {
      return n_active[lane];
    }

    /** The neighbour of a value, below n_values(); ascending. */
    unsigned int neighbour(const unsigned int lane, const unsigned int k) const
    {
      return numbers[k * most_points + lane];
    }

    double value(const unsigned int lane, const unsigned int k) const
    {
      return basis_value[k * most_points + lane];
    }

  private:
    /** F = Σ w exp, r and the lower half of the Hessian at one λ a lane. */
    struct Sums
    {
      EightDoubles total, residual[dim], hessian[dim * (dim + 1) / 2];
    };

    void find_neighbours(const unsigned int lane, const dealii::Point<dim> &x,
                         const dealii::Point<dim> &present_x)
    {
      constexpr double outside = 2.; // of any support
      unsigned int row = 0;
      for (std::size_t first = 0; first < n_neighbours; first += 8)
      {
        double eight_values[dim][8];
        unsigned int is_reached = 0xFFu;
        for (unsigned int d = 0; d < dim; ++d)
        {
          const EightDoubles value = (load_eight(initial[d].data() + first) - x[d]) *
                                     load_eight(inverse_support[d].data() + first);
          store_eight(value, eight_values[d]);
          is_reached &= bits_of(value < 1.) & bits_of(value > -1.);
        }
        for (unsigned int k = 0; is_reached != 0; ++k, is_reached >>= 1)
        {
          if ((is_reached & 1u) == 0)
            continue;
          if (row == n_rows)
          {
            std::fill_n(coordinate.begin() + std::ptrdiff_t(row * dim * most_points),
                        dim * most_points, outside);
            std::fill_n(offset.begin() + std::ptrdiff_t(row * dim * most_points), dim * most_points,
                        0.);
            ++n_rows;
          }
          for (unsigned int d = 0; d < dim; ++d)
          {
            const std::size_t entry = (std::size_t(row) * dim + d) * most_points + lane;
            coordinate[entry] = eight_values[d][k];
            offset[entry] = moved[d][first + k] - present_x[d];
          }
          numbers[std::size_t(row) * most_points + lane] = static_cast<unsigned int>(first) + k;
          ++row;
        }
      }
      n_active[lane] = row;
    }
    void find_weights()
    {
      kernel->evaluate(n_rows * dim * most_points, coordinate.data(), factor.data(), slope.data());
      EightDoubles sum = 0., count = 0.;
      for (std::size_t row = 0; row < n_rows; ++row)
      {
        EightDoubles product = load_eight(factor.data() + row * dim * most_points);
        EightDoubles square = 0.;
        for (unsigned int d = 0; d < dim; ++d)
        {
          const EightDoubles offset_component =
              load_eight(offset.data() + (row * dim + d) * most_points);
          square += offset_component * offset_component;
          if (d > 0)
            product *= load_eight(factor.data() + (row * dim + d) * most_points);
        }
        store_eight(product, weight.data() + row * most_points);
        EightDoubles distance = root_of(square), one = 1.;
        std::experimental::where(product == 0., distance) = 0.;
        std::experimental::where(product == 0., one) = 0.;
        sum += distance;
        count += one;
      }
      std::experimental::where(sum == 0., sum) = 1.;
      const EightDoubles inverse_mean = count / sum;
      for (std::size_t entry = 0; entry < n_rows * dim * most_points; entry += most_points)
        store_eight(load_eight(offset.data() + entry) * inverse_mean, offset.data() + entry);
    }
    void find_basis(const EightDoubles (&multiplier)[dim])
    {
      for (std::size_t row = 0; row < n_rows; ++row)
      {
        const double *const row_offset = offset.data() + row * dim * most_points;
        EightDoubles argument = multiplier[0] * load_eight(row_offset);
        TOMBOLO_UNROLL
        for (unsigned int d = 1; d < dim; ++d)
          argument += multiplier[d] * load_eight(row_offset + d * most_points);
        store_eight(argument, basis_value.data() + row * most_points);
      }
      double *const value = basis_value.data();
      const std::size_t n = n_rows * most_points;
      for (std::size_t k = 0; k < n; ++k)
        value[k] = std::exp(value[k]);
    }
    Sums sums_at(const EightDoubles (&multiplier)[dim])
    {
      find_basis(multiplier);
      Sums sums;
      sums.total = 0.;
      for (EightDoubles &entry : sums.residual)
        entry = 0.;
      for (EightDoubles &entry : sums.hessian)
        entry = 0.;
      for (std::size_t row = 0; row < n_rows; ++row)
      {
        const std::size_t first = row * most_points;
        const EightDoubles row_weight = load_eight(weight.data() + first);
        const EightDoubles value = row_weight * load_eight(basis_value.data() + first);
        sums.total += value;
        EightDoubles at[dim];
        TOMBOLO_UNROLL
        for (unsigned int i = 0; i < dim; ++i)
        {
          at[i] = load_eight(offset.data() + first * dim + i * most_points);
          sums.residual[i] += value * at[i];
          TOMBOLO_UNROLL
          for (unsigned int j = 0; j <= i; ++j)
            sums.hessian[i * (i + 1) / 2 + j] += value * at[i] * at[j];
        }
      }
      return sums;
    }

    /** |r| / Σ w exp */
    static EightDoubles norm_of(const Sums &sums)
    {
      EightDoubles square = 0.;
      for (const EightDoubles &entry : sums.residual)
        square += entry * entry;
      return root_of(square) / sums.total;
    }
    /** Newton's step; returns its product with r. */
    static EightDoubles find_step(const Sums &sums, EightDoubles (&step)[dim])
    {
      // As in ConvexApproximation, for neighbours in one plane.
      constexpr double relative_shift = 1e-14;
      const EightDoubles *const r = sums.residual;
      const EightDoubles *const lower = sums.hessian;
      if constexpr (dim == 2)
      {
        const EightDoubles shift = relative_shift * (lower[0] + lower[2]);
        const EightDoubles a = lower[0] + shift, b = lower[1], c = lower[2] + shift;
        const EightDoubles scale = -1. / (a * c - b * b);
        step[0] = scale * (c * r[0] - b * r[1]);
        step[1] = scale * (a * r[1] - b * r[0]);
      }
      else
      {
        const EightDoubles shift = relative_shift * (lower[0] + lower[2] + lower[5]);
        const EightDoubles xx = lower[0] + shift, yx = lower[1], yy = lower[2] + shift,
                           zx = lower[3], zy = lower[4], zz = lower[5] + shift;
        const EightDoubles cofactor_xx = yy * zz - zy * zy, cofactor_yx = zy * zx - yx * zz,
                           cofactor_zx = yx * zy - yy * zx;
        const EightDoubles scale = -1. / (xx * cofactor_xx + yx * cofactor_yx + zx * cofactor_zx);
        const EightDoubles cofactor_zy = yx * zx - xx * zy;
        step[0] = scale * (cofactor_xx * r[0] + cofactor_yx * r[1] + cofactor_zx * r[2]);
        step[1] = scale * (cofactor_yx * r[0] + (xx * zz - zx * zx) * r[1] + cofactor_zy * r[2]);
        step[2] = scale * (cofactor_zx * r[0] + cofactor_zy * r[1] + (xx * yy - yx * yx) * r[2]);
      }
      EightDoubles result = step[0] * r[0];
      for (unsigned int d = 1; d < dim; ++d)
        result += step[d] * r[d];
      return result;
    }

    std::shared_ptr<const Kernel> kernel;
    // Of neighbours, padded to multiples of eight by neighbours that reach nothing.
    std::array<std::vector<double>, dim> initial, inverse_support, moved;
    std::size_t n_neighbours = 0;

    // Of those that reach a point, by row, component and lane: rows of a lane beyond its own
    // have no weight.
    std::size_t n_rows = 0;
    std::array<unsigned int, most_points> n_active{};
    std::vector<unsigned int> numbers;
    std::vector<double> coordinate, offset, factor, slope;
    std::vector<double> weight, basis_value; // by row and lane
  };
} // namespace tombolo
