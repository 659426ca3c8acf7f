// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/on_ranks.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/types.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>
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
   * ranks receive; a particle goes, point to point, to the ranks with a box that its support
   * touches. What is sent grows with the interface between ranks.
   */
  template <int dim>
  class ParticleGhosts
  {
  public:
    static constexpr unsigned int n_boxes = 32;

    /** @p node are the global numbers of the particles of this rank; @p position and half widths
     * @p support have node_stride doubles for each; what the last one of the support holds goes
     * along. Supports reach (1 + skin) times as far.
     * Collective; a rank may have no particles. */
    RemoteParticles exchange(const std::vector<dealii::types::global_dof_index> &node,
                             const double *const position, const double *const support,
                             const double skin, MPI_Comm communicator)
    {
      if (dealii::Utilities::MPI::n_mpi_processes(communicator) == 1)
        return {};
      bisect(static_cast<unsigned int>(node.size()), position, support, skin);
      const std::vector<BoxesOfRank> boxes = gather_boxes(communicator);

      const unsigned int own_rank = dealii::Utilities::MPI::this_mpi_process(communicator);
      std::map<unsigned int, std::vector<double>> to_send;
      for (unsigned int rank = 0; rank < boxes.size(); ++rank)
      {
        if (rank == own_rank)
          continue;
        std::vector<double> messages = pack_touching(boxes[rank], node, position, support, skin);
        if (!messages.empty())
          to_send.emplace(rank, std::move(messages));
      }
      return unpack(exchange_by_rank(std::move(to_send), communicator));
    }

  private:
    template <typename Box>
    static bool overlap(const Box &a, const Box &b)
    {
      for (unsigned int d = 0; d < a.lowest.size(); ++d)
        if (!(a.lowest[d] <= b.highest[d] && b.lowest[d] <= a.highest[d]))
          return false;
      return true;
    }

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

    Group make_group(const unsigned int begin, const unsigned int end, const double *const position,
                     const double *const support, const double skin) const
    {
      Group group{begin, end, {}, {}};
      for (Box *box : {&group.points, &group.supports})
      {
        box->lowest.fill(std::numeric_limits<double>::max());
        box->highest.fill(std::numeric_limits<double>::lowest());
      }
      for (unsigned int i = begin; i < end; ++i)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const std::size_t slot = std::size_t(members[i]) * node_stride + d;
          const double x = position[slot], reach = support[slot] * (1. + skin);
          group.points.lowest[d] = std::min(group.points.lowest[d], x);
          group.points.highest[d] = std::max(group.points.highest[d], x);
          group.supports.lowest[d] = std::min(group.supports.lowest[d], x - reach);
          group.supports.highest[d] = std::max(group.supports.highest[d], x + reach);
        }
      return group;
    }
    void bisect(const unsigned int n_particles, const double *const position,
                const double *const support, const double skin)
    {
      members.resize(n_particles);
      for (unsigned int i = 0; i < n_particles; ++i)
        members[i] = i;
      groups.clear();
      if (n_particles == 0)
        return;
      groups.push_back(make_group(0, n_particles, position, support, skin));
      while (groups.size() < n_boxes)
      {
        // The longest edge of all boxes is cut in the middle: gaps and outliers are cut off first.
        double longest = 0;
        std::size_t chosen = 0;
        unsigned int axis = 0;
        for (std::size_t g = 0; g < groups.size(); ++g)
          for (unsigned int d = 0; d < dim; ++d)
          {
            const double length = groups[g].points.highest[d] - groups[g].points.lowest[d];
            if (length > longest)
            {
              longest = length;
              chosen = g;
              axis = d;
            }
          }
        const Group whole = groups[chosen];
        const double middle = 0.5 * (whole.points.highest[axis] + whole.points.lowest[axis]);
        const auto first = members.begin() + whole.begin;
        const auto cut =
            std::partition(first, members.begin() + whole.end,
                           [&](const unsigned int i)
                           { return position[std::size_t(i) * node_stride + axis] < middle; });
        const unsigned int n_below = static_cast<unsigned int>(cut - first);
        if (n_below == 0 || whole.begin + n_below == whole.end)
          break; // a single point, to rounding
        groups[chosen] = make_group(whole.begin, whole.begin + n_below, position, support, skin);
        groups.push_back(make_group(whole.begin + n_below, whole.end, position, support, skin));
      }
    }

    using BoxesOfRank = std::array<Box, n_boxes>;

    /** One particle in a message: number, position, support and the last slot of its pad. Plain
     * doubles are sent without serialization; they hold the number exactly. */
    static constexpr unsigned int message_size = 2 + 2 * dim;

    /** The boxes of all groups, by rank. Collective. */
    std::vector<BoxesOfRank> gather_boxes(MPI_Comm communicator) const
    {
      // Unused boxes touch nothing.
      constexpr double nowhere = std::numeric_limits<double>::infinity();
      BoxesOfRank own_boxes;
      for (unsigned int b = 0; b < n_boxes; ++b)
        if (b < groups.size())
          own_boxes[b] = groups[b].points;
        else
        {
          own_boxes[b].lowest.fill(nowhere);
          own_boxes[b].highest.fill(-nowhere);
        }
      return from_all_ranks(std::vector<BoxesOfRank>{own_boxes}, communicator);
    }
    /** The messages of own particles whose supports touch @p boxes. */
    std::vector<double> pack_touching(const BoxesOfRank &boxes,
                                      const std::vector<dealii::types::global_dof_index> &node,
                                      const double *const position, const double *const support,
                                      const double skin) const
    {
      std::vector<double> messages;
      std::vector<const Box *> touched;
      for (const Group &group : groups)
      {
        touched.clear();
        for (const Box &box : boxes)
          if (overlap(group.supports, box))
            touched.push_back(&box);
        if (touched.empty())
          continue;
        for (unsigned int m = group.begin; m < group.end; ++m)
        {
          const double *const x = position + std::size_t(members[m]) * node_stride;
          const double *const a = support + std::size_t(members[m]) * node_stride;
          Box reach;
          for (unsigned int d = 0; d < dim; ++d)
          {
            reach.lowest[d] = x[d] - a[d] * (1. + skin);
            reach.highest[d] = x[d] + a[d] * (1. + skin);
          }
          if (std::none_of(touched.begin(), touched.end(),
                           [&](const Box *box) { return overlap(reach, *box); }))
            continue;
          messages.push_back(static_cast<double>(node[members[m]]));
          messages.insert(messages.end(), x, x + dim);
          messages.insert(messages.end(), a, a + dim);
          messages.push_back(a[node_stride - 1]);
        }
      }
      return messages;
    }
    static RemoteParticles unpack(const std::map<unsigned int, std::vector<double>> &received)
    {
      std::vector<const double *> particles;
      for (const auto &from : received)
        for (std::size_t i = 0; i < from.second.size(); i += message_size)
          particles.push_back(&from.second[i]);
      std::sort(particles.begin(), particles.end(),
                [](const double *a, const double *b) { return a[0] < b[0]; });
      RemoteParticles result;
      result.node.resize(particles.size());
      result.position.assign(particles.size() * node_stride, 0.);
      result.support.assign(particles.size() * node_stride, 0.);
      for (std::size_t i = 0; i < particles.size(); ++i)
      {
        result.node[i] = static_cast<dealii::types::global_dof_index>(particles[i][0]);
        std::copy_n(particles[i] + 1, dim, &result.position[i * node_stride]);
        std::copy_n(particles[i] + 1 + dim, dim, &result.support[i * node_stride]);
        result.support[i * node_stride + node_stride - 1] = particles[i][1 + 2 * dim];
      }
      return result;
    }

    std::vector<unsigned int> members;
    std::vector<Group> groups;
  };

  extern template class ParticleGhosts<2>;
  extern template class ParticleGhosts<3>;
} // namespace tombolo
