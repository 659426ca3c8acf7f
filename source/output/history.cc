// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/history.h>

#include <tombolo/base/input/entries.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  template <int dim>
  History<dim>::History(const Entries &e, const std::string &file_name, const RowEntries &names)
      : table(file_name, TimeTable::Rows::in_file), section(e.section())
  {
    table.list(this->records);
    if (!e.declares())
      table.set_format(TableFormat(section.parent()));
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
  void History<dim>::check_continuation(const OutputView<dim> &view,
                                        const OutputDirectory &directory,
                                        const UnitLabels &unit_labels)
  {
    begin(view);
    table.begin_row(view.time, view.step);
    add_columns(view);
    check_columns(directory, unit_labels);
    table.refuse_other(directory, unit_labels);
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
  BalanceHistory<dim>::BalanceHistory(const Entries &e, const HistoryOfBalances &kind)
      : History<dim>(e, kind.file_name), kind(kind)
  {
    if (kind.has_reference_point)
    {
      reference_point = e.numbers("Moments about", dim == 2 ? "0, 0" : "0, 0, 0", dim, "L",
                                  "The point that moments in " + kind.file_name +
                                      " are about; it does not move.");
      reference_point.resize(3);
    }
    const auto impulses = [](ImpulseBalance &balance)
    {
      std::vector<double *> result;
      for (auto *const impulse : {&balance.impulse, &balance.angular_impulse})
        for (double &component : *impulse)
          result.push_back(&component);
      return result;
    };
    Records &all = this->records;
    auto columns = all.items(last).numbers("impulses at row", impulses);
    if (kind.is_ahead)
    {
      columns.column("works at row", &ImpulseBalance::work);
      all.value("time of row", time_of_row);
      all.value("time of work", time_of_work).optional();
    }
    else
      columns.column("times of row", &ImpulseBalance::time_of_impulse);
    if (!kind.summary.empty())
      all.value("balances at output", summary_at_output);
    if (!kind.largest.empty())
      all.value("largest " + kind.largest, largest);
  }

  template <int dim>
  void BalanceHistory<dim>::begin_item(const ImpulseBalance &balance)
  {
    now.push_back(balance);
    keys.clear();
    if (kind.is_ahead)
      now.back().time_of_impulse = view->middle_of_next_step();
    if (kind.has_reference_point)
    {
      const double to_origin[3] = {-reference_point[0], -reference_point[1], -reference_point[2]};
      add_moment(to_origin, balance.impulse.data(), now.back().angular_impulse);
    }
    present_summary.insert(present_summary.end(), balance.impulse.begin(), balance.impulse.end());
  }

  template <int dim>
  void BalanceHistory<dim>::add_mean(const std::string &what, const std::string &unit,
                                     std::array<double, 3> ImpulseBalance::*const sum,
                                     const bool is_of_rotation)
  {
    const double elapsed =
        balance().time_of_impulse - (kind.is_ahead ? time_of_row : before().time_of_impulse);
    std::array<double, 3> mean{};
    for (unsigned int c = 0; c < 3 && elapsed > 0.; ++c)
      mean[c] = ((balance().*sum)[c] - (before().*sum)[c]) / elapsed;
    add(what, unit, mean, is_of_rotation);
  }

  template <int dim>
  void BalanceHistory<dim>::add_mean(const std::string &what, const std::string &unit,
                                     double ImpulseBalance::*const sum)
  {
    const double elapsed = view->time - time_of_work;
    add(what, unit, elapsed > 0. ? (balance().*sum - before().*sum) / elapsed : 0.);
  }

  template <int dim>
  void BalanceHistory<dim>::summarize(const std::string &key, const double value)
  {
    keys.push_back(key);
    present_summary.push_back(value);
  }

  template <int dim>
  void BalanceHistory<dim>::query(const OutputView<dim> &at, const bool with_row)
  {
    view = &at;
    adds_columns = with_row;
    now.clear();
    present_summary.clear();
    present_largest.clear();
    if (const auto found = at.histories.find(kind.name); found != at.histories.end())
      for (const auto &[order, fill] : found->second)
        fill(*this);
  }

  template <int dim>
  void BalanceHistory<dim>::begin(const OutputView<dim> &at)
  {
    query(at, false);
    if (this->table.is_continued())
      return;
    last = now;
    for (ImpulseBalance &balance : last)
      balance.time_of_impulse = at.time;
    time_of_row = time_of_work = at.time;
    largest.assign(present_largest.size(), 0.);
  }

  template <int dim>
  void BalanceHistory<dim>::end_row(const OutputView<dim> &at)
  {
    last = now;
    time_of_row = at.middle_of_next_step();
    time_of_work = at.time;
    step_of_row = at.step;
    for (std::size_t k = 0; k < present_largest.size(); ++k)
      largest[k] = std::max(largest[k], present_largest[k]);
  }

  template <int dim>
  void BalanceHistory<dim>::write(const OutputView<dim> &at, TimeTable &statistics)
  {
    if (!kind.summary.empty())
    {
      if (step_of_row != at.step) // the row has queried it already
        query(at, false);
      summary_at_output = present_summary;
    }
    History<dim>::write(at, statistics);
  }

  template <int dim>
  void BalanceHistory<dim>::finish(Json &results)
  {
    History<dim>::finish(results);
    const std::size_t n = 3 + keys.size();
    for (std::size_t k = 0; k < now.size() && n * k < summary_at_output.size(); ++k)
    {
      const double *const values = summary_at_output.data() + n * k;
      Json &entry = results[kind.summary][now[k].name];
      entry["impulse"] = Json::array();
      for (unsigned int d = 0; d < dim; ++d)
        entry["impulse"].push_back(values[d]);
      for (std::size_t i = 0; i < keys.size(); ++i)
        entry[keys[i]] = values[3 + i];
      if (!kind.largest.empty())
        entry["largest_" + kind.largest] = largest[k];
    }
  }

  template class BalanceHistory<2>;
  template class BalanceHistory<3>;

  namespace
  {
    template <int dim>
    void add_to_outputs(const HistoryOfBalances &kind)
    {
      Registry<Output<dim>>::register_plugin(
          kind.name,
          {kind.description,
           [kind](ParameterHandler &handler) { declare<BalanceHistory<dim>>(handler, kind); },
           [kind](const Section &section)
           { return std::make_unique<BalanceHistory<dim>>(section, kind); }});
    }
  } // namespace

  HistoryRegistration::HistoryRegistration(const HistoryOfBalances &kind)
  {
    add_to_outputs<2>(kind);
    add_to_outputs<3>(kind);
  }

  template class History<2>;
  template class History<3>;
} // namespace tombolo
