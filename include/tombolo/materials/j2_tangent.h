// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/materials/flow_stress.h>
#include <tombolo/materials/material_tangent.h>

namespace tombolo
{
  /**
   * The consistent tangent of the radial return of J2Plasticity, from its state before and after a
   * step. With the trial stress t = q + 3G Δp of a point that flows, and the slope dq = H dΔp,
   *
   * @verbatim
   *   ds = (q/t) 2G de + (3G/q²) [H/(H + 3G) - q/t] s (s : de)
   * @endverbatim
   */
  class J2Tangent
  {
  public:
    /** Of a batch whose stress comes next. "effective plastic strain" and "plastic work" are its
     * first two internal variables; @p temperature is what the flow stress sees, null for none, and
     * rises by @p heating per plastic work. */
    J2Tangent(const MaterialBatch &batch, const double *temperature, double heating);

    /** For the moduli at the end of the step. */
    double *bulk()
    {
      return bulk_moduli.begin();
    }
    double *shear()
    {
      return shear_moduli.begin();
    }

    /** What the flow stress is to be evaluated at, after the stress of the batch was updated. */
    FlowStressBatch end_of_step(const MaterialBatch &batch);

    /** Sets the tangent, after that evaluation. */
    void find(const MaterialBatch &batch, const MaterialTangent &tangent) const;

  private:
    using Numbers = dealii::AlignedVector<double>;

    void soften(const MaterialBatch &batch, unsigned int i, const MaterialTangent &tangent) const;

    double heating;
    bool sees_temperature;
    Numbers bulk_moduli, shear_moduli;
    Numbers increment; ///< at first the strain before the step
    Numbers temperature, temperature_change, flow, slope;
  };
} // namespace tombolo
