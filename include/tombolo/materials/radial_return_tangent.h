// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/flow_stress.h>
#include <tombolo/materials/material.h>

#include <deal.II/base/aligned_vector.h>

namespace tombolo
{
  /**
   * The consistent tangent of a radial return to a flow stress: made before the stress of a batch
   * is updated, it finds the tangent after that. With the trial stress t = q + 3G Δp, dq = H dΔp,
   *
   * @verbatim
   *   ds = (q/t) 2G de + (3G/q²) [H/(H + 3G) - q/t] s (s : de)
   * @endverbatim
   *
   * where s is the deviator of the stress, q its von Mises stress, Δp the plastic increment.
   */
  class RadialReturnTangent
  {
  public:
    /** Keeps the plastic strain, the first internal variable of @p batch. @p temperature is what
     * the flow stress sees at the start of the step without the heating of its end, null where it
     * sees none. @p heating is the temperature per plastic work, which is the second variable. */
    RadialReturnTangent(const MaterialBatch &batch, const double *temperature, double heating);

    /** Sets @p tangent after update_stress(), by the moduli at each point [M/(L T^2)]. */
    void find(const MaterialBatch &batch, const FlowStress &flow_stress, const double *bulk,
              const double *shear, const MaterialTangent &tangent);

  private:
    using Numbers = dealii::AlignedVector<double>;

    /** Evaluates the slope of the flow stress at the end of the step. */
    void evaluate_slope(const MaterialBatch &batch, const FlowStress &flow_stress);

    Numbers increment;               // first the old plastic strain
    Numbers temperature_without_own; // without the plastic heating of the step; empty: not seen
    Numbers slope;                   // H [M/(L T^2)]
    double heating;
  };
} // namespace tombolo
