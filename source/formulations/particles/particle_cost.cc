// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_cost.h>

#include <tombolo/formulations/step_cost.h>

#include <cmath>

namespace tombolo
{
  namespace
  {
    // Measured, for each neighbour [ns].
    constexpr double per_neighbour = 4.;       // deformation and force
    constexpr double per_smoothing = 4.;       // velocity and motion with Φ
    constexpr double per_sharpening = 4.;      // Φ again, for γ
    constexpr double per_affine_term = 2.5;    // velocity gradient and moments
    constexpr double own_rows = 1.25;          // where rows are not shared by particles
    constexpr double per_shape_function = 18.; // neighbours and shape functions built anew
  }                                            // namespace

  template <int dim>
  double particle_cost_per_cell(const SmoothingSettings &smoothing,
                                const KernelConfiguration<dim> &kernel, const double dilation,
                                const double box_ratio)
  {
    // Neighbours on a lattice along the axes, where a support reaches over `dilation` spacings to
    // both sides; supports around a lattice that is turned or skewed hold as many more as the box
    // around a cell is larger.
    const double n_neighbours = box_ratio * std::pow(2. * std::ceil(dilation) - 1., dim);
    double cost = per_neighbour;
    if (smoothing.is_active)
      cost += per_smoothing + (smoothing.affine        ? per_affine_term
                               : smoothing.gamma != 0. ? per_sharpening
                                                       : 0.);
    if (!kernel.is_total_lagrangian())
      cost *= own_rows;
    if (kernel.is_current())
      cost += per_shape_function;
    return StepCost::per_node + n_neighbours * cost;
  }

  template double particle_cost_per_cell(const SmoothingSettings &, const KernelConfiguration<2> &,
                                         double, double);
  template double particle_cost_per_cell(const SmoothingSettings &, const KernelConfiguration<3> &,
                                         double, double);
} // namespace tombolo
