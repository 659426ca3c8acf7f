// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frozen_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  /** Eigenvalues of a free block below two bounds, over the largest. */
  struct Count
  {
    unsigned int n_zero; ///< no stress resists these
    unsigned int n_soft; ///< softer than the softest mode of elements; with those of zero
  };

  Count count(const std::string &formulation, const std::string &options,
              const std::string &mesh_options = "")
  {
    Block block;
    block.formulation = formulation;
    block.options = options;
    block.mesh_options = mesh_options;
    block.cells = {4, 4, 4};
    FrozenBody<3> body(block);
    const std::vector<double> values = body.eigenvalues();
    const auto n_below = [&](const double bound)
    {
      return static_cast<unsigned int>(
          std::count_if(values.begin(), values.end(), [&](const double v) { return v < bound; }));
    };
    const Count result{n_below(1e-8), n_below(0.01)};
    std::cout << block << ": of " << values.size() << " modes " << result.n_zero
              << " without energy (up to " << values[result.n_zero - 1] << "), the next at "
              << values[result.n_zero] << ", " << result.n_soft << " below 0.01" << std::endl;
    return result;
  }

  Count count_particles(const std::string &dilation, const std::string &smoothing,
                        const std::string &mesh_options = "")
  {
    return count("particles",
                 "set Shape functions = moving least squares\nset Dilation = " + dilation +
                     "\nset Smoothing = " + smoothing,
                 mesh_options);
  }
} // namespace

TEST(ZeroEnergyModes, a_free_block_of_elements_has_its_six_rigid_motions)
{
  for (const char *formulation : {"hexahedron", "fully integrated hexahedron"})
  {
    const Count modes = count(formulation, "");
    EXPECT_EQ(modes.n_zero, 6u);
    EXPECT_EQ(modes.n_soft, 6u);
  }
}

TEST(ZeroEnergyModes, elements_of_one_point_without_hourglass_control_have_more)
{
  EXPECT_EQ(count("hexahedron", "set Hourglass stiffness = 0").n_zero, 57u);
}

TEST(ZeroEnergyModes, a_free_block_of_particles_has_its_rigid_motions_and_soft_lattice_modes)
{
  for (const char *smoothing : {"paper", "fe matched", "affine", "none"})
  {
    EXPECT_EQ(count_particles("1.2", smoothing).n_soft, 6u);
    const Count usual = count_particles("1.8", smoothing);
    EXPECT_EQ(usual.n_zero, 6u);
    const Count wide = count_particles("2.5", smoothing);
    EXPECT_EQ(wide.n_zero, 6u);
    EXPECT_GT(wide.n_soft, 6u);
    if (std::string(smoothing) != "none")
    {
      EXPECT_GT(usual.n_soft, 6u);
    }
  }
  EXPECT_EQ(
      count_particles("1.8", "affine", "set Disorder = 0.2\nset Surface nodes = slide").n_zero, 6u);
}

TEST(ZeroEnergyModes, cell_averages_have_the_six_rigid_motions)
{
  for (const std::string smoothing : {"affine", "none"})
    for (const std::string mesh_options : {"", "set Disorder = 0.2\nset Surface nodes = slide"})
      EXPECT_EQ(count("particles",
                      "set Shape functions = cell averages\nset Smoothing = " + smoothing,
                      mesh_options)
                    .n_zero,
                6u);
}

TEST(ZeroEnergyModes, the_stiffness_of_dilatation_of_cells_has_no_soft_mode)
{
  for (const std::string mesh_options : {"", "set Disorder = 0.2\nset Surface nodes = slide"})
    for (const double poisson : {0.3, 0.499})
    {
      std::vector<double> next;
      for (const std::string options : {"", "\nset Zero-energy stiffness = 0"})
      {
        Block block;
        block.options = "set Dilatation = of cells" + options;
        block.mesh_options = mesh_options;
        block.poisson = poisson;
        block.cells = {3, 3, 3};
        FrozenBody<3> body(block);
        const std::vector<double> values = body.eigenvalues_of_stiffness();
        EXPECT_LT(std::abs(values[5]), 1e-10);
        next.push_back(values[6]);
      }
      std::cout << "softest mode: " << next[0] << ", without control " << next[1] << std::endl;
      EXPECT_GT(next[0], poisson < 0.4 ? 0.02 : 0.0001);
      EXPECT_GT(next[0], next[1]);
      EXPECT_GT(next[1], 1e-6);
    }
}

TEST(ZeroEnergyModes, a_free_coupled_block_has_its_six_rigid_motions)
{
  for (const char *smoothing : {"paper", "affine"})
    EXPECT_EQ(count("coupled", std::string("set Smoothing = ") + smoothing).n_zero, 6u);
}
