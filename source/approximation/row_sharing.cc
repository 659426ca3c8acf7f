// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/row_sharing.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    constexpr unsigned int n_gradient = Stencils::n_gradient;

    std::uint64_t hash_of(const unsigned int n, const double *value)
    {
      // Far coarser than what rows differ by: a value that happens to be rounded both ways keeps
      // its row twice, which does no harm.
      constexpr double resolution = 1 << 26;
      std::uint64_t hash = n;
      for (unsigned int k = 0; k < n; ++k)
        hash = (hash ^ static_cast<std::uint64_t>(std::llrint(value[k] * resolution))) *
               0x9e3779b97f4a7c15u;
      return hash ^ (hash >> 32);
    }
  } // namespace

  bool RowSharing::is_same(const Kept &kept, const unsigned int n, const double *value,
                           const double *gradient) const
  {
    if (kept.n != n)
      return false;
    const double *const kept_value = kept_values.data() + kept.start;
    const double *const kept_gradient = kept_gradients.data() + n_gradient * kept.start;
    double difference = 0;
    for (unsigned int k = 0; k < n; ++k)
      difference = std::max(difference, std::abs(kept_value[k] - value[k]));
    double of_gradients = 0, largest = 0;
    for (unsigned int k = 0; k < n_gradient * n; ++k)
    {
      of_gradients = std::max(of_gradients, std::abs(kept_gradient[k] - gradient[k]));
      largest = std::max(largest, std::abs(kept_gradient[k]));
    }
    return difference <= tolerance && of_gradients <= tolerance * largest;
  }

  std::size_t RowSharing::add(const unsigned int n, const double *value, const double *gradient)
  {
    const std::uint64_t hash = hash_of(n, value);
    const auto range = kept_rows.equal_range(hash);
    for (auto row = range.first; row != range.second; ++row)
      if (is_same(row->second, n, value, gradient))
        return row->second.start;
    const std::size_t start = kept_values.size();
    kept_values.insert(kept_values.end(), value, value + n);
    kept_gradients.insert(kept_gradients.end(), gradient, gradient + std::size_t(n_gradient) * n);
    kept_rows.insert({hash, {start, n}});
    return start;
  }

  void RowSharing::store(Stencils &shape) const
  {
    shape.value.resize_fast(kept_values.size());
    std::copy(kept_values.begin(), kept_values.end(), shape.value.begin());
    shape.gradient.resize_fast(kept_gradients.size() + 1);
    std::copy(kept_gradients.begin(), kept_gradients.end(), shape.gradient.begin());
    shape.gradient.back() = 0.;
  }
} // namespace tombolo
