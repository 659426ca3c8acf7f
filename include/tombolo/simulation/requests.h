// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <vector>

namespace tombolo
{
  /**
   * Requests from outside that a run handles between two steps: the signals SIGINT and SIGTERM, and
   * checkpoints that are due by wall time. Ranks may receive a signal, or reach a wall time, in
   * different steps; they agree every few steps, as many as take a fraction of a second.
   */
  class Requests
  {
  public:
    explicit Requests(const MPI_Comm communicator) : communicator(communicator) {}

    /** Restores the handlers of signals. */
    ~Requests()
    {
      restore_signals();
    }
    Requests(const Requests &) = delete;
    Requests &operator=(const Requests &) = delete;

    /** From now on signals are noted and no longer end the process. */
    void catch_signals()
    {
      noted_signal = 0;
      previous_interrupt = std::signal(SIGINT, note_signal);
      previous_terminate = std::signal(SIGTERM, note_signal);
      is_catching = true;
    }

    /** Restores the handlers of before catch_signals(). */
    void restore_signals()
    {
      if (!is_catching)
        return;
      std::signal(SIGINT, previous_interrupt);
      std::signal(SIGTERM, previous_terminate);
      is_catching = false;
    }

    /** Call between two steps. @p is_checkpoint_due is that of this rank. Afterwards signal() and
     * is_checkpoint_requested() are the same on all ranks. Collective. */
    void agree(const bool is_checkpoint_due)
    {
      constexpr unsigned int most_steps = 8;
      constexpr double seconds = 0.25;
      request = 0;
      if (--steps_to_agreement > 0)
        return;
      const auto now = std::chrono::steady_clock::now();
      // A signal has priority over the time.
      const int own = noted_signal != 0   ? 1 + static_cast<int>(noted_signal)
                      : is_checkpoint_due ? 1
                                          : 0;
      std::vector<double> maxima(2);
      dealii::Utilities::MPI::max(
          std::vector<double>{double(own),
                              std::chrono::duration<double>(now - last_agreement).count()},
          communicator, maxima);
      request = static_cast<int>(maxima[0]);
      const double step_seconds = maxima[1] / steps_between_agreements;
      steps_between_agreements = static_cast<unsigned int>(
          std::clamp(seconds / std::max(step_seconds, 1e-9), 1., double(most_steps)));
      steps_to_agreement = steps_between_agreements;
      last_agreement = now;
    }

    /** The signal that requests the end of the run, or zero. */
    int signal() const
    {
      return std::max(request - 1, 0);
    }

    /** Whether a checkpoint is requested: by a signal, or by any rank. */
    bool is_checkpoint_requested() const
    {
      return request > 0;
    }

    /** The signal that any rank has received up to now, or zero. Collective. */
    int received_signal() const
    {
      return dealii::Utilities::MPI::max(static_cast<int>(noted_signal), communicator);
    }

  private:
    using Handler = void (*)(int);

    static void note_signal(const int signal)
    {
      noted_signal = signal;
    }

    inline static volatile std::sig_atomic_t noted_signal = 0;

    MPI_Comm communicator;
    int request = 0; ///< 0: none; 1: a checkpoint; otherwise 1 + signal
    unsigned int steps_between_agreements = 1, steps_to_agreement = 1;
    std::chrono::steady_clock::time_point last_agreement = std::chrono::steady_clock::now();
    bool is_catching = false;
    Handler previous_interrupt = nullptr, previous_terminate = nullptr;
  };
} // namespace tombolo
