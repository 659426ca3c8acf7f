// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>
#include <deal.II/base/utilities.h>

#include <tombolo/base/input/parameters.h>

#include <cmath>
#include <string>
#include <vector>

namespace tombolo
{
  /** The dim finite numbers of a @p text, separated by commas. Throws the InputError of an entry.
   */
  template <int dim>
  dealii::Tensor<1, dim> vector_of_text(const std::string &text, const Section &section,
                                        const std::string &entry)
  {
    const std::vector<std::string> numbers = dealii::Utilities::split_string_list(text, ',');
    dealii::Tensor<1, dim> result;
    for (unsigned int d = 0; d < numbers.size() && d < dim; ++d)
      if (!is_number(numbers[d], result[d]) || !std::isfinite(result[d]))
        section.fail(entry, in_quotes(numbers[d]) + " is not a finite number.");
    if (numbers.size() != dim)
      section.fail(entry, "allowed are " + std::to_string(dim) + " numbers separated by commas. " +
                              in_quotes(text) + " has " + std::to_string(numbers.size()) + ".");
    return result;
  }

  /** An entry of dim finite numbers separated by commas. Throws InputError. */
  template <int dim>
  dealii::Tensor<1, dim> read_vector(const Section &section, const std::string &entry)
  {
    return vector_of_text<dim>(section.get(entry), section, entry);
  }

  /** The same of vectors separated by `;`. */
  template <int dim>
  std::vector<dealii::Tensor<1, dim>> read_vectors(const Section &section, const std::string &entry)
  {
    std::vector<dealii::Tensor<1, dim>> result;
    for (const std::string &text : dealii::Utilities::split_string_list(section.get(entry), ';'))
      result.push_back(vector_of_text<dim>(text, section, entry));
    return result;
  }

  /** One vector as a direction, with the length one. Throws InputError where it has no length. */
  template <int dim>
  dealii::Tensor<1, dim> read_direction(const Section &section, const std::string &entry)
  {
    const auto result = read_vector<dim>(section, entry);
    const double length = result.norm();
    if (!(length > 0.) || !std::isfinite(length))
      section.fail(entry, "a direction needs a length above zero.");
    return result / length;
  }
} // namespace tombolo
