// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
// Scaled inertia: what it multiplies, what it leaves alone, and what is booked of it.
#include "frozen_body.h"
#include "nodal_fields.h"
#include "text_testing.h"

#include <tombolo/physics/mechanics/loads.h>
#include <tombolo/physics/mechanics/mass_scaling.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  const std::vector<std::string> all_kinds = {"hexahedron", "fully integrated hexahedron",
                                              "lagrange hexahedron", "particles", "coupled"};

  /** Coordinates along x of the block with thin layers; 4 cells in the section, each of area 1. */
  const std::vector<double> layers = {0., 1., 2., 2.25, 2.5, 3., 3.25, 3.5, 4.5, 5.5};

  Block block_of(const std::string &kind, const double poisson = 0.3)
  {
    Block block;
    block.formulation = kind;
    block.poisson = poisson;
    block.cells = {6, 2, 2};
    if (kind == "particles" || kind == "coupled")
      block.options = "set Dilation = 1.8\nset Smoothing = affine";
    return block;
  }

  std::string scaled(std::string text, const std::string &entries)
  {
    return text + "subsection Scaling\n" + entries + "\nend\n";
  }

  std::string layered(const std::string &kind, const double poisson = 0.3)
  {
    return changed(changed(parameters_of(block_of(kind, poisson)), "set Upper corner = 6,",
                           "set Upper corner = 5.5,"),
                   "set Cells = 6, 2, 2",
                   "set Cells = 2 to 2 | 2 to 2.5 | 1 to 3 | 2 to 3.5 | 2 to 5.5; 2; 2");
  }

  /** The mass that a cell or particle of this length and mass needs for the target. */
  double needed(const double length, const double target, const double mass)
  {
    return std::max(0., target * target / (length * length) - 1.) * mass;
  }
} // namespace

TEST(Scaling, a_uniform_factor_multiplies_steps_by_its_root_and_leaves_mass_and_density)
{
  for (const std::string &kind : all_kinds)
  {
    SCOPED_TRACE(kind);
    const std::string text = parameters_of(block_of(kind));
    FrozenBody<3> plain(text);
    // 4 · 2.5²
    FrozenBody<3> body(scaled(text, "set Mass factor = 4\nset Process time factor = 2.5"));
    EXPECT_EQ(body.model->parts[0].material->density(), 1.);
    EXPECT_DOUBLE_EQ(body.model->parts[0].material->inertial_density(), 25.);
    EXPECT_NEAR(body.model->parts[0].material->longitudinal_wave_speed(), 0.2, 1e-14);
    EXPECT_NEAR(courant_limit(*body.model).time_step, 5. * courant_limit(*plain.model).time_step,
                1e-12);
    EXPECT_NEAR(body.estimator->estimate(*body.model).time_step,
                5. * plain.estimator->estimate(*plain.model).time_step, 1e-10);
    EXPECT_NEAR(sum_of_nodes(body.model->state.mass), 25. * 24., 1e-9);
    EXPECT_NEAR(sum_of_nodes(body.model->body_mass()), 24., 1e-10);
    EXPECT_EQ(plain.model->find_process<MassScaling<3>>(), nullptr);
    EXPECT_EQ(&plain.model->body_mass(), &plain.model->state.mass);
    const auto masses = body.model->find_process<MassScaling<3>>()->masses(*body.model);
    EXPECT_NEAR(masses.true_mass, 24., 1e-10);
    EXPECT_NEAR(masses.added, 72., 1e-9);
  }
}

