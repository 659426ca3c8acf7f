// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
// Fragments that rub and conduct, against values by hand.

#include <gtest/gtest.h>

#include "torn_plate.h"

#include <tombolo/physics/mechanics/fragment_contact.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  constexpr double spring_factor = 0.3, coefficient = 0.05;

  Plate rubbing_plate(const std::string &entries, const bool has_heat = false)
  {
    Plate plate;
    plate.has_heat = has_heat;
    plate.options = "set Self-contact = true\nset Self-contact damping = 0\n"
                    "set Self-contact stiffness = " +
                    std::to_string(spring_factor) + "\n" + entries;
    return plate;
  }

  double sum_of_all(const double share)
  {
    return Utilities::MPI::sum(share, MPI_COMM_WORLD);
  }

  /** k/μ of two particles; density and spacing are one. */
  double rate_squared()
  {
    return spring_factor * young * (1. - poisson) / (1. + poisson) / (1. - 2. * poisson);
  }

  /** Of particles on the facing edges of the halves: 1, and ½ at the corners. */
  double facing_volume(const long y)
  {
    return y == 0 || y == 4 ? 0.5 : 1.;
  }

  /** Two halves, x <= 3 and x >= 4, which touch across the gap. */
  class Halves
  {
  public:
    explicit Halves(const Plate &plate) : body(plate)
    {
      body.set_stress([](const Body::Site &site)
                      { return site[0] == 3 || site[0] == 4 ? 1. : 0.; });
      process = body.model->find_process<FragmentContact<2>>();
      place(1.1, 0.);
      evaluate();
      body.set_stress([](const Body::Site &) { return 0.; });
    }

    /** Puts the right half @p gap from the left one and @p slide along it, all turned. */
    void place(const double gap, const double slide, const double angle = 0.)
    {
      body.move(
          [&](const Point<2> &from)
          {
            const Point<2> to =
                from[0] > 3.5 ? Point<2>(from[0] + gap - 1., from[1] + slide) : from;
            return Point<2>(std::cos(angle) * to[0] - std::sin(angle) * to[1],
                            std::sin(angle) * to[0] + std::cos(angle) * to[1]);
          });
    }

    void evaluate()
    {
      body.model->update_stencils();
      force.reinit(body.model->state.partition());
      process->act(*body.model, clock, force);
    }

    /** Force and moment about the origin, of the right half or of all. */
    std::array<double, 3> resultant(const bool both_halves = false)
    {
      std::array<double, 3> sum{};
      const NodalState &state = body.model->state;
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        if (both_halves || state.initial_position.node(i)[0] > 3.5)
        {
          const double *const x = state.position.node(i), *const f = force.node(i);
          sum[0] += f[0];
          sum[1] += f[1];
          sum[2] += x[0] * f[1] - x[1] * f[0];
        }
      for (double &component : sum)
        component = sum_of_all(component);
      return sum;
    }

    double energy(const std::string &name)
    {
      return sum_of_all(body.part().formulation->energies()[name]);
    }

    /** Present temperatures by site. */
    void heat_up(const std::function<double(const Body::Site &)> &temperature)
    {
      for (unsigned int i = 0; i < body.model->state.partition()->n_owned(); ++i)
        *body.model->heat->state.present_temperature.node(i) = temperature(body.site_of(i));
    }

    /** What has come to the nodes since the last call. */
    NodalVector extract_heat()
    {
      NodalVector heat;
      heat.reinit_like(body.model->heat->state.pending);
      std::swap(heat, body.model->heat->state.pending);
      return heat;
    }

    Body body;
    Clock clock;
    FragmentContact<2> *process;
    NodalVector force;
  };

  /** The sum over the five pairs of springs along the normal. */
  double normal_force(const double overlap_between_halves)
  {
    double result = 0;
    for (long y = 0; y <= 4; ++y)
    {
      const double v = facing_volume(y);
      result += 0.5 * v * rate_squared() * (std::sqrt(v) - 1. + overlap_between_halves);
    }
    return result;
  }
} // namespace

