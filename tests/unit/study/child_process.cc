// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include "output_test_directory.h"

#include <gtest/gtest.h>

#include <tombolo/study/child_process.h>

#include <csignal>
#include <thread>

namespace
{
  using namespace tombolo;

  ExitState end_of(ChildProcess &process)
  {
    while (!process.has_ended())
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return process.exit_state();
  }

  struct Place : TestDirectory
  {
    Place() : TestDirectory("child_process")
    {
      std::filesystem::create_directories(path);
      ChildProcess::remember_environment();
    }
  };
} // namespace

TEST(ChildProcess, tells_how_a_program_ended)
{
  const Place place;
  const std::string screen = place.path + "/screen";
  ChildProcess success({"true"}, screen, 0.), failure({"false"}, screen, 0.);
  EXPECT_EQ(end_of(success).kind, ExitState::Kind::exited);
  EXPECT_EQ(success.exit_state().code, 0);
  EXPECT_EQ(end_of(failure).code, 1);
  ChildProcess slow({"sleep", "20"}, screen, 0.05);
  EXPECT_EQ(end_of(slow).kind, ExitState::Kind::timed_out);
}

TEST(ChildProcess, unknown_end_is_no_success)
{
  const Place place;
  // The system forgets the status of children of a process that ignores their ends.
  const auto former = std::signal(SIGCHLD, SIG_IGN);
  ChildProcess process({"true"}, place.path + "/screen", 0.);
  EXPECT_EQ(end_of(process).kind, ExitState::Kind::unknown);
  std::signal(SIGCHLD, former);
}

TEST(ChildProcess, output_does_not_follow_a_link)
{
  const Place place;
  const std::string precious = place.path + "/precious", screen = place.path + "/screen";
  std::ofstream(precious) << "precious";
  std::filesystem::create_symlink(std::filesystem::absolute(precious), screen);
  ChildProcess process({"echo", "words"}, screen, 0.);
  end_of(process);
  EXPECT_EQ(read_file(precious), "precious");
  EXPECT_EQ(read_file(screen), "words\n");
}
