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
      const std::string j2 = "j2 plasticity";

      // E = 260, ν = 0.3: G = 100, K = 216.67.
      constexpr double shear = 100., bulk = 650. / 3.;

      TEST(J2Plasticity, uniaxial_strain_yields_at_the_hugoniot_elastic_limit_and_follows_the_bulk)
      {
        const auto material = make_plugin<Material>(j2, linear("1", "0"));
        Points points(*material);
        const double limit = (1. - 0.3) / (1. - 2. * 0.3); // of Y = 1
        const double step = 1e-4;
        double strain = 0;
        bool has_yielded = false;
        for (unsigned int n = 0; n < 200; ++n)
        {
          points.advance({-step, 0., 0., 0., 0., 0.}, 1.);
          strain += step;
          const double elastic = (bulk + 4. / 3. * shear) * strain;
          const double expected = elastic < limit ? elastic : bulk * strain + 2. / 3.;
          ASSERT_NEAR(-points.stress()[0], expected, 1e-12 * limit) << "strain " << strain;
          has_yielded = has_yielded || elastic > limit;
        }
        EXPECT_TRUE(has_yielded);
        EXPECT_NEAR(bulk * (limit / (bulk + 4. / 3. * shear)) + 2. / 3., limit, 1e-12);
      }

      TEST(J2Plasticity, uniaxial_strain_with_hardening_has_the_slope_of_both_moduli)
      {
        const double h = 50.;
        const auto material = make_plugin<Material>(j2, linear("1", "50"));
        Points points(*material);
        points.advance({0.02, 0., 0., 0., 0., 0.}, 1.);
        const double first = points.stress()[0];
        points.advance({0.01, 0., 0., 0., 0., 0.}, 1.);
        const double slope = bulk + 4. / 3. * shear * h / (3. * shear + h);
        EXPECT_NEAR((points.stress()[0] - first) / 0.01, slope, 1e-9 * slope);
      }

      TEST(J2Plasticity, unloading_is_elastic_and_reversed_loading_yields_again)
      {
        const auto material = make_plugin<Material>(j2, linear("1", "0"));
        Points points(*material);
        const Tensor6 forward = {0., 0., 0., 0., 0., 0.02};
        const double flow = 1. / std::sqrt(3.);
        points.advance(forward, 1.);
        EXPECT_NEAR(points.stress()[5], flow, 1e-12);
        const double strain = points.value("effective plastic strain", 0);
        points.advance({0., 0., 0., 0., 0., -0.004}, 1.);
        EXPECT_NEAR(points.stress()[5], flow - 0.8, 1e-12);
        EXPECT_EQ(points.value("effective plastic strain", 0), strain);
        points.advance({0., 0., 0., 0., 0., -0.02}, 1.);
        EXPECT_NEAR(points.stress()[5], -flow, 1e-12);
        EXPECT_GT(points.value("effective plastic strain", 0), strain);
      }

      TEST(J2Plasticity, no_digit_of_an_elastic_point_depends_on_those_that_flow_beside_it)
      {
        const auto material = make_plugin<Material>(j2, linear("1", "0"));
        Points alone(*material), beside(*material);
        const Tensor6 elastic = {1.1e-4, -0.7e-4, 0.3e-4, 0.9e-4, -1.3e-4, 0.2e-4};
        for (unsigned int i = 0; i < n_lanes; ++i)
          for (Points *const points : {&alone, &beside})
            points->set_increment(i, elastic);
        for (unsigned int i = 1; i < n_lanes; ++i)
          beside.set_increment(i, {0.03, 0., 0., 0., 0., 0.01});
        for (unsigned int n = 0; n < 3; ++n)
        {
          alone.advance(1.);
          beside.advance(1.);
          for (unsigned int c = 0; c < 6; ++c)
            ASSERT_EQ(alone.stress()[c], beside.stress()[c]) << "step " << n;
        }
        EXPECT_EQ(alone.value("effective plastic strain", 0), 0.);
        EXPECT_TRUE(n_lanes == 1 || beside.value("effective plastic strain", 1) > 0.);
      }

      TEST(J2Plasticity, the_adiabatic_johnson_cook_curve_is_the_closed_form)
      {
        const auto material = make_plugin<Material>(j2, copper("1"));
        Points points(*material);
        const double step = 1e-4, rate = 1e4;
        const double expected[3][3] = {
            {0.5, 367.41e6, 38.36}, {1., 430.76e6, 91.22}, {2., 470.66e6, 211.06}};
        EXPECT_EQ(points.value("temperature", 0), 298.);
        double old_strain = 0, old_stress = 0, old_temperature = 0;
        unsigned int n_found = 0;
        while (n_found < 3)
        {
          points.advance({step, -0.5 * step, -0.5 * step, 0., 0., 0.}, step / rate);
          const double strain = points.value("effective plastic strain", 0);
          const double stress = effective_stress(points.stress());
          const double temperature = points.value("temperature", 0) - 298.;
          ASSERT_GE(strain, old_strain);
          if (strain >= expected[n_found][0])
          {
            const double share = (expected[n_found][0] - old_strain) / (strain - old_strain);
            EXPECT_NEAR((old_stress + share * (stress - old_stress)) / expected[n_found][1], 1.,
                        1e-3);
            EXPECT_NEAR((old_temperature + share * (temperature - old_temperature)) /
                            expected[n_found][2],
                        1., 1e-3);
            ++n_found;
          }
          old_strain = strain;
          old_stress = stress;
          old_temperature = temperature;
        }
      }

      // The mean of the flow stress up to a strain is the energy of a shear zone: what the
      // heat of a cut does to its force (6082-T6 without rate).
      TEST(J2Plasticity, heat_lowers_the_energy_of_a_shear_zone_of_aluminium_by_the_closed_form)
      {
        const auto aluminium = [](const std::string &heating)
        {
          return make_plugin<Material>(
              j2, "set Density = 2700\nset Young's modulus = 71e9\nset Poisson's ratio = 0.33\n" +
                      heating +
                      "set Flow stress = johnson cook\nset Initial temperature = 293\n"
                      "subsection johnson cook\nset Yield stress = 428.5e6\n"
                      "set Hardening coefficient = 327.7e6\nset Hardening exponent = 1.008\n"
                      "set Rate coefficient = 0\nset Reference rate = 1\n"
                      "set Thermal exponent = 1.31\nset Melting temperature = 855\n"
                      "set Reference temperature = 293\nend\n");
        };
        const auto with =
            aluminium("set Specific heat capacity = 890\nset Taylor-Quinney coefficient = 0.9\n");
        const auto without = aluminium("set Taylor-Quinney coefficient = 0\n");
        Points hot(*with), cold(*without);
        const double step = 2e-4;
        const double expected[4][3] = {
            {0.6, 0.946, 132.}, {1., 0.885, 216.}, {1.2, 0.848, 258.}, {1.4, 0.809, 299.}};
        double hot_work = 0, cold_work = 0;
        for (const auto &[strain, ratio, temperature] : expected)
        {
          while (hot.value("effective plastic strain", 0) < strain)
            for (Points *points : {&hot, &cold})
            {
              const double before = points->value("effective plastic strain", 0);
              points->advance({0., 0., 0., 0., 0., step}, 1.);
              (points == &hot ? hot_work : cold_work) +=
                  effective_stress(points->stress()) *
                  (points->value("effective plastic strain", 0) - before);
            }
          EXPECT_NEAR(hot_work / cold_work / ratio, 1., 5e-3) << strain;
          EXPECT_NEAR((hot.value("temperature", 0) - 273.15) / temperature, 1., 5e-3) << strain;
        }
      }

      /** The closed form of Johnson and Cook for copper(), one point at a time. */
      double johnson_cook(const double strain, const double rate, const double temperature)
      {
        const double t = std::min(std::max((temperature - 298.) / (1356. - 298.), 0.), 1.);
        return (65e6 + 356e6 * std::pow(strain, 0.37)) *
               (1. + 0.013 * std::log(std::max(rate, 1.))) * (1. - std::pow(t, 1.09));
      }

      TEST(J2Plasticity, any_step_from_any_state_ends_on_or_inside_the_yield_surface)
      {
        const auto material = make_plugin<Material>(j2, copper());
        std::mt19937 generator(3);
        std::uniform_real_distribution<double> uniform(-1., 1.);
        const unsigned int n = 173;
        unsigned int n_flowing = 0, n_elastic = 0, n_molten = 0, n_slow = 0;
        for (unsigned int trial = 0; trial < 60; ++trial)
        {
          Points points(*material, n);
          const double time_increment =
              trial % 7 == 0 ? 0. : std::pow(10., 6. * uniform(generator) - 4.);
          std::vector<Tensor6> start(n), increment(n);
          std::vector<double> strain(n);
          for (unsigned int i = 0; i < n; ++i)
          {
            const double strength = std::pow(10., 3. * uniform(generator) + 6.);
            const double size = std::pow(10., 4. * uniform(generator) - 4.5);
            for (unsigned int c = 0; c < 6; ++c)
            {
              start[i][c] = strength * uniform(generator);
              increment[i][c] = i % 11 == 0 ? 0. : size * uniform(generator);
            }
            points.set_stress(i, start[i]);
            points.set_increment(i, increment[i]);
            strain[i] = i % 5 == 0 ? 0. : std::pow(10., 4. * uniform(generator) - 3.);
            points.value("effective plastic strain", i) = strain[i];
            points.value("temperature", i) = i % 4 == 0 ? 298. : 800. + 700. * uniform(generator);
            points.value("yield stress", i) =
                johnson_cook(strain[i], 0., points.value("temperature", i));
          }
          points.advance(time_increment);
          for (unsigned int i = 0; i < n; ++i)
          {
            const Tensor6 now = points.stress(i);
            const double g = material->shear_modulus();
            Tensor6 elastic = start[i];
            const double trace = increment[i][0] + increment[i][1] + increment[i][2];
            for (unsigned int c = 0; c < 6; ++c)
              elastic[c] += 2. * g * increment[i][c] +
                            (c < 3 ? (material->bulk_modulus() - 2. / 3. * g) * trace : 0.);
            const double scale = effective_stress(elastic) + 1.;
            const double plastic = points.value("effective plastic strain", i);
            const double temperature = points.value("temperature", i);
            ASSERT_TRUE(std::isfinite(plastic) && std::isfinite(temperature));
            ASSERT_GE(plastic, strain[i]);
            ASSERT_NEAR(now[0] + now[1] + now[2], elastic[0] + elastic[1] + elastic[2],
                        1e-12 * (scale + std::abs(elastic[0] + elastic[1] + elastic[2])));
            const double increase = plastic - strain[i];
            const double rate = time_increment > 0. ? increase / time_increment : 0.;
            const double flow = johnson_cook(plastic, rate, temperature);
            const double effective = effective_stress(now);
            if (increase > 0.)
            {
              ASSERT_NEAR(effective, flow, 1e-8 * scale) << "point " << i << " of trial " << trial;
              for (unsigned int c = 3; c < 6; ++c)
                ASSERT_GE(now[c] * elastic[c], 0.);
              ++n_flowing;
              if (rate < 1.)
                ++n_slow;
            }
            else
            {
              ASSERT_LE(effective, flow * (1. + 1e-12));
              for (unsigned int c = 0; c < 6; ++c)
                ASSERT_NEAR(now[c], elastic[c], 1e-12 * scale);
              ++n_elastic;
            }
            if (temperature >= 1356.)
            {
              ASSERT_LE(effective, 1e-12 * scale);
              ++n_molten;
            }
          }
        }
        for (const unsigned int count : {n_flowing, n_elastic, n_molten, n_slow})
          EXPECT_GT(count, 100u);
      }

      // Newton's method alternates between a strain on the flat side of the kink and the first
      // one for states that end a little above the reference rate.
      TEST(J2Plasticity, a_step_that_ends_near_the_reference_rate_finds_its_plastic_strain)
      {
        const auto material = make_plugin<Material>(
            j2, "set Density = 2\nset Young's modulus = 260\nset Poisson's ratio = 0.3\n"
                "set Flow stress = johnson cook\nset Initial temperature = 298\n"
                "subsection johnson cook\nset Yield stress = 1\nset Hardening coefficient = 0\n"
                "set Hardening exponent = 1\nset Rate coefficient = 0.02\n"
                "set Reference rate = 1\nset Thermal exponent = 1\n"
                "set Melting temperature = 1000\nset Reference temperature = 290\nend\n");
        const double g = material->shear_modulus(), slow = 1. - 8. / 710.;
        for (const double reference_strain : {1e-7, 1e-6, 1e-5, 1e-4, 1e-3})
        {
          constexpr unsigned int n = 200;
          Points points(*material, n);
          for (unsigned int i = 0; i < n; ++i)
          {
            const double trial = slow + 3. * g * reference_strain * (1. + 0.05 * i);
            Tensor6 increment;
            increment[5] = trial / (std::sqrt(3.) * 2. * g);
            points.set_increment(i, increment);
          }
          points.advance(reference_strain);
          for (unsigned int i = 0; i < n; ++i)
          {
            const double rate = points.value("effective plastic strain", i) / reference_strain;
            EXPECT_NEAR(effective_stress(points.stress(i)),
                        slow * (1. + 0.02 * std::log(std::max(rate, 1.))), 2e-6)
                << "trial " << i << " at the reference strain " << reference_strain;
          }
        }
      }

      TEST(J2Plasticity, a_point_behaves_alike_alone_and_among_others)
      {
        const auto material = make_plugin<Material>(j2, copper());
        Points alone(*material), many(*material, 200);
        const Tensor6 increment = {1e-3, 2e-4, -5e-4, 3e-4, 0., 1e-4};
        for (unsigned int i = 0; i < 200; ++i)
          many.set_increment(i, i == 77 ? increment : Tensor6{1e-6 * i, 0., 0., 0., -1e-4, 0.});
        for (unsigned int n = 0; n < 20; ++n)
        {
          alone.advance(increment, 1e-7);
          many.advance(1e-7);
        }
        for (unsigned int c = 0; c < 6; ++c)
          EXPECT_NEAR(many.stress(77)[c], alone.stress()[c],
                      1e-12 * effective_stress(alone.stress()));
      }

      TEST(J2Plasticity, at_constant_volume_the_stress_power_is_stored_or_dissipated_to_round_off)
      {
        const auto material = make_plugin<Material>(j2, copper());
        Points points(*material);
        double work = 0;
        for (unsigned int n = 0; n < 300; ++n)
        {
          const double x = 1e-4 * std::sin(0.03 * n), y = 7e-5 * std::cos(0.05 * n);
          const Tensor6 increment = {x, -x + y, -y, y, 0.5 * x, x + y};
          const Tensor6 before = points.stress();
          points.advance(increment, 1e-8);
          const Tensor6 after = points.stress();
          work += 0.5 * (contract(before, increment) + contract(after, increment));
        }
        const double plastic = points.value("plastic work", 0);
        EXPECT_GT(plastic, 10. * points.elastic_energy());
        EXPECT_NEAR(points.elastic_energy() + plastic, work, 1e-9 * work);
        EXPECT_NEAR(points.value("temperature", 0) - 298., 0.9 / (8960. * 383.) * plastic,
                    1e-9 * (points.value("temperature", 0) - 298.));
      }

      TEST(J2Plasticity, the_plastic_work_of_a_compression_is_that_of_the_kirchhoff_stress)
      {
        // Yields after a quarter of the way, between two steps; Y = 10, H = 40.
        const auto material = make_plugin<Material>(j2, linear("10", "40"));
        const double end_strain = 0.2, flowing_strain = 0.15;
        const double plastic_strain = 2. * shear / (3. * shear + 40.) * flowing_strain;
        Points points(*material);
        const unsigned int n_steps = 40;
        for (unsigned int n = 0; n < n_steps; ++n)
          points.advance({-end_strain / n_steps, 0., 0., 0., 0., 0.}, 1.);
        // Per initial volume, whatever becomes of the volume.
        const double exact = (10. + 0.5 * 40. * plastic_strain) * plastic_strain;
        EXPECT_NEAR(points.value("plastic work", 0) / exact, 1., 1e-12);
      }

      TEST(J2Plasticity, a_material_that_neither_heats_nor_softens_has_no_temperature)
      {
        EXPECT_EQ(make_plugin<Material>(j2, linear("1", "0"))->internal_variables().size(), 2u);
        const auto heated = make_plugin<Material>(
            j2, linear("1", "0") +
                    "set Taylor-Quinney coefficient = 0.5\n"
                    "set Specific heat capacity = 4\nset Initial temperature = 20\n");
        ASSERT_EQ(heated->internal_variables().size(), 3u);
        Points points(*heated, 3);
        EXPECT_EQ(points.value("temperature", padded_to_lanes(3) - 1), 20.);
        points.advance({0., 0., 0., 0., 0., 0.1}, 1.);
        EXPECT_NEAR(points.value("temperature", 2) - 20.,
                    0.5 / (2. * 4.) * points.value("plastic work", 2), 1e-12);
        EXPECT_GT(points.value("temperature", 2), 20.001);
      }

      struct Evaluation
      {
        double flow_stress, slope;
      };

      Evaluation evaluate(const FlowStress &flow_stress, const double strain,
                          const double temperature, const double temperature_change = 0.)
      {
        std::array<double, n_lanes> p, t, change, zero{}, value, slope;
        p.fill(strain);
        t.fill(temperature);
        change.fill(temperature_change);
        flow_stress.evaluate({n_lanes, 0., p.data(), zero.data(), t.data(), change.data(),
                              value.data(), slope.data()});
        return {value.back(), slope.back()};
      }

      TEST(TabularHardening, the_table_is_exact_at_its_knots_linear_between_and_constant_beyond)
      {
        const auto table =
            make_plugin<FlowStress>("tabular", "set Plastic strains = 0, 0.1, 0.4\n"
                                               "set Temperatures = 300, 500, 600\n"
                                               "set Flow stresses = 10.1, 12.3, 13.7;"
                                               " 8.9, 9.1, 9.7; 0, 0, 0\n");
        EXPECT_TRUE(table->depends_on_temperature());
        const double strains[3] = {0., 0.1, 0.4}, temperatures[3] = {300., 500., 600.};
        const double values[3][3] = {{10.1, 12.3, 13.7}, {8.9, 9.1, 9.7}, {0., 0., 0.}};
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            EXPECT_EQ(evaluate(*table, strains[j], temperatures[i]).flow_stress, values[i][j]);
        EXPECT_NEAR(evaluate(*table, 0.05, 400.).flow_stress, (10.1 + 12.3 + 8.9 + 9.1) / 4.,
                    1e-12);
        EXPECT_NEAR(evaluate(*table, 0.25, 550.).flow_stress, (9.1 + 9.7) / 4., 1e-12);
        EXPECT_EQ(evaluate(*table, 0.9, 100.).flow_stress, 13.7);
        EXPECT_EQ(evaluate(*table, 0.9, 100.).slope, 0.);
        EXPECT_EQ(evaluate(*table, 0.05, 900.).flow_stress, 0.);
        EXPECT_NEAR(evaluate(*table, 0.05, 300.).slope, 22., 1e-12);
        EXPECT_NEAR(evaluate(*table, 0.1, 400., 2.).slope,
                    0.5 * (1.4 + 0.6) / 0.3 + 2. * (9.1 - 12.3) / 200., 1e-12);
      }

      TEST(TabularHardening, a_table_of_one_row_or_one_value_needs_no_temperature)
      {
        const auto row = make_plugin<FlowStress>(
            "tabular", "set Plastic strains = 0, 1\nset Flow stresses = 3, 5\n");
        EXPECT_FALSE(row->depends_on_temperature());
        EXPECT_EQ(evaluate(*row, 0.5, 0.).flow_stress, 4.);
        const auto constant = make_plugin<FlowStress>(
            "tabular", "set Plastic strains = 0\nset Flow stresses = 330\n");
        EXPECT_EQ(evaluate(*constant, 7., 0.).flow_stress, 330.);
        const auto softening = make_plugin<FlowStress>(
            "tabular", "set Plastic strains = 0\nset Temperatures = 0, 100\n"
                       "set Flow stresses = 10; 4\n");
        EXPECT_NEAR(evaluate(*softening, 7., 50.).flow_stress, 7., 1e-14);
      }

      /** At the strain 0.2 before an @p increment within the time 0.01. */
      Evaluation evaluate_fast(const FlowStress &flow_stress, const double increment)
      {
        std::array<double, n_lanes> p, increments, zero{}, value, slope;
        p.fill(0.2 + increment);
        increments.fill(increment);
        flow_stress.evaluate({n_lanes, 100., p.data(), increments.data(), zero.data(), zero.data(),
                              value.data(), slope.data()});
        return {value.back(), slope.back()};
      }

      TEST(RateDependence, of_tables_and_of_cowper_and_symonds_is_the_formula_with_its_slope)
      {
        const auto table = make_plugin<FlowStress>("tabular", "set Plastic strains = 0, 1\n"
                                                              "set Strain rates = 1, 5\n"
                                                              "set Flow stresses = 3, 5; 7, 9\n");
        EXPECT_FALSE(table->depends_on_temperature());
        EXPECT_NEAR(evaluate_fast(*table, 0.03).flow_stress, 3. + 2. * 0.23 + 2., 1e-12);
        EXPECT_NEAR(evaluate_fast(*table, 0.005).flow_stress, 3. + 2. * 0.205, 1e-12);
        EXPECT_NEAR(evaluate_fast(*table, 0.08).flow_stress, 7. + 2. * 0.28, 1e-12);

        const std::string factor =
            "set Cowper-Symonds rate = 40\nset Cowper-Symonds exponent = 5\n";
        const auto line = make_plugin<FlowStress>(
            "linear hardening", "set Yield stress = 3\nset Hardening modulus = 2\n" + factor);
        const auto curve = make_plugin<FlowStress>(
            "tabular", "set Plastic strains = 0, 1\nset Flow stresses = 3, 5\n" + factor);
        for (const double increment : {0.03, 1e-5, 1e-8})
        {
          const double expected = (3. + 2. * (0.2 + increment)) *
                                  (1. + (increment > 1e-7 ? std::pow(increment / 0.4, 0.2) : 0.));
          EXPECT_NEAR(evaluate_fast(*line, increment).flow_stress, expected,
                      increment > 1e-7 ? 1e-12 : 3.4 * std::pow(1e-6, 0.2) / 39.);
          EXPECT_NEAR(evaluate_fast(*curve, increment).flow_stress,
                      evaluate_fast(*line, increment).flow_stress, 1e-12);
        }
        for (const FlowStress *const flow_stress : {table.get(), line.get(), curve.get()})
          for (const double increment : {0.03, 1e-3})
          {
            const double difference = 1e-5 * increment,
                         slope = (evaluate_fast(*flow_stress, increment + difference).flow_stress -
                                  evaluate_fast(*flow_stress, increment - difference).flow_stress) /
                                 (2. * difference);
            EXPECT_NEAR(evaluate_fast(*flow_stress, increment).slope, slope, 1e-6 * slope);
          }
      }

      TEST(TabularHardening, a_table_along_a_line_is_linear_hardening)
      {
        const auto table = make_plugin<Material>(
            j2, "set Density = 2\nset Young's modulus = 260\nset Poisson's ratio = 0.3\n"
                "set Flow stress = tabular\nsubsection tabular\nset Plastic strains = 0, 0.1, 1\n"
                "set Flow stresses = 1, 6, 51\nend\n");
        const auto line = make_plugin<Material>(j2, linear("1", "50"));
        Points first(*table), second(*line);
        for (unsigned int n = 0; n < 100; ++n)
        {
          const Tensor6 increment = {2e-3, 1e-3, 0., 0., 1e-3, 0.};
          first.advance(increment, 1.);
          second.advance(increment, 1.);
          for (unsigned int c = 0; c < 6; ++c)
            ASSERT_NEAR(first.stress()[c], second.stress()[c],
                        1e-9 * effective_stress(second.stress()));
        }
      }

      template <typename Interface>
      std::string refusal(const std::string &name, const std::string &entries)
      {
        return input_error([&] { make_plugin<Interface>(name, entries); });
      }

      TEST(BadMaterial, constants_out_of_range_are_refused_with_their_place)
      {
        const std::string good = copper();
        EXPECT_EQ(refusal<Material>(j2, good), "");
        const char *const cases[][3] = {
            {"Yield stress = 65e6", "Yield stress = 0", "allowed is a number larger than zero"},
            {"Yield stress = 65e6", "Yield stress = -1", "allowed is a number larger than zero"},
            {"coefficient = 356e6", "coefficient = -1", "allowed is zero or a positive number"},
            {"exponent = 0.37", "exponent = 0", "allowed is a number above 0 and up to 2"},
            {"exponent = 0.37", "exponent = -0.37", "allowed is a number above 0 and up to 2"},
            {"coefficient = 0.013", "coefficient = -0.1", "allowed is a number from 0 to 1"},
            {"coefficient = 0.013", "coefficient = nan", "allowed is"},
            {"Reference rate = 1", "Reference rate = 0", "allowed is a number larger than zero"},
            {"exponent = 1.09", "exponent = 0", "allowed is a number above 0 and up to 10"},
            {"Melting temperature = 1356", "Melting temperature = 298",
             "allowed is a number above the reference temperature, 298."},
            {"Melting temperature = 1356", "Melting temperature = 20",
             "allowed is a number above the reference temperature, 298."},
            {"Initial temperature = 298", "Initial temperature = 1356",
             "molten from the start: allowed is a number above its initial temperature, 1356."},
            {"Taylor-Quinney coefficient = 0.9", "Taylor-Quinney coefficient = 1.1",
             "allowed is a number from 0 to 1"},
            {"heat capacity = 383", "heat capacity = 0", "allowed is a number larger than zero"},
            {"Density = 8960", "Density = 0", "allowed is a number larger than zero"},
            {"ratio = 0.34", "ratio = 0.5", "allowed is a number between -1 and 0.5"}};
        for (const auto &bad : cases)
        {
          const std::string message = refusal<Material>(j2, changed(good, bad[0], bad[1]));
          EXPECT_TRUE(contains(message, bad[2])) << bad[1];
          EXPECT_TRUE(contains(message, "test.prm:"));
          EXPECT_TRUE(contains(message, "entry \"j2 plasticity/"));
        }
      }

      TEST(BadMaterial, a_missing_constant_is_refused_by_its_name)
      {
        const std::string good = copper();
        for (const char *line :
             {"set Density = 8960\n", "set Young's modulus = 124e9\n",
              "set Poisson's ratio = 0.34\n", "set Flow stress = johnson cook\n",
              "set Specific heat capacity = 383\n", "set Initial temperature = 298\n",
              "set Yield stress = 65e6\n", "set Hardening coefficient = 356e6\n",
              "set Hardening exponent = 0.37\n", "set Rate coefficient = 0.013\n",
              "set Reference rate = 1\n", "set Thermal exponent = 1.09\n",
              "set Melting temperature = 1356\n", "set Reference temperature = 298\n"})
        {
          const std::string text = line;
          const std::string name = text.substr(4, text.find(" =") - 4);
          const std::string message = refusal<Material>(j2, changed(good, line, ""));
          EXPECT_TRUE(contains(message, name));
        }
        EXPECT_TRUE(contains(refusal<FlowStress>("linear hardening", "set Hardening modulus = 1\n"),
                             "Yield stress"));
      }

      TEST(BadMaterial, a_table_that_does_not_increase_or_fit_is_refused)
      {
        const std::string good = "set Plastic strains = 0, 0.1\nset Temperatures = 1, 2\n"
                                 "set Flow stresses = 3, 4; 1, 2\n";
        EXPECT_EQ(refusal<FlowStress>("tabular", good), "");
        const char *const cases[][3] = {
            {"0, 0.1", "0, 0", "allowed are finite numbers that increase; number 2 does not."},
            {"0, 0.1", "0, -0.1", "allowed are finite numbers that increase; number 2 does not."},
            {"0, 0.1", "0.1, 0.2", "allowed are numbers that increase from 0."},
            {"= 1, 2", "= 2, 1", "allowed are finite numbers that increase; number 2 does not."},
            {"= 1, 2", "= 1, 2, 3", "found 2 rows, separated by semicolons; needed are 3"},
            {"3, 4; 1, 2", "3, 4; 1", "row 2 has 1 values; needed are 2"},
            {"3, 4; 1, 2", "3, 4; 1, -2", "allowed are zero and positive numbers."},
            {"3, 4; 1, 2", "3, 4; 1, two", "\"two\" is not a number."}};
        for (const auto &bad : cases)
        {
          const std::string message = refusal<FlowStress>("tabular", changed(good, bad[0], bad[1]));
          EXPECT_TRUE(contains(message, bad[2])) << bad[1];
          EXPECT_TRUE(contains(message, "test.prm:"));
        }
      }

      TEST(RateDependence, twice_is_refused)
      {
        const std::string rates = "set Plastic strains = 0, 1\nset Strain rates = 1, 2\n"
                                  "set Flow stresses = 3, 4; 5, 6\n";
        EXPECT_TRUE(contains(refusal<FlowStress>("tabular", rates + "set Temperatures = 1, 2\n"),
                             "rows are over the temperature or over the rate"));
        EXPECT_TRUE(
            contains(refusal<FlowStress>("tabular", rates + "set Cowper-Symonds rate = 3\n"),
                     "one of both"));
        EXPECT_NE(refusal<FlowStress>("tabular", changed(rates, "6", "6; 7, 8"))
                      .find("needed are 2, one a rate"),
                  std::string::npos);
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
