// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/boundary/mechanical_conditions.h>

#include <tombolo/base/format.h>
#include <tombolo/base/input/read_vector.h>

#include <algorithm>
#include <iterator>
#include <tuple>

namespace tombolo
{
  namespace
  {
    /** Adds what a condition prescribes of a node, once. */
    template <int dim>
    void add_rows(const MechanicalCondition<dim> &condition, const unsigned int c,
                  const Point<dim> &point, std::vector<PrescribedRow<dim>> &rows)
    {
      const int number = static_cast<int>(c);
      if (std::any_of(rows.begin(), rows.end(),
                      [&](const PrescribedRow<dim> &row) { return row.condition == number; }))
        return;
      const Tensor<2, dim> axes = condition.axes.at(point);
      for (unsigned int d = 0; d < dim; ++d)
        if (!condition.function || !condition.function->is_free(d))
          rows.push_back({number, d, axes[d]});
    }

    void sort_once_each(std::vector<unsigned int> &nodes)
    {
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    }

    template <int dim>
    double component_along(const Tensor<1, dim> &direction, const double *const vector)
    {
      double result = 0;
      for (unsigned int d = 0; d < dim; ++d)
        result += direction[d] * vector[d];
      return result;
    }
  } // namespace

  template <int dim>
  MechanicalConditions<dim>::MechanicalConditions(const std::vector<Section> &sections,
                                                  const Mesh<dim> &mesh, const Nodes<dim> &nodes)
      : Base(sections, mesh, nodes), nodes_in_volume(sections.size())
  {
    std::map<types::global_dof_index, typename Base::Constraint> constraints_by_node;
    // By node, component, and the two conditions.
    std::map<std::tuple<types::global_dof_index, unsigned int, unsigned int, unsigned int>,
             Point<dim>>
        shared;
    for (unsigned int c = 0; c < conditions.size(); ++c)
    {
      acting.push_back(conditions[c].acts_at(0.));
      areas.keep_initial(c, conditions[c].has_initial_areas);
    }
    NodeRows rows;
    const bool has_rows = std::any_of(conditions.begin(), conditions.end(),
                                      std::mem_fn(&MechanicalCondition<dim>::needs_frames));
    const auto refuse_axis = [&](const unsigned int c, const Point<dim> &point)
    {
      if (!conditions[c].axes.are_defined_at(point))
        sections[c].fail("Axes",
                         as_text("the place (", point,
                                 ") lies on the axis, from which nothing is radial; `Where` "
                                 "can leave it out."));
    };
    const auto select_node =
        [&](const unsigned int c, const types::global_dof_index node, const Point<dim> &point)
    {
      const MechanicalCondition<dim> &condition = conditions[c];
      refuse_axis(c, point);
      if (!nodes.owned().is_element(node))
        return;
      if (!prescribes(condition.type))
        return nodes_in_volume[c].push_back(
            static_cast<unsigned int>(nodes.owned().index_within_set(node)));
      if (has_rows)
        add_rows(condition, c, point, rows[node]);
      auto &constraint = Base::constraint_of(node, constraints_by_node);
      const int number = static_cast<int>(c);
      for (unsigned int d = 0; d < dim; ++d)
        if (int &other = constraint.condition[d];
            !condition.function || !condition.function->is_free(d))
        {
          if (other >= 0 && other != number)
            shared.emplace(std::make_tuple(node, d,
                                           static_cast<unsigned int>(std::min(other, number)),
                                           static_cast<unsigned int>(std::max(other, number))),
                           point);
          other = std::max(other, number);
        }
    };
    const auto select_face =
        [&](const auto &cell, const unsigned int f, const auto &face_nodes, const auto &face_points)
    {
      for (unsigned int c = 0; c < conditions.size(); ++c)
        if (is_on_faces(conditions[c].type) && nodes.is_outer_face(cell, f) &&
            this->selects_face(c, cell, f))
        {
          for (const Point<dim> &point : face_points)
            refuse_axis(c, point);
          areas.add_face(c, face_nodes,
                         conditions[c].type == MechanicalConditionType::pressure
                             ? areas.orientation(face_points, cell->center())
                             : 0.);
        }
    };
    this->find(sections, nodes,
               [&]
               {
                 this->for_each_node(nodes, select_node);
                 nodes.for_each_face(&Base::is_at_boundary, select_face);
               });
    std::for_each(nodes_in_volume.begin(), nodes_in_volume.end(), sort_once_each);
    for (const auto &[node, constraint] : constraints_by_node)
      constraints.push_back(constraint);
    for (const auto &[key, point] : shared)
      overlapping.push_back({std::get<2>(key), std::get<3>(key), std::get<1>(key), point});
    set_rows(std::move(rows));
  }

