// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>

#include <tombolo/base/format.h>

namespace tombolo
{
  void Range::check(const Section &section, const std::string &entry, const double value) const
  {
    if (is_positive && !(value > 0.))
      section.fail(entry, "allowed is a number larger than zero.");
    if (!(value >= lower && value <= upper))
      section.fail(entry, "allowed is " + words);
  }

  namespace
  {
    /** A range that is compared, and not in the pattern. */
    Range compared(const double lower, const double upper, const std::string &words,
                   const bool is_positive = false)
    {
      return {-Range::infinite, Range::infinite, lower, upper, is_positive, words};
    }
  } // namespace

  Range any_number()
  {
    return {};
  }

  Range at_least(const double smallest)
  {
    return between(smallest, Range::infinite);
  }

  Range between(const double smallest, const double largest)
  {
    Range result;
    result.smallest = smallest;
    result.largest = largest;
    return result;
  }

  Range positive(const double smallest)
  {
    Range result = at_least(smallest);
    result.is_positive = true;
    return result;
  }

  Range zero_or_positive()
  {
    return compared(0., Range::infinite, "zero or a positive number.");
  }

  Range from_to(const double lower, const double upper)
  {
    return compared(lower, upper, as_text("a number from ", lower, " to ", upper, "."));
  }

  Range above_zero_up_to(const double upper)
  {
    return compared(std::numeric_limits<double>::denorm_min(), upper,
                    as_text("a number above 0 and up to ", upper, "."));
  }

  Range positive_up_to(const double upper, const std::string &reason)
  {
    return compared(0., upper, as_text("a number above 0 and up to ", upper, reason), true);
  }

  Entries Entries::subsection(const std::string &name) const
  {
    if (!declares())
      return section().subsection(name);
    Entries result = *this;
    result.path.push_back(name);
    result.within([](ParameterHandler &) {}); // it is there, also without entries
    return result;
  }

  std::string Entries::entry(const std::string &name, const Default &by_default,
                             const Patterns::PatternBase &pattern, const std::string &unit,
                             const std::string &documentation) const
  {
    if (!declares())
      return section().get(name);
    const std::string text = documentation + (unit.empty() ? "" : " Units: " + unit + ".");
    within(
        [&](ParameterHandler &section_handler)
        {
          if (by_default)
            section_handler.declare_entry(name, *by_default, pattern, text);
          else
            Parameters::declare_mandatory(section_handler, name, pattern, text);
        });
    return by_default.value_or("");
  }

  double Entries::number(const std::string &name, const Default &by_default, const Range &range,
                         const std::string &unit, const std::string &documentation) const
  {
    entry(name, by_default, Patterns::Double(range.smallest, range.largest), unit, documentation);
    return checked_number(name, range);
  }

  std::optional<double> Entries::optional_number(const std::string &name, const Range &range,
                                                 const std::string &unit,
                                                 const std::string &documentation) const
  {
    if (text(name, "", unit, documentation).empty())
      return {};
    return checked_number(name, range);
  }

  double Entries::checked_number(const std::string &name, const Range &range) const
  {
    if (declares())
      return 0.;
    const double value = section().get_double(name);
    range.check(section(), name, value);
    return value;
  }

  unsigned int Entries::integer(const std::string &name, const Default &by_default,
                                const Range &range, const std::string &documentation) const
  {
    constexpr int most = std::numeric_limits<int>::max();
    const int largest = range.largest < most ? static_cast<int>(range.largest) : most;
    entry(name, by_default, Patterns::Integer(static_cast<int>(range.smallest), largest), "",
          documentation);
    return declares() ? 0 : section().get_unsigned(name);
  }

  void Entries::within(const std::function<void(ParameterHandler &)> &function) const
  {
    for (const std::string &name : path)
      handler->enter_subsection(name);
    function(*handler);
    for (std::size_t i = 0; i < path.size(); ++i)
      handler->leave_subsection();
  }
} // namespace tombolo
