// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include <tombolo/approximation/moving_least_squares.h>
#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/approximation/particle_ghosts.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include "particle_clouds.h"

#include <map>

namespace
{
  using namespace tombolo;
  using namespace dealii;

  /** φ by global number of particle and neighbour. */
  using GlobalRows = std::map<types::global_dof_index, std::map<types::global_dof_index, double>>;

  /** A cloud shared by ranks in contiguous ranges of global numbers, with @p n_extra nodes on each
   * rank that are no particles, numbered before its particles. */
  template <int dim>
  struct DistributedCloud
  {
    DistributedCloud(const ParticleCloud &cloud, const double skin, const bool first_rank_is_empty,
                     const unsigned int n_extra = 3)
        : neighbourhoods(skin), least_squares(make_kernel("cubic spline"))
    {
      const unsigned int rank = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
      const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
      const unsigned int n_sharing = n_ranks - (first_rank_is_empty && n_ranks > 1 ? 1 : 0);
      const auto first_particle = [&](const unsigned int r)
      {
        const unsigned int share = r - (n_ranks - n_sharing);
        return r < n_ranks - n_sharing ? 0 : cloud.size() * share / n_sharing;
      };
      const unsigned int begin = first_particle(rank), end = first_particle(rank + 1);
      IndexSet owned_nodes(cloud.size() + n_ranks * n_extra);
      owned_nodes.add_range(begin + rank * n_extra, end + (rank + 1) * n_extra);
      owned = owned_nodes;
      first = begin;
      this->n_extra = n_extra;
      for (unsigned int i = begin; i < end; ++i)
        particles.push_back(i + (rank + 1) * n_extra);
      for (unsigned int r = 0; r <= n_ranks; ++r)
        first_of_rank.push_back(first_particle(r) + r * n_extra);
      place(cloud);
    }

    void place(const ParticleCloud &cloud)
    {
      const auto begin = std::ptrdiff_t(first * node_stride);
      const auto end = begin + std::ptrdiff_t(particles.size() * node_stride);
      position.assign(cloud.position.begin() + begin, cloud.position.begin() + end);
      support.assign(cloud.support.begin() + begin, cloud.support.begin() + end);
    }

    void rebuild()
    {
      neighbourhoods.search(particles, position, support, MPI_COMM_WORLD, shape);
      // Another ghost that was not requested, as other parts may need.
      IndexSet ghosts(owned.size());
      ghosts.add_indices(neighbourhoods.global_nodes().begin(),
                         neighbourhoods.global_nodes().end());
      ghosts.add_index(0);
      ghosts.compress();
      set_partition(ghosts);
    }

    void set_partition(const IndexSet &ghosts)
    {
      partition = std::make_shared<const NodePartition>(owned, ghosts, MPI_COMM_WORLD);
      neighbourhoods.set_partition(*partition, shape);
    }

    bool candidates_hold() const
    {
      return neighbourhoods.candidates_hold(position, support, MPI_COMM_WORLD);
    }

    /** Number of a node among the particles of the whole cloud. */
    types::global_dof_index particle(const types::global_dof_index node) const
    {
      unsigned int r = 0;
      while (node >= first_of_rank[r + 1])
        ++r;
      return node - (r + 1) * n_extra;
    }

    /** The rows of all ranks. */
    GlobalRows rows()
    {
      NodalVector nodal_position(partition), nodal_support(partition);
      for (unsigned int i = 0; i < particles.size(); ++i)
      {
        std::copy_n(&position[i * node_stride], node_stride,
                    nodal_position.node(shape.particle_node[i]));
        std::copy_n(&support[i * node_stride], node_stride,
                    nodal_support.node(shape.particle_node[i]));
      }
      nodal_position.update_ghosts();
      nodal_support.update_ghosts();
      const auto &defects = least_squares.compute(neighbourhoods.nodes(), nodal_position.data(),
                                                  nodal_support.data(), shape);
      EXPECT_TRUE(defects.empty());
      std::vector<double> own; // particle, neighbour, value
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        for (std::size_t e = shape.row_start[row]; e < shape.row_start[row + 1]; ++e)
          own.insert(own.end(),
                     {double(particle(partition->global_index(shape.particle_node[row]))),
                      double(particle(partition->global_index(shape.neighbour[e]))),
                      shape.value[e]});
        EXPECT_TRUE(std::is_sorted(shape.neighbour.data() + shape.row_start[row],
                                   shape.neighbour.data() + shape.row_start[row + 1]));
      }
      GlobalRows all;
      own = from_all_ranks(own, MPI_COMM_WORLD);
      for (std::size_t i = 0; i < own.size(); i += 3)
        all[static_cast<types::global_dof_index>(own[i])]
           [static_cast<types::global_dof_index>(own[i + 1])] = own[i + 2];
      return all;
    }

