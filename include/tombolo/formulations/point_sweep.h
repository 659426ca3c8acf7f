// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/mean_dilatation.h>
#include <tombolo/formulations/part_points.h>
#include <tombolo/materials/kinematics.h>
#include <tombolo/materials/logarithmic_strain.h>

#include <cstddef>

namespace tombolo
{
  /**
   * Blocks of up to @p size points of a part on their way through a step: one virtual call of the
   * material serves a block, whose data stay in the caches. After begin() each n_lanes points get
   * their motion(), which the owner may share among points of a cell, by move(); then volumes are
   * to be set and nodal_temperature where there is heat, and update_stress() follows.
   */
  template <unsigned int size>
  class PointSweep
  {
  public:
    PointSweep(PartPoints &part, const double time_increment)
        : part(part), points(part.points()), is_logarithmic(part.is_logarithmic())
    {
      batch.time_increment = time_increment;
      for (unsigned int c = 0; c < 6; ++c)
        batch.strain_increment[c] = strain[c];
    }

    /** Begins with @p n points from @p first_point on, a multiple of n_lanes. */
    void begin(const std::size_t first_point, const unsigned int n)
    {
      first = first_point;
      batch.n = n;
      for (unsigned int c = 0; c < 6; ++c)
        batch.stress[c] = points.component(MaterialPoints::stress, c) + first;
      ratio = points.component(MaterialPoints::volume_ratio, 0) + first;
      batch.relative_volume = ratio;
      if (is_logarithmic)
        part.material().elastic_moduli(n, part.temperature(first), bulk, shear);
    }

    /** The motion of n_lanes points from @p i of the block on by H = Δt ∂v/∂x_n. Their stress of
     * t_{n-1} becomes Kirchhoff's and is turned (eq. 19). Once. */
    TOMBOLO_ALWAYS_INLINE MotionIncrement<Lanes> motion(const unsigned int i,
                                                        const Matrix3<Lanes> &h)
    {
      const Lanes old_ratio = load_lanes(ratio + i);
      Lanes stress[6];
      for (unsigned int c = 0; c < 6; ++c)
        stress[c] = old_ratio * load_lanes(batch.stress[c] + i);
      if (is_logarithmic)
        set_moduli(load_lanes(bulk + i), load_lanes(shear + i));
      const MotionIncrement<Lanes> result =
          is_logarithmic ? logarithmic_increment(h, compliance, stress) : rate_increment(h, stress);
      for (unsigned int c = 0; c < 6; ++c)
        store_lanes(stress[c], batch.stress[c] + i);
      return result;
    }

    /** Turns the tensors of the material with the motion of these points, keeps their strain and
     * volume ratio. */
    TOMBOLO_ALWAYS_INLINE void move(const unsigned int i, const MotionIncrement<Lanes> &motion)
    {
      for (unsigned int c = 0; c < 6; ++c)
        store_lanes(motion.strain[c], strain[c] + i);
      part.turn_variables(first + i, motion.spin);
      store_lanes(load_lanes(ratio + i) * motion.volume_factor, ratio + i);
    }

    /** The same for all @p n_points points of n_lanes cells, of which @p n_valid exist, from
     * number @p begin on, by ∂v/∂x and the volumes at the end of the step. @p share(motions) shares
     * the motion of n_lanes points each among those of a cell; with @p shares_volume the points of
     * a cell keep their parts of its volume, by which their energy and Kirchhoff stress are
     * weighed.
     */
    template <unsigned int n_points, typename Share>
    TOMBOLO_ALWAYS_INLINE void move_cells(const unsigned int begin, const unsigned int n_valid,
                                          const Matrix3<Lanes> (&gradient)[n_points],
                                          const Lanes (&volume)[n_points], const bool shares_volume,
                                          MotionIncrement<Lanes> (&motions)[n_points],
                                          const Share &share)
    {
      double *const volumes = points.component(MaterialPoints::volume, 0) + first + begin;
      const Lanes growth =
          shares_volume ? MeanDilatation::growth_of_cell(volumes, volume) : Lanes(1.);
      for (unsigned int q = 0; q < n_points; ++q)
      {
        Matrix3<Lanes> h = gradient[q];
        for (Lanes &entry : h.entry)
          entry *= batch.time_increment;
        motions[q] = motion(begin + q * n_lanes, h);
      }
      share(motions);
      const Lanes is_cell([&](const auto lane) { return lane < n_valid ? 1. : 0.; });
      for (unsigned int q = 0; q < n_points; ++q)
      {
        move(begin + q * n_lanes, motions[q]);
        double *const point_volumes = volumes + q * n_lanes;
        store_lanes(shares_volume ? load_lanes(point_volumes) * growth : is_cell * volume[q],
                    point_volumes);
      }
    }

    /** Advances the stress of the block: Cauchy's afterwards. */
    void update_stress()
    {
      part.complete(batch, first, nodal_temperature, temperature_increment);
      part.material().update_stress(batch);
      for (unsigned int i = 0; i < batch.n; i += n_lanes)
      {
        const Lanes inverse_ratio = 1. / load_lanes(ratio + i);
        for (unsigned int c = 0; c < 6; ++c)
          store_lanes(load_lanes(batch.stress[c] + i) * inverse_ratio, batch.stress[c] + i);
      }
    }

    /** Advances the artificial pressure, with the volumes at the end of the step. */
    void update_viscosity()
    {
      if (part.viscosity().is_on())
        part.viscosity().advance(points, first, batch.n, batch.strain_increment,
                                 batch.time_increment);
    }

    /** At the points of the block; to be set where there is heat. */
    alignas(64) double nodal_temperature[size] = {};

  private:
    /** Points mostly have the moduli of those before them. */
    TOMBOLO_ALWAYS_INLINE void set_moduli(const Lanes &bulk_modulus, const Lanes &shear_modulus)
    {
      if (all_of(bulk_modulus == known_bulk && shear_modulus == known_shear))
        return;
      known_bulk = bulk_modulus;
      known_shear = shear_modulus;
      compliance = Compliance(bulk_modulus, shear_modulus);
    }

    PartPoints &part;
    MaterialPoints &points;
    const bool is_logarithmic;
    std::size_t first = 0;
    double *ratio = nullptr;
    MaterialBatch batch;
    alignas(64) double strain[6][size];
    alignas(64) double bulk[size], shear[size];
    Lanes known_bulk = 0., known_shear = 0.;
    Compliance compliance; ///< of these
    alignas(64) double temperature_increment[size];
  };
} // namespace tombolo
