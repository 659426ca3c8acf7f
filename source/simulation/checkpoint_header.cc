// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/checkpoint_header.h>

#include <tombolo/model/checkpoint.h>

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

  void check_header(StateArchive &archive, const unsigned int dimension,
                    const Parameters &parameters, const std::string &file)
  {
    unsigned int of_checkpoint = 0;
    archive("dimension", of_checkpoint);
    if (of_checkpoint != dimension)
      parameters.fail("Dimension", "the checkpoint " + file + " is of a model of dimension " +
                                       std::to_string(of_checkpoint) + ".");
    std::string earlier_entries;
    archive("parameters", earlier_entries);
    refuse_changed_entries(parameters, earlier_entries, file, parameters.communicator());
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
