// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
// Shape functions that are averages over cells, the masses that belong to them, and the damping of
// their surface.
#include "frozen_body.h"
#include "nodal_fields.h"

#include <tombolo/formulations/particles/patch_test.h>
#include <tombolo/model/tangent.h>
#include <tombolo/model/trial.h>
#include <tombolo/physics/mechanics/surface_damping.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  Block disordered(const unsigned int dim, const std::string &formulation,
                   const std::string &smoothing, const std::string &precision = "double")
  {
    Block block;
    block.formulation = formulation;
    block.options = "set Shape functions = cell averages\nset Row precision = " + precision +
                    "\nset Smoothing = " + smoothing;
    block.mesh_options = "set Disorder = 0.25\nset Seed = 5\nset Surface nodes = slide\n"
                         "set Rotation = 20";
    block.cells = dim == 2 ? std::vector<unsigned int>{6, 4} : std::vector<unsigned int>{4, 3, 3};
    return block;
  }

  template <int dim>
  const ParticleFormulation<dim> &particles_of(const Model<dim> &model)
  {
    return *model.particle_parts().front();
  }

  double largest(const double value)
  {
    return dealii::Utilities::MPI::max(value, MPI_COMM_WORLD);
  }

  template <int dim>
  void expect_complete_rows(const std::string &precision, const double tolerance)
  {
    const FrozenBody<dim> body(disordered(dim, "particles", "affine", precision));
    const NodalVector &x = body.model->state.initial_position;
    const Stencils &shape = particles_of(*body.model).stencils();
    double sum_error = 0, moment_error = 0;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      const double *const own = x.node(shape.particle_node[i]);
      double sum = -1., sum_gradient[dim] = {}, moment[dim] = {}, unit[dim][dim] = {};
      for (unsigned int k = 0; k < row.size; ++k)
      {
        const double *const other = x.node(row.neighbour[k]);
        const double *const gradient = row.gradient + k * Stencils::n_gradient;
        sum += row.value[k];
        for (unsigned int a = 0; a < dim; ++a)
        {
          sum_gradient[a] += gradient[a];
          moment[a] += row.value[k] * (other[a] - own[a]);
          for (unsigned int b = 0; b < dim; ++b)
            unit[a][b] += (other[a] - own[a]) * gradient[b];
        }
      }
      sum_error = std::max(sum_error, std::abs(sum));
      for (unsigned int a = 0; a < dim; ++a)
      {
        sum_error = std::max(sum_error, std::abs(sum_gradient[a]));
        moment_error = std::max(moment_error, std::abs(moment[a]));
        for (unsigned int b = 0; b < dim; ++b)
          moment_error = std::max(moment_error, std::abs(unit[a][b] - (a == b ? 1. : 0.)));
      }
    }
    EXPECT_LT(largest(sum_error), 1e-13);
    EXPECT_LT(largest(moment_error), tolerance);
    EXPECT_GT(largest(moment_error), 1e-3 * tolerance);
  }

  /** Σ_I V_I ∇φ_J(x_I) against the areas of the boundary. */
  template <int dim>
  void expect_patch_test()
  {
    const FrozenBody<dim> body(disordered(dim, "particles", "affine"));
    const Model<dim> &model = *body.model;
    const auto &particles = particles_of(model);
    const Stencils &shape = particles.stencils();
    NodalVector force(model.state.partition()), areas(model.state.partition());
    const std::vector<double> &volume = particles.particle_set().initial_volumes();
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      for (unsigned int k = 0; k < row.size; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          force.node(row.neighbour[k])[d] += volume[i] * row.gradient[k * Stencils::n_gradient + d];
    }
    force.add_to_owners();
    PartSetup<dim> setup;
    setup.nodes = model.nodes.get();
    PartBoundary<dim> boundary;
    boundary.initialize(setup);
    boundary.add_areas(model.state.initial_position, areas, areas);
    areas.add_to_owners();
    EXPECT_GT(largest_magnitude(areas), 0.1);
    EXPECT_LT(largest_difference(force, areas), 1e-13);
  }

} // namespace

TEST(CellAverages, rows_are_complete_to_first_order)
{
  expect_complete_rows<2>("double", 1e-13);
  expect_complete_rows<3>("double", 1e-13);
}

TEST(CellAverages, sums_of_rows_in_single_precision_have_no_error)
{
  expect_complete_rows<2>("single", 1e-6);
  expect_complete_rows<3>("single", 1e-6);
}

TEST(CellAverages, a_constant_stress_makes_the_forces_of_its_tractions)
{
  expect_patch_test<2>();
  expect_patch_test<3>();
}

