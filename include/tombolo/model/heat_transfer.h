// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/boundary/thermal_conditions.h>
#include <tombolo/coupling/bridge.h>
#include <tombolo/state/nodal_vector.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace tombolo
{
  /** S of a nodal @p field of scalars, with current ghosts; constrained nodes keep their values.
   * Collective. */
  template <int dim>
  void smooth_scalars(Bridge &bridge, const ThermalConditions<dim> &conditions, NodalVector &field,
                      NodalVector &smoothed)
  {
    field.distribute();
    bridge.apply_smoothing(field, smoothed);
    const std::vector<unsigned int> &constrained = conditions.constrained_nodes();
    if (conditions.has_constraints())
      smoothed.fill(constrained, [&](const std::size_t k, double *const value)
                    { *value = *field.node(constrained[k]); });
  }

  /** Its transpose: Sᵀ of @p heat at nodes (owned, slot 0), added to @p result (scalar). The heat
   * of constrained nodes stays there. Destroys @p heat and @p adjoint, scalars. Collective. */
  template <int dim>
  void add_transposed_smoothing(Bridge &bridge, const ThermalConditions<dim> &conditions,
                                NodalVector &heat, NodalVector &adjoint, std::vector<double> &kept,
                                NodalVector &result)
  {
    heat.condense();
    const std::vector<unsigned int> &constrained = conditions.constrained_nodes();
    kept.clear();
    for (const unsigned int node : constrained)
      kept.push_back(std::exchange(*heat.node(node), 0.));
    const NodalVector &smoothed_capacity = bridge.nodal_mass();
    heat.fill([&](const unsigned int i, double *const nodal_heat)
              { *nodal_heat /= *smoothed_capacity.node(i); });
    bridge.apply_adjoint(heat, adjoint);
    for (unsigned int i = 0; i < heat.partition()->n_owned(); ++i)
      *result.node(i) += *bridge.mass().node(i) * *adjoint.node(i);
    for (std::size_t k = 0; k < constrained.size(); ++k)
      *result.node(constrained[k]) += kept[k];
  }
} // namespace tombolo
