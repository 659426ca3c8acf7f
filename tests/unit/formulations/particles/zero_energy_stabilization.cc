// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/approximation/moving_least_squares.h>
#include <tombolo/approximation/neighbour_search.h>
#include <tombolo/formulations/particles/zero_energy_stabilization.h>

#include <gtest/gtest.h>

#include "frozen_body.h"
#include "particle_clouds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

using namespace tombolo;

namespace
{
  /** Elastic as far as its moduli are asked for; the test says how it flows. */
  class Flowing : public Material
  {
  public:
    double density() const override
    {
      return 1.;
    }
    std::vector<FieldDescription> internal_variables() const override
    {
      return {{"effective plastic strain", "1", FieldLocation::material_point, 1, true}};
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

  constexpr double kappa = 0.4;
  const double modulus = Flowing().bulk_modulus() + 4. / 3. * Flowing().shear_modulus();

  ZeroEnergyStabilization make_residual(const std::string &entries, const double dilation)
  {
    Parameters parameters(MPI_COMM_SELF);
    parameters.read_text("subsection s\nset Pair residual = " + std::to_string(kappa) + "\n" +
                             entries + "end\n",
                         "test.prm");
    parameters.handler().enter_subsection("s");
    ZeroEnergyStabilization::declare_parameters(parameters.handler());
    parameters.handler().declare_entry("Configuration", "total Lagrangian");
    parameters.handler().leave_subsection();
    parameters.assign();
    return ZeroEnergyStabilization(parameters.section("s"), *make_kernel("cubic spline"), dilation);
  }

  /** A cloud of particles on this rank alone, all of volume one. */
  template <int dim>
  class Cloud
  {
  public:
    explicit Cloud(const ParticleCloud &cloud, const double dilation = 1.8,
                   const std::string &entries = "")
        : cloud(cloud), residual(make_residual(entries, dilation))
    {
      shape.particle_node = cloud.nodes;
      NeighbourSearch<dim> search;
      search.find(cloud.nodes, cloud.nodes, cloud.position.data(), cloud.support.data(), 0.,
                  shape.row_start, shape.neighbour);
      MovingLeastSquares<dim> mls(make_kernel("cubic spline"));
      for (const BasisDefect &defect :
           mls.compute(cloud.nodes, cloud.position.data(), cloud.support.data(), shape))
        shape.rank_deficient_rows.push_back(defect.row);
      std::vector<FieldDescription> variables = Flowing().internal_variables();
      for (const FieldDescription &field : residual.variables())
        variables.push_back(field);
      points.reinit(n(), variables);
      std::fill_n(points.component(MaterialPoints::volume, 0), n(), 1.);
      residual.initialize(Flowing(), points);
      residual.set_reference(dim, shape, std::vector<double>(n(), 1.), cloud.position.data(),
                             cloud.support.data());
      position = cloud.position;
      const dealii::IndexSet all = dealii::complete_index_set(n());
      partition = std::make_shared<const NodePartition>(all, all, MPI_COMM_SELF);
    }

    unsigned int n() const
    {
      return cloud.size();
    }

    NodalVector vector() const
    {
      NodalVector result;
      result.reinit(partition);
      return result;
    }

    NodalVector
    field(const std::function<std::array<double, 3>(const double *, unsigned int)> &value) const
    {
      NodalVector result = vector();
      for (unsigned int i = 0; i < n(); ++i)
        std::copy_n(value(cloud.x(i), i).begin(), dim, result.node(i));
      return result;
    }

    NodalVector noise(const unsigned int seed, const double amplitude = 1e-9) const
    {
      std::mt19937 generator(seed);
      std::uniform_real_distribution<double> uniform(-amplitude, amplitude);
      return field(
          [&](const double *, unsigned int) {
            return std::array<double, 3>{
                {uniform(generator), uniform(generator), uniform(generator)}};
          });
    }

    /** The force after a further small displacement, at positions that stay. */
    NodalVector move(const NodalVector &by)
    {
      NodalVector force = vector();
      residual.add_force(shape, position.data(), by.data(), 1., points, force.data());
      return force;
    }

    /** The force after a further displacement. */
    NodalVector move_on(const NodalVector &by)
    {
      for (unsigned int i = 0; i < n(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          position[std::size_t(i) * node_stride + d] += by.node(i)[d];
      return move(by);
    }

    NodalVector stiffness_action(const NodalVector &velocity) const
    {
      NodalVector force = vector();
      residual.apply_elastic_stiffness(shape, position.data(), velocity.data(), force.data());
      return force;
    }

    double energy() const
    {
      return residual.stored_energy(points);
    }
    double dissipation() const
    {
      return residual.dissipation(points);
    }

    /** Every point flows on, at this von Mises stress. */
    void flow(const double stress)
    {
      for (unsigned int i = 0; i < n(); ++i)
      {
        points.component(MaterialPoints::n_standard_fields, 0)[i] += 1.;
        points.component(MaterialPoints::stress, 5)[i] = stress / std::sqrt(3.);
        points.component(MaterialPoints::stress, 0)[i] = 7.; // pressure
        points.component(MaterialPoints::stress, 1)[i] = 7.;
        points.component(MaterialPoints::stress, 2)[i] = 7.;
      }
    }

    ParticleCloud cloud;
    Stencils shape;
    ZeroEnergyStabilization residual;
    MaterialPoints points;
    std::shared_ptr<const NodePartition> partition;
    std::vector<double> position; ///< present
  };

  double largest(const NodalVector &vector)
  {
    const std::size_t size = std::size_t(vector.partition()->n_local()) * node_stride;
    double result = 0;
    for (std::size_t k = 0; k < size; ++k)
      result = std::max(result, std::abs(vector.data()[k]));
    return result;
  }

  template <int dim>
  std::vector<ParticleCloud> clouds()
  {
    return {lattice_cloud<dim>(5, 1.8), lattice_cloud<dim>(5, 1.8, 0.3, 1e3),
            random_cloud<dim>(dim == 2 ? 60 : 120, 0.5, 0.8)};
  }

  template <int dim>
  void expect_minus_the_gradient_of_the_energy()
  {
    for (const ParticleCloud &at : clouds<dim>())
    {
      // Of a small step from rest the energy is quadratic in the displacement.
      Cloud<dim> cloud(at), more(at), less(at);
      const NodalVector u = cloud.noise(1), w = cloud.noise(2);
      NodalVector u_and_w = cloud.vector(), u_less_w = cloud.vector();
      for (unsigned int i = 0; i < cloud.n(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
        {
          u_and_w.node(i)[d] = u.node(i)[d] + w.node(i)[d];
          u_less_w.node(i)[d] = u.node(i)[d] - w.node(i)[d];
        }
      const NodalVector force = cloud.move(u);
      more.move(u_and_w);
      less.move(u_less_w);
      const double energy = cloud.energy();
      ASSERT_GT(energy, 0.);
      EXPECT_NEAR(0.5 * (more.energy() - less.energy()), -force.dot(w), 1e-7 * energy);
      EXPECT_NEAR(energy, -0.5 * force.dot(u), 1e-7 * energy);
    }
  }

  /** A rotation by 1.2 about an axis at the corner. */
  template <int dim>
  NodalVector rotation(const Cloud<dim> &cloud)
  {
    const double c = std::cos(1.2), s = std::sin(1.2), *const x0 = cloud.cloud.x(0);
    return cloud.field(
        [&](const double *, const unsigned int i)
        {
          const double *const x = cloud.position.data() + std::size_t(i) * node_stride;
          const double dx = x[0] - x0[0], dy = x[1] - x0[1];
          return std::array<double, 3>{{(c - 1.) * dx - s * dy, s * dx + (c - 1.) * dy, 0.}};
        });
  }

  template <int dim>
  void expect_nothing_of_affine_motions()
  {
    for (const ParticleCloud &at : clouds<dim>())
    {
      Cloud<dim> cloud(at), strained(at);
      const double scale = 1e9 * largest(Cloud<dim>(at).move(cloud.noise(1)));
      EXPECT_LT(largest(cloud.move_on(rotation(cloud))), 1e-10 * scale);
      const NodalVector affine = strained.field(
          [&](const double *x, unsigned int)
          {
            const double dx = x[0] - at.x(0)[0], dy = x[1] - at.x(0)[1];
            return std::array<double, 3>{
                {0.3 + 0.2 * dx - 0.1 * dy, 0.4 * dx, 0.3 * dx - 0.2 * dy}};
          });
      EXPECT_LT(largest(strained.move_on(affine)), 1e-10 * scale);
    }
  }

  template <int dim>
  void expect_no_force_and_no_moment()
  {
    for (const ParticleCloud &at : clouds<dim>())
    {
      Cloud<dim> cloud(at);
      cloud.move_on(cloud.noise(1, 0.02));
      const NodalVector force = cloud.move_on(cloud.noise(2, 0.01));
      double sum[3] = {}, moment[3] = {}, scale = 0;
      for (unsigned int i = 0; i < cloud.n(); ++i)
      {
        const double *const f = force.node(i);
        double y[3];
        for (unsigned int d = 0; d < 3; ++d)
        {
          y[d] = cloud.position[std::size_t(i) * node_stride + d] - cloud.cloud.x(0)[d];
          sum[d] += f[d];
          scale += std::abs(f[d]) * (1. + std::abs(y[d]));
        }
        for (unsigned int d = 0; d < 3; ++d)
          moment[d] += y[(d + 1) % 3] * f[(d + 2) % 3] - y[(d + 2) % 3] * f[(d + 1) % 3];
      }
      ASSERT_GT(scale, 0.);
      for (unsigned int d = 0; d < 3; ++d)
      {
        EXPECT_NEAR(sum[d], 0., 1e-12 * scale);
        EXPECT_NEAR(moment[d], 0., 1e-12 * scale);
      }
    }
  }

  /** ½ f / (½ (K + 4/3 G) V 4 / h²) of the mode that alternates along one axis, taken over the
   * particles that are not at the surface: in units of the stiffness of a row of springs that
   * carry P waves. */
  double stiffness_of_alternation(const std::array<double, 3> &spacing, const unsigned int axis)
  {
    const unsigned int n_side = 7;
    ParticleCloud lattice;
    for (unsigned int k = 0; k < n_side; ++k)
      for (unsigned int j = 0; j < n_side; ++j)
        for (unsigned int i = 0; i < n_side; ++i)
        {
          const double x[3] = {i * spacing[0], j * spacing[1], k * spacing[2]};
          const double a[3] = {1.8 * spacing[0], 1.8 * spacing[1], 1.8 * spacing[2]};
          lattice.add(x, a, 3);
        }
    Cloud<3> cloud(lattice);
    const NodalVector force = cloud.move(cloud.field(
        [&](const double *x, unsigned int)
        {
          const auto place = std::lround(x[axis] / spacing[axis]);
          return std::array<double, 3>{{place % 2 == 0 ? 1e-9 : -1e-9, 0., 0.}};
        }));
    const unsigned int centre = (n_side * n_side * n_side) / 2;
    const double value = 1e9 * std::abs(force.node(centre)[0]);
    return value * spacing[axis] * spacing[axis] / (4. * kappa * modulus);
  }
} // namespace

TEST(ZeroEnergyStabilization, force_is_minus_the_gradient_of_the_energy)
{
  expect_minus_the_gradient_of_the_energy<2>();
  expect_minus_the_gradient_of_the_energy<3>();
}

TEST(ZeroEnergyStabilization, affine_motions_and_large_rotations_feel_nothing)
{
  expect_nothing_of_affine_motions<2>();
  expect_nothing_of_affine_motions<3>();
}

TEST(ZeroEnergyStabilization, forces_and_their_moments_sum_to_zero)
{
  expect_no_force_and_no_moment<2>();
  expect_no_force_and_no_moment<3>();
}

TEST(ZeroEnergyStabilization, a_deformed_body_that_turns_keeps_its_energy_and_turns_its_force)
{
  Cloud<3> cloud(lattice_cloud<3>(5, 1.8, 0.3));
  const NodalVector before = cloud.move_on(cloud.noise(1, 0.02));
  const double energy = cloud.energy(), scale = largest(before);
  ASSERT_GT(energy, 0.);
  const NodalVector after = cloud.move_on(rotation(cloud));
  EXPECT_NEAR(cloud.energy(), energy, 1e-12 * energy);
  const double c = std::cos(1.2), s = std::sin(1.2);
  for (unsigned int i = 0; i < cloud.n(); ++i)
  {
    const double *const f = before.node(i);
    EXPECT_NEAR(after.node(i)[0], c * f[0] - s * f[1], 1e-11 * scale);
    EXPECT_NEAR(after.node(i)[1], s * f[0] + c * f[1], 1e-11 * scale);
    EXPECT_NEAR(after.node(i)[2], f[2], 1e-11 * scale);
  }
}

TEST(ZeroEnergyStabilization, stiffness_action_is_minus_the_force_of_a_displacement)
{
  for (const ParticleCloud &at : clouds<3>())
  {
    Cloud<3> cloud(at);
    const NodalVector u = cloud.noise(1), action = cloud.stiffness_action(u);
    NodalVector sum = cloud.move(u);
    for (unsigned int i = 0; i < cloud.n(); ++i)
      for (unsigned int d = 0; d < 3; ++d)
        sum.node(i)[d] += action.node(i)[d];
    EXPECT_LT(largest(sum), 1e-7 * largest(action));
  }
}

TEST(ZeroEnergyStabilization, stiffness_along_each_axis_is_of_the_size_of_the_physical_one)
{
  const double cubic = stiffness_of_alternation({{1., 1., 1.}}, 0);
  EXPECT_NEAR(cubic, 1., 1e-6);
  for (const double ratio : {0.01, 0.1, 10., 100.})
    for (unsigned int axis = 0; axis < 3; ++axis)
    {
      const double value = stiffness_of_alternation({{ratio, 1., 1.}}, axis);
      EXPECT_LT(value, 1.6) << "axis " << axis << " at " << ratio;
      EXPECT_GT(value, 0.4) << "axis " << axis << " at " << ratio;
    }
}

TEST(ZeroEnergyStabilization, rows_that_flow_store_no_more_than_their_share)
{
  const double flow_stress = 0.3, share = 0.2;
  const double largest_energy =
      share * flow_stress * flow_stress / (6. * Flowing().shear_modulus());
  double error[2];
  for (const unsigned int refinement : {0u, 1u})
  {
    Cloud<3> cloud(lattice_cloud<3>(5, 1.8, 0.3), 1.8, "set Pair residual limit = 0.2\n");
    const NodalVector u = cloud.noise(1, 1.), w = cloud.noise(2, 1.);
    const unsigned int n_steps = refinement == 0 ? 50 : 100;
    NodalVector last_force = cloud.vector();
    double work = 0;
    for (unsigned int step = 0; step < n_steps; ++step)
    {
      cloud.flow(flow_stress);
      NodalVector increment = cloud.vector();
      const double time = (step + 0.5) / n_steps;
      for (unsigned int i = 0; i < cloud.n(); ++i)
        for (unsigned int d = 0; d < 3; ++d)
          increment.node(i)[d] =
              0.1 * (u.node(i)[d] + 3. * std::cos(5. * time) * w.node(i)[d]) / n_steps;
      NodalVector force = cloud.move(increment);
      work -= 0.5 * (force.dot(increment) + last_force.dot(increment));
      last_force = std::move(force);
    }
    EXPECT_LE(cloud.energy(), largest_energy * cloud.n() * (1. + 1e-12));
    EXPECT_GT(cloud.energy(), 0.5 * largest_energy * cloud.n());
    EXPECT_GT(cloud.dissipation(), cloud.energy());
    error[refinement] = std::abs(cloud.energy() + cloud.dissipation() - work) / work;
  }
  EXPECT_LT(error[0], 1e-12);
  EXPECT_LT(error[1], 1e-12);
}

TEST(ZeroEnergyStabilization, rows_that_do_not_flow_keep_what_they_store)
{
  Cloud<3> limited(lattice_cloud<3>(4, 1.8), 1.8, "set Pair residual limit = 1e-6\n");
  Cloud<3> unlimited(lattice_cloud<3>(4, 1.8), 1.8, "set Pair residual limit = 0\n");
  unlimited.flow(1e-3);
  const NodalVector u = limited.noise(1);
  limited.move(u);
  unlimited.move(u);
  EXPECT_GT(limited.energy(), 0.);
  EXPECT_EQ(limited.energy(), unlimited.energy());
  EXPECT_EQ(limited.dissipation(), 0.);
  EXPECT_EQ(unlimited.dissipation(), 0.);
}

TEST(ZeroEnergyStabilization, a_new_reference_books_what_was_stored)
{
  Cloud<3> cloud(lattice_cloud<3>(4, 1.8));
  cloud.move(cloud.noise(1));
  const double stored = cloud.energy();
  cloud.residual.restart(cloud.points);
  EXPECT_EQ(cloud.energy(), 0.);
  EXPECT_EQ(cloud.dissipation(), stored);
}

namespace
{
  tombolo::testing::Block block(const bool is_coupled)
  {
    tombolo::testing::Block result;
    result.formulation = is_coupled ? "coupled" : "particles";
    result.options = "set Smoothing = affine\nset Pair residual = 0.6\n";
    result.mesh_options = "set Disorder = 0.2\n";
    result.cells = {6, 4, 4};
    return result;
  }
} // namespace

TEST(ZeroEnergyStabilization, force_of_a_formulation_is_the_one_its_stiffness_action_says)
{
  for (const bool is_coupled : {false, true})
  {
    tombolo::testing::FrozenBody<3> body(block(is_coupled));
    auto &model = *body.model;
    NodalVector &v = model.state.velocity;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < 3; ++d)
      {
        const double *const x = model.state.initial_position.node(i);
        v.node(i)[d] = std::sin(91.7 * x[0] + 57.3 * x[1] + 31.1 * x[2] + 17. * d);
      }
    v.update_ghosts();
    NodalVector force, action;
    force.reinit(model.state.partition());
    action.reinit(model.state.partition());
    constexpr double dt = 1e-9;
    auto &formulation = *model.parts.back().formulation;
    formulation.add_internal_force({&model.state.position, &v, dt}, force);
    formulation.apply_elastic_stiffness(model.state.position, v, dt, action);
    force.add_to_owners();
    action.add_to_owners();
    const double size = std::sqrt(action.dot(action));
    EXPECT_NEAR(force.dot(v) / dt, -action.dot(v), 1e-6 * action.dot(v));
    EXPECT_NEAR(std::sqrt(force.dot(force)) / dt, size, 1e-6 * size);
    EXPECT_NEAR(force.dot(action) / dt, -size * size, 1e-6 * size * size);
    const double hourglass =
        dealii::Utilities::MPI::sum(formulation.energies()["hourglass energy"], MPI_COMM_WORLD);
    EXPECT_GT(hourglass, 0.05 * 0.5 * dt * dt * action.dot(v));
  }
}

TEST(ZeroEnergyStabilization, the_spectral_step_knows_it)
{
  tombolo::testing::FrozenBody<3> body(block(false)), fast(block(false));
  const double estimate = body.estimator->estimate(*body.model).time_step;
  EXPECT_FALSE(body.grows(estimate, 1500));
  EXPECT_TRUE(fast.grows(1.03 * estimate, 1500));
}
