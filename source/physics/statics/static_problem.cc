// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/statics/static_problem.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <deal.II/base/mpi.h>

#include <array>
#include <cmath>

namespace tombolo
{
  template <int dim>
  StaticProblem<dim>::StaticProblem(Model<dim> &model, const double spring_factor)
      : model(model), assembly(model.parts),
        spring_time(courant_limit(model).time_step / std::sqrt(spring_factor))
  {
    double extent = 0;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        extent = std::max(extent, std::abs(model.state.initial_position.node(i)[d]));
    // As in refuse_penetration(): bodies apart by round-off touch.
    touch_distance = 1e-9 * Utilities::MPI::max(extent, model.communicator);
    start_position.reinit(model.state.partition(), Quantity::position);
    prescribed_displacement.reinit(model.state.partition());
    free_force.reinit(model.state.partition());
    set_constrained();
    if (model.heat)
      node_records.nodal("pending heat", 1, model.heat->state.pending);
    model.state.unsmoothed_velocity.set_zero();
    model.state.velocity.set_zero();
    model.state.acceleration.set_zero();
  }

  template <int dim>
  void StaticProblem<dim>::set_constrained()
  {
    const NodePartition &partition = *model.state.partition();
    auto constrained = model.conditions->constrained_components();
    constrained.resize(partition.n_owned(), 0);
    for (const NodePartition::Reflected &on_plane : partition.nodes_on_planes())
      for (unsigned int d = 0; d < dim; ++d)
        if (on_plane.reflection.sign[d] < 0.)
          constrained[on_plane.source] |= static_cast<std::uint8_t>(1u << d);
    for (const ObliqueNode &oblique : model.conditions->oblique_nodes().all())
      constrained[oblique.node] |= oblique.prescribed;
    nodal_frames = NodalFrames<dim>(model);
    mask = nodal_field(model.state.partition(), Quantity::scalars,
                       [&](const unsigned int i, double *const components)
                       {
                         for (unsigned int d = 0; d < dim; ++d)
                           components[d] = (constrained[i] >> d) & 1u;
                       });
  }

  template <int dim>
  void StaticProblem<dim>::begin(const StaticInterval &interval)
  {
    present = interval;
    round_off = 0.;
    NodalState &state = model.state;
    start_position.copy_from(state.position);
    state.unsmoothed_velocity.set_zero();
    state.acceleration.set_zero();
    // The velocity that is prescribed over the interval, as an acceleration over it.
    const double step = present.duration();
    model.conditions->prescribe_acceleration(state, present.begin, step, step);
    prescribed_displacement.set_zero();
    const std::vector<unsigned int> &nodes = model.conditions->constrained_nodes();
    double largest = 0;
    prescribed_displacement.fill(
        nodes,
        [&](const std::size_t k, double *const displacement)
        {
          const types::global_dof_index node = state.partition()->global_index(nodes[k]);
          std::array<double, dim> rate;
          std::copy_n(state.acceleration.node(nodes[k]), dim, rate.begin());
          nodal_frames.turn(node, rate.data());
          for (unsigned int d = 0; d < dim; ++d)
          {
            const int condition = model.conditions->prescribing_condition(k, d);
            if (condition < 0 ||
                (present.is_start &&
                 model.conditions->all()[static_cast<unsigned int>(condition)].type !=
                     MechanicalConditionType::displacement))
              continue;
            displacement[d] = rate[d] * step * step;
            largest = std::max(largest, std::abs(displacement[d]));
          }
          nodal_frames.turn_back(node, displacement);
        });
    has_driven_nodes = Utilities::MPI::max(largest, model.communicator) > 0.;
    state.acceleration.set_zero();
    trial = std::make_unique<Trial<dim>>(model);
    begin_trials(process_clock());
  }

  template <int dim>
  void StaticProblem<dim>::begin_trials(const Clock &clock)
  {
    model.signals.trials(clock, touch_distance);
    for_acting(
        [](Process<dim> &process)
        {
          process.records.keep();
          process.actions.records.keep();
        });
    node_records.keep();
  }

  template <int dim>
  void StaticProblem<dim>::restart_processes()
  {
    for_acting(
        [](Process<dim> &process)
        {
          process.records.restore();
          process.actions.records.restore();
        });
    node_records.restore();
  }

  template <int dim>
  void StaticProblem<dim>::linearize(const Clock &clock,
                                     std::vector<ContactStiffness<dim>> &springs,
                                     NodalVector &bound)
  {
    Tangent<dim> tangent;
    tangent.springs = &springs;
    tangent.bound = &bound;
    for_acting([&](Process<dim> &process) { process.linearize(model, clock, tangent); });
  }

  template <int dim>
  std::vector<ContactStiffness<dim>> StaticProblem<dim>::springs_at_start()
  {
    Clock clock;
    clock.stable_step = spring_time;
    begin_trials(clock);
    NodalVector force(model.state.partition()), bound(model.state.partition(), Quantity::scalars);
    for_acting([&](Process<dim> &process) { process.act(model, clock, force); });
    std::vector<ContactStiffness<dim>> result;
    linearize(clock, result, bound);
    restart_processes();
    return result;
  }

