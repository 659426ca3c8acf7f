// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "frozen_body.h"
#include "text_testing.h"
#include <tombolo/physics/mechanics/energy_ledger.h>

#include <gtest/gtest.h>

#include <functional>

/** Plastic flow and bulk viscosity in elements and in particles. */
namespace tombolo
{
  namespace testing
  {
    namespace
    {
      using Function = std::function<dealii::Point<3>(const double *x)>;

      const std::string particle_name = "particles";

      std::string plastic_block(const std::string &formulation, const std::string &options,
                                const std::vector<unsigned int> &cells, const std::string &yield)
      {
        Block block;
        block.formulation = formulation;
        block.options = options;
        block.cells = cells;
        return changed(
            parameters_of(block), "set Model = elastic\nsubsection elastic\n",
            "set Model = j2 plasticity\nsubsection j2 plasticity\nset Flow stress = linear "
            "hardening\nset Taylor-Quinney coefficient = 0.9\nset Specific heat capacity = 0.1\n"
            "set Initial temperature = 20\nsubsection linear hardening\nset Yield stress = " +
                yield + "\nset Hardening modulus = 0.02\nend\n");
      }

      /** The one part of a scene under a motion that is prescribed at all nodes. */
      class DrivenPart
      {
      public:
        explicit DrivenPart(const std::string &text) : body(text)
        {
          force.reinit(body.model->state.partition());
        }

        Formulation<3> &formulation()
        {
          return *body.model->parts[0].formulation;
        }

        double *values(const std::string &field)
        {
          MaterialPoints &points = formulation().points();
          const unsigned int f = points.find_field(field);
          AssertThrow(f < points.fields().size(), dealii::ExcMessage("no field " + field));
          return points.component(f, 0);
        }

        void set(NodalVector &vector, const Function &function)
        {
          for (unsigned int i = 0; i < vector.partition()->n_local(); ++i)
          {
            const dealii::Point<3> value = function(body.model->state.initial_position.node(i));
            for (unsigned int d = 0; d < 3; ++d)
              vector.node(i)[d] = value[d];
          }
        }

        /** Moves all nodes to a function of their initial position. */
        void move(const Function &position, const double time_increment)
        {
          NodalState &state = body.model->state;
          NodalVector &x = state.position, &v = state.velocity;
          std::vector<double> old_position(x.data(),
                                           x.data() + node_stride * x.partition()->n_local());
          set(x, position);
          for (unsigned int i = 0; i < x.partition()->n_local(); ++i)
            for (unsigned int d = 0; d < 3; ++d)
              v.node(i)[d] = (x.node(i)[d] - old_position[node_stride * i + d]) / time_increment;
          if (body.model->parts[0].particles != nullptr)
            body.model->parts[0].particles->stencils().inverse_deformation_is_current = false;
          force.set_zero();
          formulation().add_internal_force({&x, &v, time_increment}, force);
          force.add_to_owners();
        }

        /** Σ f · v of all ranks, after move(). */
        double power()
        {
          return force.dot(body.model->state.velocity);
        }

        FrozenBody<3> body;
        NodalVector force;
      };

      const std::vector<std::pair<std::string, std::string>> all_parts = {
          {"hexahedron", ""},
          {"fully integrated hexahedron", ""},
          {"lagrange hexahedron", "set Degree = 2"},
          {particle_name, "set Dilation = 1.8"}};

