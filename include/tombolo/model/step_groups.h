// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/formulations/elements/grouped_cells.h>
#include <tombolo/state/nodal_state.h>

#include <cstddef>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The cells of a model that take longer steps than its nodes do, each an integer number of them,
   * its ratio. Nodes move in each step. The forces of a cell of the ratio r act in every r-th step
   * as the impulse of r steps, by the motion of its nodes since they last did: the composition is
   * symplectic, and each cell keeps linear and angular momentum by itself. All cells act together
   * in the first step of each cycle, and only then the state of the model is that of one time. With
   * no ratio but one there are no groups, and all is as without this class.
   *
   * Asynchronous variational integrators: Lew, Marsden, Ortiz and West, 2003; where they resonate:
   * Fong, Darve and Lew, 2008.
   */
  template <int dim>
  class StepGroups
  {
  public:
    /** The motion that cells of a ratio above one see. */
    struct Motion
    {
      unsigned int ratio = 1;
      NodalVector last_position; ///< where these cells acted last [L]
      NodalVector velocity;      ///< the mean since then [L/T]
      double elapsed = 0;        ///< since then [T]
    };

    /** Steps in a cycle: a multiple of all ratios. */
    unsigned int cycle = 1;

    std::vector<Motion> motions; ///< by ratio, ascending
    /** Of each part of the model; null: all of its cells take each step. Empty: so do all parts. */
    std::vector<GroupedCells<dim> *> parts;

    /** Finds the motion of those cells that act in this step; ghosts of positions are current. */
    void begin_step(const NodalState &state, const Clock &clock);

    /** The nodes have moved for a step. */
    void add_time(const double step)
    {
      for (Motion &motion : motions)
        motion.elapsed += step;
    }

    /** Formulation::add_internal_force() of those cells of a part, by its number, that act in this
     * step. Returns what makes it useless, or nothing. */
    std::string add_internal_force(std::size_t part, Formulation<dim> &formulation,
                                   const Clock &clock, const MechanicalInput &input,
                                   NodalVector &force) const;

    /** Formulation::apply_elastic_stiffness() of a part, with each cell in its own step, such that
     * the largest eigenvalue bounds @p time_step, the shortest. */
    void apply_elastic_stiffness(std::size_t part, const Formulation<dim> &formulation,
                                 const NodalVector &position, const NodalVector &velocity,
                                 double time_step, NodalVector &force) const;

  private:
    GroupedCells<dim> *cells_of(const std::size_t part) const
    {
      return part < parts.size() ? parts[part] : nullptr;
    }
  };
} // namespace tombolo
