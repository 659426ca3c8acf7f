// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/input/registry.h>
#include <tombolo/state/material_points.h>

#include <cstdint>
#include <vector>

namespace tombolo
{
  /**
   * When the bond between two particles breaks: a function of a measure at both of them, of which
   * the mean counts, and of the stretch of the pair, its present over its initial distance. Both
   * are the same seen from either end, and so on every rank. In batches; it has no neighbourhoods.
   */
  class BondFailure
  {
  public:
    virtual ~BondFailure() = default;

    /** Throws the InputError that points with these fields cannot be judged. */
    virtual void check(const MaterialPoints & /*points*/) const {}

    virtual bool needs_deformation() const
    {
      return false;
    }

    /** By particle. @p deformation: F since the start, 3×3 always; empty unless it is needed. */
    virtual void measure(const MaterialPoints &points,
                         const std::vector<dealii::Tensor<2, 3>> &deformation,
                         std::vector<double> &value) const = 0;

    /** No pair is checked where no measure reaches this; minus infinity: there is no such bound. */
    virtual double threshold() const = 0;

    /** Which of @p n pairs break, 1 or 0, by the mean of their measures and their stretches. */
    virtual void judge(unsigned int n, const double *mean, const double *stretch,
                       std::uint8_t *breaks) const = 0;
  };

  template <>
  struct PluginKind<BondFailure>
  {
    static constexpr const char *name = "bond failure";
  };
} // namespace tombolo
