// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include <mesh_testing.h>
#include <symmetric_body.h>

#include <gtest/gtest.h>

#include <string>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  std::string refusal(const std::string &conditions, const std::string &mesh = "")
  {
    SymmetricBlock block{"0, -0.75, 0", "1, 0.75, 1.5", "4, 6, 6" + mesh, ""};
    std::string text = parameters_of(block, Method{"paper"}, 3);
    text += conditions;
    const std::string empty = "set Conditions = \n";
    text.replace(text.find(empty), empty.size(), "set Conditions = a, b\n");
    return input_error([&] { make_model<3>(text); });
  }

  std::string condition(const std::string &name, const std::string &lines)
  {
    return "subsection Condition: " + name + "\nset Type = symmetry\n" + lines + "\nend\n";
  }

  const std::string good = condition("b", "set Where = x < 1e-9");
} // namespace

TEST(SymmetryInput, a_plane_that_is_none_is_refused_with_what_was_selected)
{
  const auto refusal_of = [](const std::string &lines)
  { return refusal(good + condition("a", lines)); };
  EXPECT_TRUE(contains(refusal_of("set Where = y < -0.1"), "Where"));
  EXPECT_TRUE(contains(refusal_of("set Where = y < -0.1"), "normal to a coordinate"));
  EXPECT_TRUE(contains(refusal_of("set Where = y < -0.74 && z < 0.01"), "too few"));
  EXPECT_TRUE(contains(refusal_of("set Where = z > 7"), "selects no node"));
  EXPECT_TRUE(contains(refusal_of("set Boundary = x min, y min"), "tilted"));
}

TEST(SymmetryInput, a_body_on_both_sides_of_a_plane_is_refused)
{
  EXPECT_TRUE(contains(refusal(good + condition("a", "set Where = abs(y) < 1e-9")),
                       "reaches beyond the plane y = 0 on both sides, by 0.75 and 0.75"));
}

TEST(SymmetryInput, a_part_of_a_plane_is_refused)
{
  EXPECT_TRUE(contains(refusal(good + condition("a", "set Where = z < 1e-9 && x < 0.6")),
                       "leaves out 14 nodes on the plane z = 0"));
}

TEST(SymmetryInput, the_same_plane_twice_is_refused)
{
  EXPECT_TRUE(contains(refusal(good + condition("a", "set Boundary = x min")),
                       "is the same plane of symmetry, x = 0"));
}

TEST(SymmetryInput, a_function_and_no_place_are_refused)
{
  EXPECT_TRUE(
      contains(refusal(good + condition("a", "set Where = z < 1e-9\nset Function = 0; 0; 0")),
               "needs no function"));
  EXPECT_TRUE(contains(refusal(good + condition("a", "")), "needs `Where`"));
}

TEST(SymmetryInput, a_turned_body_has_no_plane)
{
  EXPECT_TRUE(contains(
      refusal(condition("b", "set Boundary = x min") + condition("a", "set Where = z < 1e-9"),
              "\nset Rotation = 10"),
      "tilted"));
}

TEST(SymmetryInput, supports_that_reach_across_a_slab_are_refused)
{
  Method method{"paper\nset Dilation = 2.6"};
  const SymmetricBlock slab{"0, 0, 0", "2, 2, 0.25", "8, 8, 1", "z < 1e-9, z > 0.249"};
  EXPECT_TRUE(contains(input_error([&] { Body<3>(slab, method); }), "reach across the whole slab"));
  Body<3> thicker({"0, 0, 0", "2, 2, 0.5", "8, 8, 2", "z < 1e-9, z > 0.499"}, method);
  EXPECT_GT(
      dealii::Utilities::MPI::sum(thicker.model->state.partition()->n_images(), MPI_COMM_WORLD),
      0u);
}
