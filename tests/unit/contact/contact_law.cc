// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_law.h>

#include <gtest/gtest.h>

#include <vector>

namespace tombolo
{
  namespace
  {
    using Vector = dealii::Tensor<1, 2>;

    constexpr double mass = 2., stable_step = 0.5, step = 0.2, friction = 0.3;

    /** A mass that is moved into a plane, along it, and out again, from one depth to the next. */
    struct LedMass
    {
      ContactLaw law{0.7, 0.4, true};
      ContactSpring<2> spring;
      Vector normal{{0., 1.}};
      double dissipated = 0, work = 0; ///< of damping and friction; of the forces on the mass

      Vector force() const
      {
        return spring.normal_force() * normal - spring.stiffness * spring.elastic_slip;
      }

      void move(const double depth, const double along)
      {
        // A contact begins and ends on the way.
        const double gap = depth > 0. && spring.depth > 0. ? 0. : 0.03;
        const Vector before = force(),
                     motion{{along, spring.depth - depth + (depth > 0. ? -gap : gap)}};
        const ContactMotion<2> move(depth, motion, normal);
        if (depth > 0. || !spring.is_closed())
        {
          law.press(move, mass, stable_step, step, spring, dissipated);
          dissipated += ContactLaw::slide(move, friction * spring.normal_force(), spring);
        }
        else
          dissipated += law.release(move, spring, dissipated);
        work += 0.5 * (before + force()) * motion;
      }
    };

    TEST(ContactLaw, what_forces_take_is_stored_or_dissipated)
    {
      LedMass led;
      led.move(0., 0.);
      // The last two leave while the damper still pushes, and approach again.
      const std::vector<Vector> path = {
          Vector({0.1, 0.}),  Vector({0.3, 0.02}), Vector({0.35, 0.3}), Vector({0.2, -0.1}),
          Vector({0.25, 0.}), Vector({0., 0.}),    Vector({0., 0.}),    Vector({0.4, 0.1})};
      for (const Vector &next : path)
      {
        led.move(next[0], next[1]);
        EXPECT_NEAR(led.spring.elastic_energy() + led.dissipated, -led.work, 1e-14);
      }
      EXPECT_GT(led.dissipated, 0.01);
    }

    TEST(ContactLaw, the_damper_resists_both_ways_and_does_not_pull)
    {
      LedMass led;
      led.move(0., 0.);
      led.move(0.1, 0.);
      const double k = led.law.stiffness(mass, stable_step);
      EXPECT_GT(led.spring.normal_force(), 1.01 * k * 0.1);
      led.move(0.099, 0.);
      EXPECT_LT(led.spring.normal_force(), 0.99 * k * 0.099);
      EXPECT_GT(led.spring.normal_force(), 0.);
      led.move(0.02, 0.);
      EXPECT_DOUBLE_EQ(led.spring.normal_force(), 0.);
    }

    TEST(ContactLaw, friction_is_limited_by_the_whole_normal_force)
    {
      LedMass led;
      led.move(0., 0.);
      led.move(0.1, 0.5);
      EXPECT_GT(led.spring.damping_force, 0.);
      EXPECT_NEAR(led.spring.stiffness * led.spring.elastic_slip.norm(),
                  friction * led.spring.normal_force(), 1e-14);
    }
  } // namespace
} // namespace tombolo