TEST(CellAverages, masses_accelerate_uniformly_and_keep_momentum)
{
  for (const auto &[formulation, precision] :
       {std::pair{"particles", "double"}, std::pair{"coupled", "double"},
        std::pair{"coupled", "single"}})
  {
    SCOPED_TRACE(std::string(formulation) + ", " + precision);
    const FrozenBody<3> body(disordered(3, formulation, "affine", precision));
    Model<3> &model = *body.model;
    NodalVector one(model.state.partition()), smoothed(model.state.partition()),
        adjoint(model.state.partition());
    for (unsigned int i = 0; i < model.state.partition()->n_local(); ++i)
      std::fill_n(one.node(i), 3, 1.);
    model.bridge->apply_adjoint(one, adjoint);
    model.bridge->apply_smoothing(one, smoothed);
    double error = 0, smallest = 1., difference = 0;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double mass = *model.bridge->mass().node(i);
      const double lumped = *model.bridge->lumped_mass().node(i);
      smallest = std::min(smallest, mass / lumped);
      difference = std::max(difference, std::abs(mass / lumped - 1.));
      for (unsigned int d = 0; d < 3; ++d)
        error = std::max(
            {error, std::abs(adjoint.node(i)[d] - 1.), std::abs(smoothed.node(i)[d] - 1.)});
    }
    EXPECT_LT(largest(error), 1e-13);
    EXPECT_GT(-largest(-smallest), 0.1);
    EXPECT_GT(largest(difference), 0.1); // m̂ differs from the lumped mass

    const NodalVector v_hat = disordered_field(model, 1.), v = disordered_field(model, 5.);
    model.bridge->apply_smoothing(v_hat, smoothed);
    model.bridge->apply_adjoint(v, adjoint);
    EXPECT_NEAR(weighted_product(model.bridge->nodal_mass(), v, smoothed),
                weighted_product(model.bridge->mass(), adjoint, v_hat), 1e-12);
    EXPECT_NEAR(weighted_product(model.bridge->mass(), one, v_hat),
                weighted_product(model.bridge->nodal_mass(), one, smoothed), 1e-12);
    model.bridge->apply_short_wave_part(v_hat, smoothed);
    model.bridge->mass_split().make_symmetric(smoothed);
    EXPECT_NEAR(weighted_product(model.bridge->mass(), one, smoothed), 0., 1e-12);
  }
}

TEST(CellAverages, the_estimate_of_the_stable_step_is_the_limit)
{
  for (const std::string options :
       {"affine", "none", "affine\nset Dilatation = of cells", "none\nset Dilatation = of cells"})
  {
    SCOPED_TRACE(options);
    FrozenBody<2> body(disordered(2, "particles", options));
    const double limit = body.limit_by_eigenvalues();
    const double estimate = body.estimator->estimate(*body.model).time_step;
    EXPECT_GE(limit, 0.9999 * estimate);
    EXPECT_LE(limit, 1.05 * estimate);
  }
}

TEST(CellAverages, an_evaluation_that_fails_leaves_nothing_to_the_next)
{
  Block block = disordered(2, "particles", "none\nset Dilatation = of cells");
  block.cells = {16, 10}; // more than a block of particles on each rank
  const FrozenBody<2> body(block);
  Model<2> &model = *body.model;
  Stencils &shape = model.parts[0].particles->stencils();
  const NodalVector rest(model.state.partition());
  const auto force_at = [&](const NodalVector &position)
  {
    const Trial<2> trial(model); // undone at its end
    shape.inverse_deformation_is_current = false;
    NodalVector force(model.state.partition());
    model.parts[0].formulation->add_internal_force({&position, &rest, 1.}, force);
    return force;
  };
  NodalVector squeezed = model.state.initial_position.copy();
  for (unsigned int i = 0; i < model.state.partition()->n_local(); ++i)
    for (unsigned int d = 0; d < 2; ++d)
      squeezed.node(i)[d] *= 0.99;
  const NodalVector before = force_at(squeezed);

  // The last particle is turned inside out.
  NodalVector folded = squeezed.copy();
  const Stencils::Row row = shape.row(shape.n_particles() - 1);
  const double own = squeezed.node(shape.particle_node.back())[1];
  for (unsigned int k = 0; k < row.size; ++k)
    folded.node(row.neighbour[k])[1] = 2. * own - squeezed.node(row.neighbour[k])[1];
  EXPECT_THROW(static_cast<void>(force_at(folded)), RunError);

  const NodalVector after = force_at(squeezed);
  double difference = 0, size = 0;
  for (unsigned int i = 0; i < model.state.partition()->n_local(); ++i)
    for (unsigned int d = 0; d < 2; ++d)
    {
      difference = std::max(difference, std::abs(after.node(i)[d] - before.node(i)[d]));
      size = std::max(size, std::abs(before.node(i)[d]));
    }
  EXPECT_GT(size, 0.);
  EXPECT_LE(difference, 1e-12 * size);
}

TEST(SurfaceDamping, takes_energy_but_no_momentum_and_leaves_rigid_motion_alone)
{
  const FrozenBody<3> body(disordered(3, "particles", "affine"));
  Model<3> &model = *body.model;
  SurfaceDamping<3> damping(0.2, model);
  damping.model_changed(model);
  NodalVector force(model.state.partition()), rotation(model.state.partition());
  for (unsigned int i = 0; i < model.state.partition()->n_local(); ++i)
  {
    const double *const x = model.state.position.node(i);
    const double v[3] = {1. - 2. * x[1] + 0.5 * x[2], 2. * x[0] - x[2], 3. - 0.5 * x[0] + x[1]};
    std::copy_n(v, 3, rotation.node(i));
  }
  Tangent<3> tangent;
  tangent.factor = 1.;
  tangent.force = &force;
  tangent.velocity = &rotation;
  damping.linearize(model, Clock(), tangent);
  EXPECT_LT(largest_magnitude(force), 1e-13);

  const NodalVector v = disordered_field(model, 2.);
  force.set_zero();
  tangent.velocity = &v;
  damping.linearize(model, Clock(), tangent);
  double sum[3] = {}, moment[3] = {}, power = 0;
  for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
  {
    const double *const x = model.state.position.node(i);
    const double *const f = force.node(i);
    for (unsigned int d = 0; d < 3; ++d)
    {
      const unsigned int a = (d + 1) % 3, b = (d + 2) % 3;
      sum[d] += f[d];
      moment[d] += x[a] * f[b] - x[b] * f[a];
      power += f[d] * v.node(i)[d];
    }
  }
  for (unsigned int d = 0; d < 3; ++d)
  {
    EXPECT_NEAR(sum_over_ranks(sum[d]), 0., 1e-12);
    EXPECT_NEAR(sum_over_ranks(moment[d]), 0., 1e-12);
  }
  EXPECT_GT(sum_over_ranks(power), 0.1);
}
