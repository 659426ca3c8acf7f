// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/output/summary.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

#include "output_test_directory.h"
#include "text_testing.h"

using namespace tombolo;
using tombolo::testing::contains;

TEST(Json, strings_are_escaped_and_stay_utf8)
{
  EXPECT_EQ(json_text("a\"b\\c\n\t\r\x01"), "\"a\\\"b\\\\c\\n\\t\\r\\u0001\"\n");
  EXPECT_EQ(json_text("Δt → é"), "\"Δt → é\"\n");
  // Latin-1, an overlong slash, a cut-off character, a surrogate.
  EXPECT_EQ(json_text("\xe9"), "\"\ufffd\"\n");
  EXPECT_EQ(json_text("\xc0\xaf"), "\"\ufffd\ufffd\"\n");
  EXPECT_EQ(json_text("x\xe2\x86"), "\"x\ufffd\"\n");
  EXPECT_EQ(json_text("\xed\xa0\x80"), "\"\ufffd\ufffd\ufffd\"\n");
}

TEST(Json, numbers_are_numbers_and_exact)
{
  EXPECT_EQ(json_text(0.1), "0.1\n");
  EXPECT_EQ(json_text(3.), "3.0\n");
  EXPECT_EQ(json_text(1e300), "1e+300\n");
  EXPECT_EQ(json_text(std::numeric_limits<std::uint64_t>::max()), "18446744073709551615\n");
  EXPECT_EQ(json_text(-5), "-5\n");
  EXPECT_EQ(json_text(true), "true\n");
  EXPECT_EQ(std::stod(json_text(1. / 3)), 1. / 3);
}

TEST(Json, values_that_are_not_finite_become_null)
{
  EXPECT_EQ(json_text(std::nan("")), "null\n");
  EXPECT_EQ(json_text(-std::numeric_limits<double>::infinity()), "null\n");
}

TEST(Json, trees_keep_the_order_of_their_keys)
{
  Json tree;
  tree["z"] = 1;
  tree["a"]["inner"] = std::vector<double>{1.5, 2};
  tree["empty"] = Json::object();
  tree["none"] = Json::array();
  tree["z"] = "again";
  EXPECT_EQ(json_text(tree), "{\n  \"z\": \"again\",\n  \"a\": {\n    \"inner\": [\n      1.5,\n"
                             "      2.0\n    ]\n  },\n  \"empty\": {},\n  \"none\": []\n}\n");
  EXPECT_ANY_THROW(tree.push_back(1));
}

TEST(Summary, file_has_versions_ranks_memory_and_the_results_of_the_case)
{
  const TestDirectory test("summary");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  Summary summary(MPI_COMM_WORLD);
  summary.results()["length"] = 16.5;
  summary["nodes"] = 12u;
  summary.write(directory);
  const std::string text = read_file(directory.file("summary.json"));
  const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  EXPECT_TRUE(contains(text, "\"ranks\": " + std::to_string(n_ranks)));
  EXPECT_TRUE(contains(text, "\"deal.II\": \"9."));
  EXPECT_TRUE(contains(text, "\"nodes\": 12,"));
  EXPECT_TRUE(contains(text, "\"wall_seconds\": "));
  EXPECT_TRUE(contains(text, "\"results\": {\n    \"length\": 16.5\n  }\n}\n"));

  const std::size_t position = text.find("\"peak_memory_bytes\": ");
  ASSERT_NE(position, std::string::npos);
  const double bytes = std::stod(text.substr(position + 21));
  EXPECT_GT(bytes, 1e6 * n_ranks);
  EXPECT_LT(bytes, 1e10 * n_ranks);
}