    unsigned int first, n_extra;
    std::vector<types::global_dof_index> first_of_rank;
    std::vector<types::global_dof_index> particles;
    IndexSet owned;
    std::shared_ptr<const NodePartition> partition;
    std::vector<double> position, support;
    Stencils shape;
    Neighbourhoods<dim> neighbourhoods;
    MovingLeastSquares<dim> least_squares;
  };

  template <int dim>
  GlobalRows rows_on_one_rank(const ParticleCloud &cloud, const double skin)
  {
    Stencils shape;
    shape.particle_node = cloud.nodes;
    NeighbourSearch<dim> search;
    search.find(cloud.nodes, cloud.nodes, cloud.position.data(), cloud.support.data(), skin,
                shape.row_start, shape.neighbour);
    MovingLeastSquares<dim> mls(make_kernel("cubic spline"));
    mls.compute(cloud.nodes, cloud.position.data(), cloud.support.data(), shape);
    GlobalRows rows;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
      for (std::size_t e = shape.row_start[row]; e < shape.row_start[row + 1]; ++e)
        rows[shape.particle_node[row]][shape.neighbour[e]] = shape.value[e];
    return rows;
  }

  void expect_same(const GlobalRows &a, const GlobalRows &b)
  {
    ASSERT_EQ(a.size(), b.size());
    for (const auto &row : a)
    {
      const auto &other = b.at(row.first);
      ASSERT_EQ(row.second.size(), other.size()) << "particle " << row.first;
      for (const auto &entry : row.second)
      {
        ASSERT_EQ(other.count(entry.first), 1u) << "particle " << row.first;
        EXPECT_NEAR(entry.second, other.at(entry.first), 1e-13);
      }
    }
  }

  TEST(ParticleGhosts, give_the_neighbours_and_shape_functions_of_one_rank)
  {
    for (const bool first_rank_is_empty : {false, true})
      for (const double skin : {0., 0.2})
      {
        const ParticleCloud flat = lattice_cloud<2>(14, 1.8, 0.3);
        DistributedCloud<2> flat_parts(flat, skin, first_rank_is_empty);
        flat_parts.rebuild();
        expect_same(flat_parts.rows(), rows_on_one_rank<2>(flat, skin));

        const ParticleCloud solid = lattice_cloud<3>(7, 1.8, 0.3);
        DistributedCloud<3> solid_parts(solid, skin, first_rank_is_empty);
        solid_parts.rebuild();
        expect_same(solid_parts.rows(), rows_on_one_rank<3>(solid, skin));

        // Numbered at random: every rank is everywhere.
        const ParticleCloud random = random_cloud<3>(400, 0.3, 0.5);
        DistributedCloud<3> random_parts(random, skin, first_rank_is_empty);
        random_parts.rebuild();
        expect_same(random_parts.rows(), rows_on_one_rank<3>(random, skin));
      }
  }

  TEST(ParticleGhosts, follow_the_present_positions)
  {
    // The cloud is folded: its first and last particles, of different ranks, come together.
    ParticleCloud cloud = lattice_cloud<2>(16, 1.8, 0.1);
    DistributedCloud<2> parts(cloud, 0.1, false);
    parts.rebuild();
    for (unsigned int i = 0; i < cloud.size(); ++i)
      if (cloud.x(i)[1] > 7.5)
        cloud.position[i * node_stride + 1] = 15.3 - cloud.x(i)[1];
    parts.place(cloud);
    EXPECT_FALSE(parts.candidates_hold());
    parts.rebuild();
    expect_same(parts.rows(), rows_on_one_rank<2>(cloud, 0.1));
  }

  TEST(ParticleGhosts, are_as_many_as_the_interface_needs)
  {
    const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    const unsigned int n = 24;
    const ParticleCloud cloud = lattice_cloud<3>(n, 1.8);
    DistributedCloud<3> parts(cloud, 0.05, false);
    parts.rebuild();
    // Slabs along z: one layer of ghosts, of n² particles, on either side.
    const std::size_t n_ghosts =
        parts.neighbourhoods.global_nodes().size() - parts.particles.size();
    EXPECT_LE(n_ghosts, 2u * n * n);
    if (n_ranks > 1)
    {
      EXPECT_GE(n_ghosts, n * n);
    }

    ParticleGhosts<3> finder;
    const RemoteParticles received = finder.exchange(parts.particles, parts.position.data(),
                                                     parts.support.data(), 0.05, MPI_COMM_WORLD);
    EXPECT_LE(received.node.size(), 4u * n * n);
    EXPECT_TRUE(std::is_sorted(received.node.begin(), received.node.end()));
  }

  TEST(ParticleGhosts, survive_another_partition_with_more_ghosts)
  {
    const ParticleCloud cloud = lattice_cloud<3>(7, 1.8, 0.2);
    DistributedCloud<3> parts(cloud, 0.1, false);
    parts.rebuild();
    const GlobalRows before = parts.rows();
    IndexSet everything = complete_index_set(parts.owned.size());
    parts.set_partition(everything);
    expect_same(parts.rows(), before);
  }

  TEST(Neighbourhoods, keep_candidates_exactly_as_long_as_the_skin_allows)
  {
    ParticleCloud cloud = lattice_cloud<3>(7, 1.8, 0.);
    DistributedCloud<3> parts(cloud, 0.1, false); // 0.18 of skin
    parts.rebuild();
    EXPECT_TRUE(parts.candidates_hold());
    const auto holds_with =
        [&](const std::size_t slot, const double displacement, const double growth)
    {
      ParticleCloud changed = cloud;
      changed.position[slot] += displacement;
      changed.support[slot] += growth;
      parts.place(changed);
      return parts.candidates_hold();
    };
    for (const std::size_t slot : {std::size_t(1), std::size_t(200 * node_stride + 2)})
    {
      EXPECT_TRUE(holds_with(slot, 0.17, 0.));
      EXPECT_FALSE(holds_with(slot, 0.19, 0.));
      EXPECT_FALSE(holds_with(slot, -0.19, 0.));
      EXPECT_TRUE(holds_with(slot, 0., 0.17));
      EXPECT_FALSE(holds_with(slot, 0., 0.19));
      EXPECT_FALSE(holds_with(slot, 0.1, 0.1));
    }
    ParticleCloud moved = cloud;
    for (unsigned int i = 0; i < moved.size(); ++i)
      moved.position[i * node_stride] += 100.;
    parts.place(moved);
    EXPECT_TRUE(parts.candidates_hold()) << "rigid translation";
  }

  TEST(Neighbourhoods, hold_every_neighbour_while_they_say_so)
  {
    const double skin = 0.3;
    ParticleCloud cloud = lattice_cloud<2>(15, 1.6, 0.2);
    DistributedCloud<2> parts(cloud, skin, false);
    parts.rebuild();
    const GlobalRows candidates = parts.rows();
    unsigned int n_kept = 0;
    for (double shear = 0.; shear < 0.2; shear += 0.004)
    {
      ParticleCloud deformed = cloud;
      for (unsigned int i = 0; i < cloud.size(); ++i)
      {
        deformed.position[i * node_stride] += shear * cloud.x(i)[1];
        deformed.support[i * node_stride] *= 1. + 0.5 * shear;
      }
      parts.place(deformed);
      if (!parts.candidates_hold())
        break;
      ++n_kept;
      for (const auto &row : rows_on_one_rank<2>(deformed, 0.))
        for (const auto &entry : row.second)
          EXPECT_EQ(candidates.at(row.first).count(entry.first), 1u);
    }
    EXPECT_GT(n_kept, 2u);
    EXPECT_LT(n_kept, 50u);
  }
} // namespace
