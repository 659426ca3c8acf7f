// SPDX-License-Identifier: LGPL-2.1-or-later
// A rigid body by itself, without a mesh.
#include <tombolo/physics/mechanics/rigid_body.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/formulations/elements/rigid_cells.h>

#include <deal.II/base/numbers.h>

#include "text_testing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      using Vector = dealii::Tensor<1, 3>;

      /** Six points on the axes, whose masses make a box of sides 1, 2 and 3 and of mass 6: it has
       * three moments of inertia. */
      class Points
      {
      public:
        Points()
        {
          inertia.mass = 6.;
          inertia.centre = Vector({0.3, -0.2, 0.1});
          for (unsigned int d = 0; d < 3; ++d)
          {
            const double side = 1. + d, moment = 6. * side * side / 12.;
            inertia.second[d][d] = inertia.nodal_second[d][d] = moment;
            for (const double sign : {-1., 1.})
            {
              Vector offset;
              offset[d] = sign * std::sqrt(moment / 2.); // of masses one
              positions.push_back(inertia.centre + offset);
            }
          }
        }

        RigidInertia inertia;
        std::vector<Vector> positions;
      };

      template <int dim>
      RigidBody<dim> make_body(const std::string &entries, const RigidInertia &inertia)
      {
        static std::vector<std::unique_ptr<Parameters>> kept;
        Parameters &parameters = *kept.emplace_back(std::make_unique<Parameters>(MPI_COMM_SELF));
        parameters.read_text(entries, "test.prm");
        declare<RigidBodySettings<dim>>(parameters.handler());
        parameters.assign();
        RigidBody<dim> body("body", RigidBodySettings<dim>(parameters.section("")), inertia);
        parameters.refuse_unused();
        body.start({}, {}, 1e-7);
        return body;
      }

      const std::string free_body = "set Displacement = free; free; free\nset Rotation = free\n";

      struct Measured
      {
        double momentum = 0, angular_momentum = 0; ///< largest differences to the first, relative
        double smallest_energy = 1e300, largest_energy = -1e300;
        double early_energy = 0, late_energy = 0; ///< means over the first and the last tenth
        unsigned int n_flips = 0;
      };

      /** The momenta of points that move straight in each step. */
      Measured tumble(const double time_step, const unsigned int n_steps)
      {
        const Points points;
        RigidBody<3> body = make_body<3>(free_body + "set Initial spin = 0.02, 1, 0.01\n"
                                                     "set Initial velocity = 0.1, 0.2, -0.1\n",
                                         points.inertia);
        Clock clock;
        clock.next_step = time_step;
        Measured result;
        Vector first_momentum, first_angular;
        double last_spin = 1.;
        for (unsigned int n = 0; n < n_steps; ++n)
        {
          body.find_motion(clock, {}, {});
          body.complete_step(clock, nullptr);
          Vector momentum, angular;
          const auto motion = body.motion_of_step(clock), placement = body.placement();
          for (const Vector &position : points.positions)
          {
            const Vector velocity = motion.of(position) / time_step;
            momentum += velocity;
            angular +=
                cross_product_3d(position + placement.of(position) - body.centre(), velocity);
          }
          body.advance();
          clock.advance();
          if (n == 0)
          {
            first_momentum = momentum;
            first_angular = angular;
          }
          result.momentum =
              std::max(result.momentum, (momentum - first_momentum).norm() / first_momentum.norm());
          result.angular_momentum = std::max(
              result.angular_momentum, (angular - first_angular).norm() / first_angular.norm());
          const RigidBodyBalance now = body.balance();
          result.smallest_energy = std::min(result.smallest_energy, now.kinetic_energy);
          result.largest_energy = std::max(result.largest_energy, now.kinetic_energy);
          if (n < n_steps / 10)
            result.early_energy += now.kinetic_energy / (n_steps / 10);
          else if (n >= n_steps - n_steps / 10)
            result.late_energy += now.kinetic_energy / (n_steps / 10);
          const Vector along({now.spin[0], now.spin[1], now.spin[2]});
          const auto turned = body.placement();
          const Vector own({0., 1., 0.});
          const Vector axis =
              own + turned.of(points.inertia.centre + own) - turned.of(points.inertia.centre);
          if ((along * axis) * last_spin < 0.)
          {
            ++result.n_flips;
            last_spin = -last_spin;
          }
        }
        return result;
      }

      TEST(RigidBody, a_body_that_tumbles_keeps_momenta_over_a_hundred_thousand_steps)
      {
        const Measured measured = tumble(0.02, 100000);
        std::cout << "momentum " << measured.momentum << ", angular momentum "
                  << measured.angular_momentum << ", energy "
                  << measured.largest_energy / measured.smallest_energy - 1. << ", drift of energy "
                  << measured.late_energy / measured.early_energy - 1. << ", turns over "
                  << measured.n_flips << " times" << std::endl;
        EXPECT_GT(measured.n_flips, 20u); // Dzhanibekov
        EXPECT_LT(measured.momentum, 1e-12);
        EXPECT_LT(measured.angular_momentum, 1e-12);
        EXPECT_LT(measured.largest_energy / measured.smallest_energy - 1., 1e-8);
        EXPECT_LT(std::abs(measured.late_energy / measured.early_energy - 1.), 1e-10);
      }

      TEST(RigidBody, the_error_of_energy_falls_with_the_square_of_the_step_and_hardly_changes)
      {
        // ½ ω · J ω + ½ m v² of the start
        const double exact = 0.5 * (6.5 * 4e-4 + 5. + 2.5 * 1e-4) + 0.5 * 6. * 0.06;
        const Measured coarse = tumble(0.04, 2000), fine = tumble(0.02, 4000);
        const auto error = [&](const Measured &measured)
        { return exact - 0.5 * (measured.smallest_energy + measured.largest_energy); };
        const auto spread = [](const Measured &measured)
        { return measured.largest_energy - measured.smallest_energy; };
        EXPECT_NEAR(error(coarse) / error(fine), 4., 0.01);
        EXPECT_NEAR(spread(coarse) / spread(fine), 16., 1.);
        EXPECT_LT(error(fine), 2e-4 * exact);
      }

      /** Advances by equal steps with the weight -m g in y. */
      template <int dim>
      void swing(RigidBody<dim> &body, const double time_step, const unsigned int n_steps,
                 const double weight, double &largest_error_of_energy)
      {
        Clock clock;
        clock.next_step = time_step;
        double first = 0;
        for (unsigned int n = 0; n <= n_steps; ++n)
        {
          body.find_motion(clock, Vector({0., -weight, 0.}), {});
          body.complete_step(clock, nullptr);
          const double energy =
              body.balance().kinetic_energy + weight * body.centre()[1] - body.external_work();
          if (n == 0)
            first = energy;
          largest_error_of_energy =
              std::max(largest_error_of_energy, std::abs(energy - first) / weight);
          if (n == n_steps)
            return;
          body.advance();
          clock.advance();
        }
      }

      TEST(RigidBody, a_pendulum_swings_with_the_period_of_its_closed_form)
      {
        // A bar of length 1 and width 0.1 held at one end starts level: a quarter of the period.
        const double gravity = 9.81, second = 1. / 12. + 0.25 + 0.01 / 12.;
        const double quarter = 1.85407467730137 * std::sqrt(second / (gravity * 0.5));
        RigidInertia inertia;
        inertia.mass = 3.;
        inertia.centre = Vector({0.5, 0., 0.});
        inertia.second[0][0] = 3. / 12.;
        inertia.second[1][1] = 3. * 0.01 / 12.;
        inertia.nodal_second = inertia.second;
        double last = 0;
        for (const unsigned int n : {200u, 400u})
        {
          RigidBody<2> body = make_body<2>("set Origin = 0, 0\nset Rotation = free\n", inertia);
          double error = 0;
          swing(body, quarter / n, n, 3. * gravity, error);
          const double angle = body.balance().rotation[2] + dealii::numbers::PI / 2.;
          EXPECT_LT(std::abs(angle), 2. / (n * n));
          if (last != 0.)
          {
            EXPECT_NEAR(last / angle, 4., 0.2);
          }
          last = angle;
          EXPECT_LT(error, 2. / (n * n));
          EXPECT_LT(std::abs(body.balance().position[0]) + std::abs(body.balance().position[1]),
                    1e-15);
        }
      }

      TEST(RigidBody, a_pendulum_on_a_ball_joint_keeps_energy_and_its_moment_about_the_vertical)
      {
        Points points;
        points.inertia.centre = Vector();
        RigidBody<3> body = make_body<3>(
            "set Origin = 0.2, 2, -0.3\nset Rotation = free\nset Initial spin = 1, 2, 0.5\n",
            points.inertia);
        const auto about_vertical = [&]()
        {
          const RigidBodyBalance now = body.balance();
          // r × p + L about the joint, both of t_{n-1/2} to the order of the step
          const Vector momentum({now.momentum[0], now.momentum[1], now.momentum[2]});
          return cross_product_3d(body.centre() - Vector({0.2, 2., -0.3}), momentum)[1] +
                 now.angular_momentum[1];
        };
        double error = 0;
        const double before = about_vertical();
        swing(body, 1e-3, 4000, 6. * 10., error);
        const RigidBodyBalance now = body.balance();
        EXPECT_LT(error, 1e-4);
        EXPECT_NEAR(about_vertical(), before, 1e-12 * std::abs(before));
        EXPECT_NEAR(now.position[0], 0.2, 1e-14);
        EXPECT_NEAR(now.position[1], 2., 1e-14);
        EXPECT_NEAR(now.position[2], -0.3, 1e-14);
      }

      TEST(RigidBody, a_flywheel_gains_spin_by_its_moment)
      {
        const Points points;
        for (const std::string entries :
             {"set Rotation = about the axis\nset Axis = 0, 0, 2\nset Moment = 5; 6; 0.7\n",
              "set Rotation = free\nset Moment = 0; 0; 0.7\n"})
        {
          RigidBody<3> body = make_body<3>(entries, points.inertia);
          Clock clock;
          clock.next_step = 0.01;
          for (unsigned int n = 0; n < 100; ++n)
          {
            body.find_motion(clock, {}, {});
            body.complete_step(clock, nullptr);
            body.advance();
            clock.advance();
          }
          const double moment_of_inertia = 6. * (1. + 4.) / 12.;
          const RigidBodyBalance now = body.balance();
          EXPECT_NEAR(now.spin[2] * moment_of_inertia, 0.7 * 0.995, 1e-12);
          EXPECT_NEAR(now.angular_momentum[2], 0.7 * 0.995, 1e-12);
          EXPECT_NEAR(now.rotation[2], 0.5 * 0.7 / moment_of_inertia, 1e-5);
        }
      }

      TEST(RigidBody, a_drive_gives_what_the_inertia_of_the_prescribed_motion_takes)
      {
        // About an axis that does not go through the centre, and is no principal one.
        const Points points;
        RigidBody<3> body =
            make_body<3>("set Origin = 1.3, -0.2, 0.1\nset Displacement = 0.5*t^2; 0; free\n"
                         "set Axis = 0, 1, 1\nset Angle = 0.3*t^2\n",
                         points.inertia);
        Clock clock;
        clock.next_step = 1e-3;
        for (unsigned int n = 0; n <= 1000; ++n)
        {
          body.find_motion(clock, {}, {});
          body.complete_step(clock, nullptr);
          if (n == 1000)
            break;
          body.advance();
          clock.advance();
        }
        const RigidBodyBalance now = body.balance();
        EXPECT_NEAR(now.position[0], 1.8, 1e-13);
        EXPECT_NEAR(now.work, now.kinetic_energy, 1e-5 * now.kinetic_energy);
        EXPECT_NEAR(now.rotation[1], 0.3 / std::sqrt(2.), 1e-14);
        EXPECT_GT(now.kinetic_energy, 1.);
        // The impulse until t_{n+1/2}, that of the component that nothing holds is none.
        EXPECT_NEAR(now.impulse[0], now.momentum[0], 0.02);
        EXPECT_EQ(now.impulse[2], 0.);
      }

      TEST(RigidBody, turning_too_far_in_a_step_is_said)
      {
        const Points points;
        RigidBody<3> body =
            make_body<3>(free_body + "set Initial spin = 0, 40, 0\n", points.inertia);
        Clock clock;
        clock.next_step = 0.1;
        try
        {
          body.find_motion(clock, {}, {});
          FAIL();
        }
        catch (const RunError &error)
        {
          EXPECT_TRUE(contains(error.what(), "turns too far in one step"));
        }
      }

      TEST(RigidBody, what_contradicts_itself_is_refused)
      {
        const Points points;
        const auto expect = [&](const std::string &entries, const std::string &says) {
          EXPECT_TRUE(contains(input_error([&] { make_body<3>(entries, points.inertia); }), says));
        };
        expect("set Rotation = free\nset Angle = t\n", "the rotation is given twice");
        expect("set Angle = t\nset Initial spin = 0, 0, 1\n", "the rotation is given twice");
        expect("set Initial velocity = 1, 0, 0\n", "the motion along x is given twice");
        expect("set Force = 1; 0; 0\n", "leave a component `free`");
        expect("set Moment = 1; 0; 0\n", "allowed is another `Rotation`");
        expect("set Angle = 1 + t\n", "zero at t = 0");
        expect("set Displacement = 0; 0; cos(t)\n", "zero at t = 0");
        expect("set Displacement = x; 0; 0\n", "functions of t alone");
        expect("set Rotation = about the axis\nset Initial spin = 1, 0, 1\n",
               "a spin along `Axis`");
        expect("set Rotation = about the axis\nset Axis = 0, 0, 0\n", "a length above zero");
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
