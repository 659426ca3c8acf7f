// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
// Particles that become debris have the velocity and the temperature of the body afterwards. The
// rest of their own momentum and heat stays with those that they were bonded to.

#include <gtest/gtest.h>

#include "torn_plate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  using Sites = std::set<Body::Site>;

  const Sites one = {{{5, 2}}};
  const Sites pair_beside_elements = {{{3, 1}}, {{3, 2}}};
  const Sites corner = {{{7, 4}}};
  const Sites block = {{{4, 1}}, {{4, 2}}, {{4, 3}}, {{5, 1}}, {{5, 2}},
                       {{5, 3}}, {{6, 1}}, {{6, 2}}, {{6, 3}}};

  /** Symmetric about x = 0, and without any order otherwise. */
  double noise(const double *x, const unsigned int seed)
  {
    return std::sin(91.7 * std::abs(x[0]) + 57.3 * x[1] + 17. * seed);
  }

  void set_fields(Body &body)
  {
    Model<2> &model = *body.model;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double *const x = model.state.initial_position.node(i);
      double *const v_hat = model.state.unsmoothed_velocity.node(i);
      v_hat[0] = 0.02 * x[0] * noise(x, 0);
      v_hat[1] = 0.05 * noise(x, 1);
      if (!model.heat)
        continue;
      ThermalState &heat = model.heat->state;
      *heat.unsmoothed_temperature.node(i) = 500. + 300. * noise(x, 2);
      *heat.next_unsmoothed_temperature.node(i) = 600. + 200. * noise(x, 3);
      *heat.enthalpy.node(i) =
          model.heat->nodal_enthalpy.enthalpy(i, *heat.unsmoothed_temperature.node(i));
      *heat.next_enthalpy.node(i) =
          model.heat->nodal_enthalpy.enthalpy(i, *heat.next_unsmoothed_temperature.node(i));
    }
    model.state.unsmoothed_velocity.update_ghosts();
    if (!model.heat)
      return;
    ThermalState &heat = model.heat->state;
    model.heat->find_field(heat.next_unsmoothed_temperature, heat.next_temperature);
    model.heat->find_field_of_state();
  }

  /** Breaks all bonds of these particles in one step. */
  void blast(Body &body, const Sites &sites)
  {
    body.set_stress(
        [&](const Body::Site &site) {
          return sites.count({{std::abs(site[0]), site[1]}}) > 0 ? 2. : 0.;
        });
    body.stretch(1.1, 1.1);
    EXPECT_TRUE(body.model->update_stencils().stencils);
  }

  struct Totals
  {
    double momentum[2] = {}, heat[2] = {};
    double energy = 0, kinetic = 0;
    double momentum_scale = 0, heat_scale = 0;
  };

  Totals totals(Body &body)
  {
    const Model<2> &model = *body.model;
    Totals result;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      for (unsigned int d = 0; d < 2; ++d)
      {
        const double momentum =
            *model.bridge->mass().node(i) * model.state.unsmoothed_velocity.node(i)[d];
        result.momentum[d] += momentum;
        result.momentum_scale += std::abs(momentum);
      }
      if (!model.heat)
        continue;
      result.heat[0] += *model.heat->state.enthalpy.node(i);
      result.heat[1] += *model.heat->state.next_enthalpy.node(i);
      result.heat_scale += std::abs(*model.heat->state.enthalpy.node(i));
    }
    for (double *value : {&result.momentum[0], &result.momentum[1], &result.heat[0],
                          &result.heat[1], &result.momentum_scale, &result.heat_scale})
      *value = Utilities::MPI::sum(*value, MPI_COMM_WORLD);
    result.kinetic = model.bridge->kinetic_energy(model.state.unsmoothed_velocity);
    const EnergyAccounts energies = body.energies();
    result.energy = result.kinetic + energies["elastic energy"] + energies["failure dissipation"];
    return result;
  }

  /** Velocity, temperature and next temperature of all nodes of all ranks. */
  std::map<Body::Site, std::array<double, 4>> fields(Body &body, const NodalVector &velocity,
                                                     const NodalVector &temperature,
                                                     const NodalVector &next_temperature)
  {
    std::map<Body::Site, std::array<double, 4>> own, all;
    for (unsigned int i = 0; i < velocity.partition()->n_owned(); ++i)
      own[body.site_of(i)] = {{velocity.node(i)[0], velocity.node(i)[1], *temperature.node(i),
                               *next_temperature.node(i)}};
    for (const auto &rank_fields : Utilities::MPI::all_gather(MPI_COMM_WORLD, own))
      all.insert(rank_fields.begin(), rank_fields.end());
    return all;
  }

  std::map<Body::Site, std::array<double, 4>> own_fields(Body &body)
  {
    const ThermalState &heat = body.model->heat->state;
    return fields(body, body.model->state.unsmoothed_velocity, heat.unsmoothed_temperature,
                  heat.next_unsmoothed_temperature);
  }

  /** Those that belong to the motion of positions, and to the field θ^h. */
  std::map<Body::Site, std::array<double, 4>> smoothed_fields(Body &body)
  {
    Model<2> &model = *body.model;
    NodalVector smoothed(model.state.partition()), moving(model.state.partition());
    model.bridge->apply_smoothing(model.state.unsmoothed_velocity, smoothed);
    if (model.bridge->smoothing().affine || !model.bridge->smoothing().is_active)
      moving.copy_from(smoothed);
    else
      model.bridge->apply_interpolation(smoothed, moving);
    return fields(body, moving, model.heat->state.temperature, model.heat->state.next_temperature);
  }
} // namespace

