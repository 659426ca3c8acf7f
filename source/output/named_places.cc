// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/named_places.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tombolo
{
  namespace
  {
    template <int dim>
    NamedPlace<dim> read_place(const std::string &text, const Section &section,
                               const std::string &entry, const std::string &name)
    {
      const std::size_t colon = text.rfind(':');
      NamedPlace<dim> result{
          colon == std::string::npos ? name : Utilities::trim(text.substr(0, colon)), {}};
      if (result.name.empty())
        section.fail(entry, "\"" + text + "\" has no name before the colon");
      const std::vector<std::string> numbers = Utilities::split_string_list(
          colon == std::string::npos ? text : text.substr(colon + 1), ',');
      if (numbers.size() != dim)
        section.fail(entry, "\"" + text + "\" has " + std::to_string(numbers.size()) +
                                " coordinates; " + std::to_string(dim) +
                                " are needed, separated by commas");
      for (unsigned int d = 0; d < dim; ++d)
      {
        try
        {
          result.location[d] = Utilities::string_to_double(numbers[d]);
        }
        catch (const ExceptionBase &)
        {
          result.location[d] = std::numeric_limits<double>::quiet_NaN();
        }
        if (!std::isfinite(result.location[d]))
          section.fail(entry, "\"" + numbers[d] + "\" in \"" + text + "\" is not a number");
      }
      return result;
    }
  } // namespace

  template <int dim>
  std::vector<NamedPlace<dim>> read_named_places(const Section &section, const std::string &entry,
                                                 const std::string &word)
  {
    std::vector<NamedPlace<dim>> result;
    for (const std::string &text : Utilities::split_string_list(section.get(entry), ';'))
    {
      const auto place =
          read_place<dim>(text, section, entry, word + " " + std::to_string(result.size() + 1));
      if (std::any_of(result.begin(), result.end(),
                      [&](const NamedPlace<dim> &other) { return other.name == place.name; }))
        section.fail(entry, "two " + word + "s are called \"" + place.name + "\"");
      result.push_back(place);
    }
    return result;
  }

  template std::vector<NamedPlace<2>> read_named_places(const Section &, const std::string &,
                                                        const std::string &);
  template std::vector<NamedPlace<3>> read_named_places(const Section &, const std::string &,
                                                        const std::string &);
} // namespace tombolo
