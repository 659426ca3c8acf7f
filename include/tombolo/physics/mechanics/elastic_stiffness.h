// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/model/assembly.h>
#include <tombolo/model/model.h>

namespace tombolo
{
  /** @p force := the nodal forces of the elastic stiffness of all parts in a @p motion over a time
   * step at the present positions, as their formulations have them. @p motion has current ghosts.
   * Where a cell or particle of this rank is turned inside out the forces of its part are left out:
   * were it thrown here, the other ranks would wait in their exchanges. The stresses of such a
   * place fail in the same step, which ends the run on all ranks. With @p by_groups it is that of
   * StepGroups, which bounds the step. Collective. */
  template <int dim>
  void apply_elastic_stiffness(const Model<dim> &model, const NodalVector &motion,
                               const double time_step, NodalVector &force,
                               const bool by_groups = false)
  {
    Assembly<dim>(model.parts)
        .assemble(*model.bridge, motion, force,
                  [&](const Part<dim> &part, const NodalVector &seen, NodalVector &sum)
                  {
                    const auto number = static_cast<std::size_t>(&part - model.parts.data());
                    try
                    {
                      if (by_groups)
                        model.step_groups.apply_elastic_stiffness(
                            number, *part.formulation, model.state.position, seen, time_step, sum);
                      else
                        part.formulation->apply_elastic_stiffness(model.state.position, seen,
                                                                  time_step, sum);
                    }
                    catch (const RunError &)
                    {}
                  });
  }
} // namespace tombolo
