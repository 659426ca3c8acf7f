// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/history.h>

#include <tombolo/base/input/entries.h>

namespace tombolo
{
  template <int dim>
  History<dim>::History(const std::string &file_name, const unsigned int steps_between)
      : table(file_name, TimeTable::Rows::in_file), steps_between(steps_between)
  {
    table.list(this->records);
  }

  template <int dim>
  unsigned int History<dim>::interval(const Entries &e, const std::string &file_name)
  {
    return e.integer("Steps between rows", "10", at_least(1),
                     file_name + " has a row every so many steps.");
  }

  template <int dim>
  void History<dim>::start(const OutputView<dim> &view, const OutputDirectory &directory,
                           const UnitLabels &unit_labels)
  {
    begin(view);
    table.begin_row(view.time, view.step);
    add_columns(view);
    check_columns(directory, unit_labels);
    table.open(directory, unit_labels);
  }

  template <int dim>
  void History<dim>::after_step(const OutputView<dim> &view)
  {
    if (!has_row(view))
      return;
    table.begin_row(view.time, view.step);
    add_columns(view);
    table.write_row();
    end_row(view);
  }

  template <int dim>
  bool History<dim>::has_row(const OutputView<dim> &view)
  {
    return view.has_row(steps_between);
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
