// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/elements/mean_limits.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/state/material_points.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/types.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  /** When a cell of elements becomes particles: where the mean effective plastic strain of its
   * points, their mean damage, its shape or the time that a wave needs through it reaches a limit,
   * or where it comes near to a surface. Off unless one of the limits is given. */
  struct ConversionCriterion
  {
    /** None. */
    ConversionCriterion() = default;
    explicit ConversionCriterion(const Entries &e);

    bool is_on() const
    {
      return section.has_value();
    }

    /** Finds strain and damage in @p points, which are none where the scene has no mechanics.
     * Throws InputError where the material has no such field. Does nothing if off. */
    void initialize(const MaterialPoints &points, bool has_mechanics);

    /** Throws InputError for the entry that switches the criterion on. Only if on. */
    [[noreturn]] void refuse(const std::string &message) const;

    MeanLimits largest_means; ///< of strain and damage

    /** Limits; empty: none. Cells with a node nearer than the gap to the contact convert [L]. */
    std::optional<double> smallest_jacobian, smallest_time_step, smallest_gap;
    std::string contact;       ///< the name of the contact; with a gap only
    unsigned int layers = 0;   ///< of cells around one that fulfils the criterion that go with it
    unsigned int interval = 1; ///< cells are checked every so many steps

  private:
    std::optional<Section> section;
  };

  /**
   * The state of cells on their way to particles. A node gets the share V_k of the initial volume
   * of each of its cells that its lumped mass has, and V_k times the mean of the cell's points q,
   * weighted by N_k(ξ_q) V_q: what is the same at all points arrives unchanged.
   */
  struct StateTransfer
  {
    /** For particles with the fields of @p target from cells with those of @p source: vectors of
     * zeros for those that both have and that carry over. */
    StateTransfer(const std::shared_ptr<const NodePartition> &partition,
                  const MaterialPoints &source, const MaterialPoints &target);

    /** One component of a field of both, and Σ_k V_k q at nodes. */
    struct Component
    {
      unsigned int source_field, target_field, number;
      NodalVector sum;
    };

    /** All that cells add to. */
    std::vector<NodalVector *> sums();

    /** Makes the state of the points of particles at these local @p nodes: point i was number
     * old_index[i] of @p old_points, of the initial volume old_volume[old_index[i]], or is new
     * where that is not below their number; it gains the state of cells, by volume. */
    void merge(PartPoints &part, const std::vector<unsigned int> &nodes,
               const std::vector<double> &initial_volume, const MaterialPoints &old_points,
               const std::vector<double> &old_volume,
               const std::vector<unsigned int> &old_index) const;

    NodalVector volume;       ///< Σ V_k, scalar [L^3]
    NodalVector pending_heat; ///< of plastic work, that nodes have not received [M L^2/T^2]
    std::vector<Component> components;
    /** Temperature of the nodes at the present step; null in scenes without heat. */
    const NodalVector *temperature = nullptr;
  };

  /**
   * A part whose cells can become particles of another part while the run goes on. A converted cell
   * makes no force and has no mass any more, but it keeps its number among the cells of the part.
   * Cells are converted between t_{n-1} and t_n, as ErodingCells are removed.
   */
  template <int dim>
  class ConvertingCells
  {
  public:
    virtual ~ConvertingCells() = default;

    /** Whether it is on; if not, nothing else is called. */
    virtual const ConversionCriterion &conversion() const = 0;

    /** The cells of this rank that fulfil the criterion at these positions (with current ghosts),
     * in the order of Formulation::n_cells(), ascending. */
    virtual std::vector<unsigned int> find_converting_cells(const NodalVector &position) const = 0;

    /** Adds the state of @p cells to @p state, ghosts included. */
    virtual void add_state(const std::vector<unsigned int> &cells, StateTransfer &state) const = 0;

    /** Ends @p cells as cells of this part; masses and energies change. Collective. */
    virtual void deactivate_cells(const std::vector<unsigned int> &cells) = 0;

    /** Whether masses of cells change in the run, as by refills, and are not those of the mesh. */
    virtual bool masses_move() const
    {
      return false;
    }

    /** Sets the @p cells that a checkpoint has as particles, before it is read. Collective. */
    virtual void set_converted_cells(const std::vector<unsigned int> & /*cells*/) {}

    /** Keeps among the energies of this part what was dissipated in cells that it lost, and that
     * the particles do not have: plastic and viscous energy and thermal work of @p lost. */
    virtual void keep_dissipated(const EnergyAccounts &lost) = 0;

    /** Whether a cell of this rank is no cell of the part any more, converted or removed. */
    virtual bool is_removed(unsigned int cell) const = 0;

    virtual std::vector<dealii::types::global_dof_index> nodes_of_cell(unsigned int cell) const = 0;

    /** Over this rank. */
    virtual unsigned int n_converted_cells() const = 0;
  };
} // namespace tombolo
