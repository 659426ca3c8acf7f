// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include <tombolo/formulations/particles/pair_interactions.h>

#include <gtest/gtest.h>

#include "dimensions.h"
#include "radial_cloud.h"

#include <array>
#include <cmath>
#include <random>
#include <string>

using namespace tombolo;

namespace
{
  class Rubber : public Material
  {
  public:
    double density() const override
    {
      return 2.;
    }
    void update_stress(MaterialBatch &) const override {}
    double bulk_modulus() const override
    {
      return 2.;
    }
    double shear_modulus() const override
    {
      return 0.7;
    }
  };

  template <int dim>
  PairTerms<dim> make_terms(const std::string &entries,
                            const std::string &configuration = "current")
  {
    Parameters parameters(MPI_COMM_SELF);
    parameters.read_text("subsection s\n" + entries + "\nend\n", "test.prm");
    parameters.handler().enter_subsection("s");
    declare<PairTerms<dim>>(parameters.handler());
    parameters.handler().declare_entry("Configuration", configuration);
    parameters.handler().leave_subsection();
    parameters.assign();
    return PairTerms<dim>(parameters.section("s"));
  }

  /** A disordered cloud with spacing one, h = 1.5, and random velocities. */
  template <int dim>
  class PairTermsCloud
  {
  public:
    explicit PairTermsCloud(const std::string &entries, const double inertia = 1.)
        : cloud(lattice_cloud<dim>(5, 3., 0.2)), pairs(cloud, cloud.size(), kernel, 2.),
          terms(make_terms<dim>(entries)), velocity(noise(5))
    {
      Rubber material;
      material.scale_inertia(inertia);
      terms.initialize(
          material, [&](const double r) { return kernel.value(r); }, 2. * kernel.h, kernel.h, 1.);
      points.reinit(cloud.size(), {});
      std::fill_n(points.component(MaterialPoints::volume, 0), cloud.size(), 1.);
    }

