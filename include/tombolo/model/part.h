// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/formulations/elements/eroding_cells.h>
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
    ErodingCells<dim> *eroding = nullptr; ///< the formulation, if its cells are to be removed
    /** The formulation, if its cells are to become particles. */
    ConvertingCells<dim> *converting = nullptr;
    std::optional<unsigned int> source; ///< the part whose cells become these particles

    /** Whether a cell of this rank is no cell of the part any more. */
    bool has_lost(const unsigned int cell) const
    {
      return (eroding != nullptr && eroding->is_removed(cell)) ||
             (converting != nullptr && converting->is_removed(cell));
    }
  };
} // namespace tombolo
