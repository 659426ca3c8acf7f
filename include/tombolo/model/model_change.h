// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  /** What has changed in a model before the forces of a step are evaluated; the same on all ranks.
   */
  struct ModelChange
  {
    bool stencils = false; ///< values or neighbours of rows: the operators have another spectrum
    bool masses = false;   ///< inertia of nodes
    bool cells = false;    ///< cells were removed: an earlier limit of the step says nothing

    ModelChange &operator|=(const ModelChange &other)
    {
      stencils = stencils || other.stencils;
      masses = masses || other.masses;
      cells = cells || other.cells;
      return *this;
    }
  };
} // namespace tombolo
