// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "output_test_directory.h"

#include <gtest/gtest.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/output_directory.h>

#include <sys/stat.h>

#include <functional>

namespace
{
  using namespace tombolo;
  namespace fs = std::filesystem;

  bool is_first()
  {
    return dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  }

  /** Does something on rank 0 alone, before all continue. */
  void prepare(const std::function<void()> &action)
  {
    if (is_first())
      action();
    MPI_Barrier(MPI_COMM_WORLD);
  }

  std::string what_is_said(const std::function<void()> &action)
  {
    try
    {
      action();
    }
    catch (const RunError &error)
    {
      return error.what();
    }
    return "";
  }

  void put(const std::string &path, const std::string &text)
  {
    std::ofstream(path) << text;
  }

  class OutputDirectoryWithLinks : public ::testing::Test
  {
  protected:
    OutputDirectoryWithLinks()
        : test_directory("output_directory"),
          directory(test_directory.path + "/run", MPI_COMM_WORLD),
          elsewhere(test_directory.path + "/elsewhere")
    {
      prepare(
          [&]()
          {
            fs::create_directories(elsewhere);
            put(elsewhere + "/precious", "precious");
            for (const char *const name : {"summary.json", "log.csv", "summary.json.tmp"})
              fs::create_symlink(fs::absolute(elsewhere + "/precious"), directory.file(name));
          });
    }

    ~OutputDirectoryWithLinks() override
    {
      EXPECT_EQ(read_file(elsewhere + "/precious"), "precious");
    }

    TestDirectory test_directory;
    OutputDirectory directory;
    std::string elsewhere;
  };

  TEST_F(OutputDirectoryWithLinks, whole_files_take_the_place_of_links)
  {
    directory.write("summary.json", [](std::ostream &out) { out << "new"; });
    EXPECT_EQ(read_file(directory.file("summary.json")), "new");
    EXPECT_FALSE(fs::is_symlink(directory.file("summary.json")));
  }

  TEST_F(OutputDirectoryWithLinks, nothing_is_added_to_what_a_link_leads_to)
  {
    EXPECT_NE(what_is_said([&]() { directory.append("log.csv", "1, 2\n"); })
                  .find("it is a link, and links are not followed"),
              std::string::npos);
    EXPECT_EQ(directory.size("log.csv"), 0u);
    directory.append("other.csv", "1, 2\n");
    directory.append("other.csv", "3, 4\n");
    EXPECT_EQ(read_file(directory.file("other.csv")), "1, 2\n3, 4\n");
    MPI_Barrier(MPI_COMM_WORLD);
    directory.truncate("other.csv", 5);
    EXPECT_EQ(directory.size("other.csv"), 5u);
  }

  TEST_F(OutputDirectoryWithLinks, pipes_are_not_waited_for)
  {
    prepare(
        [&]()
        {
          for (const char *const name : {"a.csv", "b.csv.tmp"})
            ASSERT_EQ(mkfifo(directory.file(name).c_str(), 0600), 0);
        });
    EXPECT_NE(what_is_said([&]() { directory.append("a.csv", "1\n"); }).find("it is a pipe"),
              std::string::npos);
    directory.write("b.csv", [](std::ostream &out) { out << "2\n"; });
    EXPECT_EQ(read_file(directory.file("b.csv")), "2\n");
  }

  TEST_F(OutputDirectoryWithLinks, results_behind_a_link_are_neither_removed_nor_written)
  {
    prepare(
        [&]()
        {
          put(elsewhere + "/cells_0000.vtu", "of another run");
          put(elsewhere + "/step_12.h5", "of another run");
          fs::create_directory_symlink(fs::absolute(elsewhere), directory.file("solution"));
          fs::create_directory_symlink(fs::absolute(elsewhere), directory.file("checkpoint"));
        });
    directory.remove_earlier_results();
    EXPECT_TRUE(fs::exists(elsewhere + "/cells_0000.vtu"));
    EXPECT_TRUE(fs::exists(elsewhere + "/step_12.h5"));
    for (const char *const name : {"solution", "checkpoint"})
      EXPECT_NE(
          what_is_said([&]() { directory.create_subdirectory(name); }).find("a link has that name"),
          std::string::npos);
  }
} // namespace
