// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/time_table.h>

#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/state/records.h>

#include <deal.II/base/exceptions.h>

#include <fnmatch.h>

#include <algorithm>
#include <limits>
#include <ostream>

namespace tombolo
{
  namespace
  {
    bool fits(const std::string &name, const std::string &pattern)
    {
      return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
    }
  } // namespace

  TableFormat::TableFormat(const Entries &e)
  {
    const std::string format_name =
        e.choice("Table format", "csv", "csv|hdf5|csv and hdf5",
                 "In which files the tables over time are: `csv`, a file of comma-separated values "
                 "for each, or `hdf5`, one file histories.h5 with a dataset for each, whose "
                 "attributes name columns and units.");
    csv = format_name != "hdf5";
    hdf5 = format_name != "csv";
  }

  TimeTable::TimeTable(const std::string &file_name, const Rows rows)
      : file_name(file_name), rows(rows), hdf5(file_name.substr(0, file_name.rfind('.')))
  {}

  bool TimeTable::is_chosen(const std::string &name) const
  {
    return chosen.empty() || name == "time" || name == "step" ||
           std::any_of(chosen.begin(), chosen.end(),
                       [&](const std::string &pattern) { return fits(name, pattern); });
  }

  void TimeTable::refuse_unknown(const Section &section, const std::string &entry) const
  {
    const std::vector<std::string> known = names();
    for (const std::string &pattern : chosen)
      if (std::none_of(known.begin(), known.end(),
                       [&](const std::string &name) { return fits(name, pattern); }))
      {
        const std::string nearest = nearest_name(pattern, known);
        std::string message = file_name + " has no column \"" + pattern + "\"";
        message += nearest.empty() ? ". It has:" : ", did you mean \"" + nearest + "\"? It has:";
        for (const std::string &name : known)
          message += (&name == known.data() ? " " : ", ") + name;
        section.fail(entry, message);
      }
  }

  void TimeTable::begin_row()
  {
    for (Column &column : columns)
    {
      column.values.resize(std::min(column.values.size(), n_kept_rows));
      column.is_given.resize(column.values.size());
    }
    next_column = 0;
  }

  void TimeTable::begin_row(const double time, const std::uint64_t step)
  {
    begin_row();
    add("time", "T", time);
    add("step", "1", static_cast<double>(step));
  }

  TimeTable::Column &TimeTable::find_column(const std::string &name, const std::string &unit)
  {
    if (next_column >= columns.size() || columns[next_column].name != name)
    {
      const auto column = std::find_if(columns.begin(), columns.end(),
                                       [&](const Column &other) { return other.name == name; });
      next_column = static_cast<std::size_t>(column - columns.begin());
      if (column == columns.end())
      {
        AssertThrow(rows == Rows::in_memory || directory == nullptr,
                    ExcMessage("The column \"" + name + "\" comes after the header of " +
                               file_name + " was written."));
        columns.push_back({name, unit, {}, {}, is_chosen(name)});
      }
    }
    return columns[next_column++];
  }

  void TimeTable::add(const std::string &name, const std::string &unit, const double value)
  {
    Column &column = find_column(name, unit);
    AssertThrow(column.unit == unit, ExcMessage("The column \"" + name + "\" has the unit " +
                                                column.unit + ", not " + unit + "."));
    AssertThrow(column.values.size() <= n_kept_rows,
                ExcMessage("The column \"" + name + "\" has two values in one row."));
    column.values.resize(n_kept_rows, std::numeric_limits<double>::quiet_NaN());
    column.is_given.resize(n_kept_rows, false);
    column.values.push_back(value);
    column.is_given.push_back(true);
  }

  std::string TimeTable::header(const UnitLabels &labels) const
  {
    std::string result;
    for (const Column &column : columns)
      if (column.is_in_file)
        result += (result.empty() ? "" : ",") + csv_field(labels.heading(column.name, column.unit));
    return result;
  }

