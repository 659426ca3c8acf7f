// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <iostream>

/** Runs the tests on every rank, prints on rank 0 only, and fails where any rank fails, and where
 * no test is chosen, which is a mistake of a filter. */
int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
  {
    auto &listeners = ::testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
  }
  int local_result = RUN_ALL_TESTS();
  if (::testing::UnitTest::GetInstance()->test_to_run_count() == 0)
  {
    std::cerr << "No test is chosen by " << ::testing::GTEST_FLAG(filter) << "\n";
    local_result = 1;
  }
  return dealii::Utilities::MPI::max(local_result, MPI_COMM_WORLD);
}
