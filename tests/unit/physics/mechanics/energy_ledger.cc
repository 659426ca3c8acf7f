// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
// Energies and momenta that are booked while bodies are loaded, moved and damped.
#include "frozen_body.h"
#include "nodal_fields.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      constexpr double damping_rate = 0.7;

      struct BalancedBody : BookedBody
      {
        BalancedBody(const Block &block, const double rate)
            : BookedBody(parameters_of(block) +
                         "subsection Damping\nset Rate = " + std::to_string(rate) + "\nend\n")
        {}

        void set_velocity(const double wave)
        {
          NodalVector &v = model->state.unsmoothed_velocity;
          v.copy_from(vector_field(
              *model, [&](const double *const x, const unsigned int d)
              { return 0.01 * (1. + d) * (1. + wave * std::sin(1.3 * x[0] + 0.7 * x[1] + d)); }));
          model->conditions->prescribe_initial_velocity(model->state, 0., 1e-3);
          v.update_ghosts();
        }

        /** A step of its own size after the first, so that Δt_n is none of them. */
        EnergyBalance next(const double time_step)
        {
          return BookedBody::next(time_step, 2. * time_step);
        }
      };

      std::vector<Block> all_methods(const std::string &conditions)
      {
        std::vector<Block> result;
        for (const char *const element : {"hexahedron", "fully integrated hexahedron"})
        {
          Block &block = result.emplace_back();
          block.formulation = element;
        }
        for (const char *const smoothing : {"paper", "fe matched", "affine", "none"})
          for (const char *const bridge : {"", "paper", "trace"})
          {
            Block &block = result.emplace_back();
            block.formulation = *bridge == '\0' ? "particles" : "coupled";
            block.bridge = *bridge == '\0' ? "paper" : bridge;
            block.options = std::string("set Smoothing = ") + smoothing;
          }
        for (Block &block : result)
        {
          block.cells = {4, 2, 2};
          block.conditions = conditions;
        }
        return result;
      }

      TEST(EnergyLedger, an_energy_that_is_no_number_from_the_start_on_makes_the_error_none)
      {
        BalancedBody body(all_methods("").front(), damping_rate);
        body.model->processes.front()->observed.energies.connect(
            [](EnergyAccounts &energies)
            { energies.add("wrong", EnergyKind::stored, std::nan("")); });
        EXPECT_TRUE(std::isnan(body.next(0.1).error));
      }

      TEST(EnergyLedger, a_rigid_body_that_falls_and_is_damped_is_balanced_exactly)
      {
        for (const Block &block :
             all_methods("set Conditions = weight\nsubsection Condition: weight\nset Type = "
                         "gravity\nset Function = 0.3; -2; cos(3*t)\nend\n"))
        {
          SCOPED_TRACE(block);
          BalancedBody body(block, damping_rate);
          body.set_velocity(0.);
          double expected[3] = {0.01, 0.02, 0.03}, moved[3] = {};
          for (unsigned int n = 0; n < 6; ++n)
          {
            const EnergyBalance balance = body.next(n % 2 == 0 ? 0.1 : 0.2);
            EXPECT_NEAR(balance.error, 0., 1e-13);
            EXPECT_LT(balance.momentum_drift, 1e-13);
            double energy = 0;
            for (const double v : expected)
              energy += 0.5 * 16. * v * v;
            EXPECT_NEAR(balance.smoothed_kinetic, energy, 1e-12 * energy);
            // v̂ with the damping of the mean of the velocities before and after.
            const double dt = n == 0 ? 0.05 : 0.15,
                         time = body.clock.time - body.clock.previous_step;
            const double gravity[3] = {0.3, -2., std::cos(3. * time)};
            for (unsigned int d = 0; d < 3; ++d)
              expected[d] = (expected[d] * (1. - 0.5 * damping_rate * dt) + dt * gravity[d]) /
                            (1. + 0.5 * damping_rate * dt);
            for (unsigned int d = 0; d < 3; ++d)
              moved[d] += body.clock.previous_step * expected[d];
            const NodalState &state = body.model->state;
            double difference = 0;
            for (unsigned int i = 0; i < state.partition()->n_local(); ++i)
              for (unsigned int d = 0; d < 3; ++d)
              {
                const double v = state.unsmoothed_velocity.node(i)[d];
                const double u = state.position.node(i)[d] - state.initial_position.node(i)[d];
                if (i < state.partition()->n_owned())
                  difference = std::max(difference, std::abs(v - expected[d]));
                difference = std::max(difference, std::abs(u - moved[d]));
              }
            EXPECT_LT(difference, 1e-13);
          }
        }
      }

      TEST(EnergyLedger, a_body_that_is_led_as_a_whole_is_balanced_exactly)
      {
        for (const Block &block :
             all_methods("set Conditions = lead, pull\nsubsection Condition: lead\nset Type = "
                         "velocity\nset Where = x > -1\nset Function = 0.2 + sin(2*t); 1 - t; "
                         "0.3*t*t\nend\nsubsection Condition: pull\nset Type = traction\nset "
                         "Where = x > 3.99\nset Function = 1; cos(t); 0.5\nend\n"))
        {
          SCOPED_TRACE(block);
          BalancedBody body(block, damping_rate);
          body.set_velocity(0.);
          for (unsigned int n = 0; n < 6; ++n)
          {
            const EnergyBalance balance = body.next(n % 2 == 0 ? 0.1 : 0.2);
            EXPECT_NEAR(balance.error, 0., 1e-13);
            EXPECT_LT(balance.momentum_drift, 1e-13);
            if (n > 0)
            {
              EXPECT_GT(balance.energies["mass damping"], 0.01);
            }
          }
        }
      }

      TEST(EnergyLedger, waves_in_a_body_that_is_shaken_and_pulled_are_balanced)
      {
        for (const Block &block :
             all_methods("set Conditions = shake, pull\nsubsection Condition: shake\nset Type = "
                         "velocity\nset Where = x < 0.01\nset Function = 0.02*sin(t); "
                         "0.03*cos(t); free\nend\nsubsection Condition: pull\nset Type = "
                         "traction\nset Where = x > 3.99\nset Function = 0.01; 0.01*cos(t); "
                         "0.005\nend\n"))
        {
          SCOPED_TRACE(block);
          BalancedBody body(block, 0.1);
          body.set_velocity(1.);
          double error = 0, drift = 0;
          for (unsigned int n = 0; n < 80; ++n)
          {
            const EnergyBalance balance = body.next(0.03);
            error = std::max(error, std::abs(balance.error));
            drift = std::max(drift, balance.momentum_drift);
          }
          EXPECT_LT(error, 1e-3);
          EXPECT_LT(drift, 1e-13);
        }
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
