// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include "material_testing.h"

#include <tombolo/base/input/parameters.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      const double shear_modulus = 260. / 2.6;

      std::string elastic()
      {
        return "set Density = 2\nset Young's modulus = 260\nset Poisson's ratio = 0.3\n";
      }

      std::unique_ptr<Material> chaboche(const std::string &yield, const std::string &hardening,
                                         const std::string &moduli, const std::string &rates)
      {
        return make_plugin<Material>("chaboche", linear(yield, hardening) +
                                                     "set Back stress moduli = " + moduli +
                                                     "\nset Recovery rates = " + rates + "\n");
      }

      /** √3 τ after simple shear by steps of the whole shear component of the strain. */
      double shear_by(Points &points, const double strain, const unsigned int n_steps)
      {
        for (unsigned int step = 0; step < n_steps; ++step)
          points.advance(Tensor6(0, 0, 0, 0, 0, strain / n_steps), 1.);
        return std::sqrt(3.) * points.stress()[5];
      }

      TEST(Chaboche, linear_hardening_moves_the_yield_surface)
      {
        const auto material = chaboche("1", "0", "40", "0");
        Points points(*material);
        // σ = Y + C p, and 2 e/√3 = p + σ/(3 G).
        const double strain = 0.05, total = 2. * strain / std::sqrt(3.);
        const double p = (3. * shear_modulus * total - 1.) / (3. * shear_modulus + 40.);
        EXPECT_NEAR(shear_by(points, strain, 3), 1. + 40. * p, 1e-9);
        EXPECT_NEAR(points.value("effective plastic strain", 0), p, 1e-11);
        // Backwards it yields after 2 Y.
        const double back = 2. / (3. * shear_modulus) * std::sqrt(3.) / 2.;
        EXPECT_NEAR(shear_by(points, -0.999 * back, 1), 1. + 40. * p - 2. * 0.999, 1e-9);
        EXPECT_NEAR(points.value("effective plastic strain", 0), p, 1e-11);
        shear_by(points, -0.002 * back, 1);
        EXPECT_GT(points.value("effective plastic strain", 0), p + 1e-7);
      }

      TEST(Chaboche, terms_that_recover_saturate)
      {
        const auto material = chaboche("1", "0", "60, 5", "50, 2");
        Points points(*material);
        const double stress = shear_by(points, 0.05, 4000);
        const double p = points.value("effective plastic strain", 0);
        const double exact =
            1. + 60. / 50. * (1. - std::exp(-50. * p)) + 5. / 2. * (1. - std::exp(-2. * p));
        EXPECT_NEAR(stress, exact, 1e-3);
        // Of first order in the step.
        Points coarse(*material);
        const double coarse_stress = shear_by(coarse, 0.05, 40);
        const double q = coarse.value("effective plastic strain", 0);
        EXPECT_NEAR(coarse_stress,
                    1. + 60. / 50. * (1. - std::exp(-50. * q)) + 5. / 2. * (1. - std::exp(-2. * q)),
                    0.03);
      }

      TEST(Chaboche, a_cycle_of_one_amplitude_becomes_steady)
      {
        const auto material = chaboche("1", "0", "60", "50");
        Points points(*material);
        double largest = 0., last = 0.;
        for (unsigned int cycle = 0; cycle < 12; ++cycle)
        {
          last = largest;
          largest = shear_by(points, cycle == 0 ? 0.03 : 0.06, 1500);
          shear_by(points, -0.06, 1500);
        }
        EXPECT_NEAR(largest, last, 1e-6);
        // Half of the range of plastic strain: σ = Y + C/γ tanh(γ Δp/2).
        const double half = 0.06 / std::sqrt(3.) - largest / (3. * shear_modulus);
        EXPECT_NEAR(largest, 1. + 60. / 50. * std::tanh(50. * half), 0.02);
      }

      TEST(Chaboche, work_is_stored_or_lost)
      {
        const auto material = chaboche("1", "3", "60, 5", "50, 0");
        Points points(*material);
        const Tensor6 path[] = {{0.004, -0.001, 0.0005, 0.002, 0., 0.003},
                                {-0.005, 0.002, 0., 0.001, -0.003, -0.004},
                                {0.001, 0.001, -0.003, -0.005, 0.001, 0.002},
                                {-0.006, 0.003, 0.001, 0., 0.002, -0.001}};
        double work = 0., lost = 0.;
        for (const Tensor6 &leg : path)
          for (unsigned int step = 0; step < 20; ++step)
          {
            Tensor6 increment = leg;
            for (double &entry : increment.entry)
              entry /= 5.;
            const Tensor6 old = points.stress();
            const double ratio = points.points.component(MaterialPoints::volume_ratio, 0)[0];
            points.advance(increment, 0.1);
            const double trace = increment[0] + increment[1] + increment[2];
            work += ratio * std::exp(trace) * (1. - 0.5 * trace) * 0.5 *
                    (contract(old, increment) + contract(points.stress(), increment));
            EXPECT_GE(points.value("plastic work", 0), lost - 1e-12);
            lost = points.value("plastic work", 0);
          }
        EXPECT_GT(lost, 0.5 * work);
        EXPECT_GT(points.value("pressure work", 0), 1e-3 * work);
        const double ratio = points.points.component(MaterialPoints::volume_ratio, 0)[0];
        EXPECT_NEAR(ratio * points.elastic_energy() + lost + points.value("pressure work", 0), work,
                    2e-3 * work);
        double stored = 0.;
        const double modulus[] = {60., 5.};
        for (unsigned int k = 0; k < 2; ++k)
        {
          const Tensor6 back = points.tensor("back stress " + std::to_string(k + 1));
          EXPECT_NEAR(back[0] + back[1] + back[2], 0., 1e-12);
          stored += 0.75 / modulus[k] * contract(back, back);
        }
        EXPECT_NEAR(points.value("pressure work", 0), stored, 2e-2 * stored);
      }

      TEST(Chaboche, without_a_back_stress_it_is_j2_plasticity)
      {
        const auto moving = chaboche("1", "30", "1e-9", "0");
        const auto fixed = make_plugin<Material>("j2 plasticity", linear("1", "30"));
        Points one(*moving), other(*fixed);
        for (unsigned int step = 0; step < 30; ++step)
        {
          const double sign = step < 15 ? 1. : -1.;
          const Tensor6 increment(0.002 * sign, -0.001 * sign, 0., 0.001, 0.0005 * sign, 0.003);
          one.advance(increment, 0.1);
          other.advance(increment, 0.1);
          for (unsigned int c = 0; c < 6; ++c)
            EXPECT_NEAR(one.stress()[c], other.stress()[c], 1e-8);
        }
        EXPECT_NEAR(one.value("plastic work", 0), other.value("plastic work", 0), 1e-8);
        EXPECT_DOUBLE_EQ(moving->slow_yield_stress(0.1, 0.), 4.);
      }

      TEST(Chaboche, refuses_lists_that_do_not_fit)
      {
        EXPECT_THROW(chaboche("1", "0", "60, 5", "1"), InputError);
        EXPECT_THROW(chaboche("1", "0", "60, 0", "1, 1"), InputError);
        EXPECT_THROW(chaboche("1", "0", "60", "-1"), InputError);
        EXPECT_THROW(make_plugin<Material>("chaboche", elastic() +
                                                           "set Back stress moduli = 1\nset Flow "
                                                           "stress = tabular\nsubsection tabular\n"
                                                           "set Plastic strains = 0, 1\nset "
                                                           "Temperatures = 0, 100\nset Flow "
                                                           "stresses = 1, 2; 1, 2\nend\n"),
                     InputError);
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
