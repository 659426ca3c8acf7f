// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace tombolo
{
  /** An expression whose calls `table(FILE, argument)` are taken out: in `text` their values have
   * the names `table_1`, `table_2`, ... */
  struct TableCalls
  {
    struct Call
    {
      std::string name, file, argument; ///< the argument may have calls itself
    };

    std::string text;
    std::vector<Call> calls;
    std::string problem; ///< what is wrong with a call, a sentence; empty: nothing

    explicit TableCalls(const std::string &expression);
  };
} // namespace tombolo
