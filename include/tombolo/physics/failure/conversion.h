// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/model/process.h>

#include <vector>

namespace tombolo
{
  template <int dim>
  class ParticleFormulation;

  /**
   * Cells of elements that become particles of another part (`Cells = from PART`) before the forces
   * at t_n, where they fulfil the criterion of their part, with layers of cells around them. Mass,
   * momentum, heat and what was dissipated stay.
   */
  template <int dim>
  class Conversion : public Process<dim>
  {
  public:
    explicit Conversion(Model<dim> &model);

    ModelChange change_model(Model<dim> &model, const Clock &clock) override;

    /** Finds the cells that fulfil the criterion of their part, where the step is one in which the
     * check is made, with the layers around them. Returns whether there are any on any rank.
     * Collective. */
    bool find_converting_cells(Model<dim> &model, const Clock &clock);

    /** Makes particles of the cells of find_converting_cells(). Collective. */
    void convert(Model<dim> &model);

    /** What was stored in the parts less than before, what isolated particles released, and what
     * forces before and after the change do in the two halves of its step: this rank's share
     * [M L^2/T^2]. */
    double lost_energy() const
    {
      return lost;
    }

    /** Over all ranks. Collective. */
    unsigned long n_converted_cells() const;

  private:
    /** A part of elements and the part of particles that its cells become. */
    struct Pair
    {
      unsigned int source, target;
      ConvertingCells<dim> *cells;
      ParticleFormulation<dim> *particles;
    };

    using LocalNodes = std::vector<std::vector<unsigned int>>;

    /** Adds the cells that are too near to the surface of the criterion to those that are chosen.
     */
    static void add_near_cells(Model<dim> &model, const ConversionCriterion &criterion,
                               const LocalNodes &of_cells, double time,
                               std::vector<bool> &is_chosen);
    /** Remembers that these cells of a part became particles, on all ranks that see them.
     * Collective. */
    void note_conversion(const Model<dim> &model, unsigned int source,
                         const std::vector<unsigned int> &cells);
    /** The particles of the pair are those of the cells that have become some. Collective. */
    void give_cells(const Model<dim> &model, const Pair &pair, const StateTransfer *converted,
                    const NodalVector *volumes);
    /** The initial volumes of the particles of a pair at owned nodes, with those of the cells that
     * become particles now, if any do [L^dim]. */
    static NodalVector volumes_of_particles(const Model<dim> &model, const Pair &pair,
                                            const StateTransfer *converted);

    /** Writes to a checkpoint, or reads from it, which cells have become particles. Collective. */
    void serialize_structure(Model<dim> &model, StateArchive &archive);

    MPI_Comm communicator;
    std::vector<Pair> pairs;
    std::vector<bool> is_converted; ///< by active cell, ghosts included; empty before the first
    std::vector<std::vector<unsigned int>> converting_cells; ///< of each pair, in this step
    double lost = 0;
  };
} // namespace tombolo
