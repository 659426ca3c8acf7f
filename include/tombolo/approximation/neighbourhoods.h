// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbour_search.h>
#include <tombolo/approximation/particle_ghosts.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/state/node_partition.h>

#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * Which particles of one part are neighbours of which: the rows of Stencils, across ranks.
   *
   * search() takes the particles of this rank at their present positions, before any partition of
   * nodes with the right ghosts exists. It numbers the nodes of the rows by places: own particles
   * in their order, then those particles of other ranks that are neighbours; global_nodes() are
   * what a partition has to contain. set_partition() turns places into local numbers, and may be
   * called again for every new partition. Behind the places of nodes are those of images():
   * images of particles of this rank and of others that are neighbours.
   * Candidates are found with a skin, so that they can be kept while candidates_hold().
   */
  template <int dim>
  class Neighbourhoods
  {
  public:
    /** Neighbours are candidates up to (1 + skin) times the support. */
    explicit Neighbourhoods(double skin = 0.);

    /** From the next search on, the neighbours of a row are in the order of their offsets from the
     * particle, whatever their numbers are. */
    void order_by_offset()
    {
      is_ordered_by_offset = true;
    }

    /** Particles see these images of others, from the next search on. */
    void set_images(const std::shared_ptr<const Images> &images)
    {
      images_of_body = images;
    }

    /**
     * Finds the candidates of all particles of this rank, with global numbers @p particles
     * (ascending), positions and half widths with node_stride doubles for each. Particles and
     * neighbours in the rows of @p shape are places. Collective.
     */
    void search(const std::vector<dealii::types::global_dof_index> &particles,
                const std::vector<double> &position, const std::vector<double> &support,
                MPI_Comm communicator, Stencils &shape);

    /** Global numbers of the nodes of the rows, by place; sources of images are among them. */
    const std::vector<dealii::types::global_dof_index> &global_nodes() const
    {
      return all_nodes;
    }

    /** Images that are neighbours. Their places follow those of global_nodes(). */
    const std::vector<ImageNode> &images() const
    {
      return all_images;
    }

    /** Positions and half widths by place, as they were at the search; node_stride doubles each. */
    const std::vector<double> &position_at_search() const
    {
      return all_positions;
    }

    const std::vector<double> &support_at_search() const
    {
      return all_supports;
    }

    /** Particles and neighbours of @p shape become local numbers of @p partition, which must have
     * all global_nodes() and images(). */
    void set_partition(const NodePartition &partition, Stencils &shape);

    /** Takes the neighbours for which @p is_removed(row, place) holds out of the rows, which stay
     * in their order; the places of nodes remain. They come back with the next search. */
    void remove_neighbours(const std::function<bool(unsigned int, unsigned int)> &is_removed,
                           Stencils &shape);

    /** The place of each neighbour in the rows. Particles of this rank have the place of their row.
     */
    const std::vector<unsigned int> &places() const
    {
      return neighbour_place;
    }

    /** By place: the numbers that the rows use at present, places or local numbers. */
    const std::vector<unsigned int> &nodes() const
    {
      return numbers_in_use;
    }

    /**
     * Whether every pair within a support is still among the candidates, for the particles of this
     * rank at other positions and with other half widths, node_stride doubles each in the order of
     * the search. A pair that was none was apart by a_J (1 + skin) on some axis, and still is by
     * a_J (1 + skin) - R, with the range R of all displacements since the search on that axis. So
     * candidates hold while R <= a_J (1 + skin) - a'_J for all J with new half widths a'. Rigid
     * translation costs nothing (except where images move the other way); bodies that come together
     * are seen. Collective, the same answer on all ranks.
     */
    bool candidates_hold(const std::vector<double> &position, const std::vector<double> &support,
                         MPI_Comm communicator) const;

  private:
    /** Appends the images of particles that can reach a particle of this rank to the positions and
     * supports by place. */
    void add_images(const RemoteParticles &remote);

    void sort_by_offset(const std::vector<std::size_t> &row_start);

    double skin;
    bool is_ordered_by_offset = false;
    std::shared_ptr<const Images> images_of_body = Images::none();
    std::vector<ImageNode> all_images;
    std::vector<unsigned int> image_source; // places
    NeighbourSearch<dim> finder;
    ParticleGhosts<dim> ghost_finder;
    unsigned int n_own = 0;
    std::vector<double> all_positions;
    std::vector<double> all_supports;
    std::vector<dealii::types::global_dof_index> all_nodes;
    std::vector<unsigned int> numbers_in_use;
    std::vector<unsigned int> rows, columns;
    std::vector<unsigned int> neighbour_place;
  };
} // namespace tombolo
