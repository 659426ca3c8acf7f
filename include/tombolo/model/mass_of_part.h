// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

namespace tombolo
{
  /** The mass that the cells of a part, or its particles, have at owned nodes, scalar [M]. What
   * dependent nodes had of it is at those on which they depend. Collective. */
  template <int dim>
  NodalVector mass_of_part(const Model<dim> &model, const Formulation<dim> &part)
  {
    NodalVector mass(model.state.partition(), Quantity::scalar);
    part.add_mass(mass);
    mass.collect();
    return mass;
  }
} // namespace tombolo
