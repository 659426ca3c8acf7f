#pragma once

#include <tombolo/formulations/eroding_cells.h>
#include <tombolo/formulations/particle_formulation.h>

#include <memory>
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
    ErodingCells<dim> *eroding = nullptr; ///< the formulation, if its cells are to be removed
  };
} // namespace tombolo