  template <int dim>
  void MechanicalConditions<dim>::set_rows(NodeRows rows)
  {
    for (std::size_t k = 0; k < constraints.size(); ++k)
    {
      const auto found = rows.find(constraints[k].global_node);
      if (found != rows.end() &&
          std::any_of(found->second.begin(), found->second.end(),
                      [&](const PrescribedRow<dim> &row) {
                        return conditions[static_cast<unsigned int>(row.condition)].needs_frames();
                      }))
        rows_of_nodes.emplace_back(k, std::move(found->second));
    }
    find_frames();
  }

  template <int dim>
  void MechanicalConditions<dim>::find_frames()
  {
    combinations.clear();
    for (const auto &[k, rows] : rows_of_nodes)
    {
      std::vector<PrescribedRow<dim>> now;
      for (const PrescribedRow<dim> &row : rows)
        if (acting[static_cast<unsigned int>(row.condition)])
          now.push_back(row);
      PrescribedFrame<dim> frame(now);
      constraints[k].condition = frame.condition;
      for (unsigned int d = 0; d < dim; ++d)
        constraints[k].is_turned[d] = frame.condition[d] >= 0 && frame.is_turned[d];
      combinations.push_back({k, std::move(frame)});
    }
  }

  template <int dim>
  bool MechanicalConditions<dim>::are_timed() const
  {
    return std::any_of(conditions.begin(), conditions.end(),
                       [](const MechanicalCondition<dim> &condition)
                       { return prescribes(condition.type) && condition.is_timed(); });
  }

  template <int dim>
  bool MechanicalConditions<dim>::will_change(const double time) const
  {
    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (prescribes(conditions[c].type) && conditions[c].acts_at(time) != acting[c])
        return true;
    return false;
  }

  template <int dim>
  void MechanicalConditions<dim>::act_at(const double time)
  {
    for (unsigned int c = 0; c < conditions.size(); ++c)
      acting[c] = conditions[c].acts_at(time);
    find_frames();
  }

  template <int dim>
  void MechanicalConditions<dim>::set_partition(const NodePartition &partition)
  {
    Base::set_partition(partition);
    std::vector<ObliqueNode> turned;
    for (const Combination &combination : combinations)
    {
      const PrescribedFrame<dim> &frame = combination.frame;
      ObliqueNode node{constraint_nodes[combination.constraint], 0, {}};
      node.axes[2][2] = 1.;
      bool is_oblique = false;
      for (unsigned int k = 0; k < dim; ++k)
      {
        for (unsigned int d = 0; d < dim; ++d)
          node.axes[k][d] = frame.axes[k][d];
        if (frame.condition[k] >= 0)
          node.prescribed = static_cast<std::uint8_t>(node.prescribed | (1u << k));
        is_oblique = is_oblique || (frame.condition[k] >= 0 && frame.is_turned[k]);
      }
      if (is_oblique)
        turned.push_back(node);
    }
    oblique = ObliqueNodes(std::move(turned));
  }

  template <int dim>
  IndexSet MechanicalConditions<dim>::prescribed_nodes() const
  {
    IndexSet result(areas.required_nodes().size());
    for (const auto &constraint : constraints)
      result.add_index(constraint.global_node);
    result.compress();
    return result;
  }

