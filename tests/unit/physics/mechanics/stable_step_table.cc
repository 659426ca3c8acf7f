// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frozen_body.h"

#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <iostream>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  std::string position_in_block(const dealii::Point<3> &position,
                                const std::vector<unsigned int> &cells)
  {
    unsigned int n_extreme = 0;
    for (unsigned int d = 0; d < 3; ++d)
      n_extreme +=
          (std::abs(position[d]) < 1e-6 || std::abs(position[d] - cells[d]) < 1e-6) ? 1 : 0;
    const char *const names[] = {"interior", "face", "edge", "corner"};
    return names[n_extreme];
  }

  /** One row of the table; returns the estimate over the limit. */
  double write_row(std::ostream &out, const std::string &label, const Block &block)
  {
    FrozenBody<3> body(block);
    const StepLimit spectral = body.estimator->estimate(*body.model);
    const double limit = body.limit_by_eigenvalues();
    const double paper = courant_limit(*body.model).time_step;
    const auto mark = [&](const double factor)
    {
      std::ostringstream text;
      text << std::fixed << std::setprecision(2);
      if (factor * paper > limit)
        text << "**" << factor * paper / limit << "**";
      else
        text << factor * paper / limit;
      return text.str();
    };
    double gamma = 0;
    for (const Part<3> &part : body.model->parts)
      if (part.particles != nullptr)
        gamma = part.particles->smoothing().gamma;
    out << "| " << label << " | " << std::fixed << std::setprecision(2) << gamma << " | "
        << block.poisson << " | " << std::setprecision(3) << limit << " | "
        << spectral.time_step / limit << " | " << mark(0.9) << " | " << mark(1.) << " | "
        << spectral.entity << ", " << position_in_block(spectral.position, block.cells) << " |"
        << std::endl;
    return spectral.time_step / limit;
  }

  void write_head(std::ostream &out, const std::string &first)
  {
    out << "\n| " << first
        << " | γ | ν | limit c Δt/h | spectral / limit | 0.9 × (41) / limit | (41) / limit | "
           "limited by |"
           "\n|---|---|---|---|---|---|---|---|\n";
  }
} // namespace

/** Writes the tables of doc/stable_step.md into the file that the environment variable
 * TOMBOLO_STABLE_STEP_TABLE names; without it, one row of each table. */
TEST(StableStepTable, every_row_of_the_spectral_step_is_within_two_percent_below_the_limit)
{
  const char *const file = std::getenv("TOMBOLO_STABLE_STEP_TABLE");
  const bool is_complete = file != nullptr;
  std::ofstream table;
  if (is_complete)
    table.open(file);
  std::ostream &out = is_complete ? static_cast<std::ostream &>(table) : std::cout;
  std::vector<double> ratios;
  const std::vector<double> poisson =
      is_complete ? std::vector<double>{0., 0.3, 0.49} : std::vector<double>{0.3};

  write_head(out, "dilation, smoothing");
  for (const std::string dilation : {"1.2", "1.5", "1.8", "1.9", "2.2", "2.5"})
    for (const std::string smoothing : {"paper", "fe matched", "phase", "affine", "none"})
      for (const double nu : poisson)
      {
        if (!is_complete && (dilation != "1.8" || smoothing != "paper"))
          continue;
        Block block;
        block.options = "set Dilation = " + dilation + "\nset Smoothing = " + smoothing;
        block.poisson = nu;
        ratios.push_back(write_row(out, dilation + ", " + smoothing, block));
      }

  write_head(out, "element");
  for (const auto &[name, options, cells] :
       std::vector<std::tuple<std::string, std::string, std::vector<unsigned int>>>{
           {"hexahedron", "", {6, 5, 5}},
           {"fully integrated hexahedron", "", {6, 5, 5}},
           {"lagrange hexahedron", "set Degree = 2", {3, 3, 2}},
           {"lagrange hexahedron", "set Degree = 3", {2, 2, 2}}})
    for (const double nu : poisson)
    {
      if (!is_complete && name != "hexahedron")
        continue;
      Block block;
      block.formulation = name;
      block.options = options;
      block.cells = cells;
      block.poisson = nu;
      ratios.push_back(write_row(
          out, name + (options.empty() ? "" : ", ") + options.substr(options.empty() ? 0 : 4),
          block));
    }

  write_head(out, "coupled: element, smoothing, bridge");
  for (const std::string element : {"hexahedron", "fully integrated hexahedron"})
    for (const std::string smoothing : {"paper", "fe matched", "affine"})
      for (const std::string bridge : {"paper", "trace"})
        for (const double nu : poisson)
        {
          if (!is_complete && (element != "hexahedron" || smoothing != "affine"))
            continue;
          Block block;
          block.formulation = "coupled";
          block.element = element;
          block.options = "set Smoothing = " + smoothing;
          block.bridge = bridge;
          block.poisson = nu;
          ratios.push_back(write_row(out, element + ", " + smoothing + ", " + bridge, block));
        }

  for (const double ratio : ratios)
  {
    EXPECT_GE(ratio, 0.98);
    EXPECT_LE(ratio, 1.00);
  }
}
