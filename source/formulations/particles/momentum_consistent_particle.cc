// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/momentum_consistent_particle.h>

#include <tombolo/formulations/particles/least_squares_rows.h>
#include <tombolo/formulations/particles/particle_cost.h>
#include <tombolo/formulations/particles/particle_strain_measure.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void MomentumConsistentParticle<dim>::declare_parameters(const Entries &e)
  {
    ParticleMethod<dim>::declare_shared_parameters(e, "total Lagrangian");
    LeastSquaresRows<dim>::declare_parameters(e);
    SmoothingSettings::declare_parameters(e);
    declare_particle_strain_measure(e);
  }

  template <int dim>
  MomentumConsistentParticle<dim>::MomentumConsistentParticle(const Section &section)
      : ParticleMethod<dim>(section, std::make_unique<LeastSquaresRows<dim>>(section),
                            read_particle_strain_measure(section))
  {
    const auto &of_method = static_cast<const LeastSquaresRows<dim> &>(*this->rows);
    const Kernel &kernel_function = of_method.kernel();
    this->smoothing_settings =
        SmoothingSettings::read(section, kernel_function, of_method.dilation());
  }

  template <int dim>
  double MomentumConsistentParticle<dim>::cost_per_cell(const Material &material,
                                                        const double box_ratio) const
  {
    return particle_cost_per_cell<dim>(this->smoothing_settings, this->kernel,
                                       this->rows->dilation(), box_ratio) +
           material.cost_per_point();
  }

  template class MomentumConsistentParticle<2>;
  template class MomentumConsistentParticle<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, MomentumConsistentParticle, "momentum consistent particle",
      "moving least squares particles, nodally integrated, with momentum-consistent smoothing")
} // namespace tombolo
