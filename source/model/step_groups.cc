// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/step_groups.h>

#include <algorithm>

namespace tombolo
{
  template <int dim>
  void StepGroups<dim>::begin_step(const NodalState &state, const Clock &clock)
  {
    for (Motion &motion : motions)
    {
      if (clock.phase % motion.ratio != 0)
        continue;
      const std::size_t n = std::size_t(state.partition()->n_local()) * node_stride;
      const double *const now = state.position.data();
      double *const last = motion.last_position.data(), *const v = motion.velocity.data();
      // In a step of no duration stresses stay.
      const double rate = motion.elapsed > 0. ? 1. / motion.elapsed : 0.;
      for (std::size_t i = 0; i < n; ++i)
        v[i] = rate * (now[i] - last[i]);
      std::copy_n(now, n, last);
    }
  }

  template <int dim>
  std::string StepGroups<dim>::add_internal_force(const std::size_t part,
                                                  Formulation<dim> &formulation, const Clock &clock,
                                                  const MechanicalInput &input,
                                                  NodalVector &force) const
  {
    GroupedCells<dim> *const cells = cells_of(part);
    if (cells == nullptr)
    {
      formulation.add_internal_force(input, force);
      return formulation.failure();
    }
    std::string failure;
    for (const auto &group : cells->groups())
    {
      if (clock.phase % group.number != 0)
        continue;
      MechanicalInput of_group = input;
      for (const Motion &motion : motions)
        if (motion.ratio == group.number)
        {
          of_group.velocity = &motion.velocity;
          of_group.time_increment = motion.elapsed;
        }
      cells->add_force_of_group(of_group, group, force);
      if (failure.empty())
        failure = formulation.failure();
    }
    return failure;
  }

  template <int dim>
  void StepGroups<dim>::apply_elastic_stiffness(const std::size_t part,
                                                const Formulation<dim> &formulation,
                                                const NodalVector &position,
                                                const NodalVector &velocity, const double time_step,
                                                NodalVector &force) const
  {
    const GroupedCells<dim> *const cells = cells_of(part);
    if (cells == nullptr)
      return formulation.apply_elastic_stiffness(position, velocity, time_step, force);
    for (const auto &group : cells->groups())
      cells->apply_stiffness_of_group(position, velocity, time_step, group, force);
  }

  template class StepGroups<2>;
  template class StepGroups<3>;
} // namespace tombolo
