// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
// Fragments of a part and their mutual forces, against sums over all pairs.

#include <gtest/gtest.h>

#include "frozen_body.h"
#include "torn_plate.h"

#include <tombolo/formulations/particles/fragments.h>
#include <tombolo/formulations/particles/self_contact.h>
#include <tombolo/physics/mechanics/fragment_contact.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  constexpr double stiffness = 0.3, damping = 0.2;

  Plate plate_with_contact(const double approach_damping = damping)
  {
    Plate plate;
    plate.options =
        "set Self-contact = true\nset Self-contact stiffness = " + std::to_string(stiffness) +
        "\nset Self-contact damping = " + std::to_string(approach_damping);
    return plate;
  }

  /** A number between 0 and 1 of a site, without any order. */
  double noise(const Body::Site &site, const int seed)
  {
    const double x = 12.9898 * static_cast<double>(site[0]) +
                     78.233 * static_cast<double>(site[1]) + 37.719 * seed;
    return std::abs(std::fmod(43758.5453 * std::sin(x), 1.));
  }

  /** The state of one particle, on whatever rank it is. */
  struct Particle
  {
    Body::Site site;
    std::uint64_t label;
    std::array<double, 2> position, velocity, force;

    template <class Archive>
    void serialize(Archive &archive, const unsigned int)
    {
      archive &site[0] & site[1] & label;
      for (auto *const vector : {&position, &velocity, &force})
        archive &(*vector)[0] & (*vector)[1];
    }
  };

  std::vector<std::uint64_t> labels(Body &body)
  {
    std::vector<std::uint64_t> ids;
    for (const unsigned int node : body.shape().particle_node)
      ids.push_back(body.model->nodes->persistent_ids()[node]);
    std::vector<std::uint64_t> result;
    for (const FragmentOfParticle &fragment :
         find_fragments(body.shape(), ids, *body.model->state.partition()))
      result.push_back(fragment.label);
    return result;
  }

  /** Updates neighbourhoods and computes the forces; all particles of all ranks. */
  std::vector<Particle> forces(Body &body, const NodalVector *const given_velocity = nullptr)
  {
    body.model->update_stencils();
    const NodalState &state = body.model->state;
    NodalVector loads(state.partition()), velocity(state.partition());
    if (given_velocity != nullptr)
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        std::copy_n(given_velocity->node(i), node_stride, velocity.node(i));
    velocity.update_ghosts();
    std::vector<unsigned int> nodes;
    SphereContact<2> &contact = body.model->find_process<FragmentContact<2>>()->between_particles();
    contact.add_forces({&state.position, &velocity, 0.1}, body.model->element_mass, loads, nodes,
                       {});
    const std::vector<std::uint64_t> label = labels(body);
    std::vector<Particle> own;
    for (unsigned int i = 0; i < body.shape().n_particles(); ++i)
    {
      const unsigned int node = body.shape().particle_node[i];
      const double *const x = state.position.node(node), *const v = velocity.node(node),
                          *const f = loads.node(node);
      own.push_back({body.site_of(node), label[i], {{x[0], x[1]}}, {{v[0], v[1]}}, {{f[0], f[1]}}});
      const bool is_loaded = std::count(nodes.begin(), nodes.end(), node) > 0;
      EXPECT_EQ(is_loaded, f[0] != 0. || f[1] != 0.);
    }
    std::vector<Particle> all;
    for (const auto &rank_particles : Utilities::MPI::all_gather(MPI_COMM_WORLD, own))
      all.insert(all.end(), rank_particles.begin(), rank_particles.end());
    std::sort(all.begin(), all.end(),
              [](const Particle &a, const Particle &b) { return a.site < b.site; });
    return all;
  }

  /** Of a lattice of spacing 1 from x = @p left to 7 and from y = 0 to 4. */
  double volume(const Body::Site &site, const long left = 0)
  {
    return (site[0] == left || site[0] == 7 ? 0.5 : 1.) * (site[1] == 0 || site[1] == 4 ? 0.5 : 1.);
  }

  /** Fragments by walking along the bonds: the smallest site in that of each particle. */
  std::map<Body::Site, Body::Site> walk(Body &body)
  {
    std::map<Body::Site, Body::Site> first;
    const auto pairs = body.pairs();
    for (long x = 0; x <= 7; ++x)
      for (long y = 0; y <= 4; ++y)
        first[{{x, y}}] = {{x, y}};
    for (bool has_changed = true; has_changed;)
    {
      has_changed = false;
      for (const auto &pair : pairs)
      {
        const Body::Site smallest = std::min(first[pair[0]], first[pair[1]]);
        has_changed = has_changed || first[pair[0]] != smallest || first[pair[1]] != smallest;
        first[pair[0]] = first[pair[1]] = smallest;
      }
    }
    return first;
  }

  /** Breaks bonds here and there. */
  void shatter(Body &body, const int seed, const double share)
  {
    body.set_stress([&](const Body::Site &site) { return noise(site, seed) < share ? 2. : 0.1; });
    body.stretch(1.1, 1.1);
    body.model->update_stencils();
  }

  /** Compares with the sum over all pairs that @p touches selects. Returns the energy. */
  template <typename Touches>
  double check_forces(const std::vector<Particle> &particles, const double approach_damping,
                      const Touches &touches, const long left = 0)
  {
    const double rate = std::sqrt(stiffness * young * (1. - poisson) / (1. + poisson) /
                                  (1. - 2. * poisson)); // density and spacing are one
    double energy = 0;
    std::array<double, 3> sum{};
    for (const Particle &a : particles)
    {
      std::array<double, 2> force{};
      for (const Particle &b : particles)
      {
        if (a.site == b.site || !touches(a, b))
          continue;
        const double d[2] = {b.position[0] - a.position[0], b.position[1] - a.position[1]};
        const double r = std::hypot(d[0], d[1]);
        const double reach =
            0.5 * (std::sqrt(volume(a.site, left)) + std::sqrt(volume(b.site, left)));
        if (r >= reach)
          continue;
        const double mass = volume(a.site, left) * volume(b.site, left) /
                            (volume(a.site, left) + volume(b.site, left));
        const double approach =
            -((b.velocity[0] - a.velocity[0]) * d[0] + (b.velocity[1] - a.velocity[1]) * d[1]) / r;
        const double push = mass * rate * rate * (reach - r) +
                            2. * approach_damping * mass * rate * std::max(0., approach);
        force[0] -= push * d[0] / r;
        force[1] -= push * d[1] / r;
        energy += 0.25 * mass * rate * rate * (reach - r) * (reach - r);
      }
      for (unsigned int c = 0; c < 2; ++c)
      {
        EXPECT_NEAR(a.force[c], force[c], 1e-13);
        sum[c] += a.force[c];
      }
      sum[2] += a.position[0] * a.force[1] - a.position[1] * a.force[0];
    }
    for (const double component : sum)
      EXPECT_NEAR(component, 0., 1e-13);
    return energy;
  }
} // namespace

