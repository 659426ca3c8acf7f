// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/read_vector.h>

#include <deal.II/base/utilities.h>

#include <cmath>
#include <cstdlib>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    Tensor<1, dim> vector_of(const std::string &text, const Section &section,
                             const std::string &entry)
    {
      const std::vector<std::string> numbers = Utilities::split_string_list(text, ',');
      Tensor<1, dim> result;
      for (unsigned int d = 0; d < numbers.size() && d < dim; ++d)
      {
        char *end = nullptr;
        result[d] = std::strtod(numbers[d].c_str(), &end);
        if (numbers[d].empty() || *end != '\0' || !std::isfinite(result[d]))
          section.fail(entry, in_quotes(numbers[d]) + " is not a finite number.");
      }
      if (numbers.size() != dim)
        section.fail(entry, "allowed are " + std::to_string(dim) +
                                " numbers separated by commas. " + in_quotes(text) + " has " +
                                std::to_string(numbers.size()) + ".");
      return result;
    }
  } // namespace

  template <int dim>
  Tensor<1, dim> read_vector(const Section &section, const std::string &entry)
  {
    return vector_of<dim>(section.get(entry), section, entry);
  }

  template <int dim>
  std::vector<Tensor<1, dim>> read_vectors(const Section &section, const std::string &entry)
  {
    std::vector<Tensor<1, dim>> result;
    for (const std::string &text : Utilities::split_string_list(section.get(entry), ';'))
      result.push_back(vector_of<dim>(text, section, entry));
    return result;
  }

  template <int dim>
  Tensor<1, dim> read_direction(const Section &section, const std::string &entry)
  {
    const auto result = read_vector<dim>(section, entry);
    const double length = result.norm();
    if (!(length > 0.) || !std::isfinite(length))
      section.fail(entry, "a direction needs a length above zero.");
    return result / length;
  }

  template Tensor<1, 2> read_vector<2>(const Section &, const std::string &);
  template Tensor<1, 3> read_vector<3>(const Section &, const std::string &);
  template std::vector<Tensor<1, 2>> read_vectors<2>(const Section &, const std::string &);
  template std::vector<Tensor<1, 3>> read_vectors<3>(const Section &, const std::string &);
  template Tensor<1, 2> read_direction<2>(const Section &, const std::string &);
  template Tensor<1, 3> read_direction<3>(const Section &, const std::string &);
} // namespace tombolo
