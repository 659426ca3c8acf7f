// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include "output_test_directory.h"

#include <tombolo/base/memory.h>

namespace
{
  TEST(FreeMemory, of_a_container_counts_files_that_can_leave_the_memory)
  {
    const TestDirectory directory("memory");
    const auto put = [&](const std::string &file, const std::string &text)
    { std::ofstream(directory.create(file)) << text; };
    put("memory.max", "1000\n");
    put("memory.current", "990\n");
    EXPECT_EQ(tombolo::free_memory(directory.path), 10.);
    put("memory.stat", "anon 90\nfile 900\ninactive_file 800\nactive_file 100\n");
    EXPECT_EQ(tombolo::free_memory(directory.path), 810.);
    put("memory.max", "max\n");
    EXPECT_GT(tombolo::free_memory(directory.path), 1000.);
  }
} // namespace