  template <int dim>
  void MechanicalConditions<dim>::remove_prescribed(NodalVector &vector) const
  {
    if (!this->has_constraints())
      return;
    const auto &constrained = this->constrained_components();
    for (const unsigned int node : this->constrained_nodes())
    {
      double *const value = vector.node(node);
      for (unsigned int d = 0; d < 3; ++d)
        if ((constrained[node] >> d) & 1u)
          value[d] = 0.;
      if (const ObliqueNode *const oblique_node = oblique.find(node))
        oblique_node->remove_prescribed(value);
    }
  }

  template <int dim>
  std::vector<unsigned int> MechanicalConditions<dim>::loaded_nodes(const NodalState &state) const
  {
    std::vector<unsigned int> result = areas.owned_nodes(state.partition());
    for (const std::vector<unsigned int> &loaded : nodes_in_volume)
      result.insert(result.end(), loaded.begin(), loaded.end());
    sort_once_each(result);
    return result;
  }

  template <int dim>
  void MechanicalConditions<dim>::compute_loads(
      const NodalState &state, const double time, const NodalVector &positions, NodalVector &loads,
      std::vector<LoadSum> &sums, const NodalVector &mass,
      const std::function<void(unsigned int, const NodalVector &)> &receive_alone) const
  {
    loads.set_zero();
    sums.assign(conditions.size(), {});
    areas.update(state.position, state.initial_position);
    NodalVector *const alone = receive_alone ? &loads_alone : nullptr;
    if (alone != nullptr && alone->partition() != loads.partition())
      alone->reinit(loads.partition());
    // Every rank takes part in the exchange of a condition, also one where its function has failed.
    const auto add = [&](const unsigned int c, const std::function<void()> &action)
    {
      if (alone != nullptr)
        alone->set_zero();
      this->evaluate(action);
      if (alone == nullptr)
        return;
      alone->add_to_owners();
      receive_alone(c, *alone);
    };
    const auto put_of = [&](const unsigned int c)
    {
      return [&, c](const unsigned int node, const double *const force)
      {
        for (unsigned int d = 0; d < dim; ++d)
        {
          loads.node(node)[d] += force[d];
          if (alone != nullptr)
            alone->node(node)[d] += force[d];
        }
        sums[c].add(positions.node(node), force);
      };
    };
    const auto acts = [&](const unsigned int c) { return conditions[c].acts_at(time); };
    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (is_on_faces(conditions[c].type) && acts(c))
        add(c, [&]() { for_surface_forces(c, state, time, put_of(c)); });
    loads.add_to_owners();
    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (is_on_volume(conditions[c].type) && acts(c))
        add(c, [&]() { for_body_forces(c, state, mass, time, put_of(c)); });
  }

  template <int dim>
  template <typename Put>
  void MechanicalConditions<dim>::for_surface_forces(const unsigned int c, const NodalState &state,
                                                     const double time, const Put &put) const
  {
    const auto &group = areas.group(c);
    const std::vector<unsigned int> &nodes = group.nodes;
    const Expression<dim> &function = *conditions[c].function;
    const bool is_pressure = conditions[c].type == MechanicalConditionType::pressure;
    double value[3] = {0, 0, 0};
    const LocalAxes<dim> &axes = conditions[c].axes;
    for (unsigned int k = 0; k < nodes.size(); ++k)
    {
      const Point<dim> initial = point_of<dim>(state.initial_position.node(nodes[k]));
      if (k == 0 || function.depends_on_position() || axes.depend_on_position())
      {
        if (is_pressure)
          value[0] = function.value(initial, time, 0);
        else
        {
          const Tensor<1, dim> load = conditions[c].load_at(initial, time);
          std::copy_n(load.begin_raw(), dim, value);
        }
      }
      double force[3] = {0, 0, 0};
      for (unsigned int d = 0; d < dim; ++d)
        force[d] = is_pressure ? -value[0] * group.outward_areas[k][d] : value[d] * group.areas[k];
      put(nodes[k], force);
    }
  }

