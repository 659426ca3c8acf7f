// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "frozen_body.h"
#include "text_testing.h"

#include <gtest/gtest.h>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      const std::vector<std::string> kinds_of_parts = {"hexahedron", "fully integrated hexahedron",
                                                       "particles"};

      Block block_of(const std::string &formulation, const std::string &options)
      {
        Block block;
        block.formulation = formulation;
        block.options = options;
        if (formulation == "particles") // of which each has its own volume
          block.options += "\nset Dilatation = of particles";
        block.cells = {4, 3, 3};
        return block;
      }

      const char *const viscous = "set Strain measure = rate\nset Linear bulk viscosity = "
                                  "0.06\nset Quadratic bulk viscosity = 1.5";

      /** The force after nodes moved from the lattice to 1 + @p stretch times it. */
      NodalVector force_of(FrozenBody<3> &body, const double stretch, const double time_increment)
      {
        NodalState &state = body.model->state;
        for (unsigned int i = 0; i < state.partition()->n_local(); ++i)
          for (unsigned int d = 0; d < 3; ++d)
          {
            const double x = state.initial_position.node(i)[d];
            state.position.node(i)[d] = (1. + stretch) * x;
            state.velocity.node(i)[d] = stretch * x / time_increment;
          }
        if (body.model->parts[0].particles != nullptr)
          body.model->parts[0].particles->stencils().inverse_deformation_is_current = false;
        NodalVector force(state.partition());
        body.model->parts[0].formulation->add_internal_force(
            {&state.position, &state.velocity, time_increment}, force);
        force.add_to_owners();
        return force;
      }

      TEST(BulkViscosity, a_compressed_part_is_held_back_by_the_pressure_of_its_points)
      {
        const double stretch = -0.01, dt = 0.3;
        for (const std::string &name : kinds_of_parts)
        {
          SCOPED_TRACE(name);
          FrozenBody<3> with(block_of(name, viscous)),
              without(block_of(name, "set Strain measure = rate"));
          const double difference =
              force_of(with, stretch, dt).dot(with.model->state.velocity) -
              force_of(without, stretch, dt).dot(without.model->state.velocity);

          const MaterialPoints &points = with.model->parts[0].formulation->points();
          const double *const volume = points.component(MaterialPoints::volume, 0);
          const double *const ratio = points.component(MaterialPoints::volume_ratio, 0);
          // The increment in the middle of the step; the power has the gradient at its end.
          const double increment = -3. * stretch / (1. + 0.5 * stretch);
          const double rate_at_end = -3. * stretch / (dt * (1. + stretch));
          double power = 0, dissipation = 0;
          for (unsigned int i = 0; i < points.size(); ++i)
          {
            if (volume[i] == 0.)
              continue;
            const double density = 1. / ratio[i], length = std::cbrt(volume[i]);
            const double rate = increment / dt;
            const double q =
                density * length * (0.06 * std::sqrt(ratio[i]) * rate + 1.5 * length * rate * rate);
            power += volume[i] * q * rate_at_end;
            dissipation += 0.5 * q * increment * (1. + 0.5 * increment) * volume[i];
          }
          EXPECT_GT(sum_over_ranks(power), 1e-6);
          EXPECT_NEAR(difference, -sum_over_ranks(power), 1e-10 * sum_over_ranks(power));
          const EnergyAccounts energies = with.model->parts[0].formulation->energies();
          EXPECT_NEAR(sum_over_ranks(energies["viscous dissipation"]), sum_over_ranks(dissipation),
                      1e-10 * sum_over_ranks(dissipation));
          EXPECT_EQ(sum_over_ranks(
                        without.model->parts[0].formulation->energies()["viscous dissipation"]),
                    0.);
          for (unsigned int c = 0; c < 6; ++c)
            for (unsigned int i = 0; i < points.size(); ++i)
              ASSERT_EQ(points.component(MaterialPoints::stress, c)[i],
                        without.model->parts[0].formulation->points().component(
                            MaterialPoints::stress, c)[i]);
        }
      }

      TEST(BulkViscosity, an_expanding_part_does_not_feel_it)
      {
        for (const std::string &name : kinds_of_parts)
        {
          SCOPED_TRACE(name);
          FrozenBody<3> with(block_of(name, viscous)),
              without(block_of(name, "set Strain measure = rate"));
          const NodalVector first = force_of(with, 0.01, 0.3),
                            second = force_of(without, 0.01, 0.3);
          for (unsigned int i = 0; i < with.model->state.partition()->n_owned(); ++i)
            for (unsigned int d = 0; d < 3; ++d)
              ASSERT_EQ(first.node(i)[d], second.node(i)[d]);
          EXPECT_EQ(
              sum_over_ranks(with.model->parts[0].formulation->energies()["viscous dissipation"]),
              0.);
        }
      }

      TEST(BulkViscosity, points_hold_nothing_of_it_when_it_is_off)
      {
        for (const std::string &name : kinds_of_parts)
        {
          FrozenBody<3> with(block_of(name, viscous)),
              without(block_of(name, "set Strain measure = rate"));
          const MaterialPoints &first = with.model->parts[0].formulation->points();
          const MaterialPoints &second = without.model->parts[0].formulation->points();
          EXPECT_EQ(first.fields().size(), second.fields().size() + 3);
          EXPECT_EQ(second.find_field("bulk viscosity pressure"), second.fields().size());
        }
      }

      TEST(BulkViscosity, the_spectral_step_allows_for_it)
      {
        for (const std::string &name : kinds_of_parts)
        {
          SCOPED_TRACE(name);
          FrozenBody<3> with(block_of(name, "set Linear bulk viscosity = 0.5")),
              without(block_of(name, "set Strain measure = rate"));
          const double first = with.estimator->estimate(*with.model).time_step;
          const double second = without.estimator->estimate(*without.model).time_step;
          EXPECT_LT(first, 0.95 * second);
          EXPECT_GT(first, 0.3 * second);
          EXPECT_FALSE(with.grows(first, 400));
        }
      }

      TEST(BulkViscosity, coefficients_out_of_range_are_refused)
      {
        for (const char *const entry : {"Linear bulk viscosity", "Quadratic bulk viscosity"})
          for (const char *const value : {"-0.1", "11", "nan"})
            for (const std::string &name : kinds_of_parts)
            {
              const std::string line = "set " + std::string(entry) + " = " + value;
              const std::string message =
                  input_error([&] { FrozenBody<3> body(block_of(name, line)); });
              EXPECT_TRUE(contains(message, entry)) << line;
              EXPECT_TRUE(contains(message, "allowed is"));
            }
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
