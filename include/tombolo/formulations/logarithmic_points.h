// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/logarithmic_strain.h>
#include <tombolo/state/material_points.h>

namespace tombolo
{
  /** What points of StrainMeasure::logarithmic do around Material::update_stress(), of which the
   * stress is Kirchhoff's. */
  namespace LogarithmicPoints
  {
    /** Puts the Kirchhoff stress of t_{n-1} in the place of Cauchy's at n_lanes points from @p i
     * on, and returns their motion by H = @p h; the stress is not turned yet. */
    inline MotionIncrement<Lanes> begin(MaterialPoints &points, const std::size_t i,
                                        const Matrix3<Lanes> &h, const Lanes &bulk_modulus,
                                        const Lanes &shear_modulus)
    {
      const Lanes ratio = load_lanes(points.component(MaterialPoints::volume_ratio, 0) + i);
      Lanes stress[6], elastic_strain[6];
      for (unsigned int c = 0; c < 6; ++c)
      {
        double *const of_points = points.component(MaterialPoints::stress, c) + i;
        stress[c] = ratio * load_lanes(of_points);
        store_lanes(stress[c], of_points);
      }
      elastic_strain_of(stress, bulk_modulus, shear_modulus, elastic_strain);
      return logarithmic_increment(h, elastic_strain);
    }

    /** The volume of n_lanes cells, as their points have it now, over that of @p former; one where
     * there is no cell. */
    template <unsigned int n_points>
    Lanes growth_of_cell(const double *former, const Lanes (&present)[n_points])
    {
      Lanes before = 0., now = 0., growth = 1.;
      for (unsigned int q = 0; q < n_points; ++q)
      {
        before += load_lanes(former + q * n_lanes);
        now += present[q];
      }
      where(before > 0., growth) = now / before;
      return growth;
    }

    /** Gives those points of a batch from @p first on that @p are_new the @p present volumes, or
     * with @p shares_volume parts of their sum as they have now. */
    template <unsigned int n_points>
    void take_volumes(MaterialPoints &points, const std::size_t first,
                      const Lanes (&present)[n_points], const bool shares_volume,
                      const std::vector<bool> &are_new)
    {
      double *const volumes = points.component(MaterialPoints::volume, 0);
      const Lanes growth = growth_of_cell(volumes + first, present);
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          if (const std::size_t i = first + q * n_lanes + lane; are_new[i])
            volumes[i] = shares_volume ? volumes[i] * growth[lane] : present[q][lane];
    }

    /** Makes the Kirchhoff stress of @p n points from @p first on Cauchy's, with the volume ratio
     * at t_n. */
    inline void complete(MaterialPoints &points, const std::size_t first, const unsigned int n)
    {
      for (std::size_t i = first; i < first + n; i += n_lanes)
      {
        const Lanes inverse_ratio =
            1. / load_lanes(points.component(MaterialPoints::volume_ratio, 0) + i);
        for (unsigned int c = 0; c < 6; ++c)
        {
          double *const stress = points.component(MaterialPoints::stress, c) + i;
          store_lanes(load_lanes(stress) * inverse_ratio, stress);
        }
      }
    }
  } // namespace LogarithmicPoints
} // namespace tombolo
