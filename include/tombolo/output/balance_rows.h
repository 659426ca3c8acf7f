// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/time_table.h>
#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <string>
#include <vector>

namespace tombolo
{
  /** Adds to the row of a table what a balance says of its force: the mean force and the mean
   * moment since @p before, which was the balance at the row before, and the impulse since the
   * start. In two dimensions moments are about z alone. */
  template <int dim, typename Balance>
  void add_impulse_columns(const Balance &now, const Balance &before, TimeTable &table)
  {
    constexpr const char *axis_names[3] = {"x", "y", "z"};
    const double elapsed = now.time_of_impulse - before.time_of_impulse;
    const auto mean = [&](const double impulse, const double impulse_before)
    { return elapsed > 0. ? (impulse - impulse_before) / elapsed : 0.; };
    for (unsigned int d = 0; d < dim; ++d)
      table.add(now.name + " mean force " + axis_names[d], "M L/T^2",
                mean(now.impulse[d], before.impulse[d]));
    for (unsigned int c = dim == 2 ? 2 : 0; c < 3; ++c)
      table.add(now.name + " mean moment " + axis_names[c], "M L^2/T^2",
                mean(now.angular_impulse[c], before.angular_impulse[c]));
    for (unsigned int d = 0; d < dim; ++d)
      table.add(now.name + " impulse " + axis_names[d], "M L/T", now.impulse[d]);
  }

  /** Writes to a checkpoint, or reads from it, what a history keeps of the balances in its last
   * row, to take means since: impulse, angular impulse and one @p number of each; @p name is that
   * of the numbers, @p owners says what the balances are of. Throws InputError. Collective. */
  template <typename Balance>
  void serialize_last_row(StateArchive &archive, const std::string &name, double Balance::*number,
                          const std::string &owners, std::vector<Balance> &last)
  {
    std::vector<double> impulses, numbers;
    for (const Balance &balance : last)
    {
      for (const auto &impulse : {balance.impulse, balance.angular_impulse})
        impulses.insert(impulses.end(), impulse.begin(), impulse.end());
      numbers.push_back(balance.*number);
    }
    archive("impulses at row", impulses);
    archive(name, numbers);
    if (impulses.size() != 6 * numbers.size())
      archive.fail("\"impulses at row\" and \"" + name + "\" are not of as many " + owners + ".");
    last.resize(numbers.size());
    auto next = impulses.begin();
    for (std::size_t k = 0; k < numbers.size(); ++k)
    {
      last[k].*number = numbers[k];
      for (auto *const impulse : {&last[k].impulse, &last[k].angular_impulse})
      {
        std::copy_n(next, 3, impulse->begin());
        next += 3;
      }
    }
  }

  /** Writes to a checkpoint, or reads from it, what the summary of a run that ends before its next
   * output has of the balances at the last one: the impulse and these @p numbers of each. Throws
   * InputError. Collective. */
  template <typename Balance>
  void serialize_at_output(StateArchive &archive, const std::vector<double Balance::*> &numbers,
                           std::vector<Balance> &at_output)
  {
    std::vector<double> values;
    for (const Balance &balance : at_output)
    {
      values.insert(values.end(), balance.impulse.begin(), balance.impulse.end());
      for (double Balance::*const number : numbers)
        values.push_back(balance.*number);
    }
    archive("balances at output", values);
    const std::size_t n_values = 3 + numbers.size();
    if (values.size() % n_values != 0)
      archive.fail("\"balances at output\" has other numbers than this program.");
    at_output.resize(values.size() / n_values);
    auto next = values.begin();
    for (Balance &balance : at_output)
    {
      std::copy_n(next, 3, balance.impulse.begin());
      next += 3;
      for (double Balance::*const number : numbers)
        balance.*number = *next++;
    }
  }
} // namespace tombolo
