// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/formulations/plastic_heating.h>
#include <tombolo/materials/logarithmic_strain.h>
#include <tombolo/materials/material_tangent.h>
#include <tombolo/materials/strain_measure.h>
#include <tombolo/state/material_points.h>

#include <algorithm>

namespace tombolo
{
  /**
   * Points of n_lanes cells whose stress is that of one motion of the step, to first order in the
   * motion: the material is asked once, and answers to changed motions by its tangent. First
   * begin(), then batch_of() and update() with the motion of the step, then integrate() with
   * others.
   */
  template <unsigned int n_points>
  class LinearizedPoints
  {
  public:
    static constexpr unsigned int size = n_points * n_lanes;

    /** What a motion makes of the points before the material answers. */
    struct Motion
    {
      Lanes strain[n_points][6];
      Lanes stress[n_points][6]; ///< rotated; Kirchhoff's where the strain is logarithmic
      Lanes volume[n_points];    ///< left to the owner
      Lanes volume_ratio[n_points], work_factor[n_points];
    };

    explicit LinearizedPoints(const StrainMeasure measure)
        : measure(measure), tangent_values(36 * size)
    {
      for (unsigned int entry = 0; entry < 36; ++entry)
        tangent[entry] = tangent_values.data() + entry * size;
    }

    bool is_logarithmic() const
    {
      return measure == StrainMeasure::logarithmic;
    }

    /** Takes the state of @p points from @p first on, at the start of the step. */
    void begin(MaterialPoints &points, std::size_t first, const Material &material,
               const PlasticHeating &heating);

    /** Sets what the increment of a point makes of it. */
    void move(unsigned int q, const MotionIncrement<Lanes> &increment, Motion &motion) const;

    /** Stress, strain and volumes of @p motion in arrays of this object; temperature and what the
     * material remembers are left to the owner. */
    MaterialBatch batch_of(const Motion &motion, double time_increment);

    /** Asks the material for the stress of such a batch, and its tangent. */
    void update(const Material &material, MaterialBatch &batch);

    /** Volume times stress of @p changed: the stress is that of @p motion, which update() has seen,
     * and what the tangent makes of the difference. */
    void integrate(const Motion &motion, const Motion &changed,
                   Lanes (&integrated)[n_points][6]) const;

    // At the start of the step.
    Lanes old_volume[n_points], old_ratio[n_points];
    Lanes elastic_strain[n_points][6];
    alignas(64) double former_volume[size];

    Lanes stress[n_points][6]; ///< at the end of the step, Kirchhoff's or Cauchy's

  private:
    StrainMeasure measure;
    Lanes old_stress[n_points][6];
    Lanes bulk[n_points], shear[n_points]; // at the temperature of the start
    alignas(64) double stress_of_batch[6][size], strain_of_batch[6][size];
    alignas(64) double factor_of_batch[size], ratio_of_batch[size];
    dealii::AlignedVector<double> tangent_values;
    MaterialTangent tangent;
  };

  template <unsigned int n_points>
  void LinearizedPoints<n_points>::begin(MaterialPoints &points, const std::size_t first,
                                         const Material &material, const PlasticHeating &heating)
  {
    alignas(64) double bulk_at[size], shear_at[size];
    const double *const temperature = heating.temperature(points);
    material.elastic_moduli(size, temperature == nullptr ? nullptr : temperature + first, bulk_at,
                            shear_at);
    const double *const volumes = points.component(MaterialPoints::volume, 0) + first;
    std::copy_n(volumes, size, former_volume);
    for (unsigned int q = 0; q < n_points; ++q)
    {
      const unsigned int i = q * n_lanes;
      bulk[q] = load_lanes(bulk_at + i);
      shear[q] = load_lanes(shear_at + i);
      old_volume[q] = load_lanes(volumes + i);
      old_ratio[q] = load_lanes(points.component(MaterialPoints::volume_ratio, 0) + first + i);
      for (unsigned int c = 0; c < 6; ++c)
      {
        old_stress[q][c] = load_lanes(points.component(MaterialPoints::stress, c) + first + i);
        if (is_logarithmic())
          old_stress[q][c] *= old_ratio[q];
      }
      elastic_strain_of(old_stress[q], bulk[q], shear[q], elastic_strain[q]);
    }
  }

  template <unsigned int n_points>
  void LinearizedPoints<n_points>::move(const unsigned int q,
                                        const MotionIncrement<Lanes> &increment,
                                        Motion &motion) const
  {
    for (unsigned int c = 0; c < 6; ++c)
    {
      motion.strain[q][c] = increment.strain[c];
      motion.stress[q][c] = old_stress[q][c];
    }
    rotate(increment.spin, motion.stress[q]);
    motion.volume_ratio[q] = old_ratio[q] * increment.volume_factor;
    motion.work_factor[q] = work_factor(increment);
  }

  template <unsigned int n_points>
  MaterialBatch LinearizedPoints<n_points>::batch_of(const Motion &motion,
                                                     const double time_increment)
  {
    MaterialBatch batch;
    batch.n = size;
    batch.time_increment = time_increment;
    batch.measure = measure;
    for (unsigned int c = 0; c < 6; ++c)
    {
      for (unsigned int q = 0; q < n_points; ++q)
      {
        store_lanes(motion.stress[q][c], stress_of_batch[c] + q * n_lanes);
        store_lanes(motion.strain[q][c], strain_of_batch[c] + q * n_lanes);
      }
      batch.stress[c] = stress_of_batch[c];
      batch.strain_increment[c] = strain_of_batch[c];
    }
    for (unsigned int q = 0; q < n_points; ++q)
    {
      store_lanes(motion.volume_ratio[q], ratio_of_batch + q * n_lanes);
      store_lanes(is_logarithmic() ? motion.work_factor[q] : motion.volume_ratio[q],
                  factor_of_batch + q * n_lanes);
    }
    batch.volume_ratio = factor_of_batch;
    batch.relative_volume = ratio_of_batch;
    return batch;
  }

  template <unsigned int n_points>
  void LinearizedPoints<n_points>::update(const Material &material, MaterialBatch &batch)
  {
    material.update_stress_and_tangent(batch, tangent);
    for (unsigned int q = 0; q < n_points; ++q)
      for (unsigned int c = 0; c < 6; ++c)
        stress[q][c] = load_lanes(stress_of_batch[c] + q * n_lanes);
  }

  template <unsigned int n_points>
  void LinearizedPoints<n_points>::integrate(const Motion &motion, const Motion &changed,
                                             Lanes (&integrated)[n_points][6]) const
  {
    for (unsigned int q = 0; q < n_points; ++q)
    {
      Lanes turned[6], strain[6];
      for (unsigned int c = 0; c < 6; ++c)
        turned[c] = changed.stress[q][c] - motion.stress[q][c];
      elastic_strain_of(turned, bulk[q], shear[q], strain);
      for (unsigned int c = 0; c < 6; ++c)
        strain[c] += changed.strain[q][c] - motion.strain[q][c];
      const Lanes volume =
          is_logarithmic() ? changed.volume[q] / changed.volume_ratio[q] : changed.volume[q];
      for (unsigned int c = 0; c < 6; ++c)
      {
        Lanes sum = stress[q][c];
        for (unsigned int e = 0; e < 6; ++e)
          sum += load_lanes(tangent[6 * c + e] + q * n_lanes) * strain[e];
        integrated[q][c] = volume * sum;
      }
    }
  }
} // namespace tombolo