  std::string TimeTable::text_of_row(const std::size_t index) const
  {
    std::string result;
    for (const Column &column : columns)
      if (column.is_in_file)
      {
        if (&column != columns.data()) // the first one is the time
          result += ',';
        if (column.is_given[index])
          result += format_number(column.values[index]);
      }
    return result + '\n';
  }

  void TimeTable::append_row(const std::size_t index, std::vector<double> &values) const
  {
    for (const Column &column : columns)
      if (column.is_in_file)
        values.push_back(column.is_given[index] ? column.values[index]
                                                : std::numeric_limits<double>::quiet_NaN());
  }

  void TimeTable::begin_hdf5(const std::uint64_t first_rows)
  {
    std::vector<Hdf5Table::Column> headings;
    for (const Column &column : columns)
      if (column.is_in_file)
        headings.push_back({column.name, unit_labels.label_of(column.name, column.unit)});
    hdf5.begin(*directory, headings, first_rows);
  }

  bool TimeTable::has_other_columns(const UnitLabels &labels) const
  {
    return is_continued() && !header_at_checkpoint.empty() &&
           header(labels) != header_at_checkpoint;
  }

  void TimeTable::refuse_other(const OutputDirectory &directory, const UnitLabels &labels) const
  {
    if (rows == Rows::in_file && has_other_columns(labels))
      throw InputError("The columns of " + directory.file(file_name) +
                       " are not those of the run that is resumed: set the entries of this output "
                       "back, or resume into another output directory.");
    const bool goes_on = rows == Rows::in_file ? is_continued() : n_kept_rows > 0;
    if (goes_on && format.name() != format_at_checkpoint &&
        (directory.size(file_name) > 0 || directory.size(Hdf5Table::file_name) > 0))
      throw InputError("The run that is resumed has the tables of " + directory.path() +
                       " with `Table format = " + format_at_checkpoint +
                       "` in section \"Output\", not `" + format.name() +
                       "`: set it back, or resume into another output directory.");
  }

  void TimeTable::open(const OutputDirectory &run_directory, const UnitLabels &labels)
  {
    refuse_other(run_directory, labels);
    directory = std::make_unique<OutputDirectory>(run_directory);
    unit_labels = labels;
    if (rows == Rows::in_memory)
    {
      if (n_kept_rows > 0)
        write_all_rows();
      return;
    }
    begin_row();
    if (format.csv && is_continued())
      directory->truncate(file_name, bytes_at_checkpoint);
    else if (format.csv)
      directory->write(file_name, [&](std::ostream &out) { out << header(unit_labels) << '\n'; });
    if (format.hdf5)
      begin_hdf5(rows_at_checkpoint);
  }

  void TimeTable::write_row()
  {
    for (Column &column : columns)
    {
      column.values.resize(n_kept_rows + 1, std::numeric_limits<double>::quiet_NaN());
      column.is_given.resize(n_kept_rows + 1, false);
    }
    if (format.csv)
      unwritten_rows += text_of_row(n_kept_rows);
    if (format.hdf5)
      append_row(n_kept_rows, unwritten_values);
    if (rows == Rows::in_memory)
    {
      ++n_kept_rows;
      flush();
    }
    begin_row();
  }

  void TimeTable::flush()
  {
    if (rows == Rows::in_memory && columns.size() != n_columns_in_file)
      write_all_rows();
    else
    {
      if (!unwritten_rows.empty())
        directory->append(file_name, unwritten_rows);
      if (!unwritten_values.empty())
        hdf5.append(*directory, unwritten_values);
    }
    unwritten_rows.clear();
    unwritten_values.clear();
  }

