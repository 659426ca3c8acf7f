// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/stencils.h>

#include <cmath>

namespace tombolo
{
  namespace
  {
    /** Rounded numbers that are read at once, beyond the end of a row, too. */
    constexpr unsigned int block_size = 16;

    void widen(const float *const source, const unsigned int n, double *const target)
    {
      for (unsigned int block = 0; block < n; block += block_size)
        for (unsigned int k = 0; k < block_size; ++k)
          target[block + k] = static_cast<double>(source[block + k]);
    }

    /** Rounds @p n numbers, each @p stride behind the one before, to multiples of one power of two
     * whose sum is that of the numbers, rounded so. */
    void round_with_sum(const double *numbers, const unsigned int n, const unsigned int stride,
                        float *rounded)
    {
      double sum = 0;
      unsigned int largest = 0;
      for (unsigned int k = 0; k < n; ++k)
      {
        sum += numbers[k * stride];
        if (std::abs(numbers[k * stride]) > std::abs(numbers[largest * stride]))
          largest = k;
      }
      const double size = n > 0 ? std::abs(numbers[largest * stride]) : 0.;
      const double unit = size > 0. ? std::ldexp(1., std::ilogb(size) - 22) : 1.;
      double left = std::nearbyint(sum / unit);
      for (unsigned int k = 0; k < n; ++k)
      {
        const double count = std::nearbyint(numbers[k * stride] / unit);
        rounded[k * stride] = static_cast<float>(count * unit);
        left -= count;
      }
      if (left != 0.)
        rounded[largest * stride] += static_cast<float>(left * unit);
    }

    void round_row(const unsigned int n, const double *value, const double *gradient,
                   float *rounded)
    {
      round_with_sum(value, n, 1, rounded);
      for (unsigned int d = 0; d < Stencils::n_gradient; ++d)
        round_with_sum(gradient + d, n, Stencils::n_gradient, rounded + n + d);
    }
  } // namespace

  void Stencils::round()
  {
    constexpr std::size_t width = 1 + n_gradient;
    dealii::AlignedVector<float> all;
    all.resize(width * value.size() + block_size);
    unsigned int largest = 0;
    for (unsigned int i = 0; i < coefficient_start.size(); ++i)
    {
      const Row stencil = row(i);
      largest = std::max(largest, stencil.size);
      round_row(stencil.size, stencil.value, stencil.gradient,
                all.data() + width * coefficient_start[i]);
    }
    // φ and ∇φ begin at whole blocks, so that loads can follow the stores fast.
    last_row.resize(width * block_size * (largest / block_size + 2));
    rounded.swap(all);
    value.clear();
    gradient.clear();
  }

  Stencils::Row Stencils::rounded_row(const unsigned int i, const bool with_values,
                                      const bool with_gradients) const
  {
    const auto n = static_cast<unsigned int>(row_start[i + 1] - row_start[i]);
    const float *const source = rounded.data() + (1 + n_gradient) * coefficient_start[i];
    double *const values = last_row.data(), *const gradients = values + last_row.size() / 4;
    if (with_values)
      widen(source, n, values);
    if (with_gradients)
      widen(source + n, n_gradient * n, gradients);
    return {n, neighbour.data() + row_start[i], values, gradients};
  }

  std::size_t Stencils::append(const std::vector<double> &values,
                               const std::vector<double> &gradients)
  {
    const std::size_t n = values.size();
    if (!rounded.empty())
    {
      const std::size_t start = rounded.size() - block_size;
      rounded.resize(rounded.size() + (1 + n_gradient) * n);
      round_row(static_cast<unsigned int>(n), values.data(), gradients.data(),
                rounded.data() + start);
      return start / (1 + n_gradient);
    }
    const std::size_t start = value.size();
    value.insert_back(values.begin(), values.end());
    gradient.resize(n_gradient * start);
    gradient.insert_back(gradients.begin(), gradients.end());
    gradient.push_back(0.);
    return start;
  }

  void Stencils::remove_negative_values(const unsigned int i)
  {
    if (std::find(non_negative_rows.begin(), non_negative_rows.end(), i) != non_negative_rows.end())
      return;
    const Row old = row(i);
    double sum = 0;
    for (unsigned int k = 0; k < old.size; ++k)
      sum += std::max(old.value[k], 0.);
    std::vector<double> values, gradients(old.gradient, old.gradient + n_gradient * old.size);
    for (unsigned int k = 0; k < old.size; ++k)
      values.push_back(std::max(old.value[k], 0.) / sum);
    coefficient_start[i] = append(values, gradients); // rows that are the same share theirs
    non_negative_rows.push_back(i);
  }

  namespace
  {
    std::ptrdiff_t n_neighbours(const Stencils::Row &row)
    {
      return row.size - std::count(row.value, row.value + row.size, 0.);
    }
  } // namespace

  void FormerRows::remember(const Stencils &shape)
  {
    if (is_kept)
      return;
    is_kept = true;
    former.row_start = shape.row_start;
    former.coefficient_start = shape.coefficient_start;
    former.neighbour = shape.neighbour;
    former.rank_deficient_rows = shape.rank_deficient_rows;
    former.value = shape.value;
    former.value.resize(
        std::max(shape.value.size(), shape.rounded.size() / (1 + Stencils::n_gradient)));
    for (unsigned int i = 0; !shape.rounded.empty() && i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      std::copy_n(row.value, row.size, former.value.data() + former.coefficient_start[i]);
    }
  }

  std::vector<LeavingParticle> FormerRows::leaving(const Stencils &shape,
                                                   const std::vector<unsigned int> &candidates)
  {
    std::vector<LeavingParticle> result;
    if (!std::exchange(is_kept, false))
      return result;
    for (const unsigned int row : candidates)
    {
      LeavingParticle particle{row, {}};
      const double *value = former.value.data() + former.coefficient_start[row];
      std::ptrdiff_t n_before = 0;
      for (std::size_t k = former.row_start[row]; k < former.row_start[row + 1]; ++k, ++value)
      {
        particle.entries.emplace_back(former.neighbour[k], *value);
        n_before += *value != 0. ? 1 : 0;
      }
      if (!former.is_rigid(row) || n_neighbours(shape.row(row)) < n_before)
        result.push_back(std::move(particle));
    }
    return result;
  }
} // namespace tombolo