TEST(FragmentFriction, is_a_spring_that_slips_at_coulombs_limit)
{
  Halves halves(rubbing_plate("set Self-contact friction = " + std::to_string(coefficient)));
  constexpr double overlap = 0.4;
  halves.place(1. - overlap, 0.);
  halves.evaluate();
  const std::array<double, 3> pressed = halves.resultant();
  EXPECT_NEAR(pressed[0], normal_force(overlap), 1e-13);
  EXPECT_NEAR(pressed[1], 0., 1e-14);

  // Normals stay along x to first order: a slide of 1e-6 sticks.
  constexpr double tiny = 1e-6;
  halves.place(1. - overlap, tiny);
  halves.evaluate();
  double stiffness = 0;
  for (long y = 0; y <= 4; ++y)
    stiffness += 0.5 * 0.5 * facing_volume(y) * rate_squared();
  EXPECT_NEAR(halves.resultant()[1] / tiny, -stiffness + normal_force(overlap) / (1. - overlap),
              1e-6);
  EXPECT_NEAR(halves.energy("self-contact friction"), 0., 1e-20);

  // Far enough all slip: the friction of each pair is μ times its normal force, along its tangent.
  constexpr double slide = 0.1;
  for (int n = 1; n <= 100; ++n)
  {
    halves.place(1. - overlap, slide * n / 100.);
    halves.evaluate();
  }
  const double r = std::hypot(1. - overlap, slide);
  const double normal[2] = {(1. - overlap) / r, slide / r};
  std::array<double, 2> expected{};
  for (long y = 0; y <= 4; ++y)
  {
    const double v = facing_volume(y);
    const double push = 0.5 * v * rate_squared() * std::max(0., std::sqrt(v) - r);
    expected[0] += push * (normal[0] + coefficient * normal[1]);
    expected[1] += push * (normal[1] - coefficient * normal[0]);
  }
  EXPECT_NEAR(halves.resultant()[0], expected[0], 1e-13);
  EXPECT_NEAR(halves.resultant()[1], expected[1], 1e-13);
  EXPECT_GT(halves.energy("self-contact friction"), 1e-3);
}

TEST(FragmentFriction, keeps_both_momenta_and_books_its_work)
{
  const auto gap = [](const double t) { return 1.1 - 0.9 * std::sin(3.14159265358979 * t); };
  const auto slide = [](const double t) { return 0.3 * t + 0.1 * std::sin(10. * t); };
  // By the motion of the right half, with the mean of the forces at both ends of a step.
  const auto error_of_work = [&](const int n_steps)
  {
    Halves halves(rubbing_plate("set Self-contact friction = 0.5"));
    double work = 0;
    std::array<double, 3> former{};
    for (int n = 0; n <= n_steps; ++n)
    {
      const double now = static_cast<double>(n) / n_steps, before = now - 1. / n_steps;
      halves.place(gap(now), slide(now));
      halves.evaluate();
      for (const double component : halves.resultant(true))
        EXPECT_NEAR(component, 0., 1e-13);
      const std::array<double, 3> force = halves.resultant();
      work += 0.5 * (former[0] + force[0]) * (gap(now) - gap(before)) +
              0.5 * (former[1] + force[1]) * (slide(now) - slide(before));
      former = force;
    }
    const double taken = halves.energy("self-contact friction");
    EXPECT_GT(taken, 1e-2);
    EXPECT_NEAR(halves.energy("self-contact energy"), 0., 1e-14);
    return (work + taken + halves.energy("self-contact damping")) / taken;
  };
  // Of the first order in the step, during which normals turn.
  const double coarse = std::abs(error_of_work(150)), fine = std::abs(error_of_work(300));
  EXPECT_LT(fine, 0.03);
  EXPECT_GT(coarse / fine, 1.6);
}

