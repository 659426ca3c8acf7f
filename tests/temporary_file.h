// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace tombolo
{
  namespace testing
  {
    /** Writes a file for the time of one action. Rank 0 alone writes: it alone reads. */
    class TemporaryFile
    {
    public:
      TemporaryFile(const std::string &text, const std::string &extension)
      {
        path = (std::filesystem::temp_directory_path() / "tombolo_test_").string() +
               std::to_string(dealii::Utilities::MPI::broadcast(MPI_COMM_WORLD,
                                                                static_cast<int>(getpid()), 0)) +
               extension;
        if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
          std::ofstream(path, std::ios::binary) << text;
      }

      ~TemporaryFile()
      {
        if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
          std::remove(path.c_str());
      }

      std::string path;
    };
  } // namespace testing
} // namespace tombolo
