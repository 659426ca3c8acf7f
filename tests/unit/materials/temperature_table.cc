// SPDX-License-Identifier: LGPL-2.1-or-later
#include "temperature_table_testing.h"
#include "text_testing.h"

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/temperature_table.h>

#include <gtest/gtest.h>

namespace tombolo
{
  namespace
  {
    using testing::read_table;

    TEST(TemperatureTable, one_number_is_a_constant)
    {
      for (const TemperatureTable &table :
           {TemperatureTable(237.5), read_table("237.5"), read_table("20: 237.5")})
      {
        EXPECT_TRUE(table.is_constant());
        EXPECT_EQ(table.values(), std::vector<double>{237.5});
        for (const double temperature : {-1e3, 0., 20., 1e4})
          EXPECT_EQ(table.value(temperature), 237.5);
        EXPECT_EQ(table.smallest(), 237.5);
        EXPECT_EQ(table.largest(), 237.5);
      }
      EXPECT_EQ(TemperatureTable().value(3.), 0.);
    }

    TEST(TemperatureTable, pairs_are_exact_at_the_knots_straight_between_and_constant_beyond)
    {
      const TemperatureTable table = read_table("-50.1: 237.3, 200 : 241.7,  400: 230.9 , 1e3:-4");
      EXPECT_FALSE(table.is_constant());
      const std::vector<double> knots = {-50.1, 200., 400., 1000.},
                                values = {237.3, 241.7, 230.9, -4.};
      EXPECT_EQ(table.temperatures(), knots);
      EXPECT_EQ(table.values(), values);
      for (unsigned int k = 0; k < knots.size(); ++k)
        EXPECT_EQ(table.value(knots[k]), values[k]);
      for (unsigned int k = 0; k + 1 < knots.size(); ++k)
        EXPECT_NEAR(table.value(0.75 * knots[k] + 0.25 * knots[k + 1]),
                    0.75 * values[k] + 0.25 * values[k + 1], 1e-12);
      EXPECT_EQ(table.value(-1e5), 237.3);
      EXPECT_EQ(table.value(1e5), -4.);
      EXPECT_EQ(table.smallest(), -4.);
      EXPECT_EQ(table.largest(), 241.7);
    }

    TEST(TemperatureTable, many_temperatures_give_what_each_gives_alone_for_any_number_of_them)
    {
      for (const TemperatureTable &table : {read_table("0: 1, 10: 3, 11: 2, 50: 7, 51: 0"),
                                            read_table("0: 1, 10: 3"), read_table("4")})
        for (unsigned int n = 0; n < 3 * n_lanes + 2; ++n)
        {
          std::vector<double> temperature(n), result(n + 1, -77.);
          for (unsigned int i = 0; i < n; ++i)
            temperature[i] = -3. + 60. * ((7 * i) % 23) / 23.;
          table.evaluate(n, temperature.data(), result.data());
          for (unsigned int i = 0; i < n; ++i)
            ASSERT_EQ(result[i], table.value(temperature[i])) << temperature[i];
          ASSERT_EQ(result[n], -77.);
        }
    }

    TEST(TemperatureTable, what_is_no_table_is_refused_with_its_place)
    {
      const char *const cases[][2] = {
          {"0: 1, 20: 2, 20: 3", "the temperature 20 stands after 20"},
          {"0: 1, 20: 2, 10.5: 3", "the temperature 10.5 stands after 20"},
          {"0: 1, 20: two", "\"two\" is not a number"},
          {"zero: 1, 20: 2", "\"zero\" is not a number"},
          {"hot", "\"hot\" is not a number"},
          {"1 2", "\"1 2\" is not a number"},
          {"1, 2", "\"1\" is no pair `temperature: value`"},
          {"0: 1, 2", "\"2\" is no pair `temperature: value`"},
          {"0: 1: 2, 3: 4", "\"1: 2\" is not a number"},
          {"0: , 3: 4", "\"\" is not a number"},
          {": 1, 3: 4", "\"\" is not a number"},
          {"0: 1,, 3: 4", "an item is missing before or after a comma"},
          {"0: 1, 3: nan", "\"nan\" is not finite"},
          {"0: 1, inf: 2", "\"inf\" is not finite"},
          {"1e999", "\"1e999\" is not finite"}};
      for (const auto &bad : cases)
      {
        const std::string message = testing::input_error([&] { read_table(bad[0]); });
        EXPECT_TRUE(testing::contains(message, bad[1])) << bad[0];
        EXPECT_TRUE(testing::contains(message, "test.prm:2: entry \"Heat/Conductivity\" = \""));
      }
    }
  } // namespace
} // namespace tombolo
