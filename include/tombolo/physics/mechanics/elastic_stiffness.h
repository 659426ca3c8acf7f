// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/model/part.h>

namespace tombolo
{
  /** Adds the forces of the elastic stiffness of @p part at @p position in a motion over a time
   * step, as its formulation has them, to @p force (not collected over ranks). Where a cell or
   * particle of this rank is turned inside out they are left out: were it thrown here, the other
   * ranks would wait in their exchanges. The stresses of such a place fail in the same step, which
   * ends the run on all ranks. */
  template <int dim>
  void add_elastic_stiffness(const Part<dim> &part, const NodalVector &position,
                             const NodalVector &motion, const double time_step, NodalVector &force)
  {
    try
    {
      part.formulation->apply_elastic_stiffness(position, motion, time_step, force);
    }
    catch (const RunError &)
    {}
  }
} // namespace tombolo
