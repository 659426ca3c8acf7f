// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/particles/particle_formulation.h>

#include <memory>
#include <optional>
#include <string>

namespace tombolo
{
  /** Cells × formulation × material. */
  template <int dim>
  struct Part
  {
    std::string name;
    std::shared_ptr<const Material> material;
    std::shared_ptr<const ThermalProperties> heat; ///< null in scenes without heat
    std::unique_ptr<Formulation<dim>> formulation;
    ParticleFormulation<dim> *particles = nullptr; ///< the formulation, if it is one of particles
    std::optional<unsigned int> source;            ///< the part whose cells become these particles
  };
} // namespace tombolo
