// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace
{
  /** A new, empty directory of one test, the same on all ranks, removed at the end. */
  struct TestDirectory
  {
    explicit TestDirectory(const std::string &name)
        : path("output_tests." +
               std::to_string(dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD)) + "/" + name)
    {
      if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        std::filesystem::remove_all(path);
      MPI_Barrier(MPI_COMM_WORLD);
    }

    ~TestDirectory()
    {
      MPI_Barrier(MPI_COMM_WORLD);
      if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        std::filesystem::remove_all(path);
    }

    /** The path of a file in it. Makes the directory. Collective. */
    std::string create(const std::string &file) const
    {
      if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        std::filesystem::create_directories(path);
      MPI_Barrier(MPI_COMM_WORLD);
      return path + "/" + file;
    }

    const std::string path;
  };

  [[maybe_unused]] std::string read_file(const std::string &path)
  {
    std::ifstream in(path, std::ios::binary);
    EXPECT_TRUE(in) << path;
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }
} // namespace