TEST(Fragments, are_what_a_chain_of_bonds_connects)
{
  unsigned int most = 0;
  for (const int seed : {1, 2, 3, 4, 5, 6})
    for (const double share : {0.5, 0.75, 0.9})
    {
      Body body;
      shatter(body, seed, share);
      const auto by_walking = walk(body);
      std::vector<std::tuple<Body::Site, std::uint64_t>> own;
      const std::vector<std::uint64_t> label = labels(body);
      for (unsigned int i = 0; i < body.shape().n_particles(); ++i)
        own.emplace_back(body.site_of(body.shape().particle_node[i]), label[i]);
      std::map<std::uint64_t, Body::Site> first_of_label;
      std::map<Body::Site, std::uint64_t> label_of_first;
      for (const auto &rank_labels : Utilities::MPI::all_gather(MPI_COMM_WORLD, own))
        for (const auto &[site, site_label] : rank_labels)
        {
          const Body::Site first = by_walking.at(site);
          EXPECT_EQ(first_of_label.try_emplace(site_label, first).first->second, first);
          EXPECT_EQ(label_of_first.try_emplace(first, site_label).first->second, site_label);
        }
      most = std::max(most, static_cast<unsigned int>(label_of_first.size()));
    }
  EXPECT_GT(most, 10u); // or nothing is tested
}

