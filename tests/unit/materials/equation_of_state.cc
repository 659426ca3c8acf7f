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
      const std::string with_equation = "j2 plasticity";

      constexpr double density = 8960., speed = 3940., slope = 1.489, gruneisen = 2.02;
      constexpr double stiffness = density * speed * speed;

      /** Copper with hardly any strength. */
      std::string shocked_copper(const std::string &further = "")
      {
        return "set Density = 8960\nset Young's modulus = 124e9\nset Poisson's ratio = 0.34\n"
               "set Flow stress = linear hardening\n"
               "subsection linear hardening\nset Yield stress = 1\nend\n"
               "set Equation of state = mie gruneisen\nsubsection mie gruneisen\n"
               "set Sound speed = 3940\nset Hugoniot slope = 1.489\n"
               "set Gruneisen coefficient = 2.02\n" +
               further + "end\n";
      }

      /** Compresses in one direction to the relative volume 1 - @p eta. */
      void compress(Points &points, const double eta, const unsigned int n_steps = 2000)
      {
        const double strain = std::log(1. - eta) / n_steps;
        for (unsigned int n = 0; n < n_steps; ++n)
          points.advance({strain, 0., 0., 0., 0., 0.}, 1e-9);
      }

      double mean_stress(Points &points)
      {
        const Tensor6 stress = points.stress();
        return (stress[0] + stress[1] + stress[2]) / 3.;
      }

      double volume(Points &points)
      {
        return points.points.component(MaterialPoints::volume_ratio, 0)[0];
      }

      double pressure(Points &points)
      {
        return -mean_stress(points) / volume(points);
      }

      TEST(EquationOfState, gives_the_pressure_of_the_hugoniot_at_its_energy)
      {
        for (const std::string correction : {"0", "0.47"})
        {
          const auto material = make_plugin<Material>(
              with_equation, shocked_copper("set Gruneisen correction = " + correction + "\n"));
          for (const double eta : {0.01, 0.1, 0.25})
          {
            Points points(*material);
            compress(points, eta);
            // Us = c0 + s up and η = up/Us: what a shock leaves, p = ρ0 Us up and E = p η/2.
            const double shock = speed / (1. - slope * eta);
            const double expected = density * shock * shock * eta;
            EXPECT_LT(pressure(points), expected) << "the isentrope is below the Hugoniot";
            const double energy =
                points.value("pressure work", 0) + points.value("plastic work", 0);
            points.value("viscous work", 0) = 0.5 * expected * eta - energy;
            points.advance({}, 1e-9);
            EXPECT_NEAR(pressure(points) / expected, 1., 1e-9) << eta;
          }
        }
      }

      TEST(EquationOfState, knows_curved_hugoniots)
      {
        const auto material = make_plugin<Material>(
            with_equation, shocked_copper("set Second Hugoniot coefficient = 0.4\n"
                                          "set Third Hugoniot coefficient = -0.9\n"));
        const double eta = 0.2;
        Points points(*material);
        compress(points, eta);
        // Us = c0 + s1 up + s2 (up/Us) up + s3 (up/Us)² up.
        const double shock = speed / (1. - slope * eta - 0.4 * eta * eta + 0.9 * eta * eta * eta);
        const double expected = density * shock * shock * eta;
        points.value("viscous work", 0) = 0.5 * expected * eta - points.value("pressure work", 0) -
                                          points.value("plastic work", 0);
        points.advance({}, 1e-9);
        EXPECT_NEAR(pressure(points) / expected, 1., 1e-9);
      }

      TEST(EquationOfState, differs_from_the_elastic_pressure)
      {
        const auto material = make_plugin<Material>(with_equation, shocked_copper());
        Points points(*material);
        compress(points, 0.2);
        const double elastic = -stiffness * std::log(0.8);
        EXPECT_GT(pressure(points), 1.3 * elastic);
        EXPECT_EQ(material->bulk_modulus(), stiffness);
        EXPECT_NEAR(material->shear_modulus(), 124e9 / 2.68, 1.);
      }

      TEST(EquationOfState, stores_the_work_of_its_pressure_and_gives_it_back)
      {
        const auto material = make_plugin<Material>(with_equation, shocked_copper());
        Points points(*material);
        const unsigned int n_steps = 2000;
        const double strain = std::log(0.8) / n_steps;
        double work = 0;
        for (unsigned int n = 0; n < n_steps; ++n)
        {
          const double before = volume(points), old = pressure(points);
          points.advance({strain, 0., 0., 0., 0., 0.}, 1e-9);
          work -= 0.5 * (old + pressure(points)) * (volume(points) - before);
        }
        EXPECT_NEAR(points.value("pressure work", 0) / work, 1., 1e-6);
        EXPECT_LT(points.elastic_energy(), 1.); // of the deviator
        for (unsigned int n = 0; n < n_steps; ++n)
          points.advance({-strain, 0., 0., 0., 0., 0.}, 1e-9);
        EXPECT_NEAR(points.value("pressure work", 0) / work, 0., 1e-6);
        EXPECT_NEAR(pressure(points) / stiffness, 0., 1e-6);
      }

      TEST(EquationOfState, the_bulk_modulus_of_a_point_is_the_isentropic_one)
      {
        const auto material = make_plugin<Material>(
            with_equation, shocked_copper("set Gruneisen correction = 0.47\n"));
        for (const double eta : {1e-4, 0.1, 0.25, -0.05})
        {
          Points points(*material);
          EXPECT_EQ(points.value("bulk modulus", 0), stiffness);
          compress(points, eta);
          const double modulus = points.value("bulk modulus", 0), old = pressure(points);
          const double strain = 1e-5;
          points.advance({-strain, 0., 0., 0., 0., 0.}, 1e-9);
          const double mean = 0.5 * (modulus + points.value("bulk modulus", 0));
          EXPECT_NEAR((pressure(points) - old) / strain / mean, 1., 1e-5) << eta;
        }
      }

      TEST(EquationOfState, plastic_work_raises_the_pressure)
      {
        const auto material = make_plugin<Material>(with_equation, shocked_copper());
        Points points(*material);
        points.value("plastic work", 0) = 1e9;
        points.advance({}, 1e-9);
        EXPECT_NEAR(pressure(points) / (gruneisen * 1e9), 1., 1e-12);
      }

      TEST(EquationOfState, is_a_pressure_and_no_flow)
      {
        const std::string text = linear("1", "50");
        const auto elastic = make_plugin<Material>(with_equation, text);
        const auto with = make_plugin<Material>(
            with_equation, text +
                               "set Equation of state = mie gruneisen\nsubsection mie gruneisen\n"
                               "set Sound speed = 10\nset Hugoniot slope = 1\n"
                               "set Gruneisen coefficient = 1\nend\n");
        Points a(*elastic), b(*with);
        for (unsigned int n = 0; n < 20; ++n)
          for (Points *const points : {&a, &b})
            points->advance({1e-3, -2e-3, 5e-4, 1e-3, 0., 3e-4}, 1e-3);
        for (unsigned int c = 0; c < 6; ++c)
        {
          const double mean_a = c < 3 ? mean_stress(a) : 0., mean_b = c < 3 ? mean_stress(b) : 0.;
          EXPECT_NEAR(a.stress()[c] - mean_a, b.stress()[c] - mean_b, 1e-13);
        }
        EXPECT_EQ(a.value("effective plastic strain", 0), b.value("effective plastic strain", 0));
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