TEST(Debris, takes_the_smoothed_fields_along_and_leaves_the_rest)
{
  for (const std::string smoothing : {"paper", "fe matched", "affine", "none"})
    for (const std::string bridge : {"", "paper", "trace"})
      for (const Sites &sites : {one, pair_beside_elements, corner, block})
      {
        if (smoothing == "none" && !bridge.empty())
          continue;
        SCOPED_TRACE(smoothing + " " + bridge + " " + std::to_string(sites.size()));
        Plate plate;
        plate.smoothing = smoothing;
        plate.bridge = bridge;
        plate.has_heat = true;
        Body body(plate);
        set_fields(body);
        const auto raw = own_fields(body), expected = smoothed_fields(body);
        // Of which blast() loses the energy.
        body.set_stress([&](const Body::Site &site) { return sites.count(site) > 0 ? 2. : 0.; });
        const Totals before = totals(body);
        blast(body, sites);
        // Without the block, others have too few neighbours to stay.
        if (sites.size() < block.size())
        {
          EXPECT_EQ(body.counts().n_debris, sites.size());
        }
        EXPECT_GE(body.counts().n_debris, sites.size());
        const Totals after = totals(body);
        for (unsigned int d = 0; d < 2; ++d)
        {
          EXPECT_NEAR(after.momentum[d], before.momentum[d], 1e-13 * before.momentum_scale);
          EXPECT_NEAR(after.heat[d], before.heat[d], 1e-13 * before.heat_scale);
        }
        EXPECT_NEAR(after.energy, before.energy, 1e-13 * before.energy);

        const auto now = own_fields(body);
        double largest_change = 0, other_changes = 0;
        for (const auto &[site, values] : now)
          for (unsigned int c = 0; c < 4; ++c)
          {
            const double scale = c < 2 ? 0.1 : 1000.;
            const double change = std::abs(values[c] - raw.at(site)[c]) / scale;
            if (sites.count(site) == 0)
              other_changes = std::max(other_changes, change);
            else
            {
              largest_change = std::max(largest_change, change);
              // The middle of the block has only debris around it.
              if (sites.size() < block.size())
              {
                EXPECT_NEAR(values[c] / scale, expected.at(site)[c] / scale, 1e-13);
              }
            }
          }
        if (smoothing != "none")
        {
          EXPECT_GT(largest_change, 1e-3);
          EXPECT_GT(other_changes, 1e-4);
        }
        else
        {
          EXPECT_EQ(other_changes, 0.);
        }
      }
}

