// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/formulations/plastic_heating.h>
#include <tombolo/materials/material.h>
#include <tombolo/materials/strain_measure.h>
#include <tombolo/state/material_points.h>

#include <deal.II/base/tensor.h>

#include <vector>

namespace tombolo
{
  /** The sweeps of direct nodal integration: stress and force of particles from nodal motion. Nodal
   * arrays are at the address of local node 0, node_stride doubles a node. */
  namespace ParticleForce
  {
    /** Advances the stress of every particle by the motion of the last step (eqs 13, 5 and the
     * exact form of 19) and adds -Σ V σ ∇φ (eq. 16) to @p force. Uses the inverse deformation of @p
     * shape if it is current, and leaves it current. @p initial_volume is m̂/ρ₀ of each particle; @p
     * temperature is needed where @p plastic_heating is on. @p deformation, F of each particle at
     * the start of the last step, or null, becomes that at its end. */
    template <int dim>
    void add_internal_force(Stencils &shape, const std::vector<double> &initial_volume,
                            const Material &material, StrainMeasure measure, const double *position,
                            const double *velocity, const double *temperature,
                            double time_increment, const BulkViscosity &bulk_viscosity,
                            const PlasticHeating &plastic_heating, MaterialPoints &points,
                            std::vector<dealii::Tensor<2, dim>> *deformation, double *force);

    /** Adds -Σ V k ∇θ · ∇φ (eqs 29, 35) to slot 0 of @p heat_rate, with the volumes of @p points,
     * or the initial ones where it is null, and k at the temperature @p of_conductivity of each
     * particle. */
    template <int dim>
    void add_conduction(const Stencils &shape, const std::vector<double> &initial_volume,
                        const TemperatureTable &conductivity, const MaterialPoints *points,
                        const double *position, const double *of_conductivity,
                        const double *temperature, double *heat_rate);

    /** Adds Σ V (C : sym ∇v) ∇φ, the elastic stiffness at the present configuration and 2/Δt times
     * the bulk viscosity, to @p force. */
    template <int dim>
    void apply_elastic_stiffness(const Stencils &shape, const Material &material,
                                 StrainMeasure measure, const MaterialPoints &points,
                                 const double *position, const double *velocity, double time_step,
                                 const BulkViscosity &bulk_viscosity, double *force);
  } // namespace ParticleForce
} // namespace tombolo
