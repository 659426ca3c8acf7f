#pragma once

#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/formulations/point_heat.h>
#include <tombolo/materials/material.h>
#include <tombolo/particles/shape_functions.h>
#include <tombolo/state/material_points.h>

#include <vector>

namespace tombolo
{
  /** The sweeps of direct nodal integration: stress and force of particles from nodal motion. Nodal
   * arrays are at the address of local node 0, n_slots doubles a node. */
  namespace ParticleForce
  {
    /** Advances the stress of every particle by the motion of the last step (eqs 13, 5 and the
     * exact form of 19) and adds -Σ V σ ∇φ (eq. 16) to @p force. Uses the inverse deformation of @p
     * shape if it is current, and leaves it current. @p initial_volume is m̂/ρ₀ of each particle; @p
     * temperature is needed where @p point_heat is on. */
    template <int dim>
    void add_internal_force(ShapeFunctions &shape, const std::vector<double> &initial_volume,
                            const Material &material, const double *position,
                            const double *velocity, const double *temperature,
                            double time_increment, const BulkViscosity &bulk_viscosity,
                            const PointHeat &point_heat, MaterialPoints &points, double *force);

    /** Adds -Σ V k ∇θ · ∇φ (eqs 29, 35) to slot 0 of @p heat_rate, with the volumes of @p points,
     * or the initial ones where it is null, and k at the temperature @p of_conductivity of each
     * particle. */
    template <int dim>
    void add_conduction(const ShapeFunctions &shape, const std::vector<double> &initial_volume,
                        const TemperatureTable &conductivity, const MaterialPoints *points,
                        const double *position, const double *of_conductivity,
                        const double *temperature, double *heat_rate);

    /** Adds Σ V (C : sym ∇v) ∇φ, the elastic stiffness at the present configuration and 2/Δt times
     * the bulk viscosity, to @p force. */
    template <int dim>
    void add_stiffness_action(const ShapeFunctions &shape, const Material &material,
                              const MaterialPoints &points, const double *position,
                              const double *velocity, double time_step,
                              const BulkViscosity &bulk_viscosity, double *force);
  } // namespace ParticleForce
} // namespace tombolo
