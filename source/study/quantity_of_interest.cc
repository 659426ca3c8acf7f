// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/quantity_of_interest.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/base/json.h>

#include <deal.II/base/utilities.h>

#include <boost/tokenizer.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <vector>

namespace tombolo
{
  namespace
  {
    using Row = std::vector<std::string>;

    bool remove_prefix(const std::string &prefix, std::string &text)
    {
      if (text.compare(0, prefix.size(), prefix) != 0)
        return false;
      text.erase(0, prefix.size());
      return true;
    }

    bool ends_with(const std::string &text, const std::string &end)
    {
      return text.size() >= end.size() &&
             text.compare(text.size() - end.size(), end.size(), end) == 0;
    }

    /** NaN where the text is no number: an undefined error is written so. */
    double number(const std::string &text)
    {
      try
      {
        return dealii::Utilities::string_to_double(text);
      }
      catch (const std::exception &)
      {
        return no_value;
      }
    }

    Row fields_of(const std::string &line)
    {
      const boost::tokenizer<boost::escaped_list_separator<char>> tokens(
          line, boost::escaped_list_separator<char>('\\', ',', '"'));
      return Row(tokens.begin(), tokens.end());
    }

    std::string without_unit(const std::string &heading)
    {
      return heading.substr(0, heading.rfind(" ["));
    }

    const Json *child(const Json &value, const std::string &key)
    {
      if (value.is_object())
        return value.contains(key) ? &value.at(key) : nullptr;
      const bool is_index = key.find_first_not_of("0123456789") == std::string::npos;
      if (!value.is_array() || key.empty() || !is_index)
        return nullptr;
      const std::size_t index = std::stoul(key.substr(0, 9));
      return index < value.size() ? &value[index] : nullptr;
    }

    std::vector<std::string> keys_of(const Json &value)
    {
      std::vector<std::string> keys;
      if (value.is_object())
        for (const auto &entry : value.items())
          keys.push_back(entry.key());
      return keys;
    }

    std::string suggestion(const std::string &name, const std::vector<std::string> &known)
    {
      const std::string nearest = nearest_name(name, known);
      return nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?";
    }
  } // namespace

  QuantityOfInterest::QuantityOfInterest(const std::string &text) : whole_text(text)
  {
    std::string rest = text;
    if (remove_prefix("largest of ", rest))
      take = Take::largest;
    else if (remove_prefix("mean of ", rest))
      take = Take::mean;
    const std::size_t slash = rest.find('/');
    file_name = rest.substr(0, slash);
    name = slash == std::string::npos ? "" : rest.substr(slash + 1);
    const bool is_table = ends_with(file_name, ".csv");
    if (name.empty() || !(is_table || ends_with(file_name, ".json")))
      throw std::invalid_argument("\"" + text +
                                  "\" does not name a value: expected is FILE.csv/COLUMN or "
                                  "FILE.json/KEY/KEY");
    if (!is_table && take != Take::last)
      throw std::invalid_argument("\"" + text +
                                  "\": only a column of a table has a largest or a "
                                  "mean value");
    const std::size_t at = name.rfind(" at ");
    if (is_table && at != std::string::npos && std::isfinite(number(name.substr(at + 4))))
    {
      if (take != Take::last)
        throw std::invalid_argument("\"" + text + "\" asks for a time and for all times");
      take = Take::at_time;
      time = number(name.substr(at + 4));
      name.erase(at);
    }
  }

  const std::string &QuantityOfInterest::text() const
  {
    return whole_text;
  }

  double QuantityOfInterest::value(const std::string &directory) const
  {
    const std::string file = directory + "/" + file_name;
    const double value = ends_with(file_name, ".json") ? value_of_json(file) : value_of_table(file);
    if (!std::isfinite(value))
      throw RunError("\"" + whole_text + "\" is not a finite number");
    return value;
  }

  double QuantityOfInterest::value_of_json(const std::string &file) const
  {
    std::ifstream in(file);
    if (!in)
      throw RunError(file_name + " cannot be read: cannot open file");
    Json document;
    try
    {
      document = Json::parse(in);
    }
    catch (const Json::exception &error)
    {
      // Without the name of the library's exception, which it begins with.
      const std::string message = error.what();
      throw RunError(file_name + " cannot be read: " + message.substr(message.find("] ") + 2));
    }
    const Json *value = &document;
    for (const std::string &key : dealii::Utilities::split_string_list(name, '/'))
    {
      const Json *const next = child(*value, key);
      if (next == nullptr)
        throw RunError(file_name + " has no value \"" + name + "\"" +
                       suggestion(key, keys_of(*value)));
      value = next;
    }
    return value->is_number()   ? value->get<double>()
           : value->is_string() ? number(value->get<std::string>())
                                : no_value;
  }

  double QuantityOfInterest::value_of_table(const std::string &file) const
  {
    std::ifstream in(file);
    std::string line;
    if (!std::getline(in, line))
      throw RunError(file_name + " cannot be read, or is empty");
    std::vector<std::string> headings = fields_of(line);
    for (std::string &heading : headings)
      heading = without_unit(heading);
    const auto column_of = [&](const std::string &wanted)
    {
      for (std::size_t i = 0; i < headings.size(); ++i)
        if (headings[i] == wanted)
          return i;
      throw RunError(file_name + " has no column \"" + wanted + "\"" +
                     suggestion(wanted, headings));
    };
    const std::size_t column = column_of(name);
    const std::size_t time_column = take == Take::at_time ? column_of("time") : 0;

    double result = no_value;
    double sum = 0;
    unsigned int n = 0;
    while (std::getline(in, line))
    {
      const Row row = fields_of(line);
      if (row.size() <= std::max(column, time_column))
        continue;
      const double value = number(row[column]);
      if (take == Take::last)
        result = value;
      else if (take == Take::at_time)
      {
        if (std::abs(number(row[time_column]) - time) <= 1e-9 * std::abs(time))
          result = value;
      }
      else if (std::isfinite(value))
      {
        sum += value;
        ++n;
        if (take == Take::largest && !(std::abs(value) <= result))
          result = std::abs(value);
      }
    }
    return take == Take::mean ? sum / n : result;
  }
} // namespace tombolo
