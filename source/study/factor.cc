// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/factor.h>

#include <deal.II/base/patterns.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    std::string text_of(const double value)
    {
      std::ostringstream text;
      text.precision(6);
      text << value;
      return text.str();
    }

    /** The numbers of "1 to 3 in 5" and of "1 to 100 in 3 geometric"; empty if the text is no
     * range. */
    std::vector<std::string> range(const Section &section, const std::string &text)
    {
      static const std::regex form(R"((\S+)\s+to\s+(\S+)\s+in\s+(\S+)(\s+geometric)?)");
      std::smatch match;
      if (!std::regex_match(text, match, form))
        return {};
      double from = 0, to = 0;
      int n = 0;
      try
      {
        from = Utilities::string_to_double(match[1]);
        to = Utilities::string_to_double(match[2]);
        n = Utilities::string_to_int(match[3]);
      }
      catch (const std::exception &)
      {
        section.fail("Values", "a range is `FROM to TO in COUNT`, with numbers");
      }
      const bool is_geometric = match[4].matched;
      if (n < 2 || n > 1000)
        section.fail("Values", "a range has 2 to 1000 values, not " + std::to_string(n));
      if (is_geometric && !(from > 0 && to > 0))
        section.fail("Values", "the ends of a geometric range are positive");
      std::vector<std::string> values;
      for (int i = 0; i < n; ++i)
      {
        const double share = double(i) / (n - 1);
        values.push_back(
            text_of(is_geometric ? from * std::pow(to / from, share) : from + (to - from) * share));
      }
      return values;
    }
  } // namespace

  std::vector<std::string> split_texts(const std::string &text, const std::string &separator)
  {
    std::vector<std::string> parts;
    std::size_t begin = 0;
    for (;;)
    {
      const std::size_t end = text.find(separator, begin);
      parts.push_back(Utilities::trim(text.substr(begin, end - begin)));
      if (end == std::string::npos)
        return parts;
      begin = end + separator.size();
    }
  }

  void Factor::declare_parameters(ParameterHandler &handler)
  {
    Parameters::declare_mandatory(
        handler, "Entries", Patterns::Anything(),
        "The entry of the parameter file that this factor sets, as `Section/Entry`; several that "
        "are "
        "set together are joined by ` & `. `*` stands for any name: the entry is set in all "
        "sections that the parameter file has. `Base file` is the parameter file itself.");
    Parameters::declare_mandatory(
        handler, "Values", Patterns::Anything(),
        "What the entry is set to, separated by ` | `; with several entries each value has as many "
        "texts, joined by ` & `. `1 to 3 in 5` are five equidistant numbers, `1 to 1000 in 4 "
        "geometric` four with equal ratios. An empty text leaves the entry as it is.");
    handler.declare_entry("Labels", "", Patterns::Anything(),
                          "What tables and pictures call the values, separated by ` | `; empty: "
                          "the first text of each value.");
  }

  Factor Factor::read(const Section &section)
  {
    Factor factor;
    factor.name = section.name();
    factor.section_path = section.path();
    factor.entries = split_texts(section.get("Entries"), " & ");
    for (const std::string &entry : factor.entries)
      if (entry.empty() || std::count(factor.entries.begin(), factor.entries.end(), entry) > 1)
        section.fail("Entries", "an entry is missing, or named twice");

    for (const std::string &text : split_texts(section.get("Values"), "|"))
    {
      const std::vector<std::string> numbers = range(section, text);
      if (!numbers.empty() && factor.entries.size() > 1)
        section.fail("Values", "a range has one number a value, but the factor sets " +
                                   std::to_string(factor.entries.size()) + " entries");
      for (const std::string &number : numbers)
        factor.values.push_back({number, {number}});
      if (!numbers.empty())
        continue;
      const std::vector<std::string> texts =
          factor.entries.size() == 1 ? std::vector<std::string>{text} : split_texts(text, "&");
      if (texts.size() != factor.entries.size())
        section.fail("Values", "the value \"" + text + "\" has " + std::to_string(texts.size()) +
                                   " texts for " + std::to_string(factor.entries.size()) +
                                   " entries; they are joined by &");
      factor.values.push_back({texts.front(), texts});
    }

    if (section.is_set("Labels"))
    {
      const std::vector<std::string> labels = split_texts(section.get("Labels"), "|");
      if (labels.size() != factor.values.size())
        section.fail("Labels", "there are " + std::to_string(labels.size()) + " labels for " +
                                   std::to_string(factor.values.size()) + " values");
      for (std::size_t i = 0; i < labels.size(); ++i)
        factor.values[i].label = labels[i];
    }
    for (const Value &value : factor.values)
    {
      if (value.label.empty())
        section.fail("Labels", "a value has no label: an empty text needs one");
      if (std::count_if(factor.values.begin(), factor.values.end(),
                        [&](const Value &other) { return other.label == value.label; }) > 1)
        section.fail(section.is_set("Labels") ? "Labels" : "Values",
                     "two values are called \"" + value.label + "\"; give them labels");
    }
    return factor;
  }
} // namespace tombolo
