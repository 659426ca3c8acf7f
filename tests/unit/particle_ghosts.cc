// ranks: 1 2 3
#include <tombolo/particles/moving_least_squares.h>
#include <tombolo/particles/neighbourhoods.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include "particle_clouds.h"

#include <cmath>
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
      offset = (rank + 1) * n_extra;
      IndexSet owned(cloud.size() + n_ranks * n_extra);
      owned.add_range(begin + rank * n_extra, end + (rank + 1) * n_extra);
      partition =
          std::make_shared<const NodePartition>(owned, IndexSet(owned.size()), MPI_COMM_WORLD);
      first = begin;
      for (unsigned int i = begin; i < end; ++i)
        particles.push_back(n_extra + i - begin);
      this->n_extra = n_extra;
      first_of_rank.clear();
      for (unsigned int r = 0; r <= n_ranks; ++r)
        first_of_rank.push_back(first_particle(r) + r * n_extra);
      position.reinit(partition);
      support.reinit(partition);
      place(cloud);
      neighbourhoods.reinit(particles, *partition, shape);
    }

    void place(const ParticleCloud &cloud)
    {
      for (unsigned int i = 0; i < particles.size(); ++i)
        for (unsigned int d = 0; d < n_slots; ++d)
        {
          position.node(particles[i])[d] = cloud.x(first + i)[d];
          support.node(particles[i])[d] = cloud.a(first + i)[d];
        }
    }

    void rebuild()
    {
      neighbourhoods.search(position, support, shape);
      // Another ghost that nobody asked for, as other parts may need.
      IndexSet ghosts = neighbourhoods.required_ghosts();
      ghosts.add_index(0);
      ghosts.compress();
      partition = std::make_shared<const NodePartition>(partition->owned(), ghosts, MPI_COMM_WORLD);
      neighbourhoods.set_partition(*partition, shape);
      position.move_to(partition);
      support.move_to(partition);
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
      EXPECT_TRUE(
          least_squares.compute(neighbourhoods.nodes(), position.data(), support.data(), shape)
              .empty());
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
      for (const auto &part : Utilities::MPI::all_gather(MPI_COMM_WORLD, own))
        for (std::size_t i = 0; i < part.size(); i += 3)
          all[static_cast<types::global_dof_index>(part[i])]
             [static_cast<types::global_dof_index>(part[i + 1])] = part[i + 2];
      return all;
    }

    unsigned int first, offset, n_extra;
    std::vector<types::global_dof_index> first_of_rank;
    std::vector<unsigned int> particles;
    std::shared_ptr<const NodePartition> partition;
    NodalVector position, support;
    ShapeFunctions shape;
    Neighbourhoods<dim> neighbourhoods;
    MovingLeastSquares<dim> least_squares;
  };

  template <int dim>
  GlobalRows rows_on_one_rank(const ParticleCloud &cloud, const double skin)
  {
    ShapeFunctions shape;
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
        cloud.position[i * n_slots + 1] = 15.3 - cloud.x(i)[1];
    parts.place(cloud);
    EXPECT_FALSE(parts.neighbourhoods.candidates_hold(parts.position, parts.support));
    parts.rebuild();
    expect_same(parts.rows(), rows_on_one_rank<2>(cloud, 0.1));
  }

  TEST(ParticleGhosts, are_as_many_as_the_interface_needs)
  {
    const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    const unsigned int n = 24;
    const ParticleCloud cloud = lattice_cloud<3>(n, 1.8);
    DistributedCloud<3> parts(cloud, 0.05, false);
    parts.neighbourhoods.search(parts.position, parts.support, parts.shape);
    // Slabs along z: one layer of ghosts, of n² particles, on either side.
    const auto n_ghosts = parts.neighbourhoods.required_ghosts().n_elements();
    EXPECT_LE(n_ghosts, 2u * n * n);
    if (n_ranks > 1)
    {
      EXPECT_GE(n_ghosts, n * n);
    }

    ParticleGhosts<3> finder;
    std::vector<types::global_dof_index> own;
    for (unsigned int i = 0; i < parts.particles.size(); ++i)
      own.push_back(parts.first + i);
    const RemoteParticles remote =
        finder.exchange(own, cloud.x(parts.first), cloud.a(parts.first), 0.05, MPI_COMM_WORLD);
    EXPECT_LE(remote.node.size(), 4u * n * n);
    EXPECT_TRUE(std::is_sorted(remote.node.begin(), remote.node.end()));
  }

  TEST(ParticleGhosts, survive_another_partition_with_more_ghosts)
  {
    const ParticleCloud cloud = lattice_cloud<3>(7, 1.8, 0.2);
    DistributedCloud<3> parts(cloud, 0.1, false);
    parts.rebuild();
    const GlobalRows before = parts.rows();
    IndexSet everything(parts.partition->n_global());
    everything.add_range(0, everything.size());
    parts.partition =
        std::make_shared<const NodePartition>(parts.partition->owned(), everything, MPI_COMM_WORLD);
    parts.neighbourhoods.set_partition(*parts.partition, parts.shape);
    parts.position.move_to(parts.partition);
    parts.support.move_to(parts.partition);
    expect_same(parts.rows(), before);
  }

  TEST(Neighbourhoods, keep_candidates_exactly_as_long_as_the_skin_allows)
  {
    ParticleCloud cloud = lattice_cloud<3>(7, 1.8, 0.);
    DistributedCloud<3> parts(cloud, 0.1, false); // 0.18 of skin
    parts.rebuild();
    EXPECT_TRUE(parts.neighbourhoods.candidates_hold(parts.position, parts.support));
    const auto holds_with =
        [&](const std::size_t slot, const double displacement, const double growth)
    {
      ParticleCloud changed = cloud;
      changed.position[slot] += displacement;
      changed.support[slot] += growth;
      parts.place(changed);
      return parts.neighbourhoods.candidates_hold(parts.position, parts.support);
    };
    for (const std::size_t slot : {std::size_t(1), std::size_t(200 * n_slots + 2)})
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
      moved.position[i * n_slots] += 100.;
    parts.place(moved);
    EXPECT_TRUE(parts.neighbourhoods.candidates_hold(parts.position, parts.support))
        << "rigid translation";
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
        deformed.position[i * n_slots] += shear * cloud.x(i)[1];
        deformed.support[i * n_slots] *= 1. + 0.5 * shear;
      }
      parts.place(deformed);
      if (!parts.neighbourhoods.candidates_hold(parts.position, parts.support))
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
