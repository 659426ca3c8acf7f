// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/coupling/hanging_nodes.h>
#include <tombolo/model/model.h>

namespace tombolo
{
  /** The mass that the cells of a part, or its particles, have at owned nodes, scalar [M]. What
   * hanging nodes had of it is at those between which they lie. Collective. */
  template <int dim>
  NodalVector mass_of_part(const Model<dim> &model, const Formulation<dim> &part)
  {
    NodalVector mass;
    mass.reinit(model.state.partition(), 1);
    part.add_mass(mass);
    mass.add_to_owners();
    collect(model.hanging_nodes, mass);
    return mass;
  }
} // namespace tombolo
