// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material_testing.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      const std::string with_damage = "j2 plasticity";

      /** Copper of Johnson and Cook (1985). */
      std::string damage_of_copper(const std::string &further = "")
      {
        return "set Damage = johnson cook damage\nsubsection johnson cook damage\nset D1 = 0.54\n"
               "set D2 = 4.89\nset D3 = -3.03\nset D4 = 0.014\nset Reference rate = 1\n" +
               further + "end\n";
      }

      /** Damage per plastic strain where a flowing point has this mean stress (its von Mises stress
       * is 1), at a plastic strain rate. */
      double damage_rate(const Material &material, const double mean, const double rate,
                         const double temperature = -1.)
      {
        Points points(material);
        if (temperature >= 0.)
          points.set_temperature(temperature);
        points.set_stress(0, {mean, mean, mean});
        const double step = 1e-3;
        const Tensor6 increment = {step, -0.5 * step, -0.5 * step};
        double damage = 0, strain = 0;
        for (unsigned int n = 0; n < 30; ++n)
        {
          points.advance(increment, step / rate);
          if (n == 19) // flows since the fourth step
          {
            damage = points.value("damage", 0);
            strain = points.value("effective plastic strain", 0);
          }
        }
        EXPECT_NEAR(points.stress()[0], mean + 2. / 3., 1e-9);
        return (points.value("damage", 0) - damage) /
               (points.value("effective plastic strain", 0) - strain);
      }

      TEST(Damage, grows_by_the_strain_at_failure_of_the_triaxiality_and_the_rate)
      {
        const auto material =
            make_plugin<Material>(with_damage, linear("1", "0") + damage_of_copper());
        // By hand: 0.54 + 4.89 exp(-3.03 σ*), times 1 + 0.014 ln(rate).
        EXPECT_NEAR(damage_rate(*material, 0., 1.) * 5.43, 1., 1e-9);             // shear
        EXPECT_NEAR(damage_rate(*material, 1. / 3., 1.) * 2.3210308, 1., 1e-6);   // tension
        EXPECT_NEAR(damage_rate(*material, 1., 1.) * 0.7762635, 1., 1e-6);        // notch
        EXPECT_NEAR(damage_rate(*material, -1. / 3., 1.) * 13.9659885, 1., 1e-6); // compression
        EXPECT_NEAR(damage_rate(*material, 1. / 3., 1e4) * 2.6203156, 1., 1e-6);
        EXPECT_NEAR(damage_rate(*material, 1., 1e4) * 0.8763586, 1., 1e-6);
        EXPECT_NEAR(damage_rate(*material, 1., 1e-3) * 0.7762635, 1., 1e-6); // as a slow one
      }

      TEST(Damage, grows_more_slowly_in_a_hot_point)
      {
        const auto material = make_plugin<Material>(
            with_damage,
            linear("1", "0") + damage_of_copper("set D5 = 1.12\nset Melting temperature = 1356\n"
                                                "set Reference temperature = 298\n"),
            "set Specific heat capacity = 1\nset Conductivity = 1\nset Initial temperature = "
            "298\n");
        const double cold = damage_rate(*material, 1., 1., 298.);
        EXPECT_NEAR(cold * 0.7762635, 1., 1e-6);
        EXPECT_NEAR(cold / damage_rate(*material, 1., 1., 827.), 1.56, 1e-9); // T* = 1/2
        EXPECT_NEAR(cold / damage_rate(*material, 1., 1., 2000.), 2.12, 1e-9);
        EXPECT_NEAR(cold / damage_rate(*material, 1., 1., 20.), 1., 1e-9);
      }

      TEST(Damage, of_a_changing_triaxiality_is_the_sum_of_its_shares)
      {
        const auto material =
            make_plugin<Material>(with_damage, linear("1", "0") + damage_of_copper());
        Points points(*material);
        const double step = 1e-3, bulk = 650. / 3.;
        double mean = 0, expected = 0, last = 0;
        for (unsigned int n = 0; n < 40; ++n)
        {
          const double growth = 1e-4; // of the volume
          points.advance({step + growth / 3., -0.5 * step + growth / 3., -0.5 * step + growth / 3.},
                         10. * step);
          mean += bulk * growth;
          const double strain = points.value("effective plastic strain", 0);
          expected += (strain - last) / (0.54 + 4.89 * std::exp(-3.03 * mean));
          last = strain;
        }
        EXPECT_GT(expected, 0.005);
        EXPECT_NEAR(points.value("damage", 0), expected, 1e-12);
      }

      TEST(Damage, stays_finite_at_any_pressure_and_has_a_smallest_strain_at_failure)
      {
        const auto material =
            make_plugin<Material>(with_damage, linear("1", "0") + damage_of_copper());
        EXPECT_NEAR(damage_rate(*material, 1e6, 1.) * 0.54, 1., 1e-9);
        EXPECT_LT(damage_rate(*material, -1e6, 1.), 1e-20);
        const auto brittle = make_plugin<Material>(
            with_damage, linear("1", "0") +
                             "set Damage = johnson cook damage\n"
                             "subsection johnson cook damage\nset D1 = -0.09\nset D2 = 0.25\n"
                             "set D3 = -0.5\nset Smallest failure strain = 0.01\nend\n");
        EXPECT_NEAR(damage_rate(*brittle, 5., 1.), 100., 1e-9);
        EXPECT_NEAR(damage_rate(*brittle, 0., 1.) * 0.16, 1., 1e-9);
      }

      TEST(Damage, is_a_field_only_where_it_is_asked_for_and_changes_nothing_else)
      {
        const auto without = make_plugin<Material>(with_damage, copper());
        const auto with = make_plugin<Material>(with_damage, copper() + damage_of_copper());
        Points a(*without), b(*with);
        EXPECT_EQ(a.points.find_field("damage"), a.points.fields().size());
        EXPECT_EQ(b.points.fields().size(), a.points.fields().size() + 1);
        EXPECT_TRUE(b.points.fields().back().persistent);
        const double step = 1e-4;
        for (unsigned int n = 0; n < 50; ++n)
          for (Points *const points : {&a, &b})
            points->advance({step, -0.3 * step, -0.3 * step, 0.2 * step}, step / 1e4);
        for (unsigned int f = 0; f < a.points.fields().size(); ++f)
          for (unsigned int c = 0; c < a.points.fields()[f].n_components; ++c)
            EXPECT_EQ(a.points.component(f, c)[0], b.points.component(f, c)[0])
                << a.points.fields()[f].name;
        EXPECT_GT(b.value("damage", 0), 0.);
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