  template <int dim>
  template <typename Put>
  void MechanicalConditions<dim>::for_body_forces(const unsigned int c, const NodalState &state,
                                                  const NodalVector &mass, const double time,
                                                  const Put &put) const
  {
    const std::vector<unsigned int> &nodes = nodes_in_volume[c];
    const bool depends_on_position =
        conditions[c].function->depends_on_position() || conditions[c].axes.depend_on_position();
    Tensor<1, dim> load;
    for (std::size_t k = 0; k < nodes.size(); ++k)
    {
      const unsigned int i = nodes[k];
      if (k == 0 || depends_on_position)
        load = conditions[c].load_at(point_of<dim>(state.initial_position.node(i)), time);
      double force[3] = {0, 0, 0};
      for (unsigned int d = 0; d < dim; ++d)
        force[d] = *mass.node(i) * load[d];
      put(i, force);
    }
  }

  template <int dim>
  template <typename Value>
  void MechanicalConditions<dim>::prescribe(NodalVector &vector, const Value &value) const
  {
    this->evaluate(
        [&]
        {
          auto combination = combinations.begin();
          for (std::size_t k = 0; k < constraints.size(); ++k)
          {
            const unsigned int node = constraint_nodes[k];
            if (combination != combinations.end() && combination->constraint == k)
            {
              const PrescribedFrame<dim> &frame = (combination++)->frame;
              Tensor<1, dim> values;
              for (unsigned int r = 0; r < frame.rows.size(); ++r)
              {
                const PrescribedRow<dim> &row = frame.rows[r];
                const MechanicalCondition<dim> &condition =
                    conditions[static_cast<unsigned int>(row.condition)];
                values[r] = value(condition, node, row.component,
                                  condition.axes.are_local() ? &row.direction : nullptr);
              }
              frame.prescribe(values, vector.node(node));
              continue;
            }
            for (unsigned int d = 0; d < dim; ++d)
              if (const int c = constraints[k].condition[d]; c >= 0)
                vector.node(node)[d] =
                    value(conditions[static_cast<unsigned int>(c)], node, d, nullptr);
          }
        });
  }

  template <int dim>
  void MechanicalConditions<dim>::prescribe_acceleration(NodalState &state, const double time,
                                                         const double velocity_time_step,
                                                         const double position_time_step) const
  {
    prescribe(state.acceleration,
              [&](const MechanicalCondition<dim> &condition, const unsigned int node,
                  const unsigned int d, const Tensor<1, dim> *const direction)
              {
                const double *const velocity = state.unsmoothed_velocity.node(node);
                const double target = condition.prescribed_velocity(
                    point_of<dim>(state.initial_position.node(node)), state.position.node(node), d,
                    time, position_time_step, direction);
                const double now =
                    direction == nullptr ? velocity[d] : component_along(*direction, velocity);
                return (target - now) / velocity_time_step;
              });
  }

  template <int dim>
  void MechanicalConditions<dim>::prescribe_initial_velocity(NodalState &state, const double time,
                                                             const double interval) const
  {
    const auto value = [&](const MechanicalCondition<dim> &condition, const unsigned int node,
                           const unsigned int d, const Tensor<1, dim> *)
    {
      return condition.initial_velocity(point_of<dim>(state.initial_position.node(node)),
                                        state.position.node(node), d, time, interval);
    };
    // Every rank takes part in the exchange, also one where a function has failed.
    change_owned({&state.unsmoothed_velocity},
                 [&] { prescribe(state.unsmoothed_velocity, value); });
  }

  template class MechanicalConditions<2>;
  template class MechanicalConditions<3>;
  template class TributaryAreas<2>;
  template class TributaryAreas<3>;
} // namespace tombolo
