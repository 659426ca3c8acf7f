// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/log.h>

#include <tombolo/base/file_stream.h>

#include <tombolo/base/output_directory.h>

#include <deal.II/base/mpi.h>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>

namespace tombolo
{
  namespace
  {
    constexpr std::chrono::milliseconds time_between_redraws(100);

    template <typename... Arguments>
    std::string format(const char *pattern, const Arguments... arguments)
    {
      char text[256];
      std::snprintf(text, sizeof(text), pattern, arguments...);
      return text;
    }

    /** The first @p width characters (not bytes) of UTF-8 text. */
    std::string first_characters(const std::string &text, const std::size_t width)
    {
      std::size_t n_characters = 0;
      for (std::size_t i = 0; i < text.size(); ++i)
        if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80 && n_characters++ == width)
          return text.substr(0, i);
      return text;
    }
  } // namespace

  std::string format_duration(const double seconds)
  {
    if (!(seconds >= 0) || seconds > 1e9)
      return "?";
    const long whole = std::lround(seconds);
    const long hours = whole / 3600, minutes = whole / 60 % 60, rest = whole % 60;
    return hours > 0 ? format("%ld:%02ld:%02ld", hours, minutes, rest)
                     : format("%ld:%02ld", minutes, rest);
  }

  bool Log::standard_output_is_terminal()
  {
    if (isatty(STDOUT_FILENO) == 0)
      return false;
    bool is_launched = false;
    for (const char *variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"})
      is_launched = is_launched || std::getenv(variable) != nullptr;
    if (!is_launched)
      return true;
    const std::string launcher_output = "/proc/" + std::to_string(getppid()) + "/fd/1";
    const int descriptor = open(launcher_output.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK);
    if (descriptor < 0)
      return false;
    const bool result = isatty(descriptor) != 0;
    close(descriptor);
    return result;
  }

  Log::Log(const MPI_Comm communicator, const bool quiet)
      : Log(communicator, quiet, std::cout, standard_output_is_terminal())
  {
    limits_width = true;
  }

  Log::Log(const MPI_Comm communicator, const bool quiet, std::ostream &screen,
           const bool screen_is_terminal, const std::chrono::milliseconds time_between_lines)
      : is_printing_rank(dealii::Utilities::MPI::this_mpi_process(communicator) == 0),
        is_quiet(quiet), screen(screen), is_terminal(screen_is_terminal),
        time_between_lines(time_between_lines)
  {}

  Log::~Log()
  {
    end_progress();
  }

  void Log::open_file(const OutputDirectory &directory, const bool append)
  {
    if (!is_printing_rank)
      return;
    file = std::make_unique<FileStream>(
        directory.file("log.txt"), append ? FileStream::Mode::append : FileStream::Mode::create);
    *file << earlier_text << std::flush;
    earlier_text.clear();
    if (!*file)
      warn("log.txt cannot be written in " + directory.path() + ".");
  }

  void Log::print(const std::string &text)
  {
    if (!is_printing_rank)
      return;
    clear_line();
    screen << text << '\n' << std::flush;
    if (file != nullptr)
      *file << text << '\n' << std::flush;
    else
      earlier_text += text + '\n';
  }

  void Log::record(const std::string &text)
  {
    if (file != nullptr)
      *file << text << '\n' << std::flush;
  }

  void Log::start_progress(const std::uint64_t n_nodes, const double start_time,
                           const double end_time, const std::uint64_t start_step)
  {
    this->n_nodes = n_nodes;
    n_node_steps = 0;
    this->start_time = start_time;
    this->end_time = end_time;
    this->start_step = start_step;
    start = Clock::now();
    last_drawn = start;
    last_line = start;
  }

  void Log::change_nodes(const std::uint64_t n_nodes, const std::uint64_t step)
  {
    n_node_steps += this->n_nodes * (step - start_step);
    this->n_nodes = n_nodes;
    start_step = step;
  }

  std::string Log::progress_line(const Progress &progress) const
  {
    const double elapsed = std::chrono::duration<double>(Clock::now() - start).count();
    const double done = progress.time - start_time, left = end_time - progress.time;
    const auto done_steps =
        static_cast<double>(n_node_steps + n_nodes * (progress.step - start_step));
    return format("%5.1f %%  t = %.6g  step %llu  Δt = %.3g  %.3g node-steps/s  left %s  "
                  "%s error %.2g",
                  end_time > 0 ? 100 * progress.time / end_time : 100., progress.time,
                  static_cast<unsigned long long>(progress.step), progress.time_step,
                  elapsed > 0 ? done_steps / elapsed : 0.,
                  format_duration(done > 0 ? elapsed * left / done : NAN).c_str(), progress.balance,
                  progress.balance_error);
  }

  void Log::progress(const Progress &progress, const bool is_output)
  {
    if (!is_printing_rank)
      return;
    const auto now = Clock::now();
    if (is_output || now - last_line >= time_between_lines)
    {
      last_line = now;
      const std::string line = progress_line(progress);
      if (file != nullptr)
        *file << line << '\n' << std::flush;
      if (!is_quiet && !is_terminal)
        screen << line << '\n' << std::flush;
    }
    if (is_quiet || !is_terminal || (!is_output && now - last_drawn < time_between_redraws))
      return;
    last_drawn = now;
    std::string line = progress_line(progress);
    winsize window{};
    if (limits_width && ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 1)
      line = first_characters(line, window.ws_col - 1u);
    screen << "\r" << line << "\x1b[K" << std::flush;
    line_is_open = true;
  }

  void Log::clear_line()
  {
    if (line_is_open)
      screen << "\r\x1b[K";
    line_is_open = false;
  }

  void Log::end_progress()
  {
    if (line_is_open)
      screen << '\n' << std::flush;
    line_is_open = false;
  }
} // namespace tombolo
