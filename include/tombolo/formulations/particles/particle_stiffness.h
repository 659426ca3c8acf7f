// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/row_material.h>

#include <functional>
#include <vector>

namespace tombolo
{
  /** Formulation::find_cell_equations() of particles that are integrated at their nodes: a particle
   * and its row stand for a cell. */
  template <int dim>
  void find_particle_equations(const Stencils &shape, const std::vector<double> &initial_volume,
                               const RowMaterial &material, const MechanicalInput &input,
                               const std::function<void(const CellEquations &)> &take);
} // namespace tombolo