      TEST(PlasticParts, a_rigid_turn_leaves_the_plastic_state_alone_and_turns_the_stress)
      {
        for (const auto &[name, options] : all_parts)
        {
          SCOPED_TRACE(name);
          DrivenPart part(plastic_block(name, options, {3, 2, 2}, "0.002"));
          const auto sheared = [](const double *x)
          { return dealii::Point<3>(x[0] + 0.05 * x[1], x[1] - 0.01 * x[0], x[2] + 0.02 * x[1]); };
          part.move(sheared, 1.);
          const MaterialPoints &points = part.formulation().points();
          const unsigned int n = points.size();
          std::vector<std::vector<double>> kept;
          for (unsigned int f = 0; f < points.fields().size(); ++f)
            for (unsigned int c = 0; c < points.fields()[f].n_components; ++c)
              kept.emplace_back(points.component(f, c), points.component(f, c) + n);
          for (unsigned int i = 0; i < n; ++i)
            ASSERT_GT(part.values("effective plastic strain")[i], 0.01);

          const unsigned int n_steps = 24;
          for (unsigned int step = 1; step <= n_steps; ++step)
          {
            const double angle = 2. * M_PI * step / n_steps;
            const double c = std::cos(angle), s = std::sin(angle);
            part.move(
                [&](const double *x)
                {
                  const dealii::Point<3> y = sheared(x);
                  // About the axis (0, 0.6, 0.8).
                  const double along = 0.6 * y[1] + 0.8 * y[2];
                  const double cross[3] = {0.6 * y[2] - 0.8 * y[1], 0.8 * y[0], -0.6 * y[0]};
                  const double axis[3] = {0., 0.6, 0.8};
                  dealii::Point<3> result;
                  for (unsigned int d = 0; d < 3; ++d)
                    result[d] = c * y[d] + s * cross[d] + (1. - c) * along * axis[d];
                  return result;
                },
                1.);
          }
          std::size_t k = 0;
          for (unsigned int f = 0; f < points.fields().size(); ++f)
            for (unsigned int c = 0; c < points.fields()[f].n_components; ++c, ++k)
              for (unsigned int i = 0; i < n; ++i)
                ASSERT_NEAR(points.component(f, c)[i], kept[k][i], 1e-12)
                    << points.fields()[f].name << " " << c;
        }
      }

      TEST(PlasticParts, the_plastic_energy_of_a_part_is_the_sum_over_its_points)
      {
        for (const auto &[name, options] : all_parts)
        {
          SCOPED_TRACE(name);
          DrivenPart part(plastic_block(name, options, {3, 2, 2}, "0.002"));
          EXPECT_EQ(part.formulation().energies()["plastic dissipation"], 0.);
          const double volume = 3. * 2. * 2.;
          part.move([](const double *x) { return dealii::Point<3>(1.1 * x[0], x[1], x[2]); }, 1.);
          const MaterialPoints &points = part.formulation().points();
          const double rank_work = points.size() > 0 ? part.values("plastic work")[0] : 0.;
          const double work = dealii::Utilities::MPI::max(rank_work, MPI_COMM_WORLD);
          EXPECT_GT(work, 1e-5);
          EXPECT_NEAR(sum_over_ranks(part.formulation().energies()["plastic dissipation"]),
                      work * volume, 1e-12 * volume);
        }
      }

      /** The error of the energy, by the ledger, of a block that flows as it vibrates. */
      double energy_error(const std::string &text, const double time_step, const double end_time,
                          EnergyBalance &balance)
      {
        FrozenBody<3> body(text);
        EnergyLedger ledger;
        MechanicalStep<3> step(*body.model);
        NodalVector &v_hat = body.model->state.unsmoothed_velocity;
        for (unsigned int i = 0; i < v_hat.partition()->n_local(); ++i)
        {
          const double *const x = body.model->state.initial_position.node(i);
          v_hat.node(i)[0] = 0.01 * std::sin(0.5 * M_PI * x[0] / 2.);
          v_hat.node(i)[1] = 0.02 * std::cos(0.5 * M_PI * x[0] / 2.);
        }
        body.model->bridge->apply_smoothing(v_hat, body.model->state.velocity);
        Clock clock;
        clock.next_step = time_step;
        const auto n_steps = static_cast<unsigned int>(std::lround(end_time / time_step));
        for (unsigned int n = 0; n <= n_steps; ++n)
        {
          step.evaluate(clock);
          step.complete(clock);
          if (n == 0 || n == n_steps)
            balance = ledger.balance(*body.model, clock);
          step.advance(clock);
          clock.advance();
        }
        return balance.error;
      }

      TEST(PlasticParts, the_energy_of_a_flowing_block_is_booked_to_second_order_in_the_step)
      {
        for (const auto &[name, options] : all_parts)
        {
          if (name == "lagrange hexahedron")
            continue;
          SCOPED_TRACE(name);
          const std::string text = plastic_block(name, options, {4, 2, 2}, "0.0005");
          double error[3];
          EnergyBalance balance;
          for (unsigned int k = 0; k < 3; ++k)
            error[k] = energy_error(text, 0.4 / (1 << k), 4., balance);
          EXPECT_GT(balance.energies["plastic dissipation"], 0.1 * balance.total);
          EXPECT_LT(std::abs(error[2]), 1e-5);
          EXPECT_GT(std::abs(error[0] - error[1]), 2.5 * std::abs(error[1] - error[2]));
        }
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
