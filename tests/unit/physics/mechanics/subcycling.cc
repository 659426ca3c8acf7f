// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
// Cells that take longer steps than others: small graded bodies are stable up to the limits of all
// groups, keep their momentum, and respond as bodies of one step do.
#include "frozen_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  /** Cells of the sizes 1, 1/2 and @p fine along x. */
  std::string graded_body(const unsigned int dim, const std::string &formulation,
                          const unsigned int largest_ratio, const double fine,
                          const double disorder, const std::string &options = "")
  {
    const std::string beside = dim == 2 ? "; 2" : "; 2; 2";
    const auto n_fine = static_cast<unsigned int>(std::lround(1. / fine));
    return "set Dimension = " + std::to_string(dim) +
           "\nset Materials = m\nset Parts = a\nsubsection Mesh\nset Type = box\nsubsection box\n"
           "set Upper corner = 9, 2" +
           (dim == 2 ? "" : ", 2") + "\nset Cells = 4 to 4 | " + std::to_string(n_fine) +
           " to 5 | 2 to 6 | 3 to 9" + beside + "\nset Disorder = " + std::to_string(disorder) +
           "\nset Surface nodes = slide\nend\nend\nsubsection Material: m\nset Model = elastic\n"
           "subsection elastic\nset Density = 1\nset Young's modulus = 1\nset Poisson's ratio = "
           "0.3\nend\nend\nsubsection Part: a\nset Cells = all\nset Material = m\n"
           "set Formulation = " +
           formulation + "\nsubsection " + formulation + "\n" + options +
           "\nend\nend\nsubsection Time step\nsubsection Subcycling\nset Largest ratio = " +
           std::to_string(largest_ratio) + "\nend\nend\n";
  }

  /** The limit of the step, and the ratios that cells have. */
  template <int dim>
  double limit_of(FrozenBody<dim> &body)
  {
    Clock clock;
    body.model->processes.back()->change_model(*body.model, clock); // makes the first choice
    return body.estimator->estimate(*body.model).time_step;
  }

  /** The largest kinetic energy in the last tenth of a long vibration over that in the first. */
  template <int dim>
  double growth(FrozenBody<dim> &body, const double time_step, const unsigned int n_steps)
  {
    std::array<double, 2> largest{};
    body.vibrate(time_step, n_steps,
                 [&](const unsigned int n, const double energy)
                 {
                   if (n < n_steps / 10)
                     largest[0] = std::max(largest[0], energy);
                   else if (n >= n_steps - n_steps / 10)
                     largest[1] = std::max(largest[1], energy);
                   return !(energy < 1e3);
                 });
    return largest[1] > 0. ? largest[1] / largest[0] : 1e300;
  }

  template <int dim>
  void expect_stable(const std::string &text, const std::set<unsigned int> &ratios,
                     const unsigned int n_steps)
  {
    FrozenBody<dim> body(text);
    const double limit = limit_of(body);
    const std::vector<unsigned int> &cell_ratios = body.model->parts[0].step_ratios;
    for (const unsigned int ratio : ratios)
      EXPECT_GT(sum_over_ranks(double(std::count(cell_ratios.begin(), cell_ratios.end(), ratio))),
                0.)
          << ratio;
    for (const double fraction : {0.5, 0.7, 0.85, 0.9, 0.97})
      EXPECT_LT(growth(body, fraction * limit, n_steps), 1.3) << text << fraction;
  }
} // namespace

TEST(Subcycling, IsStableUpToTheLimitsOfAllGroups)
{
  for (const std::string formulation : {"hexahedron", "fully integrated hexahedron"})
    for (const double disorder : {0., 0.2})
    {
      expect_stable<2>(graded_body(2, formulation, 4, 0.2, disorder), {1, 2, 4}, 20000);
      expect_stable<2>(graded_body(2, formulation, 2, 0.4, disorder), {1, 2}, 20000);
    }
  expect_stable<3>(graded_body(3, "fully integrated hexahedron", 4, 0.2, 0.2), {1, 2, 4}, 5000);
}

TEST(Subcycling, IsUnstableBeyondTheLimit)
{
  FrozenBody<2> body(graded_body(2, "fully integrated hexahedron", 4, 0.2, 0.));
  const double limit = limit_of(body);
  EXPECT_GT(growth(body, 1.1 * limit, 5000), 100.);
}

TEST(Subcycling, LosesNoStepToTheLimitOfSingleSteps)
{
  FrozenBody<2> single(graded_body(2, "fully integrated hexahedron", 1, 0.2, 0.2));
  FrozenBody<2> grouped(graded_body(2, "fully integrated hexahedron", 8, 0.2, 0.2));
  EXPECT_GT(limit_of(grouped), 0.97 * single.estimator->estimate(*single.model).time_step);
}

TEST(Subcycling, HalvesTheLimitWhereAllCellsTakeTwoSteps)
{
  FrozenBody<2> body(graded_body(2, "fully integrated hexahedron", 2, 0.4, 0.2));
  Model<2> &model = *body.model;
  const double single = body.estimator->estimate(model).time_step;
  model.parts[0].step_ratios.assign(model.parts[0].formulation->n_cells(), 2);
  model.step_groups.parts[0]->set_step_ratios(model.parts[0].step_ratios);
  EXPECT_NEAR(body.estimator->estimate(model).time_step, 0.5 * single, 0.01 * single);
}

TEST(Subcycling, KeepsMomentum)
{
  FrozenBody<3> body(graded_body(3, "hexahedron", 4, 0.2, 0.2));
  const double limit = limit_of(body);
  const auto momentum = [&](const unsigned int d, const bool is_absolute)
  {
    double sum = 0;
    for (unsigned int i = 0; i < body.model->state.partition()->n_owned(); ++i)
    {
      const double node_momentum =
          *body.model->bridge->mass().node(i) * body.model->state.unsmoothed_velocity.node(i)[d];
      sum += is_absolute ? std::abs(node_momentum) : node_momentum;
    }
    return sum_over_ranks(sum);
  };
  std::array<double, 3> first{};
  body.vibrate(0.85 * limit, 400,
               [&](const unsigned int n, const double)
               {
                 for (unsigned int d = 0; d < 3; ++d)
                   if (n == 0)
                     first[d] = momentum(d, false);
                   else
                     EXPECT_NEAR(momentum(d, false), first[d], 1e-11 * momentum(d, true)) << n;
                 return false;
               });
}
