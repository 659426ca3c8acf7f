// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/particles/kernel_configuration.h>
#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/formulations/particles/particle_set.h>

#include <functional>
#include <string>
#include <vector>

namespace tombolo
{
  template <int dim>
  class CellDilatation;
  class ZeroEnergyControl;

  /**
   * Particles of one part that are integrated at their nodes, whatever their φ and ∇φ are: a
   * particle method that derives from this class fills its stencils, names the nodes that they need
   * and translates their numbers. Everything else follows from the stencils.
   */
  template <int dim>
  class NodalParticles : public ParticleFormulation<dim>
  {
  public:
    /** Where elements of half the size lie beside cells of particles, or these beside elements of
     * twice their size. Such nodes are no particles. */
    MiddleNodes middle_nodes() const override
    {
      return MiddleNodes::means;
    }
    const ParticleSet<dim> &particle_set() const override
    {
      return set;
    }
    bool follows_positions() const override
    {
      return dilatation != nullptr;
    }
    dealii::Point<dim> support(unsigned int i) const override;
    dealii::Tensor<2, dim> deformation(const unsigned int i,
                                       const NodalVector &position) const override
    {
      return kernel.total_deformation(i, this->stencils(), position);
    }

    void add_internal_force(const MechanicalInput &input, NodalVector &force) override;
    void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                 double time_step, NodalVector &force) const override;
    void courant_limits(const NodalVector &position,
                        std::vector<double> &time_steps) const override;
    void add_conduction(const NodalVector &position, const NodalVector &of_conductivity,
                        const NodalVector &temperature, NodalVector &heat_rate) const override;
    StepLimit diffusion_limit(const NodalVector &position) const override;
    void add_plastic_heat(NodalVector &heat) override;
    void find_cell_equations(const MechanicalInput &input,
                             const std::function<void(const CellEquations &)> &take) override;
    void find_couplings(const NodeGroupAction &use) const override;
    std::optional<std::string> unfit_to_linearize() const override;

  protected:
    /** Finds the particles of the cells of @p is_taken, in their initial configuration. Returns
     * their masses, for Stencils::mass. @p volumes: their initial ones at owned nodes [L^dim];
     * null: those of the mesh. */
    std::vector<double> collect_particles(const PartSetup<dim> &setup, double dilation,
                                          const CellSelection<dim> &is_taken,
                                          const NodalVector *volumes = nullptr);

    /** Makes the points of the particles as they are at the start, with @p further fields behind
     * those of material, viscosity and heat; none in a scene of heat alone. */
    void create_points(const std::vector<FieldDescription> &further = {});

    using Formulation<dim>::part_points;
    ParticleSet<dim> set;
    KernelConfiguration<dim> kernel;
    CellDilatation<dim> *dilatation = nullptr; ///< null: particles have their own
    ZeroEnergyControl *control = nullptr;      ///< of modes that gradients hardly see; or null
  };
} // namespace tombolo
