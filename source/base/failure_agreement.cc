// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/failure_agreement.h>

#include <tombolo/base/exceptions.h>

#include <deal.II/base/mpi.h>

namespace tombolo
{
  FailureAgreement::FailureAgreement(const MPI_Comm communicator) : communicator(communicator) {}

  FailureAgreement::~FailureAgreement()
  {
    if (request != MPI_REQUEST_NULL)
      MPI_Wait(&request, MPI_STATUS_IGNORE);
  }

  void FailureAgreement::note(const std::string &text)
  {
    if (failure.empty())
      failure = text;
  }

  void FailureAgreement::begin()
  {
    has_failed = failure.empty() ? 0 : 1;
    MPI_Iallreduce(&has_failed, &any_has_failed, 1, MPI_INT, MPI_MAX, communicator, &request);
  }

  void FailureAgreement::end()
  {
    if (request == MPI_REQUEST_NULL)
      return;
    MPI_Wait(&request, MPI_STATUS_IGNORE);
    if (any_has_failed != 0)
      throw_on_all_ranks<RunError>(failure, communicator);
  }
} // namespace tombolo