TEST(Scaling, mass_of_thin_elements_grows_to_the_target_by_as_much_as_it_takes)
{
  const double target = 0.8;
  double added = 0;
  for (std::size_t c = 0; c + 1 < layers.size(); ++c)
    added += 4. * needed(layers[c + 1] - layers[c], target, layers[c + 1] - layers[c]);
  for (const char *const kind : {"hexahedron", "fully integrated hexahedron"})
  {
    SCOPED_TRACE(kind);
    FrozenBody<3> body(scaled(layered(kind), "set Target time step = 0.8"));
    EXPECT_NEAR(courant_limit(*body.model).time_step, target, 1e-12);
    EXPECT_NEAR(body.model->find_process<MassScaling<3>>()->masses(*body.model).added, added,
                1e-10);
    const auto extent = body.model->find_process<MassScaling<3>>()->extent(*body.model);
    EXPECT_EQ(extent.cells, 5u * 4u);
    EXPECT_EQ(extent.particles, 0u);
    EXPECT_NEAR(extent.smallest_step, 0.25, 1e-12);
    // The mass is where the thin cells are.
    for (unsigned int i = 0; i < body.model->state.partition()->n_owned(); ++i)
    {
      const double x = body.model->state.initial_position.node(i)[0];
      const double here = *body.model->state.mass.node(i) / *body.model->body_mass().node(i);
      if (x < 1.5 || x > 4.)
        EXPECT_DOUBLE_EQ(here, 1.);
      else
        EXPECT_GT(here, 1.5);
    }
  }
}

TEST(Scaling, mass_of_particles_with_narrow_supports_grows_to_the_target)
{
  const double target = 1.44;
  double added = 0;
  unsigned long n = 0;
  for (std::size_t k = 0; k < layers.size(); ++k)
  {
    const double left = k > 0 ? layers[k] - layers[k - 1] : 0.;
    const double right = k + 1 < layers.size() ? layers[k + 1] - layers[k] : 0.;
    const double extra = 4. * needed(1.8 * std::max(left, right), target, 0.5 * (left + right));
    added += extra;
    n += extra > 0. ? 9 : 0;
  }
  FrozenBody<3> body(scaled(layered("particles"), "set Target time step = 1.44"));
  EXPECT_NEAR(courant_limit(*body.model).time_step, target, 1e-12);
  EXPECT_NEAR(body.model->find_process<MassScaling<3>>()->masses(*body.model).added, added, 1e-9);
  EXPECT_EQ(body.model->find_process<MassScaling<3>>()->extent(*body.model).particles, n);
}

TEST(Scaling, the_mesh_is_stable_at_the_target_of_its_elements)
{
  FrozenBody<3> plain(layered("fully integrated hexahedron", 0.));
  EXPECT_LT(plain.limit_by_eigenvalues(), 0.5);
  FrozenBody<3> body(
      scaled(layered("fully integrated hexahedron", 0.), "set Target time step = 0.8"));
  EXPECT_GE(body.limit_by_eigenvalues(), 0.8 * (1. - 1e-9));
}

TEST(Scaling, the_spectral_step_is_that_of_the_scaled_masses)
{
  for (const std::string &kind : all_kinds)
    for (const char *const bridge : {"paper", "trace"})
    {
      if (kind != "coupled" && std::string(bridge) == "trace")
        continue;
      if (kind == "lagrange hexahedron") // too many nodes for matrices
        continue;
      SCOPED_TRACE(kind + " " + bridge);
      const std::string text =
          changed(layered(kind), "set Bridge = paper", std::string("set Bridge = ") + bridge);
      FrozenBody<3> plain(text);
      FrozenBody<3> body(scaled(text,
                                "set Target time step = 2.3\nset Mass factor = 2\nset Process time "
                                "factor = 2"));
      const double limit = body.limit_by_eigenvalues();
      const double estimate = body.estimator->estimate(*body.model).time_step;
      EXPECT_GE(estimate / limit, 0.98);
      EXPECT_LE(estimate / limit, 1.00);
      // The limit of particles is far above the length of narrow supports over the wave speed.
      EXPECT_GT(limit / std::sqrt(8.),
                (kind == "particles" ? 1. : 1.2) * plain.limit_by_eigenvalues());
    }
}

