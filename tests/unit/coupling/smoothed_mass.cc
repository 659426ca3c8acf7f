// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
// Nodes that would have no smoothed mass: rows that reduce it stop to extrapolate.

#include <tombolo/base/exceptions.h>

#include <gtest/gtest.h>

#include "torn_plate.h"

#include <algorithm>
#include <string>
#include <vector>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  const Body::Site light = {{4, 2}};

  /** Not shared, so that a test can change them. */
  Plate plate_with_rows_of_their_own(const std::string &smoothing,
                                     const std::string &further_options = "")
  {
    Plate plate;
    plate.smoothing = smoothing;
    plate.has_heat = true;
    plate.options = "set Configuration = updated Lagrangian\nset Rebuild interval = 1000000\n" +
                    further_options;
    return plate;
  }

  /** Rows of neighbours get a negative φ of one node, as one-sided neighbourhoods have it. Σφ = 1
   * holds. */
  void make_light(Body &body, const double phi = -0.2)
  {
    Stencils &shape = body.part().particles->stencils();
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      double *const value = shape.value.data() + shape.coefficient_start[i];
      const unsigned int own = shape.particle_node[i];
      const auto entry_of = [&](const unsigned int node)
      {
        return static_cast<std::size_t>(std::find(row.neighbour, row.neighbour + row.size, node) -
                                        row.neighbour);
      };
      for (unsigned int k = 0; k < row.size; ++k)
        if (body.site_of(row.neighbour[k]) == light && row.neighbour[k] != own)
        {
          value[entry_of(own)] += value[k] - phi;
          value[k] = phi;
        }
    }
  }

  std::vector<std::vector<double>> values(const Stencils &shape)
  {
    std::vector<std::vector<double>> result;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      result.emplace_back(shape.row(i).value, shape.row(i).value + shape.row(i).size);
    return result;
  }
} // namespace

TEST(SmoothedMass, stays_positive_where_rows_extrapolate)
{
  for (const std::string smoothing : {"paper", "fe matched", "affine"})
  {
    Body body(plate_with_rows_of_their_own(smoothing));
    Model<2> &model = *body.model;
    const Stencils &shape = body.shape();
    model.bridge->update_nodal_mass();
    EXPECT_FALSE(model.bridge->extract_change_of_rows());
    make_light(body);
    const auto before = values(shape);
    model.bridge->update_nodal_mass();
    EXPECT_TRUE(model.bridge->extract_change_of_rows());
    EXPECT_FALSE(model.bridge->extract_change_of_rows());

    const auto after = values(shape);
    unsigned int n_changed = 0;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      bool reduces_mass = false;
      double sum = 0;
      for (unsigned int k = 0; k < row.size; ++k)
      {
        reduces_mass =
            reduces_mass || (body.site_of(row.neighbour[k]) == light && before[i][k] < 0.);
        sum += after[i][k];
      }
      EXPECT_NEAR(sum, 1., 1e-14);
      if (!reduces_mass)
      {
        EXPECT_EQ(after[i], before[i]);
        continue;
      }
      ++n_changed;
      EXPECT_GE(*std::min_element(after[i].begin(), after[i].end()), 0.);
    }
    EXPECT_EQ(Utilities::MPI::sum(n_changed, MPI_COMM_WORLD), 8u);
    EXPECT_EQ(shape.non_negative_rows.size(), n_changed);

    // S 1 = 1 with its adjoint: linear momentum is kept.
    const NodalVector v = disordered_field(model, 1.), v_hat = disordered_field(model, 5.),
                      one = vector_field(model, [](const double *, unsigned int) { return 1.; });
    NodalVector smoothed(model.state.partition()), interpolated(model.state.partition());
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      EXPECT_GT(model.bridge->nodal_mass().node(i)[0], 0.01 * *model.bridge->mass().node(i));
    model.bridge->apply_smoothing(v_hat, smoothed);
    model.bridge->apply_adjoint(v, interpolated);
    EXPECT_NEAR(weighted_product(model.bridge->nodal_mass(), v, smoothed),
                weighted_product(model.bridge->mass(), interpolated, v_hat), 1e-12);
    model.bridge->apply_smoothing(one, smoothed);
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      EXPECT_NEAR(smoothed.node(i)[0], 1., 1e-13);
  }
}

TEST(SmoothedMass, the_smallest_share_can_be_chosen)
{
  for (const bool is_chosen : {false, true})
  {
    Body body(plate_with_rows_of_their_own("paper",
                                           is_chosen ? "set Smallest smoothed mass = 0.1\n" : ""));
    Model<2> &model = *body.model;
    const auto share_of_light = [&]()
    {
      model.bridge->update_nodal_mass();
      double share = 0;
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        if (body.site_of(i) == light)
          share = model.bridge->nodal_mass().node(i)[0] / *model.bridge->mass().node(i);
      return Utilities::MPI::sum(share, MPI_COMM_WORLD);
    };
    make_light(body, 0.);
    const double own = share_of_light();
    ASSERT_GT(own, 0.1);
    EXPECT_FALSE(model.bridge->extract_change_of_rows());
    // Eight neighbours leave half of the required share.
    make_light(body, (0.05 - own) / 8.);
    const double left = share_of_light();
    EXPECT_EQ(model.bridge->extract_change_of_rows(), is_chosen);
    if (is_chosen)
      EXPECT_GT(left, 0.1);
    else
      EXPECT_NEAR(left, 0.05, 1e-12);
  }
}

TEST(SmoothedMass, is_refused_at_the_start)
{
  Body body(plate_with_rows_of_their_own("paper"));
  make_light(body);
  Bridge bridge(body.part().particles->smoothing(), false);
  EXPECT_THROW(
      bridge.reinit(body.model->state.partition(),
                    {{&body.part().particles->stencils()}, body.model->element_mass, {}, {}, {}}),
      RunError);
}

TEST(SmoothedMass, rows_that_share_their_values_change_alone)
{
  for (const bool rounds : {false, true})
  {
    Body body;
    Stencils &shape = body.part().particles->stencils();
    if (rounds)
      shape.round();
    const auto before = values(shape);
    const auto with_negative = static_cast<std::size_t>(
        std::find_if(before.begin(), before.end(),
                     [](const std::vector<double> &row)
                     { return *std::min_element(row.begin(), row.end()) < 0.; }) -
        before.begin());
    // On the lattice corners extrapolate a little; not every rank has one.
    if (with_negative == before.size())
      return;
    const Stencils::Row old = shape.row(static_cast<unsigned int>(with_negative));
    const std::vector<double> old_gradient(old.gradient, old.gradient + 3 * old.size);
    shape.remove_negative_values(static_cast<unsigned int>(with_negative));
    const auto after = values(shape);
    for (std::size_t i = 0; i < after.size(); ++i)
      if (i != with_negative)
      {
        EXPECT_EQ(after[i], before[i]);
      }
    const Stencils::Row row = shape.row(static_cast<unsigned int>(with_negative));
    EXPECT_EQ(std::vector<double>(row.gradient, row.gradient + 3 * row.size), old_gradient);
    EXPECT_GE(*std::min_element(after[with_negative].begin(), after[with_negative].end()), 0.);
    if (!rounds)
    {
      EXPECT_EQ(shape.gradient.size(), 3 * shape.value.size() + 1);
    }
  }
}