  void TimeTable::write_all_rows()
  {
    if (format.csv)
      directory->write(file_name,
                       [&](std::ostream &out)
                       {
                         out << header(unit_labels) << '\n';
                         for (std::size_t i = 0; i < n_kept_rows; ++i)
                           out << text_of_row(i);
                       });
    bool are_in_hdf5 = !format.hdf5;
    if (format.hdf5 && n_columns_in_file == 0 && format.name() == format_at_checkpoint)
      try
      {
        begin_hdf5(n_kept_rows); // a run that is killed now has them
        are_in_hdf5 = true;
      }
      catch (const RunError &)
      {
        // In another directory, or with columns that came after the checkpoint.
      }
    if (!are_in_hdf5)
    {
      std::vector<double> values;
      for (std::size_t i = 0; i < n_kept_rows; ++i)
        append_row(i, values);
      begin_hdf5(0);
      hdf5.append(*directory, values);
    }
    n_columns_in_file = columns.size();
  }

  void TimeTable::list(Records &records)
  {
    records.archived(
        [this](StateArchive &archive)
        {
          if (rows == Rows::in_memory)
            serialize_rows(archive);
          else
            serialize_length_of_file(archive);
        });
  }

  void TimeTable::serialize_length_of_file(StateArchive &archive)
  {
    if (!archive.is_reading())
    {
      flush();
      bytes_at_checkpoint = directory->size(file_name);
      header_at_checkpoint = header(unit_labels);
      rows_at_checkpoint = hdf5.n_rows();
    }
    archive("bytes", bytes_at_checkpoint);
    if (archive.has("header"))
      archive("header", header_at_checkpoint);
    serialize_format(archive);
    if (format_at_checkpoint != TableFormat().name())
      archive("rows in HDF5", rows_at_checkpoint);
  }

  void TimeTable::serialize_format(StateArchive &archive)
  {
    if (!archive.is_reading())
      format_at_checkpoint = format.name();
    if (archive.is_reading() ? archive.has("format") : format.hdf5)
      archive("format", format_at_checkpoint);
  }

  void TimeTable::serialize_rows(StateArchive &archive)
  {
    const auto group = archive.group(file_name);
    serialize_format(archive);
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
    archive("rows", n_kept_rows);
    archive("names", names);
    archive("units", units);
    archive("values", values);
    archive("is given", given);
    if (!archive.is_reading())
      return;
    const auto check = [&](const char *const what, const std::size_t n, const std::size_t expected)
    {
      if (n != expected)
        archive.fail("\"" + file_name + "/" + what + "\" has " + std::to_string(n) +
                     " values in it, but there are " + std::to_string(names.size()) +
                     " columns of " + std::to_string(n_kept_rows) + " rows.");
    };
    check("units", units.size(), names.size());
    check("values", values.size(), names.size() * n_kept_rows);
    check("is given", given.size(), names.size() * n_kept_rows);
    columns.clear();
    for (std::size_t c = 0; c < names.size(); ++c)
    {
      const auto begin = static_cast<std::ptrdiff_t>(c * n_kept_rows);
      const auto end = static_cast<std::ptrdiff_t>((c + 1) * n_kept_rows);
      columns.push_back({names[c],
                         units[c],
                         {values.begin() + begin, values.begin() + end},
                         {},
                         is_chosen(names[c])});
      columns.back().is_given.assign(given.begin() + begin, given.begin() + end);
    }
  }

  double TimeTable::present(const std::string &name) const
  {
    for (const Column &column : columns)
      if (column.name == name && column.values.size() > n_kept_rows)
        return column.values.back();
    return std::numeric_limits<double>::quiet_NaN();
  }

  std::vector<double> TimeTable::column(const std::string &name) const
  {
    for (const Column &column : columns)
      if (column.name == name)
        return {column.values.begin(),
                column.values.begin() +
                    static_cast<std::ptrdiff_t>(std::min(n_kept_rows, column.values.size()))};
    return {};
  }

  std::vector<std::string> TimeTable::names() const
  {
    std::vector<std::string> result;
    for (const Column &column : columns)
      result.push_back(column.name);
    return result;
  }
} // namespace tombolo
