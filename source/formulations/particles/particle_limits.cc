// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/momentum_consistent_particle.h>

#include <tombolo/approximation/row_deformation.h>
#include <tombolo/approximation/support_size.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  template <typename Use>
  void MomentumConsistentParticle<dim>::for_present_supports(const NodalVector &position,
                                                             const Use &use) const
  {
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      Tensor<2, dim> deformation = row_deformation<dim>(shape, i, position);
      if (shape.is_rigid(i))
        deformation = unit_symmetric_tensor<dim>();
      const Tensor<2, dim> total = deformation * reference_deformation[i];
      double row_major[dim * dim], half_width[node_stride];
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          row_major[a * dim + b] = total[a][b];
      SupportSize::stretch<dim>(row_major, initial_support.data() + std::size_t(i) * node_stride,
                                half_width);
      use(i, half_width);
    }
  }

  template <int dim>
  StepLimit MomentumConsistentParticle<dim>::courant_limit(const NodalVector &position) const
  {
    StepLimit limit;
    limit.entity = "particle";
    const double speed = part_material->longitudinal_wave_speed();
    for_present_supports(position,
                         [&](const unsigned int i, const double *half_width)
                         {
                           const double factor = inertia_factors.empty() ? 1. : inertia_factors[i];
                           const double width = *std::min_element(half_width, half_width + dim);
                           const double step = width / speed * std::sqrt(factor);
                           if (step >= limit.time_step)
                             return;
                           limit.time_step = step;
                           for (unsigned int c = 0; c < dim; ++c)
                             limit.place[c] = position.node(shape.particle_node[i])[c];
                         });
    return limit;
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::courant_limits(const NodalVector &position,
                                                       std::vector<double> &time_steps) const
  {
    time_steps.clear();
    const double speed = part_material->longitudinal_wave_speed();
    for_present_supports(
        position, [&](const unsigned int, const double *half_width)
        { time_steps.push_back(*std::min_element(half_width, half_width + dim) / speed); });
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::scale_inertia(const std::vector<double> &factors)
  {
    AssertDimension(factors.size(), shape.n_particles());
    inertia_factors = factors;
  }

  template <int dim>
  StepLimit MomentumConsistentParticle<dim>::diffusion_limit(const NodalVector &position) const
  {
    StepLimit limit;
    limit.entity = "particle";
    const double diffusivity = thermal_properties->largest_diffusivity() / part_material->density();
    if (diffusivity == 0.)
      return limit;
    for_present_supports(position,
                         [&](const unsigned int i, const double *half_width)
                         {
                           for (unsigned int d = 0; d < dim; ++d)
                           {
                             const double step = half_width[d] * half_width[d] / (2. * diffusivity);
                             if (step >= limit.time_step)
                               continue;
                             limit.time_step = step;
                             for (unsigned int c = 0; c < dim; ++c)
                               limit.place[c] = position.node(shape.particle_node[i])[c];
                           }
                         });
    return limit;
  }

  template StepLimit MomentumConsistentParticle<2>::courant_limit(const NodalVector &) const;
  template void MomentumConsistentParticle<2>::courant_limits(const NodalVector &,
                                                              std::vector<double> &) const;
  template void MomentumConsistentParticle<2>::scale_inertia(const std::vector<double> &);
  template StepLimit MomentumConsistentParticle<2>::diffusion_limit(const NodalVector &) const;
  template StepLimit MomentumConsistentParticle<3>::courant_limit(const NodalVector &) const;
  template void MomentumConsistentParticle<3>::courant_limits(const NodalVector &,
                                                              std::vector<double> &) const;
  template void MomentumConsistentParticle<3>::scale_inertia(const std::vector<double> &);
  template StepLimit MomentumConsistentParticle<3>::diffusion_limit(const NodalVector &) const;
} // namespace tombolo
