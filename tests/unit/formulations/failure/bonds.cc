// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
// Bonds break at both of their ends, on whichever ranks these are, and what remains is sound.

#include <gtest/gtest.h>

#include "smoothing_identities.h"
#include "torn_plate.h"

#include <array>
#include <cmath>
#include <string>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  bool crosses(const std::array<Body::Site, 2> &pair, const long left)
  {
    return (pair[0][0] <= left) != (pair[1][0] <= left);
  }

  /** Breaks all bonds between the columns x = 3 and x = 4, and no other. */
  void tear(Body &body)
  {
    body.set_stress([](const Body::Site &site) { return site[0] == 3 || site[0] == 4 ? 1. : 0.; });
    body.stretch(1.1, 1.);
    EXPECT_TRUE(body.model->update_stencils().stencils);
  }

  /** Rows reproduce constants, those with a basis linear functions of @p position too. */
  void check_rows(Body &body, const NodalVector &position)
  {
    const Stencils &shape = body.shape();
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      const double *const own = position.node(shape.particle_node[i]);
      double sum = 0, first[2] = {}, slope[2] = {}, deformation[2][2] = {};
      for (unsigned int k = 0; k < row.size; ++k)
      {
        sum += row.value[k];
        for (unsigned int a = 0; a < 2; ++a)
        {
          const double offset = position.node(row.neighbour[k])[a] - own[a];
          first[a] += row.value[k] * offset;
          slope[a] += row.gradient[3 * k + a];
          for (unsigned int b = 0; b < 2; ++b)
            deformation[a][b] += offset * row.gradient[3 * k + b];
        }
      }
      EXPECT_NEAR(sum, 1., 1e-13);
      for (unsigned int a = 0; a < 2; ++a)
      {
        EXPECT_NEAR(slope[a], 0., 1e-12);
        for (unsigned int b = 0; b < 2; ++b)
          EXPECT_NEAR(deformation[a][b], a == b && !shape.is_rigid(i) ? 1. : 0., 1e-12);
        if (!shape.is_rigid(i))
        {
          EXPECT_NEAR(first[a], 0., 1e-12);
        }
      }
    }
  }
} // namespace

TEST(Bonds, nothing_breaks_that_is_not_stretched_or_not_stressed)
{
  Body body;
  const auto before = body.pairs();
  body.set_stress([](const Body::Site &) { return 1.; });
  EXPECT_FALSE(body.model->update_stencils().stencils);
  body.set_stress([](const Body::Site &) { return 0.89; });
  body.stretch(1.1, 1.1);
  EXPECT_FALSE(body.model->update_stencils().stencils);
  EXPECT_EQ(body.pairs(), before);
  EXPECT_EQ(body.counts().n_broken, 0.);
}

TEST(Bonds, break_at_both_ends_and_separate_two_bodies)
{
  Body body;
  const auto before = body.pairs();
  tear(body);
  const auto after = body.pairs();
  for (const auto &pair : before)
    EXPECT_EQ(after.count(pair), crosses(pair, 3) ? 0u : 1u);
  for (const auto &pair : after)
    EXPECT_EQ(after.count({{pair[1], pair[0]}}), 1u);
  // Five pairs straight across, four each way aslant.
  EXPECT_EQ(body.counts().n_broken, 13.);
  EXPECT_EQ(body.counts().n_debris, 0u);
  check_rows(body, body.model->state.initial_position);
  // Once is for good: nothing is left to break.
  EXPECT_FALSE(body.model->update_stencils().stencils);

  // The fraction that output shows; a particle on the edge had five bonds, and has lost two.
  const MaterialPoints &points = body.part().formulation->points();
  const double *const fraction = points.component(points.find_field("broken bonds"), 0);
  for (unsigned int i = 0; i < body.shape().n_particles(); ++i)
  {
    const Body::Site site = body.site_of(body.shape().particle_node[i]);
    const bool is_torn = site[0] == 3 || site[0] == 4, is_edge = site[1] % 4 == 0;
    EXPECT_NEAR(fraction[i], !is_torn ? 0. : is_edge ? 2. / 5. : 3. / 8., 1e-15);
  }
}

