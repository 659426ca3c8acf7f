// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/statistics.h>

#include <tombolo/state/state_archive.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>

namespace tombolo
{
  using namespace dealii;

  std::string format_number(const double value)
  {
    if (std::isnan(value))
      return "nan";
    if (std::isinf(value))
      return value > 0 ? "inf" : "-inf";
    char text[64];
    const bool is_whole = std::abs(value) < 1e15 && value == std::trunc(value);
    const auto end = is_whole
                         ? std::to_chars(text, text + sizeof(text), static_cast<long long>(value))
                         : std::to_chars(text, text + sizeof(text), value);
    return std::string(text, end.ptr);
  }

  std::string csv_field(const std::string &text)
  {
    if (text.find_first_of(",\"\r\n") == std::string::npos)
      return text;
    std::string result = "\"";
    for (const char character : text)
      result += character == '"' ? "\"\"" : std::string(1, character);
    return result + "\"";
  }

  Statistics::Statistics(const OutputDirectory &directory, const std::string &file_name,
                         const UnitLabels &unit_labels)
      : directory(directory), file_name(file_name), unit_labels(unit_labels)
  {}

  void Statistics::begin_row()
  {
    for (Column &column : columns)
    {
      column.values.resize(std::min(column.values.size(), n_rows));
      column.is_given.resize(column.values.size());
    }
  }

  void Statistics::add(const std::string &name, const std::string &unit, const double value)
  {
    auto column = std::find_if(columns.begin(), columns.end(),
                               [&](const Column &other) { return other.name == name; });
    if (column == columns.end())
    {
      columns.push_back({name, unit, {}, {}});
      column = columns.end() - 1;
    }
    AssertThrow(column->unit == unit, ExcMessage("The column \"" + name + "\" has the unit " +
                                                 column->unit + ", not " + unit + "."));
    AssertThrow(column->values.size() <= n_rows,
                ExcMessage("The column \"" + name + "\" has two values in one row."));
    column->values.resize(n_rows, std::numeric_limits<double>::quiet_NaN());
    column->is_given.resize(n_rows, false);
    column->values.push_back(value);
    column->is_given.push_back(true);
  }

  double Statistics::present(const std::string &name) const
  {
    for (const Column &column : columns)
      if (column.name == name && column.values.size() > n_rows)
        return column.values.back();
    return std::numeric_limits<double>::quiet_NaN();
  }

  std::string Statistics::header() const
  {
    std::string result;
    for (const Column &column : columns)
      result +=
          (result.empty() ? "" : ",") + csv_field(unit_labels.heading(column.name, column.unit));
    return result + "\n";
  }

  std::string Statistics::row(const std::size_t index) const
  {
    std::string result;
    for (std::size_t c = 0; c < columns.size(); ++c)
      result += (c == 0 ? "" : ",") +
                (columns[c].is_given[index] ? format_number(columns[c].values[index]) : "");
    return result + "\n";
  }

  void Statistics::write_row()
  {
    for (Column &column : columns)
    {
      column.values.resize(n_rows + 1, std::numeric_limits<double>::quiet_NaN());
      column.is_given.resize(n_rows + 1, false);
    }
    ++n_rows;

    if (columns.size() != n_columns_in_file)
      write_all_rows();
    else
      directory.append(file_name, row(n_rows - 1));
  }

  void Statistics::write_all_rows()
  {
    directory.write(file_name,
                    [&](std::ostream &out)
                    {
                      out << header();
                      for (std::size_t i = 0; i < n_rows; ++i)
                        out << row(i);
                    });
    n_columns_in_file = columns.size();
  }

  void Statistics::serialize(StateArchive &archive)
  {
    const auto group = archive.group(file_name);
    std::vector<std::string> names, units;
    std::vector<double> values;
    std::vector<std::uint64_t> given;
    for (const Column &column : columns)
    {
      names.push_back(column.name);
      units.push_back(column.unit);
      values.insert(values.end(), column.values.begin(), column.values.end());
      given.insert(given.end(), column.is_given.begin(), column.is_given.end());
    }
    archive("rows", n_rows);
    archive("names", names);
    archive("units", units);
    archive("values", values);
    archive("is given", given);
    if (!archive.is_reading())
      return;
    const auto check = [&](const char *const what, const std::size_t n, const std::size_t wanted)
    {
      if (n != wanted)
        archive.fail("\"" + file_name + "/" + what + "\" has " + std::to_string(n) +
                     " values in it, but there are " + std::to_string(names.size()) +
                     " columns of " + std::to_string(n_rows) + " rows.");
    };
    check("units", units.size(), names.size());
    check("values", values.size(), names.size() * n_rows);
    check("is given", given.size(), names.size() * n_rows);
    columns.clear();
    for (std::size_t c = 0; c < names.size(); ++c)
    {
      const auto begin = static_cast<std::ptrdiff_t>(c * n_rows);
      const auto end = static_cast<std::ptrdiff_t>((c + 1) * n_rows);
      columns.push_back({names[c], units[c], {values.begin() + begin, values.begin() + end}, {}});
      columns.back().is_given.assign(given.begin() + begin, given.begin() + end);
    }
  }

  std::vector<double> Statistics::column(const std::string &name) const
  {
    for (const Column &column : columns)
      if (column.name == name)
        return {column.values.begin(), column.values.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                   n_rows, column.values.size()))};
    return {};
  }

  std::vector<std::string> Statistics::names() const
  {
    std::vector<std::string> result;
    for (const Column &column : columns)
      result.push_back(column.name);
    return result;
  }
} // namespace tombolo