    std::vector<double> noise(const unsigned int seed) const
    {
      std::mt19937 generator(seed);
      std::uniform_real_distribution<double> uniform(-1., 1.);
      std::vector<double> result = zero();
      for (unsigned int i = 0; i < cloud.size(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          result[std::size_t(i) * node_stride + d] = uniform(generator);
      return result;
    }

    std::vector<double> zero() const
    {
      return std::vector<double>(cloud.size() * node_stride, 0.);
    }

    std::vector<double> viscous_force(const std::vector<double> &nodal_velocity,
                                      double *taken = nullptr) const
    {
      std::vector<double> force = zero(), power(cloud.size(), 0.);
      terms.add_forces(pairs.rows(), points, cloud.position.data(), nodal_velocity.data(),
                       force.data(), power.data(), nullptr);
      for (const double node_power : power)
      {
        EXPECT_GE(node_power, 0.);
        if (taken != nullptr)
          *taken += node_power;
      }
      return force;
    }

    /** Sums of forces, of their moments about the origin, and of their sizes. */
    std::array<double, 7> sums(const std::vector<double> &force) const
    {
      std::array<double, 7> result{};
      for (unsigned int i = 0; i < cloud.size(); ++i)
      {
        const double *const f = force.data() + std::size_t(i) * node_stride;
        const double *const x = cloud.x(i);
        for (unsigned int d = 0; d < 3; ++d)
        {
          const unsigned int e = (d + 1) % 3, g = (d + 2) % 3;
          result[d] += f[d];
          result[3 + d] += x[e] * f[g] - x[g] * f[e];
          result[6] += std::abs(f[d]);
        }
      }
      return result;
    }

    double dot(const std::vector<double> &a, const std::vector<double> &b) const
    {
      double sum = 0;
      for (std::size_t i = 0; i < a.size(); ++i)
        sum += a[i] * b[i];
      return sum;
    }

    HyperbolicKernel<dim> kernel{1.5};
    ParticleCloud cloud;
    RadialPairs<dim> pairs;
    PairTerms<dim> terms;
    std::vector<double> velocity;
    MaterialPoints points;
  };

  template <typename>
  class PairTermsOfDimension : public ::testing::Test
  {};
  TYPED_TEST_SUITE(PairTermsOfDimension, tombolo::testing::Dimensions);

  TYPED_TEST(PairTermsOfDimension, viscosity_is_central_and_takes_what_it_says)
  {
    constexpr int dim = TypeParam::value;
    const PairTermsCloud<dim> cloud("set Artificial viscosity = true");
    double taken = 0;
    const std::vector<double> force = cloud.viscous_force(cloud.velocity, &taken);
    const std::array<double, 7> sums = cloud.sums(force);
    ASSERT_GT(sums[6], 1.);
    for (unsigned int k = 0; k < 6; ++k)
      EXPECT_LT(std::abs(sums[k]), 1e-13 * sums[6]);
    EXPECT_NEAR(cloud.dot(force, cloud.velocity), -taken, 1e-12 * taken);
  }

  /** Π_ij as printed, pair by pair. */
  TYPED_TEST(PairTermsOfDimension, viscosity_is_that_of_the_formula)
  {
    constexpr int dim = TypeParam::value;
    const double alpha = 0.7, beta = 1.3, inertia = 4.;
    const PairTermsCloud<dim> cloud(
        "set Artificial viscosity = true\nset Artificial viscosity alpha = 0.7\n"
        "set Artificial viscosity beta = 1.3",
        inertia);
    const std::vector<double> force = cloud.viscous_force(cloud.velocity);
    const double h = cloud.kernel.h;
    const double c = std::sqrt((2. + 4. / 3. * 0.7) / (inertia * 2.));
    double largest = 0;
    for (unsigned int i = 0; i < cloud.cloud.size(); ++i)
    {
      std::array<double, dim> expected{};
      for (unsigned int j = 0; j < cloud.cloud.size(); ++j)
      {
        double squared = 0, product = 0;
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double x = cloud.cloud.x(i)[d] - cloud.cloud.x(j)[d];
          squared += x * x;
          product +=
              x * (cloud.velocity[i * node_stride + d] - cloud.velocity[j * node_stride + d]);
        }
        const double r = std::sqrt(squared);
        if (i == j || product >= 0.)
          continue;
        const double mu = h * product / (squared + 0.01 * h * h);
        // m_i m_j Π_ij |∇_iW_ij| with m = 2 and ρ = 2, both with the inertia.
        const double pair_factor =
            inertia * 2. * 2. * (-alpha * c * mu + beta * mu * mu) / 2. * cloud.kernel.slope(r) / r;
        for (unsigned int d = 0; d < dim; ++d)
          expected[d] += pair_factor * (cloud.cloud.x(i)[d] - cloud.cloud.x(j)[d]);
      }
      for (unsigned int d = 0; d < dim; ++d)
      {
        EXPECT_NEAR(force[i * node_stride + d], expected[d], 1e-5);
        largest = std::max(largest, std::abs(expected[d]));
      }
    }
    EXPECT_GT(largest, 0.1);
  }

