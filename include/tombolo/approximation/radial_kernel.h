// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>

#include <cstddef>
#include <memory>

namespace tombolo
{
  /**
   * A kernel of the distance, W(r) = α w(r/(2h)) with the smoothing length h, zero for r >= 2h. The
   * factor α makes its integral over the plane or space one; it comes from a quadrature, and so
   * serves any Kernel.
   */
  template <int dim>
  class RadialKernel
  {
  public:
    RadialKernel(std::shared_ptr<const Kernel> kernel, double smoothing_length);

    /** W [1/L^dim] and dW/dr [1/L^(dim+1)] at @p n distances [L]. @p n is a multiple of n_lanes,
     * and no pointer may be the same. At r = 0 the slope is that of r → 0+. */
    void evaluate(std::size_t n, const double *distance, double *value, double *slope) const;

    /** h [L]. */
    double smoothing_length() const
    {
      return length;
    }
    /** 2h [L]. */
    double support() const
    {
      return 2. * length;
    }

  private:
    std::shared_ptr<const Kernel> kernel;
    double length;
    double scale; ///< α
  };
} // namespace tombolo
