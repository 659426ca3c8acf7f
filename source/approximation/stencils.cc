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

  void LeavingParticles::add(const unsigned int of_row, const Stencils::Row &former)
  {
    if (row_start.empty())
      row_start.push_back(0);
    row.push_back(of_row);
    neighbour.insert(neighbour.end(), former.neighbour, former.neighbour + former.size);
    value.insert(value.end(), former.value, former.value + former.size);
    row_start.push_back(neighbour.size());
  }

  void FormerRows::remember(const Stencils &shape)
  {
    if (is_kept)
      return;
    is_kept = true;
    row_start = shape.row_start;
    coefficient_start = shape.coefficient_start;
    neighbour = shape.neighbour;
    rank_deficient_rows = shape.rank_deficient_rows;
    value = shape.value;
  }

  Stencils::Row FormerRows::former_row(const unsigned int i) const
  {
    return {static_cast<unsigned int>(row_start[i + 1] - row_start[i]),
            neighbour.data() + row_start[i], value.data() + coefficient_start[i], nullptr};
  }

  LeavingParticles FormerRows::leaving(const Stencils &shape,
                                       const std::vector<unsigned int> &candidates)
  {
    LeavingParticles result;
    if (!is_kept)
      return result;
    is_kept = false;
    for (const unsigned int row : candidates)
    {
      const Stencils::Row former = former_row(row);
      if (!std::binary_search(rank_deficient_rows.begin(), rank_deficient_rows.end(), row) ||
          n_neighbours(shape.row(row)) < n_neighbours(former))
        result.add(row, former);
    }
    return result;
  }
} // namespace tombolo
