// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/moment.h>
#include <tombolo/output/output.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
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
    /** The names of the entries that set when there are rows, and the default of the first. */
    struct RowEntries
    {
      const char *steps = "Steps between rows", *by_default = "10", *time = "Time between rows";
    };

    /** The table is written to @p file_name of the output directory. */
    History(const Entries &e, const std::string &file_name, const RowEntries &names = RowEntries());

    /** Throws InputError where there is no column that `Columns` names. */
    void check(const OutputView<dim> &view) override;
    void check_continuation(const OutputView<dim> &view, const OutputDirectory &directory,
                            const UnitLabels &unit_labels) override;
    void start(const OutputView<dim> &view, const OutputDirectory &directory,
               const UnitLabels &unit_labels) override;
    void after_step(const OutputView<dim> &view) override;
    void write(const OutputView<dim> &view, TimeTable &statistics) override;
    void finish(Json &results) override;

  protected:
    /** Before the first row. What a resumed run has read stays. */
    virtual void begin(const OutputView<dim> & /*view*/) {}

    /** Adds the columns of the present row to the table. Collective. */
    virtual void add_columns(const OutputView<dim> &view) = 0;

    /** Refuses columns that are not those of the run that is resumed, where its message can be more
     * precise than that of the table. */
    virtual void check_columns(const OutputDirectory & /*directory*/, const UnitLabels &) {}

    /** Whether the step that has ended has a row. */
    virtual bool has_row(const OutputView<dim> &view) const;

    /** The row was written. */
    virtual void end_row(const OutputView<dim> & /*view*/) {}

    /** Writes the present row. Collective. */
    void write_row(const OutputView<dim> &view);

    /** Adds the components of a vector to the row: all of one of rotation that can differ from
     * zero, which in two dimensions is that about z. */
    void add_vector(const std::string &name, const std::string &unit,
                    const std::array<double, 3> &value, bool is_of_rotation = false);

    TimeTable table;
    Section section; ///< with the entries of the output

  private:
    unsigned int steps_between;
    double time_between;  ///< zero: steps count [T]
    double next_time = 0; ///< of a row, with a time between rows
  };

  /** The name of a table of histories of items of one kind, and what it contains. */
  struct HistoryOfBalances
  {
    std::string name, file_name;
    std::string description; ///< of the output
    /** Whether impulses of the row at t_n go until t_{n+1/2}; else until that of balances. */
    bool is_ahead = false;
    /** Whether an entry sets the reference point of moments, which is the origin for balances. */
    bool has_reference_point = false;
    std::string summary{}, largest{}; ///< its group there, and see summarize_largest()
  };

  /** Registers a table of histories as an output: a static object in the file that fills it.
   * Other than with the second constructor, scenes name it in `Further outputs`. */
  struct HistoryRegistration
  {
    explicit HistoryRegistration(const HistoryOfBalances &kind);
    HistoryRegistration(const HistoryOfBalances &kind, const int order,
                        const std::string &switched_by,
                        const std::function<bool(const Section &)> &is_requested)
        : HistoryRegistration(kind)
    {
      OutputOfScene(order, kind.name, switched_by, is_requested);
    }
  };

  /**
   * A history of items of one kind, such as contacts or sections, each with columns whose names
   * begin with its own. The processes that have them fill it (doc/add_a_process.md): for each item
   * begin_item(balance), add_impulses() and add() of further columns.
   *
   * Rows have means since the row before. The summary has the impulse of each item at the last
   * output, by its name, and what else it is given.
   */
  template <int dim>
  class BalanceHistory : public History<dim>
  {
  public:
    BalanceHistory(const Entries &e, const HistoryOfBalances &kind);

    /** What follows is of this. */
    void begin_item(const ImpulseBalance &balance);

    void add(const std::string &what, const std::string &unit, const double value)
    {
      if (adds_columns)
        this->table.add(balance().name + " " + what, unit, value);
    }

    /** See History::add_vector(). */
    void add(const std::string &what, const std::string &unit, const std::array<double, 3> &value,
             const bool is_of_rotation = false)
    {
      if (adds_columns)
        this->add_vector(balance().name + " " + what, unit, value, is_of_rotation);
    }

    /** The mean since the row before of the rate of a sum since the start; zero in the first. */
    void add_mean(const std::string &what, const std::string &unit,
                  std::array<double, 3> ImpulseBalance::*sum, bool is_of_rotation = false);
    void add_mean(const std::string &what, const std::string &unit, double ImpulseBalance::*sum);

    /** Mean force and mean moment since the row before, and the impulse since the start. */
    void add_impulses()
    {
      add_mean("mean force", "M L/T^2", &ImpulseBalance::impulse);
      add_mean("mean moment", "M L^2/T^2", &ImpulseBalance::angular_impulse, true);
      add("impulse", "M L/T", balance().impulse);
    }

    /** Of the item in the summary at the last output. Every item has as many. */
    void summarize(const std::string &key, double value);

    /** The largest of all rows so far, "largest_" and HistoryOfBalances::largest. */
    void summarize_largest(const double value)
    {
      present_largest.push_back(value);
    }

    /** While it is filled. */
    const OutputView<dim> &present() const
    {
      return *view;
    }

    void write(const OutputView<dim> &view, TimeTable &statistics) override;
    void finish(Json &results) override;

  private:
    const ImpulseBalance &balance() const
    {
      return now.back();
    }
    /** At the row before, or now where there was none. */
    const ImpulseBalance &before() const
    {
      return now.size() <= last.size() ? last[now.size() - 1] : now.back();
    }

    /** Collects what the items are, and adds columns to the present row if @p with_row. */
    void query(const OutputView<dim> &view, bool with_row);
    void begin(const OutputView<dim> &view) override;
    void add_columns(const OutputView<dim> &view) override
    {
      query(view, true);
    }
    void end_row(const OutputView<dim> &view) override;

    HistoryOfBalances kind;
    std::vector<double> reference_point;      ///< of moments; empty: that of the items [L]
    const OutputView<dim> *view = nullptr;    ///< while items are queried
    bool adds_columns = false;                ///< while they are queried for a row
    std::vector<ImpulseBalance> now, last;    ///< at this row, and at the one before
    double time_of_row = 0;                   ///< until which impulses of the last row go
    double time_of_work = 0;                  ///< until which its works go
    std::optional<std::uint64_t> step_of_row; ///< of the last row of this process
    std::vector<std::string> keys;            ///< of one item in the summary
    std::vector<double> present_summary, summary_at_output; ///< impulse and `keys` of each item
    std::vector<double> present_largest, largest;           ///< one of each item
  };
} // namespace tombolo
