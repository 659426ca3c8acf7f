// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/moment.h>
#include <tombolo/state/records.h>

#include <array>
#include <vector>

namespace tombolo
{
  /**
   * The impulse of forces and its moment about the origin, this rank's share since the start. The
   * impulse of the interval Δt_n = t_{n+1/2} - t_{n-1/2} is known at t_n, but momentum is that of
   * t_{n-1/2}: it counts from the next step on.
   */
  class ImpulseAccount
  {
  public:
    using Vector = std::array<double, 3>;

    /** Counts what was added in the last step. */
    void begin_step()
    {
      add_now(pending_linear, pending_angular);
      pending_linear = pending_angular = {};
    }

    /** Adds the impulse of a force at @p position in the present step. */
    void add(const double *position, const Vector &impulse)
    {
      add_to(pending_linear, impulse);
      add_moment(position, impulse.data(), pending_angular);
    }

    /** Adds the impulse of the present step with its moment, or @p interval times a force and its
     * moment. */
    void add(const Vector &impulse, const Vector &moment, const double interval = 1.)
    {
      add_to(pending_linear, impulse, interval);
      add_to(pending_angular, moment, interval);
    }

    /** Adds what counts at once. */
    void add_now(const Vector &impulse, const Vector &moment)
    {
      add_to(linear, impulse);
      add_to(angular, moment);
    }

    void account(EnergyAccounts &accounts) const
    {
      accounts.add_impulse(linear, angular);
    }

    /** Appends the three components of the impulse, and those of its moment. */
    void append(std::vector<double> &numbers) const
    {
      numbers.insert(numbers.end(), linear.begin(), linear.end());
      numbers.insert(numbers.end(), angular.begin(), angular.end());
    }

    void list(Records &records)
    {
      records.sums("impulses", linear, angular, pending_linear, pending_angular);
    }

  private:
    static void add_to(Vector &sum, const Vector &vector, const double factor = 1.)
    {
      for (unsigned int d = 0; d < 3; ++d)
        sum[d] += factor * vector[d];
    }

    Vector linear{}, angular{}, pending_linear{}, pending_angular{};
  };
} // namespace tombolo