TEST(Bonds, break_at_the_end_that_does_not_see_the_other_too)
{
  // Spacings of 2 and 1: the wide supports of x = 2 reach x = 5, but not the other way.
  Plate plate;
  plate.cells = "2 to 4 | 3 to 7; 4";
  Body body(plate);
  const auto before = body.pairs();
  EXPECT_EQ(before.count({{{{5, 2}}, {{2, 2}}}}), 1u);
  EXPECT_EQ(before.count({{{{2, 2}}, {{5, 2}}}}), 0u);
  body.set_stress([](const Body::Site &site) { return site[0] == 2 || site[0] == 5 ? 1. : 0.; });
  body.stretch(1.1, 1.);
  EXPECT_TRUE(body.model->update_stencils().stencils);
  EXPECT_EQ(body.pairs().count({{{{5, 2}}, {{2, 2}}}}), 0u);
  // Each end has its half of them.
  EXPECT_EQ(body.counts().n_broken, 13.);
}

TEST(Bonds, leave_smoothing_adjoint_and_momentum_kept)
{
  for (const std::string smoothing : {"paper", "fe matched", "affine"})
    for (const std::string bridge : {"", "paper", "trace"})
    {
      Plate plate;
      plate.smoothing = smoothing;
      plate.bridge = bridge;
      Body body(plate);
      // In the coupled plate the crack runs along the interface, through rows of shared nodes.
      if (bridge.empty())
        tear(body);
      else
      {
        body.set_stress([](const Body::Site &site) { return site[0] <= 3 ? 1. : 0.; });
        body.stretch(1.1, 1.);
        EXPECT_TRUE(body.model->update_stencils().stencils);
        EXPECT_EQ(body.counts().n_broken, 13.);
      }
      Model<2> &model = *body.model;
      const NodalVector v = disordered_field(model, 1.), v_hat = disordered_field(model, 5.);
      expect_adjoint_smoothing(model, v, v_hat);
      // Momentum; the affine smoothing keeps it after affine deformations, such as this one.
      const NodalVector one = vector_field(model, [](const double *, const unsigned int d)
                                           { return d == 0 ? 1. : 0.; });
      NodalVector smoothed(model.state.partition());
      model.bridge->apply_smoothing(v_hat, smoothed);
      const double scale = std::sqrt(weighted_product(model.bridge->mass(), v, v) *
                                     weighted_product(model.bridge->mass(), v_hat, v_hat));
      EXPECT_NEAR(weighted_product(model.bridge->nodal_mass(), one, smoothed) / scale,
                  weighted_product(model.bridge->mass(), one, v_hat) / scale, 1e-13);
      EXPECT_NEAR(weighted_product(model.bridge->nodal_mass(), one, one),
                  weighted_product(model.bridge->mass(), one, one), 1e-12);
      model.bridge->apply_smoothing(one, smoothed);
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        EXPECT_NEAR(smoothed.node(i)[0], 1., 1e-13);
    }
}