  TYPED_TEST(PairTermsOfDimension, tangent_of_the_viscosity_is_symmetric)
  {
    constexpr int dim = TypeParam::value;
    const PairTermsCloud<dim> cloud("set Artificial viscosity = true");
    const std::vector<double> a = cloud.noise(11), b = cloud.noise(12);
    std::vector<double> damped_a = cloud.zero(), damped_b = cloud.zero();
    const auto apply = [&](const std::vector<double> &direction, std::vector<double> &result)
    {
      PairDampers<dim> dampers;
      cloud.terms.linearize_viscosity(cloud.pairs.rows(), cloud.cloud.position.data(),
                                      cloud.velocity.data(), dampers);
      dampers.apply(direction.data(), 3., result.data());
    };
    apply(a, damped_a);
    apply(b, damped_b);
    EXPECT_NEAR(cloud.dot(a, damped_b), cloud.dot(b, damped_a), 1e-12 * cloud.dot(a, damped_a));
    EXPECT_GT(cloud.dot(a, damped_a), 0.);

    // All pairs approach in a contraction, and the tangent is the derivative of the force.
    std::vector<double> contraction = cloud.zero(), image = cloud.zero();
    for (std::size_t i = 0; i < contraction.size(); ++i)
      contraction[i] = -cloud.cloud.position[i];
    const double step = 1e-6;
    std::vector<double> more = contraction;
    for (std::size_t i = 0; i < more.size(); ++i)
      more[i] += step * a[i];
    const std::vector<double> before = cloud.viscous_force(contraction),
                              after = cloud.viscous_force(more);
    PairDampers<dim> dampers;
    cloud.terms.linearize_viscosity(cloud.pairs.rows(), cloud.cloud.position.data(),
                                    contraction.data(), dampers);
    dampers.apply(a.data(), 1., image.data());
    for (std::size_t i = 0; i < image.size(); ++i)
      EXPECT_NEAR((before[i] - after[i]) / step, image[i], 1e-4);
  }
} // namespace

TEST(PairTerms, viscosity_leaves_pairs_that_separate_and_rigid_spins_alone)
{
  const PairTermsCloud<2> cloud("set Artificial viscosity = true");
  std::vector<double> velocity = cloud.cloud.position;
  for (const double component : cloud.viscous_force(velocity))
    EXPECT_EQ(component, 0.);
  for (unsigned int i = 0; i < cloud.cloud.size(); ++i)
  {
    velocity[i * node_stride] = -cloud.cloud.x(i)[1];
    velocity[i * node_stride + 1] = cloud.cloud.x(i)[0];
  }
  for (const double component : cloud.viscous_force(velocity))
    EXPECT_NEAR(component, 0., 1e-13);
}

namespace
{
  /** The artificial stress under @p stress, and the internal force of it. */
  template <int dim>
  std::vector<double> artificial_stress(PairTermsCloud<dim> &cloud,
                                        const std::array<double, 6> &stress)
  {
    for (unsigned int c = 0; c < 6; ++c)
      std::fill_n(cloud.points.component(MaterialPoints::stress, c), cloud.cloud.size(), stress[c]);
    std::vector<double> force = cloud.zero();
    cloud.terms.add_forces(cloud.pairs.rows(), cloud.points, cloud.cloud.position.data(),
                           cloud.velocity.data(), nullptr, nullptr, force.data());
    return force;
  }