TEST(FragmentFriction, turns_with_the_body_and_sees_no_rotation)
{
  Halves halves(rubbing_plate("set Self-contact friction = 5"));
  halves.place(0.6, 0.);
  halves.evaluate();
  halves.place(0.6, 0.02);
  halves.evaluate();
  const std::array<double, 3> before = halves.resultant();
  const double stored = halves.energy("self-contact energy");
  constexpr double angle = 1.2;
  constexpr int n_steps = 200;
  for (int n = 1; n <= n_steps; ++n)
  {
    halves.place(0.6, 0.02, angle * n / n_steps);
    halves.evaluate();
    for (const double component : halves.resultant(true))
      EXPECT_NEAR(component, 0., 1e-13);
  }
  const std::array<double, 3> after = halves.resultant();
  EXPECT_NEAR(std::cos(angle) * after[0] + std::sin(angle) * after[1], before[0], 1e-12);
  EXPECT_NEAR(std::cos(angle) * after[1] - std::sin(angle) * after[0], before[1], 1e-12);
  EXPECT_NEAR(halves.energy("self-contact energy"), stored, 1e-13);
  EXPECT_NEAR(halves.energy("self-contact friction"), 0., 1e-14);
}

TEST(FragmentFriction, gives_all_its_heat_and_ends_where_the_hotter_one_melts)
{
  Halves halves(rubbing_plate("set Self-contact friction = 300: 0.1, 400: 0", true));
  halves.heat_up([](const Body::Site &) { return 350.; });
  halves.place(0.6, 0.);
  halves.evaluate();
  const auto slide = [&](const double from, const double to)
  {
    for (int n = 1; n <= 50; ++n)
    {
      halves.place(0.6, from + (to - from) * n / 50.);
      halves.evaluate();
    }
  };
  slide(0., 0.1);
  const double first = halves.energy("self-contact friction");
  EXPECT_GT(first, 5e-4);
  NodalVector heat = halves.extract_heat();
  EXPECT_NEAR(sum_of_nodes(heat), first, 1e-13 * first);
  // Half each: pairs are of equal particles.
  for (unsigned int i = 0; i < heat.partition()->n_owned(); ++i)
  {
    const Body::Site site = halves.body.site_of(i);
    EXPECT_EQ(*heat.node(i) > 0., site[0] == 3 || site[0] == 4);
  }
  double left = 0;
  for (unsigned int i = 0; i < heat.partition()->n_owned(); ++i)
    left += halves.body.site_of(i)[0] == 3 ? *heat.node(i) : 0.;
  EXPECT_NEAR(sum_of_all(left), 0.5 * first, 1e-13 * first);

  halves.heat_up([](const Body::Site &site) { return site[0] <= 3 ? 300. : 400.; });
  slide(0.1, 0.101); // what the springs hold
  const double last = halves.energy("self-contact friction");
  slide(0.101, 0.3);
  EXPECT_EQ(halves.energy("self-contact friction"), last);
  EXPECT_NEAR(sum_of_nodes(halves.extract_heat()), last - first, 1e-13 * first);
}

TEST(FragmentFriction, conducts_as_two_bodies_do_whatever_the_conductance)
{
  for (const double conductance : {1e-3, 1., 1e30})
  {
    std::ostringstream entry;
    entry << "set Self-contact conductance = " << conductance;
    Halves halves(rubbing_plate(entry.str(), true));
    halves.clock.previous_step = 0.1;
    halves.heat_up([](const Body::Site &site) { return site[0] <= 3 ? 300. : 500.; });
    halves.place(0.6, 0.);
    halves.evaluate();
    const NodalVector heat = halves.extract_heat();
    EXPECT_NEAR(sum_of_nodes(heat), 0., 1e-13 * 200.);
    for (unsigned int i = 0; i < heat.partition()->n_owned(); ++i)
    {
      const Body::Site site = halves.body.site_of(i);
      const double volume = facing_volume(site[1]);
      const double e = conductance * std::sqrt(volume) * 0.1;
      const double capacities[2] = {volume * 2.6, volume * 3.}; // at 300 and at 500
      const double x = e / capacities[0] + e / capacities[1];
      const double q = e * -std::expm1(-x) / x * 200.;
      const double expected = site[0] == 3 ? q : site[0] == 4 ? -q : 0.;
      EXPECT_NEAR(*heat.node(i), expected, 1e-12 * std::max(std::abs(q), 1e-10));
    }
    EXPECT_EQ(halves.energy("self-contact friction"), 0.);
  }
}

