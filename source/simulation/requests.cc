// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/requests.h>

#include <deal.II/base/mpi.h>

#include <csignal>
#include <vector>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    volatile std::sig_atomic_t noted_signal = 0;

    extern "C" void note_signal(int signal)
    {
      noted_signal = signal;
    }
  } // namespace

  Requests::Requests(const MPI_Comm communicator) : communicator(communicator) {}

  Requests::~Requests()
  {
    restore_signals();
  }

  void Requests::catch_signals()
  {
    noted_signal = 0;
    previous_interrupt = std::signal(SIGINT, note_signal);
    previous_terminate = std::signal(SIGTERM, note_signal);
    is_catching = true;
  }

  void Requests::restore_signals()
  {
    if (!is_catching)
      return;
    std::signal(SIGINT, previous_interrupt);
    std::signal(SIGTERM, previous_terminate);
    is_catching = false;
  }

  void Requests::agree(const bool is_checkpoint_due)
  {
    constexpr unsigned int most_steps = 8;
    constexpr double seconds = 0.25;
    request = 0;
    if (--steps_to_agreement > 0)
      return;
    const auto now = std::chrono::steady_clock::now();
    // A signal goes before the time.
    const int own = noted_signal != 0   ? 1 + static_cast<int>(noted_signal)
                    : is_checkpoint_due ? 1
                                        : 0;
    std::vector<double> of_all(2);
    Utilities::MPI::max(
        std::vector<double>{double(own),
                            std::chrono::duration<double>(now - last_agreement).count()},
        communicator, of_all);
    request = static_cast<int>(of_all[0]);
    const double step_seconds = of_all[1] / steps_between_agreements;
    steps_between_agreements = static_cast<unsigned int>(
        std::clamp(seconds / std::max(step_seconds, 1e-9), 1., double(most_steps)));
    steps_to_agreement = steps_between_agreements;
    last_agreement = now;
  }

  int Requests::received_signal() const
  {
    return Utilities::MPI::max(static_cast<int>(noted_signal), communicator);
  }
} // namespace tombolo
