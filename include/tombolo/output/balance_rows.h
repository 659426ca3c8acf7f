// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <string>
#include <vector>

namespace tombolo
{
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
} // namespace tombolo
