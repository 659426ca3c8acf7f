// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>

#include <deal.II/base/mpi.h>

#include <mpi.h>

#include <string>

namespace tombolo
{
  /**
   * Failures that single ranks find and that must end the run on all. The ranks agree by a
   * reduction that is in progress during the step.
   */
  class FailureAgreement
  {
  public:
    explicit FailureAgreement(const MPI_Comm communicator) : communicator(communicator) {}
    ~FailureAgreement()
    {
      if (request != MPI_REQUEST_NULL)
        MPI_Wait(&request, MPI_STATUS_IGNORE);
    }

    FailureAgreement(const FailureAgreement &) = delete;
    FailureAgreement &operator=(const FailureAgreement &) = delete;

    /** Stores the first failure of this rank; an empty @p text is none. Not collective. */
    void note(const std::string &text)
    {
      if (failure.empty())
        failure = text;
    }

    /** Whether this rank has one. */
    bool has_failure() const
    {
      return !failure.empty();
    }

    /** Starts to agree on what was noted. Collective. */
    void begin()
    {
      has_failed = failure.empty() ? 0 : 1;
      MPI_Iallreduce(&has_failed, &any_has_failed, 1, MPI_INT, MPI_MAX, communicator, &request);
    }

    /** Ends what begin() has begun, if anything. Throws the RunError of the first rank that has
     * failed on all ranks. Collective. */
    void end()
    {
      if (request == MPI_REQUEST_NULL)
        return;
      MPI_Wait(&request, MPI_STATUS_IGNORE);
      if (any_has_failed != 0)
        throw_on_all_ranks<RunError>(failure, communicator);
    }

  private:
    MPI_Comm communicator;
    std::string failure;
    int has_failed = 0;
    int any_has_failed = 0;
    MPI_Request request = MPI_REQUEST_NULL;
  };
} // namespace tombolo
