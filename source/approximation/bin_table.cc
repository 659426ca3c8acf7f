// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/bin_table.h>

#include <algorithm>

namespace tombolo
{
  void BinTable::clear()
  {
    keys.clear();
    std::fill(slots.begin(), slots.end(), Slot{no_key, no_bin});
  }

  void BinTable::enlarge()
  {
    slots.assign(std::max<std::size_t>(2 * slots.size(), 1024), {no_key, no_bin});
    const std::size_t mask = slots.size() - 1;
    for (unsigned int bin = 0; bin < keys.size(); ++bin)
    {
      std::size_t i = hash(keys[bin]) & mask;
      while (slots[i].key != no_key)
        i = (i + 1) & mask;
      slots[i] = {keys[bin], bin};
    }
  }
} // namespace tombolo
