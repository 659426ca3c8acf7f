// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/neighbour_search.h>
#include <tombolo/base/memory.h>

#include <gtest/gtest.h>

#include "particle_clouds.h"

#include <cmath>

namespace
{
  using namespace tombolo;

  struct Rows
  {
    std::vector<std::size_t> start;
    std::vector<unsigned int> neighbour;

    bool operator==(const Rows &other) const
    {
      return start == other.start && neighbour == other.neighbour;
    }
  };

  template <int dim>
  Rows brute_force(const ParticleCloud &cloud, const std::vector<unsigned int> &rows,
                   const std::vector<unsigned int> &columns, const double skin)
  {
    Rows result;
    result.start.push_back(0);
    for (const unsigned int i : rows)
    {
      for (const unsigned int j : columns)
      {
        bool inside = true;
        for (unsigned int d = 0; d < dim; ++d)
          inside &= std::abs(cloud.x(i)[d] - cloud.x(j)[d]) < cloud.a(j)[d] * (1. + skin);
        if (inside)
          result.neighbour.push_back(j);
      }
      result.start.push_back(result.neighbour.size());
    }
    return result;
  }

  template <int dim>
  Rows search(NeighbourSearch<dim> &search, const ParticleCloud &cloud,
              const std::vector<unsigned int> &rows, const std::vector<unsigned int> &columns,
              const double skin)
  {
    Rows result;
    search.find(rows, columns, cloud.position.data(), cloud.support.data(), skin, result.start,
                result.neighbour);
    return result;
  }

  template <int dim>
  void expect_brute_force(const ParticleCloud &cloud, const double skin)
  {
    NeighbourSearch<dim> finder;
    EXPECT_TRUE(search<dim>(finder, cloud, cloud.nodes, cloud.nodes, skin) ==
                brute_force<dim>(cloud, cloud.nodes, cloud.nodes, skin));
  }

  TEST(NeighbourSearch, finds_what_brute_force_finds_on_lattices_regular_and_disordered)
  {
    for (const double disorder : {0., 0.1, 0.2, 0.4})
      for (const double skin : {0., 0.1, 0.5})
      {
        expect_brute_force<2>(lattice_cloud<2>(23, 1.8, disorder), skin);
        expect_brute_force<3>(lattice_cloud<3>(9, 1.8, disorder), skin);
      }
  }

  TEST(NeighbourSearch, finds_what_brute_force_finds_far_from_the_origin)
  {
    expect_brute_force<2>(lattice_cloud<2>(17, 1.8, 0.2, 1e6), 0.1);
    expect_brute_force<3>(lattice_cloud<3>(7, 2., 0., -1e6), 0.);
    expect_brute_force<3>(lattice_cloud<3>(7, 1.8, 0.2, 1e6), 0.1);
  }

  TEST(NeighbourSearch, finds_what_brute_force_finds_among_particles_at_random)
  {
    expect_brute_force<2>(random_cloud<2>(600, 0.05, 0.1), 0.);
    expect_brute_force<3>(random_cloud<3>(900, 0.05, 0.3), 0.2);
    expect_brute_force<3>(random_cloud<3>(1, 0.1, 0.2), 0.);
  }

  TEST(NeighbourSearch, finds_what_brute_force_finds_with_supports_of_very_different_size)
  {
    // Spacing halves again and again along x, from 1 to 1/256.
    ParticleCloud cloud;
    double x = 0, h = 1;
    for (unsigned int column = 0; column < 90; ++column)
    {
      for (double y = 0; y < 4.; y += std::max(h, 0.05))
      {
        const double position[2] = {x, y}, support[2] = {1.8 * h, 1.8 * std::max(h, 0.05)};
        cloud.add(position, support, 2);
      }
      x += h;
      if (column % 10 == 9)
        h *= 0.5;
    }
    expect_brute_force<2>(cloud, 0.);
    expect_brute_force<2>(cloud, 0.3);

    // Elongated supports, and few that reach across everything.
    ParticleCloud elongated = random_cloud<3>(700, 0.01, 0.02);
    for (unsigned int i = 0; i < elongated.size(); ++i)
      elongated.support[i * node_stride + i % 3] *= i % 50 == 0 ? 100. : 10.;
    expect_brute_force<3>(elongated, 0.1);
  }

  TEST(NeighbourSearch, bounds_its_memory_over_empty_space)
  {
    // Two bodies a million spacings apart, and fragments further off on a diagonal.
    ParticleCloud cloud = lattice_cloud<3>(6, 1.8, 0.1);
    const ParticleCloud other = lattice_cloud<3>(6, 1.8, 0.1, 1e6);
    for (const unsigned int i : other.nodes)
      cloud.add(other.x(i), other.a(i), 3);
    for (unsigned int i = 0; i < 20; ++i)
    {
      const double position[3] = {1e7 * i, 2e7 * i, -3e7 * i}, support[3] = {1.8, 1.8, 1.8};
      cloud.add(position, support, 3);
    }
    const std::size_t memory = allocated_bytes();
    NeighbourSearch<3> finder;
    EXPECT_TRUE(search<3>(finder, cloud, cloud.nodes, cloud.nodes, 0.1) ==
                brute_force<3>(cloud, cloud.nodes, cloud.nodes, 0.1));
    EXPECT_LT(allocated_bytes() - memory, 2000u * cloud.size());
  }

  TEST(NeighbourSearch, treats_rows_that_are_some_of_the_columns_and_columns_that_are_some_nodes)
  {
    const ParticleCloud cloud = lattice_cloud<3>(8, 1.8, 0.3);
    std::vector<unsigned int> rows, columns;
    for (const unsigned int i : cloud.nodes)
    {
      if (i % 3 != 0)
        columns.push_back(i);
      if (i % 3 == 1)
        rows.push_back(i);
    }
    NeighbourSearch<3> finder;
    EXPECT_TRUE(search<3>(finder, cloud, rows, columns, 0.1) ==
                brute_force<3>(cloud, rows, columns, 0.1));
    EXPECT_TRUE(search<3>(finder, cloud, {}, {}, 0.1) == brute_force<3>(cloud, {}, {}, 0.1));
  }

  TEST(NeighbourSearch, allocates_nothing_in_a_second_search_of_the_same_size)
  {
    const ParticleCloud cloud = lattice_cloud<3>(12, 1.8, 0.2);
    NeighbourSearch<3> finder;
    const Rows first = search<3>(finder, cloud, cloud.nodes, cloud.nodes, 0.1);
    const std::size_t memory = allocated_bytes();
    EXPECT_TRUE(first == search<3>(finder, cloud, cloud.nodes, cloud.nodes, 0.1));
    EXPECT_EQ(memory, allocated_bytes());
  }

  TEST(NeighbourSearch, keeps_coincident_particles_as_neighbours)
  {
    ParticleCloud cloud;
    const double position[3] = {1., 2., 3.}, support[3] = {1., 1., 1.};
    for (unsigned int i = 0; i < 40; ++i)
      cloud.add(position, support, 3);
    expect_brute_force<3>(cloud, 0.);
  }
} // namespace