  template <int dim>
  Clock StaticProblem<dim>::process_clock() const
  {
    Clock clock;
    clock.step = present.step;
    clock.time = present.end;
    clock.previous_step = present.is_start ? 0. : present.duration();
    clock.next_step = present.duration();
    clock.stable_step = spring_time;
    return clock;
  }

  template <int dim>
  std::string StaticProblem<dim>::evaluate_parts()
  {
    std::string failure;
    const auto add = [&](const Part<dim> &part, const NodalVector &velocity, NodalVector &force)
    {
      const auto number = static_cast<std::size_t>(&part - model.parts.data());
      model.signals.part_force(number, force, false);
      std::string part_failure;
      try
      {
        part.formulation->add_internal_force(
            {&model.state.position, &velocity, present.duration(), present.temperature}, force);
        part_failure = part.formulation->failure();
      }
      catch (const RunError &error)
      {
        part_failure = error.what();
      }
      if (!part_failure.empty() && failure.empty())
        failure = "part \"" + part.name + "\": " + part_failure;
      model.signals.part_force(number, force, true);
    };
    assembly.assemble(*model.bridge, model.state.velocity, model.state.force, add);
    const Clock clock = process_clock();
    for_acting(
        [&](Process<dim> &process)
        {
          process.act(model, clock, model.state.force);
          if (failure.empty())
            failure = process.failure;
        });
    return failure.empty() ? model.conditions->failure() : failure;
  }

  template <int dim>
  bool StaticProblem<dim>::evaluate(const NodalVector &displacement)
  {
    ++count;
    trial->restart();
    restart_processes();
    NodalState &state = model.state;
    const double inverse_step = 1. / present.duration();
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
      {
        state.position.node(i)[d] = start_position.node(i)[d] + displacement.node(i)[d];
        state.velocity.node(i)[d] = displacement.node(i)[d] * inverse_step;
      }
    state.position.distribute();
    state.velocity.distribute();
    model.bridge->positions_have_changed();
    std::string failure = evaluate_parts();
    double sum = 0;
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
    {
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double force = state.force.node(i)[d];
        sum += force * 0.;
        free_force.node(i)[d] = force;
      }
      remove_constrained(i, free_force.node(i));
    }
    if (failure.empty() && !std::isfinite(sum))
      failure = "a force is not finite.";
    failure_text = first_text(model.communicator, failure);
    return failure_text.empty();
  }

  template <int dim>
  void StaticProblem<dim>::undo()
  {
    trial.reset();
    restart_processes();
    model.state.position.copy_from(start_position);
    model.state.velocity.set_zero();
    model.bridge->positions_have_changed();
  }

  template <int dim>
  double StaticProblem<dim>::residual_norm() const
  {
    double sum = 0;
    for (unsigned int i = 0; i < free_force.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        sum += free_force.node(i)[d] * free_force.node(i)[d];
    return std::sqrt(ordered_sum(sum, model.communicator));
  }

  template <int dim>
  double StaticProblem<dim>::unresolved_work() const
  {
    double sum = 0;
    for (unsigned int i = 0; i < free_force.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        sum += std::pow(model.state.position.node(i)[d] - start_position.node(i)[d], 2);
    return std::max(residual_norm(), round_off) * std::sqrt(ordered_sum(sum, model.communicator));
  }

  template <int dim>
  std::string StaticProblem<dim>::largest_residual() const
  {
    double largest = -1.;
    unsigned int node = 0;
    for (unsigned int i = 0; i < free_force.partition()->n_owned(); ++i)
    {
      const double *const force = free_force.node(i);
      const double norm = std::hypot(force[0], force[1], force[2]);
      if (norm > largest)
      {
        largest = norm;
        node = i;
      }
    }
    std::string text;
    if (largest >= 0.)
      text = as_text("node ", model.nodes->persistent_ids()[node], " at ",
                     position_text(vector_of<dim>(model.state.position.node(node))), " with ",
                     largest);
    const auto rank_maxima = from_all_ranks(std::vector<double>{largest}, model.communicator);
    const auto first_largest = std::max_element(rank_maxima.begin(), rank_maxima.end());
    return texts_of_ranks(model.communicator, text)[first_largest - rank_maxima.begin()];
  }

  template <int dim>
  void StaticProblem<dim>::remove_constrained(const unsigned int node, double *const vector) const
  {
    const types::global_dof_index global_node = mask.partition()->global_index(node);
    nodal_frames.turn(global_node, vector);
    for (unsigned int d = 0; d < dim; ++d)
      if (mask.node(node)[d] > 0.)
        vector[d] = 0.;
    nodal_frames.turn_back(global_node, vector);
  }

  template class StaticProblem<2>;
  template class StaticProblem<3>;
} // namespace tombolo
