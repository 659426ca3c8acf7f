// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/input/parameters.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** An entry of dim finite numbers separated by commas. Throws InputError. */
  template <int dim>
  dealii::Tensor<1, dim> read_vector(const Section &section, const std::string &entry);

  /** The same of vectors separated by `;`. */
  template <int dim>
  std::vector<dealii::Tensor<1, dim>> read_vectors(const Section &section,
                                                   const std::string &entry);

  /** One vector as a direction, with the length one. Throws InputError where it has no length. */
  template <int dim>
  dealii::Tensor<1, dim> read_direction(const Section &section, const std::string &entry);
} // namespace tombolo
