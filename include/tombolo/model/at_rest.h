// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  template <int dim>
  class Process;

  /**
   * What a process is as well that knows bodies at rest (`Time integration`). Their steps ask
   * processes for forces at trial positions (Process::act(), before and after those of parts), and
   * for works and impulses (Process::complete_step()) where the equilibrium is found; nothing else
   * of a step is called. Other processes are refused there.
   */
  class AtRest
  {
  public:
    virtual ~AtRest() = default;

    /** Whether such steps ask it. Otherwise it has nothing to do at rest, as what resists motion,
     * and is there with its accounts and columns only. */
    virtual bool acts_at_rest() const
    {
      return true;
    }
  };

  template <int dim>
  bool acts_at_rest(const Process<dim> &process)
  {
    const auto *const at_rest = dynamic_cast<const AtRest *>(&process);
    return at_rest != nullptr && at_rest->acts_at_rest();
  }
} // namespace tombolo