TEST(FragmentFriction, keeps_temperatures_between_those_of_all_that_touch)
{
  Halves halves(rubbing_plate("set Self-contact conductance = 1e6", true));
  halves.clock.previous_step = 1.;
  halves.heat_up([](const Body::Site &site)
                 { return 300. + 10. * static_cast<double>((7 * site[0] + site[1]) % 5); });
  // Half a spacing along: each touches two of the other side.
  halves.place(0.6, 0.5);
  halves.evaluate();
  const NodalVector heat = halves.extract_heat();
  const auto &enthalpy = halves.body.model->heat->nodal_enthalpy;
  EXPECT_NEAR(sum_of_nodes(heat), 0., 1e-12);
  double largest = 0;
  for (unsigned int i = 0; i < heat.partition()->n_owned(); ++i)
  {
    const double before = *halves.body.model->heat->state.present_temperature.node(i);
    const double now = enthalpy.temperature(i, enthalpy.enthalpy(i, before) + *heat.node(i));
    EXPECT_GT(now, 299.9);
    EXPECT_LT(now, 340.1);
    largest = std::max(largest, std::abs(now - before));
  }
  EXPECT_GT(Utilities::MPI::max(largest, MPI_COMM_WORLD), 5.);
}

TEST(FragmentFriction, keeps_the_linear_momentum_of_debris)
{
  Plate plate = rubbing_plate("set Self-contact friction = 0.5");
  Body body(plate);
  FragmentContact<2> *const process = body.model->find_process<FragmentContact<2>>();
  // The corner comes off alone, and is pressed on the edge of the plate and along it.
  body.set_stress([](const Body::Site &site) { return site == Body::Site{{7, 4}} ? 10. : 0.; });
  NodalVector force;
  const auto evaluate = [&](const double height, const double slide)
  {
    body.move(
        [&](const Point<2> &from)
        { return from[0] > 6.5 && from[1] > 3.5 ? Point<2>(4. + slide, 4. + height) : from; });
    body.model->update_stencils();
    force.reinit(body.model->state.partition());
    process->act(*body.model, Clock(), force);
  };
  evaluate(2., 0.);
  evaluate(0.5, 0.);
  evaluate(0.5, 0.001);
  for (unsigned int d = 0; d < 2; ++d)
    EXPECT_NEAR(sum_of_nodes(force, d), 0., 1e-14);
  EXPECT_GT(largest_magnitude(force), 1e-3);
}

TEST(FragmentFriction, costs_nothing_where_it_is_not_asked_for)
{
  Halves without(rubbing_plate("", true));
  EXPECT_FALSE(without.process->actions.has_heat());
  const EnergyAccounts energies = without.body.part().formulation->energies();
  for (const EnergyAccounts::Account &account : energies.accounts())
    EXPECT_NE(account.name, "self-contact friction");
  Halves with(rubbing_plate("set Self-contact friction = 0.1", true));
  EXPECT_TRUE(with.process->actions.has_heat());
  // A pressing without any slide is the same to the last bit.
  for (Halves *const halves : {&without, &with})
  {
    halves->place(0.6, 0.);
    halves->evaluate();
  }
  EXPECT_EQ(largest_difference(with.force, without.force), 0.);
}
