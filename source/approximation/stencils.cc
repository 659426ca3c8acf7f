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
} // namespace tombolo
