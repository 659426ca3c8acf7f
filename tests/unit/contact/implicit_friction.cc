// SPDX-License-Identifier: LGPL-2.1-or-later
#include "temperature_table_testing.h"

#include <tombolo/contact/implicit_friction.h>

#include <gtest/gtest.h>

namespace tombolo
{
  namespace
  {
    using testing::read_table;

    TEST(ImplicitFriction, a_straight_line_has_the_coefficient_of_its_own_heat)
    {
      // c = 0.5 (1100 - T)/100 with T = 1050 + 200 c.
      const TemperatureTable friction = read_table("1000: 0.5, 1100: 0");
      const double found =
          implicit_coefficient(friction, 1050., [](const double c) { return 1050. + 200. * c; });
      EXPECT_NEAR(found, 0.125, 1e-12);
    }

    TEST(ImplicitFriction, no_heat_goes_beyond_the_temperature_at_which_friction_ends)
    {
      for (const char *const table : {"1000: 0.5, 1100: 0", "1099: 0.5, 1100: 0"})
        for (const double heat : {1., 1e3, 1e5})
          for (const double before : {20., 1000., 1099.5, 1100., 1200.})
          {
            const TemperatureTable friction = read_table(table);
            const auto heated = [&](const double c) { return before + heat * c; };
            const double found = implicit_coefficient(friction, before, heated);
            EXPECT_GE(found, 0.);
            EXPECT_LE(heated(found), std::max(before, 1100.) + 1e-3) << table << ", " << heat;
            EXPECT_NEAR(friction.value(heated(found)), found, 1e-9 * std::max(1., heat));
          }
    }

    TEST(ImplicitFriction, friction_that_grows_has_a_solution_too)
    {
      const TemperatureTable friction = read_table("0: 0.1, 100: 0.4, 200: 0.2");
      for (const double heat : {0., 10., 200., 1e4})
      {
        const auto heated = [&](const double c) { return 50. + heat * c; };
        const double found = implicit_coefficient(friction, 50., heated);
        EXPECT_NEAR(friction.value(heated(found)), found, 1e-10);
      }
    }

    TEST(ImplicitFriction, where_nothing_is_heated_it_is_that_of_the_table_to_the_last_bit)
    {
      const TemperatureTable friction = read_table("0: 0.1, 100: 0.4");
      EXPECT_EQ(implicit_coefficient(friction, 37., [](double) { return 37.; }),
                friction.value(37.));
      EXPECT_EQ(
          implicit_coefficient(TemperatureTable(0.3), 37., [](const double c) { return 1e3 * c; }),
          0.3);
    }
  } // namespace
} // namespace tombolo
