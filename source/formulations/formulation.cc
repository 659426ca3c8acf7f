// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/formulation.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/formulations/step_cost.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  template <int dim>
  StepCost Formulation<dim>::step_cost(const Material &material, const double /*box_ratio*/) const
  {
    return StepCosts::of_elements(dim, std::max(degree(), 1u), std::max(n_points_per_cell(), 1u),
                                  StepCosts::per_point, material);
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
  StepLimit Formulation<dim>::courant_limit(const NodalVector &position,
                                            const std::vector<double> &inertia,
                                            const std::vector<unsigned int> &step_ratios) const
  {
    std::vector<double> time_steps;
    courant_limits(position, time_steps);
    StepLimit limit;
    limit.entity = particle_nodes().empty() ? "cell" : "particle";
    unsigned int shortest = 0;
    for (unsigned int i = 0; i < time_steps.size(); ++i)
      if (const double step = time_steps[i] * std::sqrt(inertia.empty() ? 1. : inertia[i]) /
                              (step_ratios.empty() ? 1 : step_ratios[i]);
          step < limit.time_step)
      {
        limit.time_step = step;
        shortest = i;
      }
    if (limit.time_step == StepLimit().time_step)
      return limit;
    std::vector<dealii::Point<dim>> points;
    point_positions(position, points);
    const bool is_point = !particle_nodes().empty();
    const unsigned int n_points = is_point ? 1 : n_points_per_cell();
    for (unsigned int q = 0; q < n_points; ++q)
      for (unsigned int d = 0; d < dim; ++d)
        limit.place[d] += points[is_point ? shortest : point_of_cell(shortest, q)][d] / n_points;
    return limit;
  }

  template <int dim>
  void Formulation<dim>::add_extra_mass(const std::vector<double> & /*inertia*/,
                                        NodalVector & /*mass*/) const
  {
    throw InputError("A part has a formulation whose cells cannot be given mass one by one.");
  }

  template class Formulation<2>;
  template class Formulation<3>;
} // namespace tombolo
