// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/output.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * A table of what a derived class adds, with a row every n steps or at each multiple of a time,
   * and with all columns or those that its entry `Columns` names. Rows are in the file after each
   * output.
   */
  template <int dim>
  class History : public Output<dim>
  {
  public:
    /** The names of the entries that say when there are rows, and the default of the first. */
    struct RowEntries
    {
      const char *steps = "Steps between rows", *by_default = "10", *time = "Time between rows";
    };

    /** The table is written to @p file_name of the output directory. */
    History(const Entries &e, const std::string &file_name, const RowEntries &names = RowEntries());

    /** Throws InputError where there is no column that `Columns` names. */
    void check(const OutputView<dim> &view) override;
    void start(const OutputView<dim> &view, const OutputDirectory &directory,
               const UnitLabels &unit_labels) override;
    void after_step(const OutputView<dim> &view) override;
    void write(const OutputView<dim> &view, TimeTable &statistics) override;
    void finish(Json &results) override;

  protected:
    /** Before the first row. Where the table of a run that is resumed goes on, what was read
     * stays. */
    virtual void begin(const OutputView<dim> & /*view*/) {}

    /** Adds the columns of the present row to the table. Collective. */
    virtual void add_columns(const OutputView<dim> &view) = 0;

    /** Refuses columns that are not those of the run that is resumed, where it can say more than
     * the table. */
    virtual void check_columns(const OutputDirectory & /*directory*/, const UnitLabels &) {}

    /** Whether the step that has ended has a row. */
    virtual bool has_row(const OutputView<dim> &view) const;

    /** The row was written. */
    virtual void end_row(const OutputView<dim> & /*view*/) {}

    /** Writes a row of now. Collective. */
    void write_row(const OutputView<dim> &view);

    /** Adds the components of a vector to the row: all of one of rotation that can differ from
     * zero, which in two dimensions is that about z. */
    void add_vector(const std::string &name, const std::string &unit,
                    const std::array<double, 3> &value, bool is_of_rotation = false);

    /** The same of its mean over the time @p elapsed since @p before, zero without any. */
    void add_mean(const std::string &name, const std::string &unit,
                  const std::array<double, 3> &now, const std::array<double, 3> &before,
                  double elapsed, bool is_of_rotation = false);

    TimeTable table;
    Section section; ///< with the entries of the output

  private:
    unsigned int steps_between;
    double time_between;  ///< zero: steps count [T]
    double next_time = 0; ///< of a row, with a time between rows
  };

  /**
   * A history of balances, each a set of sums since the start of which a row has means since the
   * row before. The summary has each balance at the last output, by name.
   */
  template <int dim, typename Balance>
  class BalanceHistory : public History<dim>
  {
  public:
    /** What checkpoints have of the last row beside impulses. */
    struct Kept
    {
      std::string name;        ///< of the numbers
      double Balance::*number; ///< of each balance
    };

    /** What the summary has of each balance at the last output beside the impulse. */
    struct Summary
    {
      std::string group; ///< empty: nothing
      std::vector<double Balance::*> numbers;
    };

    BalanceHistory(const Entries &e, const std::string &file_name, const Kept &kept,
                   const Summary &summary)
        : History<dim>(e, file_name), summary(summary)
    {
      const auto impulses = [](Balance &balance)
      {
        std::vector<double *> result;
        for (auto *const impulse : {&balance.impulse, &balance.angular_impulse})
          for (double &component : *impulse)
            result.push_back(&component);
        return result;
      };
      this->records.items(last).numbers("impulses at row", impulses).column(kept.name, kept.number);
      if (summary.group.empty())
        return;
      this->records.items(at_output).numbers("balances at output",
                                             [numbers = summary.numbers](Balance &balance)
                                             {
                                               std::vector<double *> result;
                                               for (double &component : balance.impulse)
                                                 result.push_back(&component);
                                               for (double Balance::*const number : numbers)
                                                 result.push_back(&(balance.*number));
                                               return result;
                                             });
    }

    void write(const OutputView<dim> &view, TimeTable &statistics) override
    {
      if (!summary.group.empty())
        at_output = balances(view);
      History<dim>::write(view, statistics);
    }

    void finish(Json &results) override
    {
      History<dim>::finish(results);
      for (std::size_t k = 0; k < at_output.size(); ++k)
      {
        Json &entry = results[summary.group][at_output[k].name];
        entry["impulse"] = Json::array();
        for (unsigned int d = 0; d < dim; ++d)
          entry["impulse"].push_back(at_output[k].impulse[d]);
        add_to_summary(k, at_output[k], entry);
      }
    }

  protected:
    /** Those of now. Collective. */
    virtual std::vector<Balance> balances(const OutputView<dim> &view) const = 0;

    /** Adds the columns of balance number @p k, which at the row before was @p before. */
    virtual void add_balance(const OutputView<dim> &view, std::size_t k, const Balance &now,
                             const Balance &before) = 0;

    /** Adds to the entry of balance number @p k in the summary, which has the impulse. */
    virtual void add_to_summary(std::size_t /*k*/, const Balance & /*at_output*/, Json & /*entry*/)
    {}

    void begin(const OutputView<dim> &view) override
    {
      const std::vector<Balance> now = balances(view);
      if (!this->table.is_continued())
        last = now;
      for (std::size_t k = 0; k < std::min(now.size(), at_output.size()); ++k)
        at_output[k].name = now[k].name;
    }

    void add_columns(const OutputView<dim> &view) override
    {
      present = balances(view);
      for (std::size_t k = 0; k < present.size(); ++k)
        add_balance(view, k, present[k], k < last.size() ? last[k] : present[k]);
    }

    void end_row(const OutputView<dim> & /*view*/) override
    {
      last = present;
    }

    std::vector<Balance> last, present; ///< at the row before, and at this one

  private:
    Summary summary;
    std::vector<Balance> at_output;
  };
} // namespace tombolo
