// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <utility>
#include <vector>

namespace tombolo
{
  /** Functions that are called together, in the order in which they were connected. */
  template <typename... Arguments>
  class Signal
  {
  public:
    void connect(std::function<void(Arguments...)> slot)
    {
      slots.push_back(std::move(slot));
    }

    bool is_connected() const
    {
      return !slots.empty();
    }

    void operator()(Arguments... arguments) const
    {
      for (const auto &slot : slots)
        slot(arguments...);
    }

  private:
    std::vector<std::function<void(Arguments...)>> slots;
  };
} // namespace tombolo
