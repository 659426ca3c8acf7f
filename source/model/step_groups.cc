// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/step_groups.h>

#include <tombolo/model/model.h>

#include <algorithm>
#include <utility>

namespace tombolo
{
  namespace
  {
    /** @p velocity := (@p now - @p before) / @p elapsed at these nodes. */
    void find_velocity(const NodalVector &now, const NodalVector &before, const double elapsed,
                       const std::vector<unsigned int> &nodes, NodalVector &velocity)
    {
      for (const unsigned int i : nodes)
        store_node((load_node(now.node(i)) - load_node(before.node(i))) * (1. / elapsed),
                   velocity.node(i));
    }

    /** Calls @p use with the group of cells of a ratio, if there is one. */
    template <int dim, typename Use>
    void for_group(const GroupedCells<dim> &cells, const unsigned int ratio, const Use &use)
    {
      for (const auto &group : cells.groups())
        if (group.number == ratio)
          use(group);
    }
  } // namespace

  template <int dim>
  void StepGroups<dim>::make(const Model<dim> &model)
  {
    std::vector<int> are_there(32, 0);
    for (std::size_t p = 0; p < parts.size(); ++p)
      for (const unsigned int ratio : model.parts[p].step_ratios)
        are_there[ratio] = 1;
    dealii::Utilities::MPI::max(are_there, model.communicator, are_there);
    groups.clear();
    step_in_cycle = 0;
    for (unsigned int ratio = 2; ratio < are_there.size(); ++ratio)
    {
      if (are_there[ratio] == 0)
        continue;
      Group &group = groups.emplace_back();
      group.ratio = ratio;
      group.position = model.state.position.copy();
      for (std::size_t p = 0; p < parts.size(); ++p)
        if (parts[p] != nullptr)
          group.shares.push_back(
              {p, {}, NodalVector(model.state.partition()), NodalVector(model.state.partition())});
    }
    set_partition(model);
  }

  template <int dim>
  void StepGroups<dim>::set_partition(const Model<dim> &model)
  {
    const auto &partition = model.state.partition();
    next.reinit(partition, Quantity::position);
    velocity.reinit(partition);
    for (Group &group : groups)
    {
      group.position.move_to(partition);
      group.position.distribute();
      NodalVector all(partition, Quantity::scalar);
      for (Share &share : group.shares)
      {
        for (NodalVector *const force : {&share.force, &share.last_force})
        {
          force->move_to(partition);
          for (unsigned int i = partition->n_owned(); i < partition->n_local(); ++i)
            store_node(NodeLanes(0.), force->node(i));
        }
        NodalVector mark(partition, Quantity::scalar);
        for_group(*parts[share.part], group.ratio,
                  [&](const auto &cell_group)
                  {
                    for (const unsigned int node : parts[share.part]->nodes_of(cell_group))
                    {
                      *mark.node(node) += 1.;
                      *all.node(node) += 1.;
                    }
                  });
        mark.collect();
        share.nodes = positive_nodes(mark, partition->n_owned());
      }
      group.local = positive_nodes(all, partition->n_local());
      all.collect();
      group.owned = positive_nodes(all, partition->n_owned());
    }
  }

  template <int dim>
  bool StepGroups<dim>::keep_ready(const Model<dim> &model, const std::size_t part,
                                   std::vector<unsigned int> &cells)
  {
    if (cells_of(part) == nullptr)
      return true;
    const auto others = std::stable_partition(cells.begin(), cells.end(),
                                              [&](const unsigned int cell)
                                              { return model.parts[part].step_ratios[cell] == 1; });
    const auto all_cells =
        cells_of_part(*model.nodes, *model.part_cells, static_cast<unsigned int>(part));
    std::vector<types::global_dof_index> cell_nodes;
    const std::vector<unsigned int> nodes =
        owned_marked_nodes(fast_nodes.partition(),
                           [&](const auto &mark)
                           {
                             for (const unsigned int cell : cells)
                             {
                               model.nodes->cell_nodes(all_cells[cell], cell_nodes);
                               for (const types::global_dof_index node : cell_nodes)
                                 mark(fast_nodes.partition()->local_index(node));
                             }
                           });
    for (const unsigned int node : nodes)
      *fast_nodes.node(node) = 1.;
    const int n_others = static_cast<int>(cells.end() - others);
    cells.erase(others, cells.end());
    return dealii::Utilities::MPI::max(n_others, model.communicator) == 0;
  }

  template <int dim>
  void StepGroups<dim>::synchronize(const Model<dim> &model, const Clock &clock,
                                    const NodalVector *const temperature)
  {
    const NodalVector &x = model.state.position;
    NodalVector unused(model.state.partition());
    for (GroupedCells<dim> *const cells : parts)
      if (cells != nullptr)
        for_group(*cells, 1,
                  [&](const auto &cell_group)
                  {
                    cells->add_force_of_group(
                        {&x, &model.state.velocity, clock.previous_step, temperature}, cell_group,
                        unused);
                  });
    for (Group &group : groups)
    {
      const double elapsed = group.age * clock.previous_step;
      if (elapsed == 0.)
        continue; // stresses are the present ones
      find_velocity(x, group.position, elapsed, group.local, velocity);
      for (const Share &share : group.shares)
        for_group(*parts[share.part], group.ratio,
                  [&](const auto &cell_group)
                  {
                    parts[share.part]->add_force_of_group({&x, &velocity, elapsed, temperature},
                                                          cell_group, unused);
                  });
    }
    is_synchronized = true;
  }