  TYPED_TEST(PairTermsOfDimension, artificial_stress_takes_tensile_principal_stresses_only)
  {
    constexpr int dim = TypeParam::value;
    PairTermsCloud<dim> cloud("set Artificial stress = true\nset Artificial stress exponent = 0");
    // With the exponent zero it is -ε times the internal force of the tensile part, but for the
    // part of the row at the particle itself.
    const double s = 0.3, tension = 2., compression = -1.;
    const double c2 = std::cos(s) * std::cos(s), s2 = std::sin(s) * std::sin(s),
                 cs = std::cos(s) * std::sin(s);
    const std::vector<double> all =
        artificial_stress(cloud, {{tension * c2 + compression * s2, tension * s2 + compression * c2,
                                   compression, 0., 0., (tension - compression) * cs}});
    const std::vector<double> tensile =
        artificial_stress(cloud, {{tension * c2, tension * s2, 0., 0., 0., tension * cs}});
    const std::array<double, 7> sums = cloud.sums(all);
    ASSERT_GT(sums[6], 0.1);
    for (unsigned int d = 0; d < 3; ++d)
      EXPECT_LT(std::abs(sums[d]), 1e-13 * sums[6]);
    for (std::size_t i = 0; i < all.size(); ++i)
      EXPECT_NEAR(all[i], tensile[i], 1e-12);
    for (const double component : artificial_stress(cloud, {{-1., -2., -1., 0.3, 0., 0.4}}))
      EXPECT_EQ(component, 0.);
  }
} // namespace

TEST(PairTerms, artificial_stress_pushes_pairs_apart_under_tension)
{
  PairTermsCloud<2> cloud("set Artificial stress = true");
  ParticleCloud pair;
  const double a[2] = {3., 3.}, first[2] = {0., 0.}, second[2] = {0.8, 0.};
  pair.add(first, a, 2);
  pair.add(second, a, 2);
  const RadialPairs<2> pairs(pair, 2, cloud.kernel);
  MaterialPoints points;
  points.reinit(2, {});
  std::fill_n(points.component(MaterialPoints::volume, 0), 2, 1.);
  std::fill_n(points.component(MaterialPoints::stress, 0), 2, 2.);
  std::vector<double> force(8, 0.);
  const std::vector<double> velocity(8, 0.);
  cloud.terms.add_forces(pairs.rows(), points, pair.position.data(), velocity.data(), nullptr,
                         nullptr, force.data());
  const double ratio = cloud.kernel.value(0.8) / cloud.kernel.value(1.);
  // m² (W/W(dp))⁴ (R_i + R_j) |W'|, of two particles of volume one
  const double expected = 2. * 0.3 * 2. * std::pow(ratio, 4) * cloud.kernel.slope(0.8);
  EXPECT_NEAR(force[0], -expected, 1e-5 * expected);
  EXPECT_NEAR(force[4], expected, 1e-5 * expected);
}

TEST(PairTerms, xsph_keeps_momentum_and_the_centre_of_mass)
{
  const PairTermsCloud<3> cloud("set XSPH = true");
  std::vector<double> momentum = cloud.zero();
  cloud.terms.add_exchanged_momentum(cloud.pairs.rows(), cloud.cloud.position.data(),
                                     cloud.velocity.data(), momentum.data());
  const std::array<double, 7> sums = cloud.sums(momentum);
  ASSERT_GT(sums[6], 1.);
  for (unsigned int d = 0; d < 3; ++d)
    EXPECT_LT(std::abs(sums[d]), 1e-13 * sums[6]);
  // What it adds to positions keeps the moment of the momentum: Σ Δx_i × m_i v_i = 0.
  for (unsigned int d = 0; d < 3; ++d)
  {
    const unsigned int e = (d + 1) % 3, g = (d + 2) % 3;
    double moment = 0;
    for (unsigned int i = 0; i < cloud.cloud.size(); ++i)
    {
      const double *const p = momentum.data() + std::size_t(i) * node_stride;
      const double *const v = cloud.velocity.data() + std::size_t(i) * node_stride;
      moment += p[e] * v[g] - p[g] * v[e];
    }
    EXPECT_LT(std::abs(moment), 1e-13 * sums[6]);
  }
  // ε m_i m_j W/ρ (v_j - v_i) of all neighbours, with m = 2 and ρ = 2.
  for (unsigned int d = 0; d < 3; ++d)
  {
    double expected = 0;
    for (unsigned int j = 1; j < cloud.cloud.size(); ++j)
    {
      double squared = 0;
      for (unsigned int e = 0; e < 3; ++e)
        squared += std::pow(cloud.cloud.x(j)[e] - cloud.cloud.x(0)[e], 2);
      expected += 0.5 * 2. * cloud.kernel.value(std::sqrt(squared)) *
                  (cloud.velocity[j * node_stride + d] - cloud.velocity[d]);
    }
    EXPECT_NEAR(momentum[d], expected, 1e-5);
  }
}

TEST(PairTerms, bad_input_is_refused)
{
  const auto refused = [](const std::string &entries, const std::string &configuration = "current")
  { EXPECT_THROW(make_terms<2>(entries, configuration), InputError) << entries; };
  refused("set Artificial viscosity = true\nset Artificial viscosity alpha = -0.1");
  refused("set Artificial viscosity = true\nset Artificial viscosity beta = -1");
  refused("set Artificial viscosity = true\nset Artificial viscosity alpha = 0\n"
          "set Artificial viscosity beta = 0");
  refused("set Artificial stress = true\nset Artificial stress factor = -1");
  refused("set Artificial stress = true\nset Artificial stress factor = 2");
  refused("set XSPH = true\nset XSPH factor = -0.5");
  refused("set XSPH = true\nset XSPH factor = 1.5");
  refused("set Artificial stress = true", "total Lagrangian");
  refused("set Artificial stress = true", "updated Lagrangian");
  EXPECT_FALSE(make_terms<2>("").is_on());
  EXPECT_TRUE(make_terms<2>("set Artificial viscosity = true", "total Lagrangian").has_viscosity());
}
