// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/child_process.h>

#include <tombolo/base/exceptions.h>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

extern char **environ;

namespace tombolo
{
  namespace
  {
    std::vector<std::string> environment_at_start;

    std::vector<char *> pointers_to(std::vector<std::string> &texts)
    {
      std::vector<char *> pointers;
      for (std::string &text : texts)
        pointers.push_back(text.data());
      pointers.push_back(nullptr);
      return pointers;
    }
  } // namespace

  void ChildProcess::remember_environment()
  {
    environment_at_start.clear();
    for (char **variable = environ; *variable != nullptr; ++variable)
      environment_at_start.emplace_back(*variable);
  }

  ChildProcess::ChildProcess(const std::vector<std::string> &command,
                             const std::string &output_file, const double time_limit_seconds)
      : time_limit(time_limit_seconds), start(std::chrono::steady_clock::now())
  {
    std::vector<std::string> arguments = command;
    std::vector<char *> argument_pointers = pointers_to(arguments);
    std::vector<char *> environment_pointers = pointers_to(environment_at_start);

    unlink(output_file.c_str()); // what there was, not what a link leads to
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output_file.c_str(),
                                     O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, 0644);
    posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    const int error = posix_spawnp(&process, argument_pointers[0], &files, &attributes,
                                   argument_pointers.data(), environment_pointers.data());
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0)
      throw RunError("The program " + command.front() + " cannot be started with its output in " +
                     output_file + ": " + std::strerror(error) + ".");
  }

  ChildProcess::~ChildProcess()
  {
    if (!ended)
      terminate();
  }

  bool ChildProcess::has_ended()
  {
    if (ended)
      return true;
    int status = 0;
    pid_t result;
    do
      result = waitpid(process, &status, WNOHANG);
    while (result < 0 && errno == EINTR);
    if (result != 0)
    {
      ended = true;
      if (result < 0)
        state = {ExitState::Kind::unknown, 0};
      else if (WIFSIGNALED(status))
        state = {ExitState::Kind::killed_by_signal, WTERMSIG(status)};
      else
        state = {ExitState::Kind::exited, WEXITSTATUS(status)};
      return true;
    }
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    if (time_limit > 0 && elapsed.count() > time_limit)
    {
      terminate();
      state = {ExitState::Kind::timed_out, 0};
    }
    return ended;
  }

  const ExitState &ChildProcess::exit_state() const
  {
    return state;
  }

  void ChildProcess::terminate()
  {
    // A program that hangs may not listen to SIGTERM; mpirun passes it on and ends its ranks.
    kill(-process, SIGTERM);
    for (int wait = 0; wait < 100 && waitpid(process, nullptr, WNOHANG) == 0; ++wait)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    kill(-process, SIGKILL);
    waitpid(process, nullptr, 0);
    ended = true;
  }
} // namespace tombolo
