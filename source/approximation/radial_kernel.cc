// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/radial_kernel.h>

#include <tombolo/base/simd/vectorization.h>

#include <deal.II/base/numbers.h>
#include <deal.II/base/quadrature_lib.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** ∫ w(|x|) dx over the unit ball. */
    template <int dim>
    double integral_over_ball(const Kernel &kernel)
    {
      // Splines of two and of three intervals are polynomials between these points.
      constexpr unsigned int n_intervals = 6;
      const QGauss<1> gauss(8);
      const double surface = dim == 2 ? 2. * numbers::PI : 4. * numbers::PI;
      double sum = 0;
      for (unsigned int i = 0; i < n_intervals; ++i)
        for (unsigned int q = 0; q < gauss.size(); ++q)
        {
          std::array<double, n_lanes> r = {}, w, dw;
          r[0] = (i + gauss.point(q)[0]) / n_intervals;
          kernel.evaluate(n_lanes, r.data(), w.data(), dw.data());
          sum += gauss.weight(q) / n_intervals * surface * std::pow(r[0], dim - 1) * w[0];
        }
      return sum;
    }
  } // namespace

  template <int dim>
  RadialKernel<dim>::RadialKernel(std::shared_ptr<const Kernel> of_coordinate,
                                  const double smoothing_length)
      : kernel(std::move(of_coordinate)), length(smoothing_length),
        scale(1. / (integral_over_ball<dim>(*kernel) * std::pow(2. * length, dim)))
  {}

  template <int dim>
  void RadialKernel<dim>::evaluate(const std::size_t n, const double *const distance,
                                   double *const value, double *const slope) const
  {
    constexpr std::size_t n_at_once = 512;
    static_assert(n_at_once % n_lanes == 0, "whole Lanes");
    alignas(64) double coordinate[n_at_once];
    const double inverse_support = 1. / support();
    for (std::size_t begin = 0; begin < n; begin += n_at_once)
    {
      const std::size_t count = std::min(n_at_once, n - begin);
      for (std::size_t i = 0; i < count; i += n_lanes)
        store_lanes(load_lanes(distance + begin + i) * inverse_support, coordinate + i);
      kernel->evaluate(count, coordinate, value + begin, slope + begin);
      for (std::size_t i = begin; i < begin + count; i += n_lanes)
      {
        store_lanes(load_lanes(value + i) * scale, value + i);
        store_lanes(load_lanes(slope + i) * (scale * inverse_support), slope + i);
      }
    }
  }

  template class RadialKernel<2>;
  template class RadialKernel<3>;
} // namespace tombolo
