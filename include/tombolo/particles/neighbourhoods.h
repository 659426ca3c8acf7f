#pragma once

#include <deal.II/base/index_set.h>

#include <tombolo/particles/neighbour_search.h>
#include <tombolo/particles/particle_ghosts.h>
#include <tombolo/particles/shape_functions.h>
#include <tombolo/state/nodal_vector.h>

#include <vector>

namespace tombolo
{
  /**
   * Which particles of one part are neighbours of which: the rows of ShapeFunctions, across ranks.
   * The order of use is
   *
   *   search()         at the present positions; required_ghosts() may be others afterwards
   *   set_partition()  with a partition that has them, at once; and whenever the partition changes
   *   MovingLeastSquares::compute(nodes(), ...)
   *
   * Candidates are found with a skin, so that they can be kept while candidates_hold().
   */
  template <int dim>
  class Neighbourhoods
  {
  public:
    /** Neighbours are candidates up to (1 + skin) times the support. */
    explicit Neighbourhoods(double skin);

    /** The particles that this rank owns, as ascending local numbers of @p partition: they become
     * the rows of @p shape, without neighbours yet. */
    void reinit(const std::vector<unsigned int> &owned_particles, const NodePartition &partition,
                ShapeFunctions &shape) const;

    /** Finds the candidates of all rows. @p position and half widths @p support are read at owned
     * particles only. Collective over the communicator of their partition. */
    void search(const NodalVector &position, const NodalVector &support, ShapeFunctions &shape);

    /** Particles of other ranks that occur as neighbours. */
    const dealii::IndexSet &required_ghosts() const;

    /** Translates the neighbours to the local numbers of @p partition, which owns the same nodes as
     * that of the search and has the required ghosts. */
    void set_partition(const NodePartition &partition, ShapeFunctions &shape);

    /** Local numbers of all nodes in the rows: own particles, then ghosts. */
    const std::vector<unsigned int> &nodes() const;

    /**
     * Whether every pair within a support is still among the candidates. A pair that was none was
     * apart by a_J (1 + skin) on some axis; that has become |x_I - x_J| >= a_J (1 + skin) - R, with
     * the range R of displacements since the search on that axis, so candidates hold while
     * R <= a_J (1 + skin) - a'_J for all J with new half widths a'. Rigid translation costs
     * nothing. Rigorous for bodies that come together, too. Reads owned particles; collective, the
     * same answer on all ranks.
     */
    bool candidates_hold(const NodalVector &position, const NodalVector &support) const;

    std::size_t memory_consumption() const;

  private:
    double skin;
    NeighbourSearch<dim> finder;
    ParticleGhosts<dim> ghost_finder;

    // Own particles, then those of other ranks, as they were at the search; n_slots doubles each.
    unsigned int n_own = 0;
    std::vector<double> search_position;
    std::vector<double> search_support;

    std::vector<unsigned int> search_rows, search_columns;
    unsigned int n_owned_nodes = 0;
    dealii::IndexSet ghosts;
    std::vector<unsigned int> all_nodes;
  };
} // namespace tombolo
