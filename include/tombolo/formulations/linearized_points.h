// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/formulations/mean_dilatation.h>
#include <tombolo/formulations/part_points.h>
#include <tombolo/materials/logarithmic_strain.h>

#include <algorithm>

namespace tombolo
{
  /**
   * Points of n_lanes cells whose stress is that of one motion of the step, to first order in the
   * motion: the material is evaluated once, and changed motions follow by its tangent. First
   * begin(), then update() with the motion of the step, then integrate() with others.
   */
  template <unsigned int n_points>
  class LinearizedPoints
  {
  public:
    static constexpr unsigned int size = n_points * n_lanes;

    /** The effect of a motion on the points before the material is evaluated. */
    struct Motion
    {
      Lanes strain[n_points][6];
      Lanes stress[n_points][6]; ///< rotated; Kirchhoff's
      Lanes volume[n_points];
      Lanes spin[n_points][3];
      Lanes volume_ratio[n_points];
    };

    LinearizedPoints(PartPoints &part, const double time_increment)
        : part(part), tangent_values(36 * size)
    {
      for (unsigned int entry = 0; entry < 36; ++entry)
        tangent[entry] = tangent_values.data() + entry * size;
      batch.n = size;
      batch.time_increment = time_increment;
      for (unsigned int c = 0; c < 6; ++c)
      {
        batch.stress[c] = stress_of_batch[c];
        batch.strain_increment[c] = strain_of_batch[c];
      }
      batch.relative_volume = ratio_of_batch;
    }

    bool is_logarithmic() const
    {
      return part.is_logarithmic();
    }

    /** The volume ratio of n_lanes points @p q at the start of the step. */
    const Lanes &old_ratio_of(const unsigned int q) const
    {
      return old_ratio[q];
    }

    /** Reads the state of the points from @p first_point on, at the start of the step. */
    void begin(const std::size_t first_point)
    {
      first = first_point;
      const MaterialPoints &points = part.points();
      alignas(64) double bulk_at[size], shear_at[size];
      part.material().elastic_moduli(size, part.temperature(first), bulk_at, shear_at);
      const double *const volumes = points.component(MaterialPoints::volume, 0) + first;
      std::copy_n(volumes, size, old_volume);
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const unsigned int i = q * n_lanes;
        compliance[q] = Compliance(load_lanes(bulk_at + i), load_lanes(shear_at + i));
        old_ratio[q] = load_lanes(points.component(MaterialPoints::volume_ratio, 0) + first + i);
        for (unsigned int c = 0; c < 6; ++c)
          old_stress[q][c] =
              old_ratio[q] * load_lanes(points.component(MaterialPoints::stress, c) + first + i);
      }
    }

    /** Sets what H = Δt ∂v/∂x of each point makes of the points, whose volumes at the end of the
     * step @p motion has; see PointSweep::move_cells(). */
    template <typename Share>
    void move(const Matrix3<Lanes> (&h)[n_points], const bool shares_volume, const Share &share,
              Motion &motion) const
    {
      const bool grows = shares_volume && is_logarithmic();
      const Lanes growth =
          grows ? MeanDilatation::growth_of_cell(old_volume, motion.volume) : Lanes(1.);
      MotionIncrement<Lanes> increments[n_points];
      for (unsigned int q = 0; q < n_points; ++q)
      {
        std::copy_n(old_stress[q], 6, motion.stress[q]);
        increments[q] = is_logarithmic()
                            ? logarithmic_increment(h[q], compliance[q], motion.stress[q])
                            : rate_increment(h[q], motion.stress[q]);
      }
      share(increments);
      for (unsigned int q = 0; q < n_points; ++q)
      {
        std::copy_n(increments[q].strain, 6, motion.strain[q]);
        std::copy_n(increments[q].spin, 3, motion.spin[q]);
        motion.volume_ratio[q] = old_ratio[q] * increments[q].volume_factor;
        if (grows)
          motion.volume[q] = load_lanes(old_volume + q * n_lanes) * growth;
      }
    }

    /** Evaluates the stress of @p motion and its tangent. Advances the variables of the material,
     * and with heat the temperature, from that of the nodes at the points. */
    void update(const Motion &motion, const double *const nodal_temperature)
    {
      for (unsigned int q = 0; q < n_points; ++q)
      {
        for (unsigned int c = 0; c < 6; ++c)
        {
          store_lanes(motion.stress[q][c], stress_of_batch[c] + q * n_lanes);
          store_lanes(motion.strain[q][c], strain_of_batch[c] + q * n_lanes);
        }
        store_lanes(motion.volume_ratio[q], ratio_of_batch + q * n_lanes);
        part.turn_variables(first + q * n_lanes, motion.spin[q]);
      }
      part.complete(batch, first, nodal_temperature, temperature_increment);
      part.material().update_stress_and_tangent(batch, tangent);
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int c = 0; c < 6; ++c)
          stress[q][c] = load_lanes(stress_of_batch[c] + q * n_lanes);
    }

    /** Volume times stress of @p changed, by that of @p motion of update() and the tangent. */
    void integrate(const Motion &motion, const Motion &changed,
                   Lanes (&integrated)[n_points][6]) const
    {
      for (unsigned int q = 0; q < n_points; ++q)
      {
        Lanes turned[6], strain[6];
        for (unsigned int c = 0; c < 6; ++c)
          turned[c] = changed.stress[q][c] - motion.stress[q][c];
        elastic_strain_of(turned, compliance[q], strain);
        for (unsigned int c = 0; c < 6; ++c)
          strain[c] += changed.strain[q][c] - motion.strain[q][c];
        const Lanes volume = changed.volume[q] / changed.volume_ratio[q];
        for (unsigned int c = 0; c < 6; ++c)
        {
          Lanes sum = stress[q][c];
          for (unsigned int e = 0; e < 6; ++e)
            sum += load_lanes(tangent[6 * c + e] + q * n_lanes) * strain[e];
          integrated[q][c] = volume * sum;
        }
      }
    }

    Lanes stress[n_points][6]; ///< at the end of the step, Kirchhoff's

  private:
    PartPoints &part;
    MaterialBatch batch;
    // Of the points at hand at the start of the step.
    std::size_t first = 0;
    alignas(64) double old_volume[size];
    Lanes old_ratio[n_points], old_stress[n_points][6];
    Compliance compliance[n_points]; // at the temperature of the start
    alignas(64) double stress_of_batch[6][size], strain_of_batch[6][size];
    alignas(64) double ratio_of_batch[size], temperature_increment[size];
    dealii::AlignedVector<double> tangent_values;
    MaterialTangent tangent;
  };

} // namespace tombolo
