// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/declarations.h>

#include <tombolo/base/input/parameters.h>

#include <array>
#include <charconv>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The shortest text that reads back as the same number. */
    template <typename Number>
    std::optional<std::string> text_of(const std::optional<Number> &value)
    {
      if (!value)
        return {};
      std::array<char, 64> text;
      const auto end = std::to_chars(text.begin(), text.end(), *value);
      return std::string(text.begin(), end.ptr);
    }
  } // namespace

  Declarations::Declarations(ParameterHandler &handler) : handler(handler) {}

  void Declarations::declare(const std::string &entry,
                             const std::optional<std::string> &default_value,
                             const Patterns::PatternBase &pattern, const std::string &unit,
                             const std::string &documentation)
  {
    const std::string with_unit = documentation + (unit.empty() ? "" : " Units: " + unit + ".");
    if (default_value)
      handler.declare_entry(entry, *default_value, pattern, with_unit);
    else
      Parameters::declare_mandatory(handler, entry, pattern, with_unit);
  }

  void Declarations::number(const std::string &entry, const std::optional<double> default_value,
                            const std::string &unit, const std::string &documentation,
                            const double smallest, const double largest)
  {
    declare(entry, text_of(default_value), Patterns::Double(smallest, largest), unit,
            documentation);
  }

  void Declarations::non_negative(const std::string &entry,
                                  const std::optional<double> default_value,
                                  const std::string &unit, const std::string &documentation)
  {
    number(entry, default_value, unit, documentation, 0.);
  }

  void Declarations::whole_number(const std::string &entry, const std::optional<int> default_value,
                                  const int smallest, const std::string &documentation)
  {
    declare(entry, text_of(default_value), Patterns::Integer(smallest), "", documentation);
  }

  void Declarations::numbers(const std::string &entry,
                             const std::optional<std::string> &default_value, const unsigned int n,
                             const std::string &unit, const std::string &documentation)
  {
    declare(entry, default_value, Patterns::List(Patterns::Double(), n, n, ","), unit,
            documentation);
  }

  void Declarations::choice(const std::string &entry,
                            const std::optional<std::string> &default_value,
                            const std::string &alternatives, const std::string &documentation)
  {
    declare(entry, default_value, Patterns::Selection(alternatives), "", documentation);
  }

  void Declarations::text(const std::string &entry, const std::optional<std::string> &default_value,
                          const std::string &unit, const std::string &documentation)
  {
    declare(entry, default_value, Patterns::Anything(), unit, documentation);
  }
} // namespace tombolo
