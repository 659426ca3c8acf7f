// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include "material_testing.h"
#include "mesh_testing.h"

#include <tombolo/contact/contact_surface.h>
#include <tombolo/state/records.h>

#include "output_test_directory.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      constexpr double time_step = 0.01;

      std::unique_ptr<ContactSurface<3>> plane(const std::string &entries)
      {
        return make_plugin<ContactSurface<3>>(
            "plane", "set Point = 1, 2, 3\nset Normal = 0, 0, 1\n" + entries);
      }

      /** Steps of equal size, with a force of the bodies that does not change. */
      class Flight
      {
      public:
        Flight(ContactSurface<3> &surface, const dealii::Tensor<1, 3> &reaction)
            : translation(surface.translation()), reaction(reaction)
        {
          clock.next_step = time_step;
        }

        void advance(const unsigned int n_steps)
        {
          for (unsigned int step = 0; step < n_steps; ++step)
          {
            translation.accelerate(clock, reaction);
            translation.advance(clock);
            clock.advance();
          }
          translation.accelerate(clock, reaction);
        }

        RigidTranslation<3> &translation;
        dealii::Tensor<1, 3> reaction;
        Clock clock;
      };

      const dealii::Tensor<1, 3> none, along({0.3, -0.4, 0.5});

      TEST(ToolWithMass, falls_as_the_integral_of_its_forces)
      {
        const auto tool =
            plane("set Mass = 4\nset Force = 0; 8; -2\nset Initial velocity = 1, 0, 2\n");
        Flight flight(*tool, along);
        flight.advance(150);
        const double t = flight.clock.time;
        const auto acceleration = (along + dealii::Tensor<1, 3>({0., 8., -2.})) / 4.;
        const dealii::Tensor<1, 3> start({1., 0., 2.});
        const auto expected = t * start + 0.5 * t * t * acceleration;
        EXPECT_NEAR((flight.translation.displacement(t) - expected).norm(), 0., 1e-12);
        EXPECT_NEAR(
            (tool->reference_point(t) - dealii::Tensor<1, 3>({1., 2., 3.}) - expected).norm(), 0.,
            1e-12);
        EXPECT_NEAR(
            (flight.translation.velocity() - start - (t - 0.5 * time_step) * acceleration).norm(),
            0., 1e-12);
        // In a step it has come from where it was.
        const double before = t - time_step;
        EXPECT_NEAR((flight.translation.displacement(before) - before * start -
                     0.5 * before * before * acceleration)
                        .norm(),
                    0., 1e-12);
        EXPECT_NEAR((tool->motion(dealii::Tensor<1, 3>(), before, t) -
                     time_step * flight.translation.velocity())
                        .norm(),
                    0., 1e-14);
      }

      TEST(ToolWithMass, gains_the_energy_that_its_force_gives)
      {
        const auto tool =
            plane("set Mass = 4\nset Force = 0; 8*sin(3*t); -2\nset Initial velocity = "
                  "1, 0, 2\n");
        Flight flight(*tool, none);
        flight.translation.accelerate(flight.clock, none);
        const double start = flight.translation.kinetic_energy();
        EXPECT_NEAR(start, 10., 1e-14);
        flight.advance(150);
        EXPECT_GT(std::abs(flight.translation.work_of_force()), 1.);
        EXPECT_NEAR(flight.translation.kinetic_energy() - start, flight.translation.work_of_force(),
                    1e-3);
      }

      TEST(ToolWithMass, leaves_what_is_across_its_directions_to_a_guide)
      {
        const auto tool =
            plane("set Mass = 2\nset Force = 1; 2; 3\nset Directions = 0, 3, 4; 1, 0, "
                  "0\n");
        EXPECT_TRUE(tool->translation().moves_along(0));
        EXPECT_TRUE(tool->translation().moves_along(1));
        const auto one = plane("set Mass = 2\nset Directions = 0, 0, 7\n");
        EXPECT_FALSE(one->translation().moves_along(0));
        EXPECT_FALSE(one->translation().moves_along(1));
        EXPECT_TRUE(one->translation().moves_along(2));
        Flight flight(*tool, along);
        flight.advance(100);
        const dealii::Tensor<1, 3> force({1.3, 1.6, 3.5});
        const double inclined = (0.6 * force[1] + 0.8 * force[2]);
        const dealii::Tensor<1, 3> kept({force[0], 0.6 * inclined, 0.8 * inclined});
        EXPECT_NEAR((flight.translation.displacement(1.) - kept / 4.).norm(), 0., 1e-12);
      }

      TEST(ToolWithMass, of_every_kind_moves)
      {
        for (const auto &[name, entries] : std::vector<std::pair<std::string, std::string>>{
                 {"sphere", "set Radius = 1\n"},
                 {"profile", "set Corners = 0, 0; 1, 0; 1, 2; 0, 2\n"}})
        {
          const auto tool = make_plugin<ContactSurface<3>>(
              name, entries + "set Origin = 0, 0, 0\nset Angle = 2*t\nset Mass = 1\nset Initial "
                              "velocity = 0, 0, -1\n");
          Flight flight(*tool, none);
          flight.advance(100);
          EXPECT_NEAR((tool->reference_point(1.) - dealii::Tensor<1, 3>({0., 0., -1.})).norm(), 0.,
                      1e-12)
              << name;
        }
      }

      TEST(ToolWithMass, goes_on_from_a_checkpoint)
      {
        const TestDirectory directory("tool_motion");
        const std::string file = directory.create("tool.h5");
        const std::string entries =
            "set Mass = 3\nset Force = 0; t; -2\nset Directions = 0, 1, 1\n";
        const auto whole = plane(entries), resumed = plane(entries);
        Flight flight(*whole, along), second(*resumed, along);
        for (unsigned int step = 0; step < 20; ++step)
        {
          flight.translation.accelerate(flight.clock, along);
          flight.translation.advance(flight.clock);
          flight.clock.advance();
        }
        for (Flight *const some : {&flight, &second})
        {
          StateArchive archive(
              file, some == &flight ? StateArchive::Mode::write : StateArchive::Mode::read,
              MPI_COMM_WORLD);
          Records records;
          some->translation.list(records);
          records.serialize(archive);
          if (some == &flight)
            archive.close();
        }
        second.clock = flight.clock;
        for (Flight *const some : {&flight, &second})
          some->advance(10);
        const double t = flight.clock.time;
        EXPECT_EQ(second.translation.displacement(t), flight.translation.displacement(t));
        EXPECT_EQ(second.translation.displacement(t - time_step),
                  flight.translation.displacement(t - time_step));
        EXPECT_EQ(second.translation.velocity(), flight.translation.velocity());
        EXPECT_EQ(second.translation.kinetic_energy(), flight.translation.kinetic_energy());
        EXPECT_EQ(second.translation.work_of_force(), flight.translation.work_of_force());
      }

      TEST(ToolMotion, that_cannot_be_is_refused)
      {
        const auto refusal = [](const std::string &entries)
        { return input_error([&]() { plane(entries); }); };
        for (const std::string mass : {"0", "-1", "heavy", "1 kg", "nan", "1e999"})
          EXPECT_TRUE(contains(refusal("set Mass = " + mass + "\n"),
                               "allowed is a number larger than zero."));
        const char *const cases[][2] = {
            {"set Mass = 1\nset Displacement = 0; 0; t\n", "a body with a mass moves by forces"},
            {"set Force = 0; 0; 1\n", "has no effect"},
            {"set Initial velocity = 0, 0, 1\n", "has no effect"},
            {"set Directions = 0, 0, 1\n", "has no effect"},
            {"set Displacement = 0; 0; sn(t)\n", "is unknown"},
            {"set Displacement = 0; 0; 2*(t\n", "this is not an expression"},
            {"set Displacement = 0; 0\n", "3 components"},
            {"set Displacement = 0; 0; x\n", "functions of t alone"},
            {"set Mass = 1\nset Force = 0; 0; 2*(t\n", "this is not an expression"},
            {"set Mass = 1\nset Force = 1\n", "3 components"},
            {"set Mass = 1\nset Force = 0; y; 0\n", "functions of t alone"},
            {"set Mass = 1\nset Directions = 0, 1\n", "has 2."},
            {"set Mass = 1\nset Directions = 0, 0, up\n", "\"up\" is not a finite number"},
            {"set Mass = 1\nset Directions = 0, 0, 1; 0, 0, -3\n", "adds nothing to those before"},
            {"set Mass = 1\nset Directions = 0, 0, 1\nset Initial velocity = 0, 1, 1\n",
             "the body cannot move so"}};
        for (const auto &[entries, message] : cases)
          EXPECT_TRUE(contains(refusal(entries), message)) << entries;
        EXPECT_EQ(
            refusal("set Mass = 1\nset Directions = 0, 0, 1\nset Initial velocity = 0, 0, 1\n"),
            "");
        EXPECT_TRUE(contains(input_error(
                                 []()
                                 {
                                   make_plugin<ContactSurface<3>>(
                                       "sphere",
                                       "set Radius = 1\nset Origin = 0, 0, 0\nset Angle = 2*x\n");
                                 }),
                             "a function of t alone"));
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
