// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
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
    try
    {
      Parameters parameters(MPI_COMM_WORLD);
      const std::string empty = "set Conditions = \n";
      text.replace(text.find(empty), empty.size(), "set Conditions = a, b\n");
      parameters.read_text(text, "test.prm");
      Model<3>::declare_parameters(parameters);
      parameters.assign();
      Model<3> model(parameters, MPI_COMM_WORLD);
    }
    catch (const InputError &error)
    {
      return error.what();
    }
    return "";
  }

  std::string condition(const std::string &name, const std::string &lines)
  {
    return "subsection Condition: " + name + "\nset Type = symmetry\n" + lines + "\nend\n";
  }

  const std::string good = condition("b", "set Where = x < 1e-9");
} // namespace

TEST(SymmetryInput, a_plane_that_is_none_is_refused_with_what_was_selected)
{
  EXPECT_NE(refusal(good + condition("a", "set Where = y < -0.1")).find("Where"),
            std::string::npos);
  EXPECT_NE(refusal(good + condition("a", "set Where = y < -0.1")).find("normal to a coordinate"),
            std::string::npos);
  EXPECT_NE(refusal(good + condition("a", "set Where = y < -0.74 && z < 0.01")).find("too few"),
            std::string::npos);
  EXPECT_NE(refusal(good + condition("a", "set Where = z > 7")).find("selects no node"),
            std::string::npos);
  EXPECT_NE(refusal(good + condition("a", "set Boundary = x min, y min")).find("tilted"),
            std::string::npos);
}

TEST(SymmetryInput, a_body_on_both_sides_of_a_plane_is_refused)
{
  const std::string message = refusal(good + condition("a", "set Where = abs(y) < 1e-9"));
  EXPECT_NE(message.find("reaches beyond the plane y = 0 on both sides, by 0.75 and 0.75"),
            std::string::npos)
      << message;
}

TEST(SymmetryInput, a_part_of_a_plane_is_refused)
{
  const std::string message = refusal(good + condition("a", "set Where = z < 1e-9 && x < 0.6"));
  EXPECT_NE(message.find("leaves out 14 nodes on the plane z = 0"), std::string::npos) << message;
}

TEST(SymmetryInput, the_same_plane_twice_is_refused)
{
  const std::string message = refusal(good + condition("a", "set Boundary = x min"));
  EXPECT_NE(message.find("is the same plane of symmetry, x = 0"), std::string::npos) << message;
}

TEST(SymmetryInput, a_function_and_no_place_are_refused)
{
  EXPECT_NE(refusal(good + condition("a", "set Where = z < 1e-9\nset Function = 0; 0; 0"))
                .find("needs no function"),
            std::string::npos);
  EXPECT_NE(refusal(good + condition("a", "")).find("needs `Where`"), std::string::npos);
}

TEST(SymmetryInput, a_turned_body_has_no_plane)
{
  EXPECT_NE(refusal(condition("b", "set Boundary = x min") + condition("a", "set Where = z < 1e-9"),
                    "\nset Rotation = 10")
                .find("tilted"),
            std::string::npos);
}

TEST(SymmetryInput, supports_that_reach_across_a_slab_are_refused)
{
  Method method{"paper\nset Dilation = 2.6"};
  const SymmetricBlock slab{"0, 0, 0", "2, 2, 0.25", "8, 8, 1", "z < 1e-9, z > 0.249"};
  try
  {
    Body<3> body(slab, method);
    FAIL() << "no refusal";
  }
  catch (const InputError &error)
  {
    EXPECT_NE(std::string(error.what()).find("reach across the whole slab"), std::string::npos)
        << error.what();
  }
  Body<3> thicker({"0, 0, 0", "2, 2, 0.5", "8, 8, 2", "z < 1e-9, z > 0.499"}, method);
  EXPECT_GT(
      dealii::Utilities::MPI::sum(thicker.model->state.partition()->n_images(), MPI_COMM_WORLD),
      0u);
}