TEST(Bonds, a_particle_that_loses_all_is_debris_and_books_its_energy)
{
  Body body;
  const Body::Site alone{{5, 2}};
  body.set_stress([&](const Body::Site &site) { return site == alone ? 2. : 0.; });
  const double elastic = body.energies()["elastic energy"];
  // Of uniaxial stress.
  EXPECT_NEAR(elastic, 0.5 * 4. / young, 1e-14);
  body.stretch(1.1, 1.1);
  EXPECT_TRUE(body.model->update_stencils().stencils);
  EXPECT_EQ(body.counts().n_broken, 8.);
  EXPECT_EQ(body.counts().n_debris, 1u);
  for (const auto &pair : body.pairs())
    EXPECT_TRUE(pair[0] != alone && pair[1] != alone);
  EXPECT_NEAR(body.energies()["failure dissipation"], elastic, 1e-14);
  EXPECT_EQ(body.energies()["elastic energy"], 0.);
  check_rows(body, body.model->state.initial_position);

  // It keeps its mass, and flies on without any force.
  NodalState &state = body.model->state;
  const auto is_alone = [&](const unsigned int i) { return body.site_of(i) == alone; };
  state.unsmoothed_velocity.fill(
      [&](const unsigned int i, double *const v)
      {
        for (unsigned int d = 0; d < 2; ++d)
          v[d] = is_alone(i) ? 0.5 + d : 0.1 * std::sin(7. * i + d);
      });
  const double time = body.run(20);
  for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
    if (is_alone(i))
    {
      EXPECT_NEAR(body.model->bridge->nodal_mass().node(i)[0], 1., 1e-14);
      for (unsigned int d = 0; d < 2; ++d)
      {
        EXPECT_NEAR(state.unsmoothed_velocity.node(i)[d], 0.5 + d, 1e-14);
        EXPECT_NEAR(state.position.node(i)[d],
                    1.1 * static_cast<double>(alone[d]) + (0.5 + d) * time, 1e-13);
      }
    }
}

TEST(Bonds, a_line_of_particles_is_debris_that_hangs_together)
{
  Body body;
  body.set_stress([](const Body::Site &site) { return site[0] == 3 ? 2. : 0.; });
  body.stretch(1.1, 1.);
  EXPECT_TRUE(body.model->update_stencils().stencils);
  EXPECT_EQ(body.counts().n_broken, 26.);
  EXPECT_EQ(body.counts().n_debris, 5u);
  const auto pairs = body.pairs();
  EXPECT_EQ(pairs.count({{{{3, 1}}, {{3, 2}}}}), 1u);
  for (const auto &pair : pairs)
    EXPECT_FALSE(crosses(pair, 3) || crosses(pair, 2));
  check_rows(body, body.model->state.initial_position);
  EXPECT_EQ(body.energies()["elastic energy"], 0.);
}

TEST(Bonds, a_particle_that_others_leave_or_turn_inside_out_loses_the_rest)
{
  // Its neighbours on the right are gone; then those on the left pass to the other side.
  for (const bool is_crossed : {false, true})
  {
    Body body;
    tear(body);
    const std::array<double, 2> site{{3., 2.}};
    body.set_stress([](const Body::Site &) { return 0.5; });
    body.move(
        [&](const Point<2> &from)
        {
          return from[0] == site[0] && from[1] == site[1]
                     ? Point<2>(from[0] - (is_crossed ? 1.5 : 0.3), from[1])
                     : from;
        });
    // Closer by a third is not too much for it.
    EXPECT_EQ(body.model->update_stencils().stencils, is_crossed);
    EXPECT_EQ(body.counts().n_debris, is_crossed ? 1u : 0u);
    EXPECT_EQ(body.counts().n_broken, is_crossed ? 13. + 5. : 13.);
    for (const auto &pair : body.pairs())
      EXPECT_FALSE(is_crossed && (pair[0] == Body::Site{{3, 2}} || pair[1] == Body::Site{{3, 2}}));
    check_rows(body, body.model->state.initial_position);
    EXPECT_NEAR(body.energies()["failure dissipation"], is_crossed ? 0.5 * 0.25 / young : 0.,
                1e-14);
  }
}

TEST(Bonds, stay_broken_when_the_kernel_is_renewed_and_bodies_meet_again)
{
  Plate plate;
  plate.options = "set Configuration = updated Lagrangian\nset Rebuild interval = 2";
  Body body(plate);
  tear(body); // the first step
  EXPECT_EQ(body.counts().n_broken, 13.);
  // Back, and into each other: the columns 3 and 5 come within the support of each other.
  body.set_stress([](const Body::Site &) { return 0.; });
  body.move([](const Point<2> &from)
            { return Point<2>(from[0] > 3.5 ? from[0] - 0.7 : from[0], from[1]); });
  EXPECT_TRUE(body.model->update_stencils().stencils);
  for (unsigned int n = 0; n < 4; ++n)
  {
    for (const auto &pair : body.pairs())
      EXPECT_FALSE(crosses(pair, 3));
    check_rows(body, body.model->state.position);
    body.model->update_stencils();
  }
  EXPECT_EQ(body.counts().n_broken, 13.);
}

