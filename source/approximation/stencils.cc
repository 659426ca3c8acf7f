// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/stencils.h>

namespace tombolo
{
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
    // Behind the others: rows that are the same share theirs.
    coefficient_start[i] = value.size();
    value.insert_back(values.begin(), values.end());
    gradient.resize(n_gradient * coefficient_start[i]);
    gradient.insert_back(gradients.begin(), gradients.end());
    gradient.push_back(0.);
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