TEST(SelfContact, is_absent_where_it_is_not_wanted_and_rests_where_nothing_is_apart)
{
  Body without;
  EXPECT_EQ(without.model->find_process<FragmentContact<2>>(), nullptr);
  Body body(plate_with_contact());
  EXPECT_NE(body.model->find_process<FragmentContact<2>>(), nullptr);
  body.stretch(0.5, 0.5);
  for (const Particle &particle : forces(body))
    EXPECT_EQ(std::hypot(particle.force[0], particle.force[1]), 0.);
  EXPECT_EQ(Utilities::MPI::sum(body.part().particles->fragment_contact()->counts().n_fragments,
                                MPI_COMM_WORLD),
            1u);
}

TEST(SelfContact, is_the_sum_over_all_pairs_of_different_fragments)
{
  unsigned int n_checked = 0;
  for (const int seed : {1, 2, 3, 4, 5, 6})
    for (const double share : {0.5, 0.9})
    {
      Body body(plate_with_contact());
      shatter(body, seed, share);
      const std::vector<Particle> before = forces(body);
      for (const Particle &particle : before)
        EXPECT_EQ(std::hypot(particle.force[0], particle.force[1]), 0.);
      body.set_stress([](const Body::Site &) { return 0.; });
      for (const double distance : {0.9, 0.7, 1.})
      {
        body.move(
            [&](const Point<2> &from)
            {
              const Body::Site site{{std::lround(from[0]), std::lround(from[1])}};
              return Point<2>(distance * from[0] + 0.1 * noise(site, seed + 10),
                              distance * from[1] + 0.1 * noise(site, seed + 20));
            });
        const NodalVector velocity = disordered_field(*body.model, seed);
        const std::vector<Particle> now = forces(body, &velocity);
        // Distorted particles have come off, with spheres of another size.
        if (!std::equal(now.begin(), now.end(), before.begin(),
                        [](const Particle &a, const Particle &b) { return a.label == b.label; }))
          break;
        ++n_checked;
        const double energy = check_forces(
            now, damping, [](const Particle &a, const Particle &b) { return a.label != b.label; });
        EXPECT_NEAR(sum_over_ranks(body.part().formulation->energies()["self-contact energy"]),
                    energy, 1e-12 * std::max(energy, 1.));
        if (distance < 1.)
        {
          EXPECT_GT(energy, 1e-4);
        }
      }
    }
  EXPECT_GT(n_checked, 10u);
}

TEST(SelfContact, leaves_nodes_of_elements_to_the_elements)
{
  Plate plate = plate_with_contact();
  plate.bridge = "paper";
  Body body(plate);
  body.set_stress([](const Body::Site &) { return 1.; });
  body.stretch(1.1, 1.1);
  forces(body);
  body.stretch(0.8, 0.8);
  const std::vector<Particle> particles = forces(body);
  EXPECT_GT(check_forces(
                particles, damping,
                [](const Particle &a, const Particle &b)
                { return a.label != b.label && !(a.site[0] == 2 && b.site[0] == 2); },
                2),
            0.);
}

TEST(SelfContact, begins_without_a_force_where_fragments_overlap_when_they_come_off)
{
  Body body(plate_with_contact(0.));
  body.set_stress([](const Body::Site &site) { return site[0] == 3 || site[0] == 4 ? 1. : 0.; });
  // One half slides along the other: all bonds between them are stretched, and yet they overlap.
  const auto largest = [&](const double gap)
  {
    body.move([&](const Point<2> &from)
              { return from[0] > 3.5 ? Point<2>(from[0] + gap - 1., from[1] + 2.5) : from; });
    double result = 0;
    for (const Particle &particle : forces(body))
      result = std::max(result, std::hypot(particle.force[0], particle.force[1]));
    return result;
  };
  EXPECT_NEAR(largest(0.7), 0., 1e-15);
  EXPECT_EQ(Utilities::MPI::sum(body.part().particles->fragment_contact()->counts().n_fragments,
                                MPI_COMM_WORLD),
            2u);
  EXPECT_EQ(largest(0.71), 0.);
  EXPECT_GT(largest(0.68), 1e-3);
}

