// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mpi.h>

#include <algorithm>
#include <chrono>

namespace tombolo
{
  /**
   * Requests from outside that a run serves between two steps: the signals SIGINT and SIGTERM, and
   * checkpoints that are due by wall time. Ranks may receive a signal, or reach a wall time, in
   * different steps; they agree every few steps, as many as take a fraction of a second.
   */
  class Requests
  {
  public:
    explicit Requests(MPI_Comm communicator);

    /** Restores the handlers of signals. */
    ~Requests();
    Requests(const Requests &) = delete;
    Requests &operator=(const Requests &) = delete;

    /** From now on signals are noted and no longer end the process. */
    void catch_signals();

    /** Gives signals back to the handlers of before catch_signals(). */
    void restore_signals();

    /** Call between two steps. @p is_checkpoint_due is that of this rank. Afterwards signal() and
     * wants_checkpoint() are the same on all ranks. Collective. */
    void agree(bool is_checkpoint_due);

    /** The signal that asks for the end of the run, or zero. */
    int signal() const
    {
      return std::max(request - 1, 0);
    }

    /** Whether a checkpoint is asked for: by a signal, or by any rank. */
    bool wants_checkpoint() const
    {
      return request > 0;
    }

    /** The signal that any rank has received up to now, or zero. Collective. */
    int received_signal() const;

  private:
    using Handler = void (*)(int);

    MPI_Comm communicator;
    int request = 0; ///< 0: none; 1: a checkpoint; otherwise 1 + signal
    unsigned int steps_between_agreements = 1, steps_to_agreement = 1;
    std::chrono::steady_clock::time_point last_agreement = std::chrono::steady_clock::now();
    bool is_catching = false;
    Handler previous_interrupt = nullptr, previous_terminate = nullptr;
  };
} // namespace tombolo
