// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/formulations/smoothed/sub_cells.h>
#include <tombolo/model/model.h>
#include <tombolo/remesh/cell_overlap.h>

#include <vector>

namespace tombolo
{
  /** What the nodes of a part have at a refill, by its mass alone. */
  template <int dim>
  class NodalContent
  {
  public:
    /** @p mass: that of the part before the refill, owned. */
    NodalContent(const Model<dim> &model, unsigned int part, NodalVector mass);

    NodalVector mass;     ///< before, scalar, owned
    NodalVector enthalpy; ///< per mass, at the three times of ThermalState; those of after
    NodalVector initial;  ///< those of before, with ghosts

    /** The three temperatures of ThermalState at the nodes of the part. */
    NodalVector temperatures(const Model<dim> &model) const;
    /** The enthalpies of these, with ghosts. */
    NodalVector enthalpies(const Model<dim> &model, const NodalVector &temperatures) const;
    /** Gives nodes the enthalpies of after, where they have the mass @p after of the part (owned).
     */
    void give_heat(Model<dim> &model, const NodalVector &after) const;

    /** The volumes of all points at t_{n-1}, by cell and point; zero of void cells. @p lattice: the
     * cells initially; @p after: the places of their nodes at t_n, with ghosts as @p velocity. */
    static std::vector<double> former_volumes(const std::vector<RemapCell<dim>> &cells,
                                              const std::vector<SmoothedCell<dim>> &lattice,
                                              SmoothedIntegrationRule rule,
                                              const NodalVector &after, const NodalVector &velocity,
                                              double step);

  private:
    unsigned int part;
  };
} // namespace tombolo
