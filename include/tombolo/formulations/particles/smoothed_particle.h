// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/particles/particle_method.h>

namespace tombolo
{
  /**
   * Smoothed particle hydrodynamics of solids (doc/smoothed_particles.md): rows of a radial kernel
   * (RadialRows) and no smoothing of velocities, with the material, the integration, the bonds and
   * the conduction of all particles. Where volumes V_I = m_I/ρ_I follow the velocity gradient of
   * the rows, forces are those of the symmetric equation of momentum.
   */
  template <int dim>
  class SmoothedParticle : public ParticleMethod<dim>
  {
  public:
    explicit SmoothedParticle(const Section &section);
    static void declare_parameters(dealii::ParameterHandler &handler);

    double cost_per_cell(const Material &material, double box_ratio) const override;
    NeighbourCounts neighbour_counts() const override;
  };
} // namespace tombolo
