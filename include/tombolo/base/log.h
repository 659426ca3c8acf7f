// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mpi.h>

#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <string>

namespace tombolo
{
  class FileStream;
  class OutputDirectory;

  /** Where a run is. */
  struct Progress
  {
    double time = 0;                ///< t_n [T]
    std::uint64_t step = 0;         ///< steps taken, those before a resumption included
    double time_step = 0;           ///< Δt [T]
    const char *balance = "energy"; ///< or "heat", in scenes without mechanics
    double balance_error = 0;       ///< relative to the largest so far
  };

  /**
   * The log of a run. Rank 0 prints to the screen and to `log.txt`, the other ranks print nothing.
   * On a terminal the progress is one line that is redrawn; into a file or a pipe, and in log.txt,
   * it is one line at each output, and one where none was written for a minute. Cheap enough to
   * call in every step.
   */
  class Log
  {
  public:
    /** To standard output. @p quiet leaves out the progress on the screen, not in log.txt. */
    explicit Log(MPI_Comm communicator, bool quiet = false);

    /** To @p screen, which is redrawn as a terminal of unlimited width or not. @p
     * time_between_lines of the progress without an output. */
    Log(MPI_Comm communicator, bool quiet, std::ostream &screen, bool screen_is_terminal,
        std::chrono::milliseconds time_between_lines = std::chrono::minutes(1));

    Log(const Log &) = delete;
    Log &operator=(const Log &) = delete;

    /** Ends the line of the progress. */
    ~Log();

    /** Opens log.txt, writes what was printed before to it, and keeps it open. @p append continues
     * the file of the run that is resumed. */
    void open_file(const OutputDirectory &directory, bool append = false);

    /** Prints a line or several; a newline is added. */
    void print(const std::string &text);

    /** Writes a line to log.txt only. */
    void record(const std::string &text);

    /** Prints "Warning: ..." */
    void warn(const std::string &text)
    {
      print("Warning: " + text);
    }

    /** Starts the clock of speed and time left. A run begins at time 0; one that is resumed has
     * reached @p start_time in @p start_step steps, which count as done. */
    void start_progress(std::uint64_t n_nodes, double start_time, double end_time,
                        std::uint64_t start_step = 0);

    /** From @p step on there are @p n_nodes. */
    void change_nodes(std::uint64_t n_nodes, std::uint64_t step);

    /** Call in every step; @p is_output where results are written. */
    void progress(const Progress &progress, bool is_output);

    /** Ends the redrawn line; called by the destructor too. */
    void end_progress();

    /** Whether standard output ends at a terminal. MPI launchers put a terminal of their own
     * between rank 0 and a pipe, which is recognized. */
    static bool standard_output_is_terminal();

  private:
    std::string progress_line(const Progress &progress) const;
    void clear_line();

    using Clock = std::chrono::steady_clock;

    bool is_printing_rank;
    bool is_quiet;
    std::ostream &screen;
    bool is_terminal;
    std::chrono::milliseconds time_between_lines;
    bool limits_width = false;
    bool line_is_open = false;
    std::unique_ptr<FileStream> file; // null before open_file()
    std::string earlier_text;

    std::uint64_t n_nodes = 0, n_node_steps = 0; // the latter before start_step
    double start_time = 0, end_time = 0;
    std::uint64_t start_step = 0;
    Clock::time_point start, last_drawn, last_line;
  };

  /** "0:05", "12:40", "3:02:11", for the screen. */
  std::string format_duration(double seconds);
} // namespace tombolo
