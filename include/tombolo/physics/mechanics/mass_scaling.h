// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/part.h>
#include <tombolo/physics/mechanics/scaling_settings.h>

#include <vector>

namespace tombolo
{
  /**
   * The inertia of the parts of a scene where it is not that of their densities. The uniform factor
   * is known to the materials (Material::scale_inertia), whose wave speeds follow; this class
   * keeps the factors of single cells and particles, which bring each of them to the target step.
   * By the theorem of element eigenvalues the step of a mesh is at least the smallest one of its
   * elements, each with its own mass.
   */
  template <int dim>
  class MassScaling
  {
  public:
    /** @p parts must outlive it; start() comes after they are initialized. */
    MassScaling(const Section &section, const ScalingSettings &settings,
                const std::vector<Part<dim>> &parts, MPI_Comm communicator);

    const ScalingSettings &settings() const;

    /** Finds the factors for the initial positions (with current ghosts). Throws InputError where
     * the target does nothing, or would take too much. Collective. */
    void start(const NodalVector &position);

    /** Raises the factors of cells and particles whose step has fallen below the target. Says
     * whether there are any, on any rank: masses have changed then. Collective. */
    bool raise(const NodalVector &position);

    /** Whether the mass is to be looked at in this step. */
    bool is_due(unsigned long step) const;

    /** Makes the inertia of element nodes from their mass, which add_mass() has added on all ranks
     * that see them: adds that of single cells, collects ghosts and applies the uniform factor. */
    void complete_element_mass(NodalVector &element_mass) const;

    /** Factors of the masses of particles, by particle part, and further ones by row; what is empty
     * is one. */
    std::vector<double> particle_factors() const;
    std::vector<std::vector<double>> row_factors() const;

    /** Numbers over all ranks. Collective. */
    struct Extent
    {
      unsigned long cells = 0, particles = 0; ///< that have more than the uniform factor
      double smallest_step = 0;               ///< by eq. (41), without any scaling [T]
    };
    Extent extent(const NodalVector &position) const;

    /** Writes the factors of a part to a checkpoint or reads them; rows of the archive are its
     * cells or particles. Collective. */
    void serialize(StateArchive &archive, unsigned int part);

  private:
    Section section;
    ScalingSettings chosen;
    const std::vector<Part<dim>> &parts;
    MPI_Comm communicator;
    std::vector<std::vector<double>> factors; // by part, of cells or particles; selective only
  };
} // namespace tombolo
