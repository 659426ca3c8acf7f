// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/signal.h>
#include <tombolo/state/nodal_vector.h>

#include <cstddef>

namespace tombolo
{
  /** What those processes connect to that have to know more than functions of Process tell.
   * Collective, but for part_force. */
  struct ModelSignals
  {
    /** Masses, cells or rows are about to change: what has to be accounted for with the present
     * ones, by the smoothed velocity of the rows as they are, is accounted for now. */
    Signal<> change;
    /** Rows of a part are about to change in update_stencils(), and its successor: all have, with
     * the partition of before. */
    Signal<> rows_change, rows_changed;
    /** The number of a part, the vector that its internal force at t_n goes to at local nodes,
     * ghosts and images not collected yet, and whether it is added already. */
    Signal<std::size_t, const NodalVector &, bool> part_force;
    /** Owned nodes of which the first vector (scalar) is positive are about to be placed: where
     * they are now, or those next to them on the surface of now, and where they go. Moves those
     * deeper in a surface than these, and those that touched it, to where they are as deep, and
     * marks them in the last vector (scalar). A node with less than one may leave a surface
     * steeply. */
    Signal<const Clock &, const NodalVector &, const NodalVector &, NodalVector &, NodalVector &>
        nodes_move;
    /** Nodes were placed anew, at positions to which no motion has led, as when a part is refilled;
     * their former positions, with the ghosts of now. Emitted after Process::model_changed(). */
    Signal<const Clock &, const NodalVector &> nodes_placed;
    /** A step of bodies at rest begins, where nothing resists rates, and what is apart by less than
     * the length touches. Forces are asked for at several positions, each time with the records
     * that are left now. The clock has in `stable_step` the time of which springs of contacts are
     * made, and in `previous_step` the length of the step, zero at the start of the run. */
    Signal<const Clock &, double> trials;
  };
} // namespace tombolo
