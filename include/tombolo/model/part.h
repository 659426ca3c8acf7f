// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/particles/particle_formulation.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  template <int dim>
  class Model;

  /** Cells × formulation × material. */
  template <int dim>
  struct Part
  {
    std::string name;
    std::shared_ptr<Material> material;
    std::shared_ptr<const ThermalProperties> heat; ///< null in scenes without heat
    std::unique_ptr<Formulation<dim>> formulation;
    ParticleFormulation<dim> *particles = nullptr; ///< the formulation, if it is one of particles
    std::optional<unsigned int> source;            ///< the part whose cells become these particles
    /** The inertia of each cell or particle over that of its inertial density, in the order of
     * Formulation::courant_limits(); empty: one. */
    std::vector<double> inertia;
    /** How many of the shortest steps each cell takes in one (StepGroups), in the same order;
     * empty: one. */
    std::vector<unsigned int> step_ratios;

    /** The formulation, if it can do what @p Cells ask for, else null. */
    template <template <int> class Cells>
    Cells<dim> *as() const
    {
      return dynamic_cast<Cells<dim> *>(formulation.get());
    }
  };

  /** Whether velocities are smoothed in the particle parts among @p parts, in their order: what
   * Bridge::set_smoothed_parts() needs. */
  template <int dim>
  std::vector<bool> smoothed_parts(const std::vector<Part<dim>> &parts)
  {
    std::vector<bool> are_smoothed;
    for (const Part<dim> &part : parts)
      if (part.particles != nullptr)
        are_smoothed.push_back(part.particles->smoothing().is_active);
    return are_smoothed;
  }

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
