// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/formulation.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/formulations/step_cost.h>

#include <algorithm>

namespace tombolo
{
  template <int dim>
  double Formulation<dim>::cost_per_cell(const Material &material, const double /*box_ratio*/) const
  {
    return StepCost::of_element(dim, std::max(degree(), 1u), std::max(n_points_per_cell(), 1u),
                                StepCost::per_point, material);
  }

  template <int dim>
  void Formulation<dim>::add_conduction(const NodalVector & /*position*/,
                                        const NodalVector & /*of_conductivity*/,
                                        const NodalVector & /*temperature*/,
                                        NodalVector & /*heat_rate*/) const
  {
    throw InputError("A part has a formulation that conducts no heat, but its material has heat.");
  }

  template <int dim>
  StepLimit Formulation<dim>::diffusion_limit(const NodalVector & /*position*/) const
  {
    return {};
  }

  template <int dim>
  void Formulation<dim>::courant_limits(const NodalVector & /*position*/,
                                        std::vector<double> &time_steps) const
  {
    time_steps.clear();
  }

  template <int dim>
  void Formulation<dim>::scale_inertia(const std::vector<double> & /*factors*/)
  {
    throw InputError("A part has a formulation whose cells cannot be given mass one by one, as "
                     "\"Scaling/Target time step\" asks for.");
  }

  template class Formulation<2>;
  template class Formulation<3>;
} // namespace tombolo
