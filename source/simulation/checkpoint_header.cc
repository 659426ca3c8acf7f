// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/checkpoint_header.h>

#include <deal.II/base/mpi.h>

#include <filesystem>
#include <system_error>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  void write_header(StateArchive &archive, unsigned int dimension, std::string entries)
  {
    archive("dimension", dimension);
    archive("parameters", entries);
  }

  std::string read_header(StateArchive &archive, const unsigned int dimension,
                          const Parameters &parameters)
  {
    unsigned int earlier = 0;
    archive("dimension", earlier);
    if (earlier != dimension)
      parameters.fail("Dimension", "the checkpoint " + archive.file() +
                                       " is of a model of dimension " + std::to_string(earlier) +
                                       ".");
    std::string entries;
    archive("parameters", entries);
    return entries;
  }

  void serialize_clock(Clock &clock, StateArchive &archive)
  {
    const auto group = archive.group("clock");
    archive("step", clock.step);
    archive("time", clock.time);
    archive("previous step", clock.previous_step);
    archive("next step", clock.next_step);
    archive("stable step", clock.stable_step);
  }

  void serialize_divisions(CellDivisions &divisions, StateArchive &archive)
  {
    const char *const name = "divided cells";
    if (archive.is_reading() ? archive.has(name) : !divisions.empty())
      archive(name, divisions);
    else
      divisions.clear();
  }

  bool is_of_directory(const std::string &file, const std::string &directory,
                       const MPI_Comm communicator)
  {
    bool is = false;
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
    {
      std::error_code code;
      is = std::filesystem::equivalent(std::filesystem::absolute(file).parent_path().parent_path(),
                                       directory, code);
    }
    return Utilities::MPI::broadcast(communicator, is, 0);
  }
} // namespace tombolo