  template <int dim>
  void StepGroups<dim>::add_internal_force(const std::size_t part, Formulation<dim> &formulation,
                                           const MechanicalInput &input, NodalVector &force) const
  {
    GroupedCells<dim> *const cells = cells_of(part);
    if (cells == nullptr)
      return formulation.add_internal_force(input, force);
    MechanicalInput group_input = input;
    // In so short a time stresses stay, at the rates that they have.
    constexpr double moment = 1e-9;
    if (is_synchronized)
      group_input.time_increment *= moment;
    for_group(*cells, 1,
              [&](const auto &group) { cells->add_force_of_group(group_input, group, force); });
  }

  template <int dim>
  void StepGroups<dim>::add_further_forces(const Model<dim> &model, const Clock &clock,
                                           const NodalVector *const temperature,
                                           const Evaluation &evaluate, NodalVector &force)
  {
    for (Group &group : groups)
    {
      if (step_in_cycle % group.ratio == 0)
        act(model, clock, temperature, evaluate, force, group);
      for (const Share &share : group.shares)
      {
        model.signals.part_force(share.part, force, false);
        for (const unsigned int i : share.nodes)
          add_to_node(load_node(share.force.node(i)), force.node(i));
        model.signals.part_force(share.part, force, true);
      }
    }
    is_synchronized = false;
  }

  template <int dim>
  void StepGroups<dim>::act(const Model<dim> &model, const Clock &clock,
                            const NodalVector *const temperature, const Evaluation &evaluate,
                            const NodalVector &shorter, Group &group)
  {
    const NodalState &state = model.state;
    const double step = clock.previous_step > 0. ? clock.previous_step : first_step;
    const double ahead = 0.5 * (group.ratio - 1.), square = 0.125 * group.ratio * group.ratio;
    const NodalVector &mass = model.bridge->nodal_mass();
    for (const unsigned int i : group.owned)
      store_node(load_node(shorter.node(i)) / load_node(mass.node(i)), velocity.node(i));
    model.conditions->remove_prescribed(velocity);
    for (const unsigned int i : group.owned)
      store_node(load_node(state.position.node(i)) +
                     load_node(state.velocity.node(i)) * (ahead * step) +
                     load_node(velocity.node(i)) * (square * step * step),
                 next.node(i));
    next.distribute();
    const double elapsed = (group.age + ahead) * step;
    find_velocity(next, group.position, elapsed, group.local, velocity);
    std::swap(next, group.position);
    group.age = -ahead;

    for (Share &share : group.shares)
    {
      std::swap(share.force, share.last_force);
      for (const std::vector<unsigned int> *const nodes : {&share.nodes, &group.local})
        for (const unsigned int i : *nodes)
          store_node(NodeLanes(0.), share.force.node(i));
      for_group(*parts[share.part], group.ratio,
                [&](const auto &cell_group)
                {
                  evaluate(share.part,
                           [&]
                           {
                             parts[share.part]->add_force_of_group(
                                 {&group.position, &velocity, elapsed, temperature}, cell_group,
                                 share.force);
                           });
                });
      share.force.collect();
    }
  }

  template <int dim>
  void StepGroups<dim>::apply_elastic_stiffness(const std::size_t part,
                                                const Formulation<dim> &formulation,
                                                const NodalVector &position,
                                                const NodalVector &motion, const double time_step,
                                                NodalVector &force) const
  {
    const GroupedCells<dim> *const cells = cells_of(part);
    if (cells == nullptr)
      return formulation.apply_elastic_stiffness(position, motion, time_step, force);
    for (const auto &group : cells->groups())
      cells->apply_stiffness_of_group(position, motion, time_step, group, force);
  }

  template <int dim>
  void StepGroups<dim>::complete_step()
  {
    step_in_cycle = (step_in_cycle + 1) % cycle();
    for (Group &group : groups)
      group.age += 1.;
  }

  template <int dim>
  double StepGroups<dim>::work_ahead(const NodalVector &position) const
  {
    double sum = 0;
    for (const Group &group : groups)
    {
      // Forces between those of the last two positions are the means on the way to the present one.
      const double last_weight = -0.5 * group.age / group.ratio;
      for (const Share &share : group.shares)
        for (const unsigned int i : share.nodes)
          for (unsigned int d = 0; d < dim; ++d)
          {
            const double force = share.force.node(i)[d];
            sum += (force + last_weight * (share.last_force.node(i)[d] - force)) *
                   (group.position.node(i)[d] - position.node(i)[d]);
          }
    }
    return sum;
  }

  template class StepGroups<2>;
  template class StepGroups<3>;
} // namespace tombolo
