// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include "frozen_body.h"
#include "patch_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace
{
  using namespace tombolo;
  using namespace tombolo::testing;

  Block smoothed_block(const std::vector<unsigned int> &cells, const std::string &options,
                       const std::string &mesh_options)
  {
    Block block;
    block.formulation = "smoothed cells";
    block.cells = cells;
    block.options = options;
    block.mesh_options = mesh_options;
    return block;
  }

  const std::string disorder = "set Disorder = 0.2\nset Surface nodes = slide";

  template <int dim>
  void expect_patch(const std::string &options, const std::string &mesh_options)
  {
    const std::vector<unsigned int> n(dim, dim == 3 ? 5 : 8);
    const PatchErrors errors =
        patch_errors<dim>(parameters_of(smoothed_block(n, options, mesh_options)), n);
    EXPECT_LE(errors.force, 1e-11) << options << ", " << mesh_options;
    EXPECT_LE(errors.stress, 1e-8) << options << ", " << mesh_options; // of the step's own size
  }

  TEST(SmoothedCells, pass_the_patch_test_in_disordered_and_warped_cells)
  {
    for (const std::string dilation : {"1.1", "1.5"})
    {
      expect_patch<2>("set Dilation = " + dilation, disorder);
      expect_patch<3>("set Dilation = " + dilation, disorder);
    }
    expect_patch<3>("set Strain measure = rate", disorder);
  }

  TEST(SmoothedCells, of_one_point_pass_it_on_a_lattice_only)
  {
    const std::string options = "set Integration = one point";
    expect_patch<2>(options, "");
    expect_patch<3>(options, "");
    const std::vector<unsigned int> n(3, 5);
    EXPECT_GT(patch_errors<3>(parameters_of(smoothed_block(n, options, disorder)), n).force, 1e-2);
  }

  TEST(SmoothedCells, pass_the_patch_test_beside_elements)
  {
    std::string text = parameters_of(smoothed_block({6, 5, 5}, "", disorder));
    const auto replace = [&text](const std::string &from, const std::string &to)
    {
      const std::size_t at = text.find(from);
      ASSERT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    };
    replace("set Parts = a", "set Parts = a, e");
    replace("set Cells = all", "set Cells = x < 3 || y > 3");
    text += "subsection Part: e\nset Cells = otherwise\nset Material = m\n"
            "set Formulation = fully integrated hexahedron\nend\n";
    const PatchErrors errors = patch_errors<3>(text, {6, 5, 5});
    EXPECT_LE(errors.force, 1e-11);
    EXPECT_LE(errors.stress, 1e-8);
  }

  template <int dim>
  std::vector<double> eigenvalues(const std::string &formulation, const std::string &options,
                                  double &largest)
  {
    Block block = smoothed_block(std::vector<unsigned int>(dim, dim == 3 ? 3 : 6), options, "");
    block.formulation = formulation;
    FrozenBody<dim> body(block);
    largest = 4. / std::pow(body.limit_by_eigenvalues(), 2);
    return body.eigenvalues();
  }

  template <int dim>
  void expect_rigid_modes_alone(const std::string &options)
  {
    constexpr unsigned int n_rigid = dim * (dim + 1) / 2;
    double largest, largest_of_elements;
    const std::vector<double> values = eigenvalues<dim>("smoothed cells", options, largest);
    const std::vector<double> element_eigenvalues =
        eigenvalues<dim>("fully integrated hexahedron", "", largest_of_elements);
    EXPECT_LT(values[n_rigid - 1], 1e-8) << options;
    // Frequencies: roots of eigenvalues.
    EXPECT_GE(std::sqrt(values[n_rigid] * largest),
              0.2 * std::sqrt(element_eigenvalues[n_rigid] * largest_of_elements))
        << options;
  }

  TEST(SmoothedCells, have_the_rigid_motions_as_their_only_modes_without_energy)
  {
    expect_rigid_modes_alone<2>("");
    expect_rigid_modes_alone<3>("");
    expect_rigid_modes_alone<3>("set Dilation = 1.5");
  }

  TEST(SmoothedCells, of_one_point_have_more)
  {
    double largest;
    EXPECT_LT(eigenvalues<3>("smoothed cells", "set Integration = one point", largest)[12], 1e-8);
  }

  TEST(SmoothedCells, have_a_step_that_is_estimated_and_not_shorter_than_elements)
  {
    for (const std::string dilation : {"1.1", "1.5"})
    {
      FrozenBody<3> body(smoothed_block({4, 3, 3}, "set Dilation = " + dilation, disorder));
      const double limit = body.limit_by_eigenvalues();
      const double estimate = body.estimator->estimate(*body.model).time_step;
      EXPECT_LE(estimate, 1.0001 * limit);
      EXPECT_GE(estimate, 0.98 * limit);
      Block elements = smoothed_block({4, 3, 3}, "", disorder);
      elements.formulation = "fully integrated hexahedron";
      EXPECT_GT(limit, FrozenBody<3>(elements).limit_by_eigenvalues());
      EXPECT_FALSE(body.grows(0.98 * limit, 400));
      EXPECT_TRUE(body.grows(1.02 * limit, 2000));
    }
  }
} // namespace
