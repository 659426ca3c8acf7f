// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/kinematics.h>
#include <tombolo/materials/logarithmic_strain.h>
#include <tombolo/state/material_points.h>

#include <vector>

namespace tombolo
{
  /** The energy W = κ w + w², w = ½ (d + 1/d) - 1, of an own dilatation d; derivatives by ln d. */
  struct OwnDilatation
  {
    static constexpr double stiffness_at_one = 0.01; ///< κ

    explicit OwnDilatation(const Lanes &d)
    {
      const Lanes half_sum = 0.5 * (d + 1. / d), half_difference = 0.5 * (d - 1. / d);
      const Lanes w = half_sum - 1., rise = stiffness_at_one + 2. * w;
      energy = w * (stiffness_at_one + w);
      slope = rise * half_difference;
      stiffness = rise * half_sum + 2. * half_difference * half_difference;
    }

    Lanes energy, slope, stiffness;
  };

  /**
   * The mean of the dilatation over the points of a cell (B-bar, Hughes, Int. J. Numer. Meth. Engng
   * 15, 1413-1418, 1980), for n_lanes cells with the present volumes V_q of their points: L̄_q = L_q
   * + (tr L̄ - tr L_q) I/dim with tr L̄ = Σ V_q tr L_q / Σ V_q, and, energy-conjugate, σ̄_q = σ_q +
   * (p̄ - p_q) I with p_q = tr σ_q/dim, p̄ = Σ V_q p_q / Σ V_q in the force. In two dimensions both
   * are in the plane, and the strain out of it stays zero.
   */
  namespace MeanDilatation
  {
    /** Of a strain or a stress; in two dimensions without the component across the plane. */
    template <int dim>
    Lanes trace_in_plane(const Lanes (&components)[6])
    {
      Lanes sum = components[0];
      for (unsigned int d = 1; d < dim; ++d)
        sum += components[d];
      return sum;
    }

    template <int dim>
    Lanes trace(const Matrix3<Lanes> &matrix)
    {
      Lanes sum = matrix(0, 0) + matrix(1, 1);
      if constexpr (dim == 3)
        sum += matrix(2, 2);
      return sum;
    }

    /** Puts the mean into the gradients L_q; @p shared is what that adds to their diagonals. */
    template <int dim, unsigned int n_points>
    void share_gradient(const Lanes (&volume)[n_points], Matrix3<Lanes> (&gradient)[n_points],
                        Lanes (&shared)[n_points])
    {
      Lanes total = 0., rate = 0.;
      for (unsigned int q = 0; q < n_points; ++q)
      {
        total += volume[q];
        rate += volume[q] * trace<dim>(gradient[q]);
      }
      rate /= total;
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const Lanes difference = (1. / dim) * (rate - trace<dim>(gradient[q]));
        shared[q] = difference;
        for (unsigned int i = 0; i < dim; ++i)
          gradient[q](i, i) += difference;
      }
    }

    /** Puts the mean into the strains of a step. */
    template <int dim, unsigned int n_points>
    void share_strain(const Lanes (&volume)[n_points], MotionIncrement<Lanes> (&motion)[n_points])
    {
      Lanes total = 0., mean = 0.;
      Lanes dilatation[n_points];
      for (unsigned int q = 0; q < n_points; ++q)
      {
        dilatation[q] = trace_in_plane<dim>(motion[q].strain);
        total += volume[q];
        mean += volume[q] * dilatation[q];
      }
      mean /= total;
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int d = 0; d < dim; ++d)
          motion[q].strain[d] += (1. / dim) * (mean - dilatation[q]);
    }

    /** The same for logarithmic strains. Volumes of points change as that of the cell. */
    template <int dim, unsigned int n_points>
    void share_logarithmic(const Lanes (&volume)[n_points],
                           MotionIncrement<Lanes> (&motion)[n_points])
    {
      Lanes present = 0., growth = 0.;
      Lanes dilatation[n_points];
      for (unsigned int q = 0; q < n_points; ++q)
      {
        dilatation[q] = trace_in_plane<dim>(motion[q].strain); // of volume over old volume the ln
        present += volume[q];
        growth -= volume[q] * exponential_less_one(-dilatation[q]);
      }
      growth /= present - growth;
      const Lanes shared = logarithm_of_one_and(growth);
      for (unsigned int q = 0; q < n_points; ++q)
      {
        for (unsigned int d = 0; d < dim; ++d)
          motion[q].strain[d] += (1. / dim) * (shared - dilatation[q]);
        motion[q].volume_factor = 1. + growth;
      }
    }

    /** Either of them. */
    template <int dim, unsigned int n_points>
    void share(const bool is_logarithmic, const Lanes (&volume)[n_points],
               MotionIncrement<Lanes> (&motion)[n_points])
    {
      if (is_logarithmic)
        share_logarithmic<dim>(volume, motion);
      else
        share_strain<dim>(volume, motion);
    }

    /** Sets the motion of points so that their volumes grow by @p factor. */
    template <int dim>
    void set_ratio(const bool is_logarithmic, const Lanes &factor, MotionIncrement<Lanes> &motion)
    {
      const Lanes growth = factor - 1.;
      // The rate form has the strain of the middle of the step.
      const Lanes dilatation =
          is_logarithmic ? logarithm_of_one_and(growth) : growth / (1. + 0.5 * growth);
      const Lanes difference = (1. / dim) * (dilatation - trace_in_plane<dim>(motion.strain));
      for (unsigned int d = 0; d < dim; ++d)
        motion.strain[d] += difference;
      motion.volume_factor = factor;
    }

    /** p̄ of stresses that come multiplied by the volumes. */
    template <int dim, unsigned int n_points>
    Lanes mean_pressure(const Lanes (&volume)[n_points], const Lanes (&stress)[n_points][6])
    {
      Lanes total = 0., sum = 0.;
      for (unsigned int q = 0; q < n_points; ++q)
      {
        total += volume[q];
        for (unsigned int i = 0; i < dim; ++i)
          sum += stress[q][i];
      }
      return sum / (dim * total);
    }

    /** The volume of n_lanes cells over that of @p former; one where there is no cell. */
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

    /** Sets the volumes of those points of a batch from @p first on that @p are_new to the @p
     * present ones, or with @p shares_volume to parts of their sum as they have now. */
    template <unsigned int n_points>
    void set_volumes(MaterialPoints &points, const std::size_t first,
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
  } // namespace MeanDilatation
} // namespace tombolo
