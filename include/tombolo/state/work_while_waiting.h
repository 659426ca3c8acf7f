// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <utility>

namespace tombolo
{
  /** As long as it exists, each exchange of nodal values calls @p work(has_arrived) on a rank that
   * would wait for others: it does other work, which must not exchange anything, piece by piece
   * until has_arrived() or nothing is left. */
  class WorkWhileWaiting
  {
  public:
    using HasArrived = std::function<bool()>;

    explicit WorkWhileWaiting(std::function<void(const HasArrived &)> work)
        : work(std::move(work)), outer(std::exchange(present, this))
    {}

    WorkWhileWaiting(const WorkWhileWaiting &) = delete;
    WorkWhileWaiting &operator=(const WorkWhileWaiting &) = delete;

    ~WorkWhileWaiting()
    {
      present = outer;
    }

    static bool is_there()
    {
      return present != nullptr;
    }

    static void work_until(const HasArrived &has_arrived)
    {
      present->work(has_arrived);
    }

  private:
    std::function<void(const HasArrived &)> work;
    WorkWhileWaiting *outer;
    static inline WorkWhileWaiting *present = nullptr; // a rank is one thread
  };
} // namespace tombolo
