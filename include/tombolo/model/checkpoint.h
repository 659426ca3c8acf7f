// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/log.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/state/state_archive.h>

#include <chrono>
#include <functional>
#include <string>

namespace tombolo
{
  /**
   * When checkpoints are written, and their files: `checkpoint/step_NNNNNNNNNNNN.h5` in the output
   * directory. One is written under another name, put on the disk, read again and compared with its
   * checksums, then renamed; only after that the oldest are removed. The last complete one
   * therefore survives wherever the run is killed. The state at the end of a run, from which other
   * runs can start, is `checkpoint/end.h5`.
   */
  class Checkpoints
  {
  public:
    /** Reads section "Checkpoint". */
    explicit Checkpoints(const Entries &e);

    /** Whether the number of steps asks for one, or the end of the run where it would have asked or
     * one was written before. The same on all ranks. */
    bool is_due(const unsigned long step, const bool is_end) const
    {
      return (step_interval > 0 && (is_end || step % step_interval == 0)) ||
             (is_end && !newest.empty());
    }

    /** Whether the time that has passed since the last one asks for one, on this rank's clock. */
    bool is_due_by_wall_time() const
    {
      return wall_interval > 0 &&
             std::chrono::duration<double>(std::chrono::steady_clock::now() - last).count() >=
                 wall_interval;
    }

    /** Writes one with what @p serialize puts into it. Throws RunError where it cannot be written
     * or not be read again. Collective. */
    void write(const OutputDirectory &directory, unsigned long step,
               const std::function<void(StateArchive &)> &serialize);

    /** Whether the scene keeps the state at its end. */
    bool keep_end_state() const
    {
      return keeps_end_state;
    }

    /** Writes that state with what @p serialize puts into it. Throws likewise. Collective. */
    void write_end_state(const OutputDirectory &directory,
                         const std::function<void(StateArchive &)> &serialize) const;

    /** The file written last, relative to the working directory; empty if none was. */
    const std::string &last_file() const
    {
      return newest;
    }

    /** The checkpoint to resume from: @p wanted, a file or a directory of checkpoints, or where it
     * is empty the newest whole one of the output directory. Warns of damaged ones that are passed
     * over. Throws InputError where there is none, or where the one that was named is damaged.
     * Collective. */
    static std::string find(const std::string &wanted, const std::string &output_directory,
                            Log &log, MPI_Comm communicator);

    /** The state that another run left, for one that starts from it: @p wanted is a file, or a
     * directory of checkpoints with the state at the end of a run, or without it the newest
     * checkpoint there. Throws InputError about the entry @p entry of @p section where there is
     * none, or where it is damaged. Collective. */
    static std::string find_state(const Section &section, const std::string &entry,
                                  MPI_Comm communicator);

    /** Removes the checkpoints of steps after @p step and what is left of an unfinished one, when a
     * run is resumed. Collective. */
    static void remove_later(const OutputDirectory &directory, unsigned long step);

  private:
    unsigned int step_interval;
    double wall_interval;
    unsigned int keep;
    bool keeps_end_state;
    std::string newest;
    std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();
  };

  /** Every entry that @p parameters use, as text in a checkpoint. */
  std::string text_of_entries(const Parameters &parameters);

  /** Throws an InputError that names the first entry with another value than in @p earlier
   * (text_of_entries() of the run that wrote @p file), except those that a resumed run may change.
   */
  void refuse_changed_entries(const Parameters &parameters, const std::string &earlier,
                              const std::string &file, MPI_Comm communicator);

  /** The same of the entries that say what the mesh and its parts are, for a run that starts from
   * the state of another. */
  void refuse_other_parts(const Parameters &parameters, const std::string &earlier,
                          const std::string &file, MPI_Comm communicator);
} // namespace tombolo
