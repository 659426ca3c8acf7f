// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/types.h>

#include <tombolo/state/node_partition.h>

#include <array>
#include <map>
#include <vector>

namespace tombolo
{
  /** Particles of other ranks, ascending by global number; node_stride doubles each. */
  struct RemoteParticles
  {
    std::vector<dealii::types::global_dof_index> node;
    std::vector<double> position;
    std::vector<double> support;
  };

  /**
   * Finds the particles of other ranks whose supports reach this rank's particles at their present
   * positions. Each rank describes where its particles are by a bounded number of boxes, which all
   * ranks see; a particle goes, point to point, to the ranks with a box that its support touches.
   * What is sent grows with the interface between ranks.
   */
  template <int dim>
  class ParticleGhosts
  {
  public:
    /** Boxes of one rank, at most. */
    static constexpr unsigned int n_boxes = 32;

    /** @p node are the global numbers of the particles of this rank; @p position and half widths
     * @p support have node_stride doubles for each; what the last one of the support holds goes
     * along. Supports reach (1 + skin) times as far.
     * Collective; a rank may have no particles. */
    RemoteParticles exchange(const std::vector<dealii::types::global_dof_index> &node,
                             const double *position, const double *support, double skin,
                             MPI_Comm communicator);

  private:
    struct Box
    {
      std::array<double, dim> lowest;
      std::array<double, dim> highest;
    };

    /** A box of own particles, members[begin ... end-1], and how far their supports reach. */
    struct Group
    {
      unsigned int begin, end;
      Box points;
      Box supports;
    };

    Group make_group(unsigned int begin, unsigned int end, const double *position,
                     const double *support, double skin) const;
    void bisect(unsigned int n_particles, const double *position, const double *support,
                double skin);

    using BoxesOfRank = std::array<Box, n_boxes>;

    /** One particle in a message: number, position, support and the last slot of its pad. Plain
     * doubles travel without serialization; they hold the number exactly. */
    static constexpr unsigned int message_size = 2 + 2 * dim;

    /** The boxes of all groups, by rank. Collective. */
    std::vector<BoxesOfRank> gather_boxes(MPI_Comm communicator) const;
    /** The messages of own particles whose supports touch @p boxes. */
    std::vector<double> pack_touching(const BoxesOfRank &boxes,
                                      const std::vector<dealii::types::global_dof_index> &node,
                                      const double *position, const double *support,
                                      double skin) const;
    static RemoteParticles unpack(const std::map<unsigned int, std::vector<double>> &received);

    std::vector<unsigned int> members;
    std::vector<Group> groups;
  };
} // namespace tombolo