TEST(Bonds, do_not_form_across_a_crack_among_those_that_were_near_all_along)
{
  Plate plate;
  // Sites two apart are not in the support, but within the skin that searches add to it.
  plate.options = "set Configuration = current\nset Dilation = 1.9";
  Body body(plate);
  tear(body);
  EXPECT_EQ(body.counts().n_broken, 13.);
  body.set_stress([](const Body::Site &) { return 0.; });
  // The columns 3 and 5, and 2 and 4, were not within the support of each other, and come there by
  // steps so small that no search is needed.
  const std::set<std::array<Body::Site, 2>> before = body.pairs();
  for (unsigned int n = 1; n <= 8; ++n)
  {
    body.move([&](const Point<2> &from)
              { return Point<2>(from[0] > 3.5 ? from[0] - 0.1 * n : from[0], from[1]); });
    EXPECT_TRUE(body.model->update_stencils().stencils);
    for (const auto &pair : body.pairs())
    {
      EXPECT_FALSE(crosses(pair, 3));
      EXPECT_EQ(before.count(pair), 1u);
    }
    check_rows(body, body.model->state.position);
  }
  EXPECT_EQ(body.counts().n_broken, 13.);
}

TEST(Bonds, of_images_break_as_those_of_the_whole_body)
{
  // A crack beside the plane of symmetry x = 0, in bonds of the row x = 1 to its own images too.
  Plate half;
  half.options = "set Dilation = 2.5";
  half.conditions = "set Conditions = plane\nsubsection Condition: plane\nset Type = symmetry\n"
                    "set Where = x < 1e-9\nend\n";
  Plate whole = half;
  whole.conditions = "";
  whole.lower = "-7, 0";
  whole.cells = "14, 4";
  Body a(half), b(whole);
  for (Body *body : {&a, &b})
  {
    // No pair of x = 1 with x = 2 breaks: their mean is below the limit.
    body->set_stress([](const Body::Site &site) { return std::abs(site[0]) <= 1 ? 1. : 0.; });
    body->stretch(1.1, 1.);
    EXPECT_TRUE(body->model->update_stencils().stencils);
  }
  const auto half_pairs = a.pairs(), whole_pairs = b.pairs();
  for (const auto &pair : whole_pairs)
    if (pair[0][0] >= 0)
    {
      EXPECT_EQ(half_pairs.count(pair), 1u);
    }
  for (const auto &pair : half_pairs)
    EXPECT_EQ(whole_pairs.count(pair), 1u);
  EXPECT_GT(a.counts().n_broken, 0.);
}

TEST(Bonds, of_any_particle_that_is_turned_inside_out_break_where_it_is_wanted)
{
  for (const std::string configuration :
       {"total Lagrangian", "updated Lagrangian\nset Rebuild interval = 1"})
    for (const bool isolates_all : {false, true})
    {
      SCOPED_TRACE(configuration + (isolates_all ? ", all" : ", with broken bonds"));
      Plate plate;
      plate.options = "set Configuration = " + configuration +
                      "\nset Isolate distorted = " + (isolates_all ? "all" : "with broken bonds");
      Body body(plate);
      body.move([](const Point<2> &from)
                { return from[0] > 6.9 && from[1] > 3.9 ? Point<2>(5.4, 2.4) : from; });
      if (!isolates_all)
      {
        EXPECT_EQ(body.counts().n_debris, 0u);
        if (configuration == "total Lagrangian")
        {
          EXPECT_FALSE(body.model->update_stencils().stencils);
        }
        continue;
      }
      EXPECT_TRUE(body.model->update_stencils().stencils);
      EXPECT_GE(body.counts().n_debris, 1u);
      EXPECT_LE(body.counts().n_debris, 4u);
      for (const auto &pair : body.pairs())
        EXPECT_NE(pair[0], (Body::Site{{7, 4}}));
    }
}
