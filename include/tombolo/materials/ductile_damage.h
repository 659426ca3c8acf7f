// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/materials/material.h>

#include <memory>

namespace tombolo
{
  /** Arguments of a strain at failure: n points, a multiple of n_lanes; arrays do not overlap. */
  struct FailureStrainBatch
  {
    unsigned int n;            ///< number of points
    const double *triaxiality; ///< mean stress, tension positive, over the von Mises stress
    const double *rate;        ///< of the effective plastic strain [1/T]
    const double *temperature; ///< nullptr if not needed

    double *failure_strain; ///< out: effective plastic strain at failure, larger than zero
  };

  /**
   * The plastic strain ε_f at which a material fails, and the damage of its points, D = Σ Δε_p/ε_f
   * with the ε_f at the end of each step. It changes no stress: criteria of bonds, erosion,
   * conversion compare it with limits.
   */
  class DuctileDamage
  {
  public:
    virtual ~DuctileDamage() = default;

    virtual bool depends_on_temperature() const = 0;

    virtual void evaluate(FailureStrainBatch &batch) const = 0;

    /** That of `Damage` in the section of a material; null for `none`. */
    static std::unique_ptr<const DuctileDamage> create(const Entries &e);

    static FieldDescription field();

    /** Adds to @p damage of @p n points from @p begin on, with the stress of @p batch at the end of
     * the step and the plastic strains there and before; @p temperature is null if not needed. */
    void advance(const MaterialBatch &batch, unsigned int begin, unsigned int n,
                 const double *old_plastic_strain, const double *plastic_strain,
                 const double *temperature, double *damage) const;
  };

  template <>
  struct PluginKind<DuctileDamage>
  {
    static constexpr const char *name = "damage";
  };
} // namespace tombolo
