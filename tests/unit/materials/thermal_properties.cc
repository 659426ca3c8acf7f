// SPDX-License-Identifier: LGPL-2.1-or-later
#include "text_testing.h"

#include <gtest/gtest.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/materials/thermal_properties.h>

#include <cmath>

namespace tombolo
{
  namespace
  {
    std::shared_ptr<const ThermalProperties> read_properties(const std::string &entries)
    {
      Parameters parameters(MPI_COMM_SELF);
      parameters.read_text("subsection Material: plate\nsubsection Heat\n" + entries + "end\nend\n",
                           "test.prm");
      parameters.handler().enter_subsection("Material: plate");
      parameters.handler().enter_subsection("Heat");
      declare<ThermalProperties>(parameters.handler());
      parameters.handler().leave_subsection();
      parameters.handler().leave_subsection();
      parameters.assign();
      auto result = ThermalProperties::read(parameters.section("Material: plate"));
      parameters.refuse_unused();
      return result;
    }

    std::shared_ptr<const ThermalProperties>
    make(const std::string &capacity, const std::string &conductivity, const std::string &initial)
    {
      return read_properties("set Specific heat capacity = " + capacity + "\nset Conductivity = " +
                             conductivity + "\nset Initial temperature = " + initial + "\n");
    }

    TEST(ThermalProperties, a_material_that_sets_nothing_has_none)
    {
      EXPECT_EQ(read_properties(""), nullptr);
      const auto given = make("900", "237", "20");
      ASSERT_NE(given, nullptr);
      EXPECT_EQ(given->initial_temperature(), 20.);
      EXPECT_EQ(given->capacity().value(0.), 900.);
      EXPECT_EQ(given->conductivity().value(0.), 237.);
    }

    TEST(ThermalProperties, the_enthalpy_of_a_constant_capacity_is_proportional_to_the_heating)
    {
      const auto p = make("900", "237", "20");
      EXPECT_EQ(p->enthalpy(20.), 0.);
      EXPECT_EQ(p->enthalpy(21.), 900.);
      EXPECT_EQ(p->enthalpy(0.), -18000.);
      EXPECT_EQ(p->temperature(0.), 20.);
      EXPECT_EQ(p->temperature(4500.), 25.);
      EXPECT_EQ(p->temperature_after(30., 4500.), 35.);
      EXPECT_EQ(p->largest_diffusivity(), 237. / 900.);
    }

    const char *const rough = "0: 385, 100: 390.5, 250: 381, 300: 3000, 301: 450, 900: 700";

    TEST(ThermalProperties, the_enthalpy_is_the_integral_of_the_capacity)
    {
      // By the trapezoidal rule, exact where the points of integration contain the knots.
      for (const char *const initial : {"-20", "0", "20", "250", "299.5", "900", "1000"})
      {
        const auto p = make(rough, "1", initial);
        const double start = p->initial_temperature();
        EXPECT_EQ(p->enthalpy(start), 0.);
        EXPECT_EQ(p->temperature(0.), start);
        const double step = 0.5;
        for (const double direction : {1., -1.})
        {
          long double sum = 0.;
          for (unsigned int n = 0; n < 2400; ++n)
          {
            const double from = start + direction * n * step;
            const double to = start + direction * (n + 1) * step;
            sum += 0.5L * (p->capacity().value(from) + p->capacity().value(to)) * direction * step;
            ASSERT_NEAR(p->enthalpy(to) / static_cast<double>(sum), 1., 1e-13)
                << "from " << initial << " to " << to;
          }
        }
      }
    }

    TEST(ThermalProperties, the_temperature_of_the_enthalpy_is_the_temperature)
    {
      for (const char *const capacity : {"383", "0: 385, 100: 390.5, 250: 381, 600: 450",
                                         "20: 400, 1000: 4", "20: 4, 1000: 400"})
        for (const char *const initial : {"-20", "20", "77.7", "298", "1000"})
        {
          const auto p = make(capacity, "1", initial);
          const double start = p->initial_temperature();
          for (double t = -273.; t < 1300.; t += 0.37)
          {
            // Rounding of the temperatures and, over the capacity, of the enthalpy.
            const double scale = std::max(std::abs(t), std::abs(start)) +
                                 std::abs(p->enthalpy(t)) / p->capacity().value(t);
            ASSERT_NEAR(p->temperature(p->enthalpy(t)), t, 8e-16 * scale)
                << capacity << " from " << initial;
          }
          for (const double knot : p->capacity().temperatures())
            ASSERT_NEAR(p->temperature(p->enthalpy(knot)), knot,
                        1e-14 * std::max(std::abs(knot), std::abs(start)));
        }
      const auto aluminium = make("0: 890, 100: 940, 200: 990, 400: 1080, 660: 1240", "237", "20");
      for (double t = 0.5; t < 2000.; t += 0.37)
        ASSERT_NEAR(aluminium->temperature(aluminium->enthalpy(t)) / t, 1., 1e-14) << t;
    }