TEST(Debris, flies_on_with_the_velocity_that_it_had_in_the_body)
{
  Plate plate;
  plate.smoothing = "paper";
  plate.has_heat = true;
  Body body(plate);
  set_fields(body);
  const auto expected = smoothed_fields(body).at({{5, 2}});
  body.set_stress([](const Body::Site &site) { return one.count(site) > 0 ? 2. : 0.; });
  body.stretch(1.1, 1.1);
  NodalState &state = body.model->state;
  const double time = body.run(20);
  EXPECT_EQ(body.counts().n_debris, 1u);
  for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
    if (one.count(body.site_of(i)) > 0)
      for (unsigned int d = 0; d < 2; ++d)
      {
        EXPECT_NEAR(state.unsmoothed_velocity.node(i)[d], expected[d], 1e-14);
        EXPECT_NEAR(state.position.node(i)[d],
                    1.1 * static_cast<double>(body.site_of(i)[d]) + expected[d] * time, 1e-13);
      }
}

TEST(Debris, leaves_prescribed_components_alone)
{
  Plate plate;
  plate.smoothing = "paper";
  plate.has_heat = true;
  plate.conditions = "set Conditions = clamp, bath\nsubsection Condition: clamp\n"
                     "set Type = velocity\nset Where = x > 6.9\nset Function = 0.3; free\nend\n"
                     "subsection Condition: bath\nset Type = temperature\nset Where = y > 3.9\n"
                     "set Function = 700\nend\n";
  Body body(plate);
  set_fields(body);
  for (unsigned int i = 0; i < body.model->state.partition()->n_owned(); ++i)
    if (body.site_of(i)[0] == 7)
      body.model->state.unsmoothed_velocity.node(i)[0] = 0.3;
  body.model->state.unsmoothed_velocity.update_ghosts();
  const auto before = own_fields(body);
  const Totals total = totals(body);
  blast(body, {{{6, 3}}, {{7, 2}}, {{2, 4}}});
  const auto after = own_fields(body);
  for (const auto &[site, values] : after)
  {
    if (site[0] == 7)
    {
      EXPECT_EQ(values[0], before.at(site)[0]);
    }
    if (site[1] == 4)
    {
      EXPECT_EQ(values[2], before.at(site)[2]);
      EXPECT_EQ(values[3], before.at(site)[3]);
    }
  }
  EXPECT_NE(after.at({{7, 2}})[1], before.at({{7, 2}})[1]);
  EXPECT_NE(after.at({{6, 3}})[2], before.at({{6, 3}})[2]);
  for (unsigned int d = 0; d < 2; ++d)
  {
    EXPECT_NEAR(totals(body).momentum[d], total.momentum[d], 1e-13 * total.momentum_scale);
    EXPECT_NEAR(totals(body).heat[d], total.heat[d], 1e-13 * total.heat_scale);
  }
}

TEST(Debris, of_half_a_body_is_that_of_the_whole)
{
  Plate half;
  half.smoothing = "fe matched";
  half.has_heat = true;
  half.conditions = "set Conditions = plane\nsubsection Condition: plane\nset Type = symmetry\n"
                    "set Where = x < 1e-9\nend\n";
  Plate whole = half;
  whole.conditions = "";
  whole.lower = "-7, 0";
  whole.cells = "14, 4";
  Body a(half), b(whole);
  for (Body *body : {&a, &b})
  {
    set_fields(*body);
    blast(*body, {{{0, 3}}, {{1, 1}}});
  }
  EXPECT_EQ(a.counts().n_debris, 2u);
  EXPECT_EQ(b.counts().n_debris, 3u);
  const auto half_fields = own_fields(a), whole_fields = own_fields(b);
  for (const auto &[site, values] : half_fields)
    for (unsigned int c = 0; c < 4; ++c)
    {
      const double scale = c < 2 ? 0.1 : 1000.;
      EXPECT_NEAR(values[c] / scale, whole_fields.at(site)[c] / scale, 1e-13);
    }
}
