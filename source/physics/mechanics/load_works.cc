// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/load_works.h>

#include <tombolo/state/state_archive.h>

#include <string>

namespace tombolo
{
  template <int dim>
  LoadWorks<dim>::LoadWorks(const std::vector<MechanicalCondition<dim>> &conditions,
                            ConditionAccounts<dim> &accounts)
      : accounts(accounts)
  {
    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (!prescribes_motion(conditions[c].type))
        loads.push_back({c, {}, {}});
  }

  template <int dim>
  bool LoadWorks<dim>::is_active() const
  {
    return loads.size() > 1;
  }

  template <int dim>
  void LoadWorks<dim>::set_nodes(const std::vector<unsigned int> &loaded_nodes)
  {
    if (nodes == loaded_nodes)
      return;
    nodes = loaded_nodes;
    forget();
    for (OfCondition &load : loads)
      load.force.assign(nodes.size(), Vector{});
  }

  template <int dim>
  void LoadWorks<dim>::forget()
  {
    for (OfCondition &load : loads)
      load.previous_impulse.clear();
  }

  template <int dim>
  void LoadWorks<dim>::add_first_half(const NodalVector &at_places)
  {
    for (OfCondition &load : loads)
    {
      if (load.previous_impulse.size() != nodes.size())
        continue;
      double work = 0;
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          work += 0.5 * load.previous_impulse[k][d] * at_places.node(nodes[k])[d];
      accounts.add_work(load.number, work);
      first_half_is_added = true;
    }
    forget();
  }

  template <int dim>
  void LoadWorks<dim>::take(const unsigned int condition, const NodalVector &of_condition)
  {
    for (OfCondition &load : loads)
      if (load.number == condition)
        for (std::size_t k = 0; k < nodes.size(); ++k)
          for (unsigned int d = 0; d < dim; ++d)
            load.force[k][d] = of_condition.node(nodes[k])[d];
  }

  template <int dim>
  void LoadWorks<dim>::add_second_half(const NodalVector &at_places, const double velocity_step,
                                       const bool is_start)
  {
    add_first_half(at_places);
    // Velocities are given at t_0, so that Δt_0 is half a step; as the beginning of the first
    // interval a force counts whole, like at any other.
    const double as_previous = is_start ? 2. : 1.;
    for (OfCondition &load : loads)
    {
      double power = 0;
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          power += load.force[k][d] * at_places.node(nodes[k])[d];
      if (!is_start)
        accounts.add_work(load.number, (first_half_is_added ? 0.5 : 1.) * velocity_step * power);
      load.previous_impulse.resize(nodes.size());
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (unsigned int d = 0; d < 3; ++d)
          load.previous_impulse[k][d] = as_previous * velocity_step * load.force[k][d];
    }
    first_half_is_added = false;
  }

  template <int dim>
  void LoadWorks<dim>::serialize(StateArchive &archive)
  {
    for (OfCondition &load : loads)
      archive.nodal("previous impulse of " + std::to_string(load.number), nodes,
                    load.previous_impulse);
  }

  template class LoadWorks<2>;
  template class LoadWorks<3>;
} // namespace tombolo
