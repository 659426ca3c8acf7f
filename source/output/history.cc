// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/history.h>

#include <tombolo/base/input/entries.h>

#include <cmath>

namespace tombolo
{
  template <int dim>
  History<dim>::History(const Entries &e, const std::string &file_name, const RowEntries &names)
      : table(file_name, TimeTable::Rows::in_file), section(e.section())
  {
    table.list(this->records);
    this->records.value("next time", next_time).optional();
    time_between = e.number(names.time, "0", at_least(0.), "",
                            "The time between rows of " + file_name + ". Units: T. 0: see `" +
                                names.steps + "`.");
    steps_between = e.integer(names.steps, names.by_default, at_least(1),
                              "The number of steps between rows of " + file_name + ". Excludes `" +
                                  names.time + "`.");
    e.refuse(e.is_set(names.steps) && time_between > 0, names.steps,
             std::string("only one of ") + names.time + " and " + names.steps +
                 " can be set: remove one");
    table.choose(e.list("Columns", "",
                        "Columns of " + file_name +
                            " beside time and step, without units; * stands "
                            "for any text. Empty: all."));
  }

  template <int dim>
  void History<dim>::check(const OutputView<dim> &view)
  {
    if (!table.has_choice() || table.is_open())
      return;
    begin(view);
    table.begin_row(view.time, view.step);
    add_columns(view);
    table.refuse_unknown(section, "Columns");
  }

  template <int dim>
  void History<dim>::start(const OutputView<dim> &view, const OutputDirectory &directory,
                           const UnitLabels &unit_labels)
  {
    if (!table.is_continued())
      next_time = view.time;
    begin(view);
    table.begin_row(view.time, view.step);
    add_columns(view);
    check_columns(directory, unit_labels);
    table.open(directory, unit_labels);
  }

  template <int dim>
  void History<dim>::after_step(const OutputView<dim> &view)
  {
    if (has_row(view))
      write_row(view);
  }

  template <int dim>
  void History<dim>::write_row(const OutputView<dim> &view)
  {
    table.begin_row(view.time, view.step);
    add_columns(view);
    table.write_row();
    if (time_between > 0.)
      next_time += time_between * (std::floor((view.time - next_time) / time_between + 1e-9) + 1.);
    end_row(view);
  }

  template <int dim>
  bool History<dim>::has_row(const OutputView<dim> &view) const
  {
    // Times that are sums of steps may fall short of a multiple by their rounding.
    return time_between == 0. ? view.has_row(steps_between)
                              : view.time >= next_time - 1e-9 * time_between;
  }

  template <int dim>
  void History<dim>::write(const OutputView<dim> & /*view*/, TimeTable & /*statistics*/)
  {
    table.flush();
  }

  template <int dim>
  void History<dim>::finish(Json & /*results*/)
  {
    table.flush();
  }

  template <int dim>
  void History<dim>::add_vector(const std::string &name, const std::string &unit,
                                const std::array<double, 3> &value, const bool is_of_rotation)
  {
    for (unsigned int c = is_of_rotation && dim == 2 ? 2 : 0; c < (is_of_rotation ? 3 : dim); ++c)
      table.add(name + " " + "xyz"[c], unit, value[c]);
  }

  template <int dim>
  void History<dim>::add_mean(const std::string &name, const std::string &unit,
                              const std::array<double, 3> &now, const std::array<double, 3> &before,
                              const double elapsed, const bool is_of_rotation)
  {
    std::array<double, 3> mean{};
    for (unsigned int c = 0; c < 3 && elapsed > 0.; ++c)
      mean[c] = (now[c] - before[c]) / elapsed;
    add_vector(name, unit, mean, is_of_rotation);
  }

  template class History<2>;
  template class History<3>;
} // namespace tombolo
