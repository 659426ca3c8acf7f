// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material_testing.h"
#include "text_testing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      const std::string heat = "set Specific heat capacity = 4\nset Conductivity = 1\n"
                               "set Initial temperature = 20\n";

      std::string elastic(const std::string &young, const std::string &poisson,
                          const std::string &expansion)
      {
        return "set Density = 2\nset Young's modulus = " + young +
               "\nset Poisson's ratio = " + poisson + "\nset Thermal expansion = " + expansion +
               "\n";
      }

      const char *const young_table = "0: 260, 100: 200, 150: 220, 400: 90";
      const char *const poisson_table = "50: 0.3, 300: 0.4";

      double young(const double t)
      {
        return t < 100.   ? 260. - 0.6 * std::max(t, 0.)
               : t < 150. ? 200. + 0.4 * (t - 100.)
                          : 220. - 0.52 * (std::min(t, 400.) - 150.);
      }

      double poisson(const double t)
      {
        return 0.3 + 0.1 * std::min(std::max((t - 50.) / 250., 0.), 1.);
      }

      Tensor6 isotropic(const double mean)
      {
        return {mean, mean, mean, 0., 0., 0.};
      }

      void heat_all(Points &points, const double change)
      {
        for (unsigned int i = 0; i < points.points.padded_size(); ++i)
          points.add_temperature(i, change);
      }

      TEST(Thermoelasticity, heating_without_constraint_gives_no_stress)
      {
        const auto material = make_plugin<Material>(
            "elastic", elastic(young_table, poisson_table, "0: 1e-5, 200: 3e-5"), heat);
        Points points(*material);
        points.set_temperature(20.);
        for (unsigned int n = 0; n < 50; ++n)
        {
          const double middle = points.temperature[0] + 2.5;
          const double alpha = 1e-5 + 1e-7 * std::min(middle, 200.);
          heat_all(points, 5.);
          points.advance(isotropic(5. * alpha), 1.);
        }
        for (unsigned int c = 0; c < 6; ++c)
          EXPECT_NEAR(points.stress()[c], 0., 1e-13 * 200. * 2e-5 * 250.);
        EXPECT_NEAR(points.value("thermal work", 0), 0., 1e-13 * 200. * std::pow(2e-5 * 250., 2));
      }

      TEST(Thermoelasticity, a_clamped_point_is_pressed_by_three_bulk_moduli_times_the_strain)
      {
        const double bulk = 650. / 3., alpha = 2e-5;
        const auto material = make_plugin<Material>("elastic", elastic("260", "0.3", "2e-5"), heat);
        for (const unsigned int n_steps : {1u, 7u, 1000u})
        {
          Points points(*material);
          points.set_temperature(20.);
          for (unsigned int n = 0; n < n_steps; ++n)
          {
            heat_all(points, 300. / n_steps);
            points.advance(Tensor6(), 1.);
          }
          const double expected = -3. * bulk * alpha * 300.;
          for (unsigned int c = 0; c < 6; ++c)
            EXPECT_NEAR(points.stress()[c], c < 3 ? expected : 0., -1e-13 * expected);
          const double energy = points.elastic_energy();
          EXPECT_NEAR(energy, expected * expected / (2. * bulk), 1e-12 * energy);
          EXPECT_NEAR(points.value("thermal work", 0), energy, 1e-13 * energy);
          // Back to the start: nothing is left of either.
          heat_all(points, -300.);
          points.advance(Tensor6(), 1.);
          EXPECT_NEAR(points.stress()[0], 0., -1e-13 * expected);
          EXPECT_NEAR(points.value("thermal work", 0), 0., 1e-13 * energy);
        }
      }

      TEST(Thermoelasticity, expansion_over_the_temperature_is_integrated)
      {
        // α = a + b (θ - 20): the middle of a step is exact.
        const auto material =
            make_plugin<Material>("elastic", elastic("260", "0.3", "20: 1e-5, 420: 5e-5"), heat);
        Points points(*material);
        points.set_temperature(20.);
        for (const double change : {100., 170., -30., 60.})
        {
          heat_all(points, change);
          points.advance(Tensor6(), 1.);
        }
        const double strain = 1e-5 * 300. + 0.5 * 1e-7 * 300. * 300.;
        EXPECT_NEAR(points.stress()[1], -650. * strain, 1e-12 * 650. * strain);
      }

      /** C(θ) : (ε - α (θ - 20) I) with both tables. */
      Tensor6 stress_at(const Tensor6 &strain, const double temperature, const double alpha)
      {
        const double e = young(temperature), nu = poisson(temperature);
        const double shear = e / (2. * (1. + nu)), bulk = e / (3. * (1. - 2. * nu));
        const double trace = strain[0] + strain[1] + strain[2];
        Tensor6 result;
        for (unsigned int c = 0; c < 6; ++c)
          result[c] = 2. * shear * (strain[c] - (c < 3 ? trace / 3. : 0.)) +
                      (c < 3 ? bulk * (trace - 3. * alpha * (temperature - 20.)) : 0.);
        return result;
      }

      TEST(Thermoelasticity, with_tables_the_stress_depends_on_the_state_and_not_on_the_path)
      {
        const double alpha = 1e-5;
        const auto material =
            make_plugin<Material>("elastic", elastic(young_table, poisson_table, "1e-5"), heat);
        std::mt19937 generator(5);
        std::uniform_real_distribution<double> uniform(-1., 1.);
        Points points(*material);
        points.set_temperature(20.);
        Tensor6 strain;
        for (unsigned int n = 0; n < 2000; ++n)
        {
          // At last back to the start.
          const bool is_last = n == 1999;
          Tensor6 increment;
          for (unsigned int c = 0; c < 6; ++c)
          {
            increment[c] = is_last ? -strain[c] : n % 3 == 1 ? 0. : 1e-3 * uniform(generator);
            strain[c] += increment[c];
          }
          const double goal = is_last ? 20. : 220. + 240. * uniform(generator);
          if (n % 3 != 0 || is_last)
            heat_all(points, goal - points.temperature[0]);
          points.advance(increment, 1.);
          const Tensor6 expected = stress_at(strain, points.temperature[0], alpha);
          for (unsigned int c = 0; c < 6; ++c)
            ASSERT_NEAR(points.stress()[c], expected[c], 1e-12 * 260. * 0.05) << "step " << n;
        }
        EXPECT_NEAR(points.stress()[0], 0., 1e-12);
      }

      /** A walk at constant volume: what the motion and the temperature supply is stored or
       * dissipated. Returns the dissipated share. */
      double check_energy_balance(const Material &material, const double size)
      {
        Points points(material);
        points.set_temperature(20.);
        double work = 0, thermal_range = 0;
        for (unsigned int n = 0; n < 400; ++n)
        {
          const double x = size * std::sin(0.03 * n), y = 0.7 * size * std::cos(0.05 * n);
          const Tensor6 increment = {x, -x + y, -y, y, 0.5 * x, x + y};
          heat_all(points, 4. * std::cos(0.07 * n) + 0.5);
          const Tensor6 before = points.stress();
          points.advance(increment, 1.);
          const Tensor6 after = points.stress();
          work += 0.5 * (contract(before, increment) + contract(after, increment));
          thermal_range = std::max(thermal_range, std::abs(points.value("thermal work", 0)));
        }
        const bool flows = points.points.find_field("plastic work") < points.points.fields().size();
        const double plastic = flows ? points.value("plastic work", 0) : 0.;
        const double elastic_energy = points.elastic_energy();
        const double scale = std::max({work, plastic, elastic_energy});
        EXPECT_NEAR(elastic_energy + plastic, work + points.value("thermal work", 0),
                    1e-12 * scale);
        EXPECT_GT(thermal_range, 1e-3 * scale);
        return plastic / scale;
      }

      TEST(Thermoelasticity, the_energy_balance_closes_to_round_off)
      {
        for (const char *const alpha : {"0", "2e-5", "0: 1e-5, 200: 9e-5"})
          check_energy_balance(
              *make_plugin<Material>("elastic", elastic(young_table, poisson_table, alpha), heat),
              1e-3);
        check_energy_balance(*make_plugin<Material>("elastic", elastic("260", "0.3", "2e-5"), heat),
                             1e-4);
      }

      std::string plastic(const std::string &moduli, const std::string &rest = "")
      {
        return moduli + rest +
               "set Flow stress = tabular\nsubsection tabular\nset Plastic strains = 0, 1\n"
               "set Temperatures = 0, 400\nset Flow stresses = 0.4, 0.9; 0.1, 0.2\nend\n";
      }

      TEST(Thermoelasticity, the_energy_balance_closes_with_plastic_flow)
      {
        for (const char *const alpha : {"0", "2e-5"})
        {
          const double share = check_energy_balance(
              *make_plugin<Material>("j2 plasticity",
                                     plastic(elastic(young_table, poisson_table, alpha)), heat),
              3e-4);
          EXPECT_GT(share, 0.5);
        }
      }

      TEST(Thermoelasticity, points_at_their_own_temperatures_do_not_see_each_other)
      {
        for (const std::string model : {"elastic", "j2 plasticity"})
        {
          std::string entries = elastic(young_table, poisson_table, "0: 1e-5, 200: 9e-5");
          if (model == "j2 plasticity")
            entries = plastic(entries);
          const auto material = make_plugin<Material>(model, entries, heat);
          const unsigned int n = 150;
          for (const unsigned int probe : {0u, 9u, 63u, 64u, 149u})
          {
            Points alone(*material);
            alone.set_temperature(20.);
            Points all(*material, n);
            all.set_temperature(20.);
            const auto increment = [](const unsigned int i, const unsigned int step) {
              return Tensor6{1e-4 * std::sin(i + step), 1e-4, -1e-4,
                             2e-4 * std::cos(0.3 * i),  0.,   1e-4};
            };
            const auto change = [](const unsigned int i, const unsigned int step)
            { return 20. * std::sin(0.2 * i + 0.3 * step); };
            for (unsigned int step = 0; step < 10; ++step)
            {
              for (unsigned int i = 0; i < n; ++i)
              {
                all.set_increment(i, increment(i, step));
                all.add_temperature(i, change(i, step));
              }
              all.advance(1.);
              heat_all(alone, change(probe, step));
              alone.advance(increment(probe, step), 1.);
            }
            for (unsigned int c = 0; c < 6; ++c)
              EXPECT_NEAR(all.stress(probe)[c], alone.stress()[c], 1e-13);
            EXPECT_NEAR(all.value("thermal work", probe), alone.value("thermal work", 0), 1e-15);
            EXPECT_NEAR(all.elastic_energy(probe), alone.elastic_energy(), 1e-14);
          }
        }
      }

      TEST(Thermoelasticity, the_moduli_that_bound_the_step_are_the_largest)
      {
        const auto material =
            make_plugin<Material>("elastic", elastic(young_table, poisson_table, "0"), heat);
        double bulk = 0, shear = 0;
        for (double t = -10.; t < 500.; t += 0.01)
        {
          bulk = std::max(bulk, young(t) / (3. * (1. - 2. * poisson(t))));
          shear = std::max(shear, young(t) / (2. * (1. + poisson(t))));
        }
        EXPECT_GE(material->bulk_modulus(), bulk * (1. - 1e-14));
        EXPECT_GE(material->shear_modulus(), shear * (1. - 1e-14));
        EXPECT_NEAR(material->bulk_modulus(), bulk, 1e-4 * bulk);
        EXPECT_NEAR(material->shear_modulus(), shear, 1e-4 * shear);
      }

      TEST(Thermoelasticity, constants_without_expansion_do_not_read_the_temperature)
      {
        const auto plain = make_plugin<Material>("elastic", elastic("260", "0.3", "0"));
        const auto heated = make_plugin<Material>("elastic", elastic("260", "0.3", "0"), heat);
        EXPECT_TRUE(plain->internal_variables().empty());
        EXPECT_TRUE(heated->internal_variables().empty());
        Points first(*plain), second(*heated);
        second.set_temperature(std::nan(""));
        for (unsigned int n = 0; n < 10; ++n)
        {
          const Tensor6 increment = {1e-3 * n, 2e-4, -3e-4, 4e-4, 1e-4, 7e-5 * n};
          first.advance(increment, 1.);
          second.advance(increment, 1.);
        }
        for (unsigned int c = 0; c < 6; ++c)
          EXPECT_EQ(first.stress()[c], second.stress()[c]);
        EXPECT_EQ(first.elastic_energy(), second.elastic_energy());
      }

      std::string without(std::string text, const std::string &line)
      {
        const std::size_t position = text.find(line);
        AssertThrow(position != std::string::npos, dealii::ExcMessage("no " + line));
        return text.erase(position, line.size());
      }

      std::vector<std::string> names(const Material &material)
      {
        std::vector<std::string> result;
        for (const FieldDescription &field : material.internal_variables())
          result.push_back(field.name);
        return result;
      }

      TEST(PlasticityWithHeat, the_formulation_that_heats_gives_the_adiabatic_material)
      {
        const auto adiabatic = make_plugin<Material>("j2 plasticity", copper());
        const auto heated =
            make_plugin<Material>("j2 plasticity",
                                  without(without(copper(), "set Specific heat capacity = 383\n"),
                                          "set Initial temperature = 298\n"),
                                  "set Specific heat capacity = 383\nset Conductivity = 400\n"
                                  "set Initial temperature = 298\n");
        EXPECT_EQ(adiabatic->plastic_heat_fraction(), 0.);
        EXPECT_EQ(heated->plastic_heat_fraction(), 0.9);
        EXPECT_EQ(names(*heated),
                  (std::vector<std::string>{"effective plastic strain", "plastic work"}));
        Points first(*adiabatic), second(*heated);
        second.set_temperature(298.);
        for (unsigned int n = 0; n < 400; ++n)
        {
          const Tensor6 increment = {-2e-3, 1e-3, 1e-3, 1e-3 * std::sin(0.1 * n), 0., 5e-4};
          const double before = second.value("plastic work", 0);
          first.advance(increment, 1e-7);
          second.advance(increment, 1e-7);
          const double work = second.value("plastic work", 0) - before;
          heat_all(second, 0.9 * work / (8960. * 383.));
          const double scale = effective_stress(first.stress());
          for (unsigned int c = 0; c < 6; ++c)
            ASSERT_NEAR(first.stress()[c], second.stress()[c], 1e-9 * scale) << "step " << n;
          ASSERT_NEAR(first.value("temperature", 0), second.temperature[0], 1e-9) << "step " << n;
        }
        EXPECT_GT(second.temperature[0], 350.);
      }

      TEST(PlasticityWithHeat, the_flow_stress_is_that_of_the_temperature_it_is_given)
      {
        const auto material =
            make_plugin<Material>("j2 plasticity", plastic(elastic("260", "0.3", "0")), heat);
        EXPECT_EQ(names(*material),
                  (std::vector<std::string>{"effective plastic strain", "plastic work"}));
        for (const double temperature : {0., 100., 300., 400., 900.})
        {
          Points points(*material);
          points.set_temperature(temperature);
          points.advance({0., 0., 0., 0., 0., 0.1}, 1.);
          const double share = std::min(temperature / 400., 1.);
          const double strain = points.value("effective plastic strain", 0);
          EXPECT_NEAR(effective_stress(points.stress()),
                      (1. - share) * (0.4 + 0.5 * strain) + share * (0.1 + 0.1 * strain), 1e-9);
        }
      }

      TEST(PlasticityWithHeat, internal_variables_stand_in_their_order)
      {
        EXPECT_EQ(
            names(*make_plugin<Material>("j2 plasticity", plastic(elastic("260", "0.3", "1e-5")),
                                         heat)),
            (std::vector<std::string>{"effective plastic strain", "plastic work", "thermal work"}));
        EXPECT_EQ(names(*make_plugin<Material>("elastic", elastic(young_table, "0.3", "0"), heat)),
                  std::vector<std::string>{"thermal work"});
        EXPECT_EQ(names(*make_plugin<Material>(
                      "j2 plasticity",
                      plastic(elastic("260", "0.3", "0"), "set Initial temperature = 3\n"))),
                  (std::vector<std::string>{"effective plastic strain", "plastic work",
                                            "temperature", "yield stress"}));
      }

      TEST(HeatConductor, has_mass_and_no_stress)
      {
        const auto material = make_plugin<Material>("heat conductor", "set Density = 2.5\n");
        EXPECT_FALSE(material->has_mechanics());
        EXPECT_EQ(material->density(), 2.5);
        EXPECT_EQ(material->bulk_modulus(), 0.);
        EXPECT_EQ(material->longitudinal_wave_speed(), 0.);
        EXPECT_EQ(material->plastic_heat_fraction(), 0.);
        Points points(*material);
        points.advance({0.1, 0., 0., 0., 0., 0.1}, 1.);
        EXPECT_EQ(points.stress()[0], 0.);
        EXPECT_EQ(points.elastic_energy(), 0.);
        EXPECT_TRUE(make_plugin<Material>("elastic", elastic("260", "0.3", "0"))->has_mechanics());
      }

      void expect_refusal(const std::string &model, const std::string &entries,
                          const std::string &heat_entries, const std::string &expected)
      {
        const std::string message =
            input_error([&] { make_plugin<Material>(model, entries, heat_entries); });
        EXPECT_TRUE(contains(message, expected)) << entries;
        EXPECT_TRUE(contains(message, ".prm:"));
      }

      TEST(BadThermalMaterial, what_needs_a_temperature_needs_the_section_heat)
      {
        const std::string table = "a table over the temperature needs the temperature of the "
                                  "material, but its section \"Heat\" is missing";
        const std::string expands = "thermal expansion needs the temperature of the material, but "
                                    "its section \"Heat\" is missing";
        expect_refusal("elastic", elastic("0: 260, 100: 200", "0.3", "0"), "", table);
        expect_refusal("elastic", elastic("260", "0: 0.3, 100: 0.2", "0"), "", table);
        expect_refusal("elastic", elastic("260", "0.3", "0: 0, 100: 1e-5"), "", table);
        expect_refusal("elastic", elastic("260", "0.3", "1e-5"), "", expands);
        expect_refusal("elastic", elastic("260", "0.3", "-1e-5"), "", expands);
        expect_refusal("j2 plasticity", plastic(elastic("260", "0.3", "1e-5")), "", expands);
        EXPECT_NO_THROW(make_plugin<Material>("elastic", elastic("20: 260", "0.3", "0")));
      }

      TEST(BadThermalMaterial, values_out_of_range_are_refused)
      {
        expect_refusal("elastic", elastic("0: 260, 100: 0", "0.3", "0"), heat,
                       "allowed are values larger than zero");
        expect_refusal("elastic", elastic("0: 260, 0: 250", "0.3", "0"), heat,
                       "the temperature 0 stands after 0");
        expect_refusal("elastic", elastic("260", "0: 0.3, 100: 0.5", "0"), heat,
                       "allowed is a number between -1 and 0.5");
        expect_refusal("elastic", elastic("260", "0: -1, 100: 0.3", "0"), heat,
                       "allowed is a number between -1 and 0.5");
        expect_refusal("elastic", elastic("soft", "0.3", "0"), "", "\"soft\" is not a number");
        expect_refusal("elastic", elastic("-260", "0.3", "0"), "",
                       "allowed is a number larger than zero");
        expect_refusal("elastic", elastic("260", "0.3", "nan"), heat, "\"nan\" is not finite");
        expect_refusal("elastic", elastic("260", "0.3", "1e-5"),
                       "set Conductivity = 1\nset Specific heat capacity = 1\n",
                       "the entry \"Initial temperature\" is missing");
        expect_refusal("heat conductor", "set Density = 0\n", "",
                       "allowed is a number larger than zero");
      }

      TEST(BadThermalMaterial, a_plastic_material_with_heat_has_its_temperature_there)
      {
        const std::string moduli = elastic("260", "0.3", "0");
        for (const std::string line :
             {"set Specific heat capacity = 4\n", "set Initial temperature = 20\n"})
          expect_refusal("j2 plasticity", plastic(moduli, line), heat,
                         "says it already; allowed is one of both");
        expect_refusal("j2 plasticity",
                       without(without(copper(), "set Specific heat capacity = 383\n"),
                               "set Initial temperature = 298\n"),
                       "set Specific heat capacity = 383\nset Conductivity = 400\n"
                       "set Initial temperature = 1400\n",
                       "molten from the start");
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