TEST(Scaling, weight_and_heat_capacity_are_those_of_the_true_mass)
{
  for (const std::string &kind : all_kinds)
  {
    SCOPED_TRACE(kind);
    const std::string text =
        changed(layered(kind), "subsection Material: m\n",
                "subsection Material: m\nsubsection Heat\nset Specific heat capacity = 7\nset "
                "Conductivity = 1\nset Initial temperature = 0\nend\n") +
        "set Conditions = g\nsubsection Condition: g\nset Type = body force\nset "
        "Function = 0; 0; -3\nend\n";
    FrozenBody<3> body(scaled(text, "set Target time step = 0.8\nset Mass factor = 1.5"));
    MechanicalStep<3> step(*body.model);
    step.evaluate(Clock());
    EXPECT_NEAR(sum_of_nodes(body.model->find_process<Loads<3>>()->action().given(), 2), -3. * 22.,
                1e-9);
    EXPECT_NEAR(sum_of_nodes(body.model->heat->bridge.mass()), 7. * 22., 1e-9);
    EXPECT_GT(sum_of_nodes(body.model->state.mass), 1.5 * 22. + 0.5);
  }
}

TEST(Scaling, mass_is_added_as_cells_shrink_and_never_taken_away_and_is_booked)
{
  for (const std::string &kind : all_kinds)
  {
    SCOPED_TRACE(kind);
    FrozenBody<3> body(
        scaled(layered(kind), "set Target time step = 0.9\nset Interval = 7\nset Mass factor = 2"));
    Model<3> &model = *body.model;
    NodalState &state = model.state;
    for (unsigned int i = 0; i < state.partition()->n_local(); ++i)
    {
      const double *const x = state.initial_position.node(i);
      double *const v = state.unsmoothed_velocity.node(i);
      v[0] = 1. + 0.3 * x[1];
      v[1] = -2. + 0.1 * x[0] * x[2];
      v[2] = 0.5 * x[1];
      for (unsigned int d = 0; d < 3; ++d)
        state.position.node(i)[d] = (d == 0 ? 0.5 : 1.) * x[d];
    }
    if (state.unsmoothed_position.partition() != nullptr)
      state.unsmoothed_position.copy_from(state.position);
    if (kind == "particles" || kind == "coupled")
      for (Part<3> &part : model.parts)
        if (part.particles != nullptr)
          part.particles->stencils().inverse_deformation_is_current = false;
    EnergyLedger ledger;
    const Clock clock;
    ledger.balance(model, clock);

    auto &scaling = *model.find_process<MassScaling<3>>();
    const auto raise_masses = [&](const unsigned long step)
    {
      Clock at_step;
      at_step.step = step;
      return scaling.change_model(model, at_step).masses;
    };
    EXPECT_LT(courant_limit(model).time_step, 0.9 - 0.05);
    EXPECT_FALSE(raise_masses(0));
    EXPECT_FALSE(raise_masses(8));
    NodalVector before(state.partition(), Quantity::scalar);
    before.copy_from(model.bridge->mass());
    const double mass_before = sum_of_nodes(state.mass);
    EXPECT_TRUE(raise_masses(14));
    EXPECT_NEAR(courant_limit(model).time_step, 0.9, 1e-12);
    const double mass_after = sum_of_nodes(state.mass);
    EXPECT_GT(mass_after, mass_before + 1.);
    EXPECT_FALSE(raise_masses(21));

    double energy = 0;
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
    {
      const double *const v = state.unsmoothed_velocity.node(i);
      energy += 0.5 * (*model.bridge->mass().node(i) - *before.node(i)) *
                (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
    energy = dealii::Utilities::MPI::sum(energy, MPI_COMM_WORLD);
    const EnergyBalance balance = ledger.balance(model, clock);
    EXPECT_NEAR(balance.energies["mass scaling work"], energy, 1e-10 * energy);
    EXPECT_GT(energy, 1.);
    EXPECT_LT(std::abs(balance.error), 1e-13);
    EXPECT_LT(balance.momentum_drift, 1e-13);
    EXPECT_LT(balance.angular_momentum_drift, 1e-13);

    state.position.copy_from(state.initial_position);
    EXPECT_FALSE(raise_masses(28));
    EXPECT_EQ(sum_of_nodes(state.mass), mass_after);
  }
}
