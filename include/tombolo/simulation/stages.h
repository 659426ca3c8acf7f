// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * A chain of runs in one file: `set Stages = press, cool, release`, with a section "Stage: NAME"
   * each, whose entries and sections stand in place of those outside of it. Each stage is a run of
   * its own, with its own clock and output directory (that of the file, then the name of the
   * stage), which starts from the state at the end of the one before. Sections of conditions,
   * materials and the like that a stage does not list, but another does, are no part of it.
   */
  class Stages
  {
  public:
    /** Reads the file. Throws InputError where stages and their sections do not fit. Collective. */
    Stages(const std::string &file, MPI_Comm communicator);

    const std::vector<std::string> &names() const
    {
      return stage_names;
    }

    /** The entries of a stage with @p overrides of the command line, not declared yet. Throws
     * InputError. */
    std::unique_ptr<Parameters> parameters(std::size_t stage,
                                           const std::vector<std::string> &overrides) const;

    /** The output directory of a stage with these overrides. */
    std::string output_directory(std::size_t stage,
                                 const std::vector<std::string> &overrides) const;

  private:
    struct Line
    {
      std::string text;
      std::string section;   ///< the top one that it is in; empty: none
      bool is_frame = false; ///< it opens or closes that section
    };

    void read_lines(const std::string &text);
    /** The value of an entry outside of all sections, of a stage or of the file. */
    std::string value(const std::string &stage, const std::string &entry) const;
    /** Whether a section "KIND: NAME" is of other stages only. */
    bool is_of_others(const std::string &stage, const std::string &section) const;
    /** The lines of the file for a stage, those of others empty, so that they keep their numbers.
     */
    std::string common_text(const std::string &stage) const;
    std::string own_text(const std::string &stage) const;

    std::string file_name;
    MPI_Comm communicator;
    ParameterScanner scanner;
    std::vector<std::string> stage_names;
    std::vector<Line> lines;
  };

  /** Whether this directory has checkpoints to resume from. Collective. */
  bool has_checkpoints(const std::string &output_directory, MPI_Comm communicator);

  /** Whether the run in this directory came to its end. Collective. */
  bool has_finished(const std::string &output_directory, MPI_Comm communicator);
} // namespace tombolo
