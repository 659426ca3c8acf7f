// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/kinematic_solver.h>

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/model/model.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Of the deepest predicted penetration: what sweeps may still change. */
    constexpr double sweep_tolerance = 1e-4;
    constexpr unsigned int most_sweeps = 200;

    /** Nesterov's momentum for responses whose eigenvalues over the masses differ by up to 16, as
     * those of the kernels do: (√16 - 1)/(√16 + 1). */
    constexpr double momentum_of_sweeps = 0.6;

    void make_unique_nodes(std::vector<unsigned int> &nodes)
    {
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    }
  } // namespace

  template <int dim>
  KinematicSolver<dim>::KinematicSolver(std::vector<KinematicContact<dim> *> of_scene,
                                        Model<dim> &model)
      : contacts(std::move(of_scene)), position_response(*model.bridge)
  {
    for (const KinematicContact<dim> *const contact : contacts)
      candidates.insert(candidates.end(), contact->candidate_nodes().begin(),
                        contact->candidate_nodes().end());
    make_unique_nodes(candidates);
  }

  template <int dim>
  bool KinematicSolver<dim>::may_touch(const Model<dim> &model, const Clock &clock)
  {
    double largest = 0;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double *const a = model.state.acceleration.node(i);
      largest = std::max(largest, a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    }
    largest = std::sqrt(Utilities::MPI::max(largest, model.communicator));
    for (const unsigned int node : candidates)
      store_node(load_node(model.state.position.node(node)) +
                     load_node(model.state.velocity.node(node)) * clock.next_step,
                 predicted.node(node));
    double least = std::numeric_limits<double>::max();
    for (KinematicContact<dim> *const contact : contacts)
      least = std::min(least, contact->least_gap(predicted, clock));
    // B can raise the largest acceleration a little.
    constexpr double factor = 4.;
    const bool may = least < factor * clock.next_step * clock.velocity_step() * largest;
    return Utilities::MPI::max(may ? 1 : 0, model.communicator) == 1;
  }

  template <int dim>
  double KinematicSolver<dim>::find_constraints(Model<dim> &model, const Clock &clock,
                                                const NodalHeat &nodal_heat)
  {
    position_response.predict(model.state, clock, candidates, predicted);
    double deepest = 0;
    nodes.clear();
    for (KinematicContact<dim> *const contact : contacts)
    {
      deepest =
          std::max(deepest, contact->begin_step(model.state, predicted, position_response.mass(),
                                                model.conditions->constrained_components(), clock,
                                                nodal_heat));
      contact->append_nodes_behind(nodes);
    }
    make_unique_nodes(nodes);
    return Utilities::MPI::max(deepest, model.communicator);
  }

  template <int dim>
  void KinematicSolver<dim>::sweep(Model<dim> &model, const Clock &clock, const double tolerance)
  {
    for (const unsigned int node : nodes)
      *count.node(node) = 0.;
    for (const KinematicContact<dim> *const contact : contacts)
      contact->count_constraints(count);
    for (KinematicContact<dim> *const contact : contacts)
      contact->share_masses(count);
    position_response.set_nodes(nodes);
    double change = std::numeric_limits<double>::max();
    for (unsigned int k = 0; k < most_sweeps && change > tolerance; ++k)
    {
      for (const unsigned int node : nodes)
        store_node(NodeLanes(0.), trial_loads.node(node));
      for (const KinematicContact<dim> *const contact : contacts)
        contact->add_trial_forces(trial_loads);
      position_response.respond(trial_loads, model.conditions->constrained_components(), response);
      change = 0;
      // Without momentum the first sweep is exact for nodes that do not move others, and the
      // responses of the second are those of its forces.
      const double momentum = k == 0 ? 0. : momentum_of_sweeps;
      for (KinematicContact<dim> *const contact : contacts)
        change = std::max(change, contact->correct(response, clock, momentum));
      change = Utilities::MPI::max(change, model.communicator);
    }
  }

  template <int dim>
  void KinematicSolver<dim>::solve(Model<dim> &model, const Clock &clock,
                                   const NodalHeat &nodal_heat, NodalVector &loads,
                                   std::vector<unsigned int> &loaded_nodes)
  {
    const auto &partition = model.state.partition();
    for (NodalVector *const vector : {&predicted, &trial_loads, &response})
      vector->fit_to(partition);
    count.fit_to(partition, Quantity::scalar);
    position_response.begin_step(partition);
    model.state.acceleration.update_ghosts();
    if (!position_response.is_global() || may_touch(model, clock))
    {
      const double deepest = find_constraints(model, clock, nodal_heat);
      if (deepest > 0.)
        sweep(model, clock, sweep_tolerance * deepest);
    }
    for (KinematicContact<dim> *const contact : contacts)
      contact->end_step(model.state, clock, nodal_heat, loads, loaded_nodes);
  }

  template class KinematicSolver<2>;
  template class KinematicSolver<3>;
} // namespace tombolo
