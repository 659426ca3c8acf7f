// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "model_scene.h"
#include <tombolo/boundary/mechanical_conditions.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/mechanical_step.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace
{
  using namespace tombolo;

  /** A block of particles with waves that alternate from particle to particle, all of it at this
   * speed, with which one end is driven. Returns the balance after some steps. */
  EnergyBalance balance_at(const double speed, const char *const smoothing)
  {
    const auto scene = tombolo::testing::make_model<2>(
        "set Dimension = 2\nset Parts = b\nset Materials = m\nset Conditions = drive\n"
        "subsection Mesh\nset Type = box\nsubsection box\nset Upper corner = 6, 4\nset Cells = 6, "
        "4\n"
        "end\nend\nsubsection Part: b\nset Cells = all\nset Material = m\n"
        "set Formulation = momentum consistent particle\nsubsection momentum consistent particle\n"
        "set Smoothing = " +
        std::string(smoothing) +
        "\nset Dilatation = of particles\nend\nend\nsubsection Material: m\nset Model = "
        "elastic\nsubsection elastic\n"
        "set Density = 1\nset Young's modulus = 1\nset Poisson's ratio = 0.3\nend\nend\n"
        "subsection Condition: drive\nset Type = velocity\nset Where = x < 1e-9\nset Function "
        "= " +
        std::to_string(speed) +
        "; 0\nend\nsubsection Lattice filter\nset Power = 1\nset Interval = 2\nend\n");
    Model<2> &model = *scene;
    MechanicalStep<2> step(model);
    EnergyLedger ledger;
    NodalVector &v = model.state.unsmoothed_velocity;
    v.fill(
        [&](const unsigned int i, double *const components)
        {
          const double *const x = model.state.initial_position.node(i);
          components[0] = speed + 0.01 * std::cos(M_PI * (x[0] + x[1])) + 0.01 * std::sin(x[0]);
          components[1] = 0.;
        });
    Clock clock;
    clock.next_step = 0.1;
    model.conditions->prescribe_initial_velocity(model.state, 0., clock.next_step);
    v.update_ghosts();
    ledger.balance(model, clock);
    for (unsigned int n = 0; n < 20; ++n)
    {
      step.evaluate(clock);
      step.complete(clock);
      step.advance(clock);
      clock.advance();
    }
    step.evaluate(clock);
    step.complete(clock);
    return ledger.balance(model, clock);
  }

  TEST(LatticeFilter, takes_the_same_of_a_body_at_rest_and_of_one_that_is_led_along)
  {
    constexpr double speed = 1.5;
    for (const char *const smoothing : {"paper", "fe matched", "affine"})
    {
      const EnergyBalance at_rest = balance_at(0., smoothing), led = balance_at(speed, smoothing);
      const double taken = at_rest.energies["filter dissipation"], scale = led.total;
      EXPECT_GT(taken, 0.2 * at_rest.total) << smoothing;
      EXPECT_NEAR(led.energies["filter dissipation"], taken, 1e-12 * scale) << smoothing;
      EXPECT_NEAR(led.energies["elastic energy"], at_rest.energies["elastic energy"],
                  1e-12 * scale);
      const auto imbalance = [](const EnergyBalance &of)
      { return of.total - of.initial_total - of.external; };
      EXPECT_NEAR(imbalance(led), imbalance(at_rest), 1e-12 * scale) << smoothing;
      EXPECT_LT(led.momentum_drift, 1e-12) << smoothing;
      EXPECT_GT(std::abs(at_rest.impulse[0]), 1e-3) << smoothing;
    }
  }
} // namespace
