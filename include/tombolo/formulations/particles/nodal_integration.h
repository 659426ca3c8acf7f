// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/particles/kernel_configuration.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/formulations/plastic_heating.h>
#include <tombolo/formulations/row_material.h>
#include <tombolo/materials/strain_measure.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  struct StateTransfer;

  /**
   * Direct nodal integration: the material points of one part, which are its particles, and what
   * their stresses do through the rows of φ and ∇φ, whichever method they are of. Internal force,
   * elastic stiffness, conduction, plastic heat, energies and step limits; artificial viscosity
   * where it is given.
   */
  template <int dim>
  class NodalIntegration
  {
  public:
    /** Without artificial viscosity. */
    NodalIntegration() = default;
    explicit NodalIntegration(const BulkViscosity &viscosity,
                              StrainMeasure measure = StrainMeasure::rate);

    /** Takes material and heat of the part. In a scene of heat alone there are no points. */
    void initialize(const PartSetup<dim> &setup);

    /** Makes the points of @p particles as they are at the start, with @p further fields behind
     * those of material, viscosity and heat; none in a scene of heat alone. */
    void create_points(const ParticleSet<dim> &particles,
                       const std::vector<FieldDescription> &further = {});

    /** Those of @p particles; the initial ones in a scene of heat alone [L^dim]. */
    std::vector<double> present_volumes(const ParticleSet<dim> &particles) const;

    /** @name As in Formulation, through the rows of @p shape */
    ///@{
    /** @p deformation: as in ParticleForce, or null. */
    void add_internal_force(const ParticleSet<dim> &particles, Stencils &shape,
                            const MechanicalInput &input,
                            std::vector<dealii::Tensor<2, dim>> *deformation, NodalVector &force);
    void apply_elastic_stiffness(const Stencils &shape, const NodalVector &position,
                                 const NodalVector &velocity, double time_step,
                                 NodalVector &force) const;
    void add_conduction(const ParticleSet<dim> &particles, const Stencils &shape,
                        const NodalVector &position, const NodalVector &of_conductivity,
                        const NodalVector &temperature, NodalVector &heat_rate) const;
    void add_plastic_heat(const Stencils &shape, NodalVector &heat);
    double pending_plastic_heat() const;
    EnergyAccounts energies() const;
    std::vector<double> courant_limits(const ParticleSet<dim> &particles,
                                       const KernelConfiguration<dim> &kernel,
                                       const Stencils &shape, const NodalVector &position) const;
    StepLimit diffusion_limit(const ParticleSet<dim> &particles,
                              const KernelConfiguration<dim> &kernel, const Stencils &shape,
                              const NodalVector &position) const;
    ///@}

    /** For the tangent of the points. */
    RowMaterial row_material();
    std::string unfit_to_linearize() const;

    /** The elastic energy of each point, padding included [M L^2/T^2]. */
    std::vector<double> elastic_energies() const;

    /** Makes the state of the present points, of which there are more than before: point i was
     * number old_index[i] of @p old_points, of the initial volume old_volume[old_index[i]], or is
     * new where that is not below their number; it gains the state of cells in @p state, by
     * volume. */
    void merge_points(const ParticleSet<dim> &particles, const MaterialPoints &old_points,
                      const std::vector<double> &old_volume,
                      const std::vector<unsigned int> &old_index, const StateTransfer &state);

    const MaterialPoints &points() const;
    MaterialPoints &points();
    const Material &material() const;
    StrainMeasure measure() const;
    /** The temperature of all points; null without heat. */
    const double *temperature() const;

  private:
    std::shared_ptr<const Material> part_material;
    std::shared_ptr<const ThermalProperties> thermal_properties;
    bool has_points = true;
    BulkViscosity bulk_viscosity;
    StrainMeasure strain_measure = StrainMeasure::rate;
    PlasticHeating plastic_heating;
    MaterialPoints material_points;
  };
} // namespace tombolo
