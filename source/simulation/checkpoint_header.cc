// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/on_ranks.h>
#include <tombolo/simulation/checkpoint_header.h>

#include <filesystem>
#include <system_error>

namespace tombolo
{
  namespace
  {
    constexpr const char *divisions_name = "divided cells";
  } // namespace

  void write_header(StateArchive &archive, unsigned int dimension, CheckpointHeader header)
  {
    archive("dimension", dimension);
    archive("parameters", header.entries);
    if (!header.divisions.empty())
      archive(divisions_name, header.divisions);
  }

  CheckpointHeader read_header(StateArchive &archive, const unsigned int dimension,
                               const Parameters &parameters)
  {
    unsigned int earlier = 0;
    archive("dimension", earlier);
    if (earlier != dimension)
      parameters.fail("Dimension", "the checkpoint " + archive.file() +
                                       " is of a model of dimension " + std::to_string(earlier) +
                                       ".");
    CheckpointHeader result;
    archive("parameters", result.entries);
    if (archive.has(divisions_name))
      archive(divisions_name, result.divisions);
    return result;
  }

  void list(Records &records, Clock &clock)
  {
    records.value("step", clock.step);
    records.value("time", clock.time);
    records.value("previous step", clock.previous_step);
    records.value("next step", clock.next_step);
    records.value("stable step", clock.stable_step);
  }

  bool is_of_directory(const std::string &file, const std::string &directory,
                       const MPI_Comm communicator)
  {
    namespace fs = std::filesystem;
    std::error_code code;
    return of_first_rank(communicator,
                         [&] {
                           return fs::equivalent(fs::absolute(file).parent_path().parent_path(),
                                                 directory, code);
                         });
  }
} // namespace tombolo
