// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/formulation.h>

#include <deal.II/base/tensor.h>

#include <functional>
#include <vector>

namespace tombolo
{
  /** The sweeps of direct nodal integration: what the stresses of particles, the points of @p part,
   * do through the rows of φ and ∇φ in @p shape. @p initial_volume is m̂/ρ₀ of each particle. As in
   * Formulation. */
  namespace ParticleForce
  {
    /** Advances the stress of every particle by the motion of the last step (eqs 13, 5 and the
     * exact form of 19) and adds -Σ V σ ∇φ (eq. 16) to @p force. Uses the inverse deformation of @p
     * shape if it is current. @p deformation, F of each particle at the start of the last step, or
     * null, becomes that at its end. */
    template <int dim>
    void add_internal_force(PartPoints &part, const Stencils &shape,
                            const std::vector<double> &initial_volume, const MechanicalInput &input,
                            std::vector<dealii::Tensor<2, dim>> *deformation, NodalVector &force);

    /** Adds Σ V (C : sym ∇v) ∇φ, the elastic stiffness at the present configuration and 2/Δt times
     * the bulk viscosity, to @p force. */
    template <int dim>
    void apply_elastic_stiffness(const PartPoints &part, const Stencils &shape,
                                 const NodalVector &position, const NodalVector &velocity,
                                 double time_step, NodalVector &force);

    /** A particle and its row stand for a cell. */
    template <int dim>
    void find_cell_equations(PartPoints &part, const Stencils &shape,
                             const std::vector<double> &initial_volume,
                             const MechanicalInput &input,
                             const std::function<void(const CellEquations &)> &take);

    /** Adds -Σ V k ∇θ · ∇φ (eqs 29, 35) to slot 0 of @p heat_rate, with the initial volumes where
     * there are no points. */
    template <int dim>
    void add_conduction(const PartPoints &part, const Stencils &shape,
                        const std::vector<double> &initial_volume, const NodalVector &position,
                        const NodalVector &of_conductivity, const NodalVector &temperature,
                        NodalVector &heat_rate);
  } // namespace ParticleForce
} // namespace tombolo