TEST(SelfContact, stays_as_it_is_where_a_chip_takes_the_label_of_its_body_away)
{
  Body body(plate_with_contact(0.));
  body.set_stress([](const Body::Site &site)
                  { return site[0] == 3 || site[0] == 4 || site[0] + site[1] <= 2 ? 1. : 0.; });
  for (const long chip : {7L, 0L})
  {
    const auto press = [&](const double gap, const double away)
    {
      body.move(
          [&](const Point<2> &from)
          {
            const Body::Site site{{std::lround(from[0]), std::lround(from[1])}};
            if (site == Body::Site{{chip, 0}})
              return Point<2>(from[0] + (chip == 0 ? -away : away), from[1] - away);
            return from[0] > 3.5 ? Point<2>(from[0] + gap - 1., from[1]) : from;
          });
      return forces(body);
    };
    press(1.1, 0.);
    const std::vector<Particle> before = press(0.7, 0.);
    body.set_stress(
        [&](const Body::Site &site) {
          return site == Body::Site{{chip, 0}} ? 10. : 0.;
        });
    const std::vector<Particle> after = press(0.7, 1.);
    EXPECT_EQ(Utilities::MPI::sum(body.part().particles->fragment_contact()->counts().n_fragments,
                                  MPI_COMM_WORLD),
              chip == 7 ? 3u : 4u);
    double largest = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
      for (unsigned int c = 0; c < 2; ++c)
      {
        EXPECT_NEAR(after[i].force[c], before[i].force[c], 1e-14);
        largest = std::max(largest, std::abs(before[i].force[c]));
      }
    EXPECT_GT(largest, 1e-2);
  }
}

TEST(SelfContact, gives_back_what_springs_store_and_books_what_dampers_take)
{
  for (const double approach_damping : {0., damping})
  {
    Body body(plate_with_contact(approach_damping));
    body.set_stress([](const Body::Site &site) { return site[0] == 3 || site[0] == 4 ? 1. : 0.; });
    body.stretch(1.1, 1.);
    forces(body);
    constexpr int n_steps = 2000;
    constexpr double deepest = 0.3, time_step = 0.1;
    double most = 0;
    for (int n = 0; n <= n_steps; ++n)
    {
      const auto way = [&](const int step)
      { return 0.2 - (0.2 + deepest) * std::sin(3.14159265358979 * step / n_steps); };
      body.move(
          [&](const Point<2> &from)
          { return Point<2>(from[0] + (from[0] > 3.5 ? way(n) : 0.), from[1] + 0.1 * way(n)); });
      NodalVector velocity(body.model->state.partition());
      for (unsigned int i = 0; i < velocity.partition()->n_owned(); ++i)
        if (body.model->state.initial_position.node(i)[0] > 3.5 && n > 0)
          velocity.node(i)[0] = (way(n) - way(n - 1)) / time_step;
      forces(body, &velocity);
      most = std::max(most,
                      sum_over_ranks(body.part().formulation->energies()["self-contact energy"]));
    }
    const EnergyAccounts end = body.part().formulation->energies();
    EXPECT_NEAR(sum_over_ranks(end["self-contact energy"]), 0., 1e-15);
    EXPECT_GT(most, 1e-3);
    const double taken = sum_over_ranks(end["self-contact damping"]) / most;
    if (approach_damping == 0.)
    {
      EXPECT_NEAR(taken, 0., 1e-6);
    }
    else
    {
      EXPECT_GT(taken, 1e-3);
    }
  }
}

TEST(SelfContact, takes_more_of_the_step_the_stiffer_it_is)
{
  Body soft(plate_with_contact());
  const auto fraction = [](Body &body, const double step)
  { return body.part().particles->fragment_contact()->stable_fraction(step); };
  EXPECT_NEAR(fraction(soft, 1e-9), 1., 1e-8);
  EXPECT_LT(fraction(soft, 1.), fraction(soft, 0.5));
  EXPECT_LT(fraction(soft, 0.5), 1.);
  Body without;
  EXPECT_EQ(without.part().particles->fragment_contact(), nullptr);
}