    TEST(ThermalProperties, small_heating_from_the_start_is_as_precise_as_large_heating)
    {
      for (const char *const initial : {"0", "300", "150", "-40", "1200"})
      {
        const auto p = make(rough, "1", initial);
        const double start = p->initial_temperature();
        for (const double size : {1e-3, 1e-6, 1e-9, 1e-12})
          for (const double sign : {1., -1.})
          {
            const double t = start + sign * size, change = t - start; // as it is rounded
            if (change == 0.)
              continue;
            const double mean = 0.5 * (p->capacity().value(t) + p->capacity().value(start));
            EXPECT_NEAR(p->enthalpy(t) / (mean * change), 1., 1e-13) << initial << " + " << change;
            EXPECT_NEAR(p->temperature(p->enthalpy(t)), t, 3e-16 * std::abs(t));
          }
      }
    }

    TEST(ThermalProperties, heat_in_portions_ends_where_all_at_once_ends_and_comes_back)
    {
      const auto p = make(rough, "1", "20");
      double temperature = 20.;
      for (unsigned int n = 0; n < 1000; ++n)
        temperature = p->temperature_after(temperature, 400.);
      EXPECT_NEAR(temperature, p->temperature(400e3), 1e-10);
      EXPECT_GT(temperature, 301.);
      EXPECT_NEAR(p->temperature_after(temperature, -400e3), 20., 1e-10);
    }

    TEST(ThermalProperties, the_largest_diffusivity_is_at_a_knot_of_either_table)
    {
      EXPECT_EQ(make("10", "0: 1, 50: 40, 80: 20", "0")->largest_diffusivity(), 4.);
      EXPECT_EQ(make("0: 10, 50: 2, 80: 20", "8", "0")->largest_diffusivity(), 4.);
      const auto p = make("0: 10, 60: 4, 80: 20", "20: 8, 50: 24, 70: 8", "0");
      double largest = 0;
      for (double t = -10.; t <= 100.; t += 0.01)
        largest = std::max(largest, p->conductivity().value(t) / p->capacity().value(t));
      EXPECT_GE(p->largest_diffusivity(), largest * (1. - 1e-14));
      EXPECT_NEAR(p->largest_diffusivity(), largest, 1e-3 * largest);
      EXPECT_EQ(make("10", "0", "0")->largest_diffusivity(), 0.);
    }

    TEST(ThermalProperties, what_is_out_of_range_or_missing_is_refused_with_its_place)
    {
      const char *const cases[][4] = {
          {"0", "237", "20", "allowed is a number larger than zero."},
          {"-900", "237", "20", "allowed is a number larger than zero."},
          {"0: 900, 10: 0", "237", "20", "allowed are values larger than zero at all temperatures"},
          {"0: 900, 10: -1", "237", "20",
           "allowed are values larger than zero at all temperatures"},
          {"10: 900, 0: 910", "237", "20", "the temperature 0 stands after 10"},
          {"nan", "237", "20", "not finite"},
          {"900", "-1", "20", "allowed is zero or a positive number."},
          {"900", "0: 1, 10: -1", "20", "allowed are zero and positive values."},
          {"900", "0: 1, 0: 2", "20", "the temperature 0 stands after 0"},
          {"900", "237", "nan", "allowed is"},
          {"900", "237", "inf", "allowed is"}};
      for (const auto &bad : cases)
      {
        const std::string message = testing::input_error([&] { make(bad[0], bad[1], bad[2]); });
        for (const std::string part : {bad[3], "test.prm:", "entry \"Material: plate/Heat/"})
          EXPECT_TRUE(testing::contains(message, part))
              << bad[0] << " | " << bad[1] << " | " << bad[2];
      }
      const char *const lines[] = {"set Specific heat capacity = 900\n", "set Conductivity = 237\n",
                                   "set Initial temperature = 20\n"};
      for (const std::string missing : lines)
      {
        std::string entries;
        for (const std::string line : lines)
          entries += line == missing ? "" : line;
        const std::string name = missing.substr(4, missing.find(" =") - 4);
        EXPECT_TRUE(testing::contains(testing::input_error([&] { read_properties(entries); }),
                                      "the entry \"" + name + "\" is missing"));
      }
    }
  } // namespace
} // namespace tombolo
