// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/kinematic_solver.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/model/model.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace tombolo
{
  namespace
  {
    /** A node whose free components make up less than this of the normal, squared, is held. */
    constexpr double smallest_free_share = 0.01;

    template <int dim>
    Tensor<1, dim> along_surface(const Tensor<1, dim> &vector, const Tensor<1, dim> &normal)
    {
      return vector - (vector * normal) * normal;
    }

    /** Of the deepest predicted penetration: the change at which sweeps end. */
    constexpr double sweep_tolerance = 1e-3;
    constexpr unsigned int most_sweeps = 200;

    /** Responses are found at the nodes that were near the surface in an earlier step, as long as
     * these are at most so many times those that are near it. */
    constexpr std::size_t most_responding = 2;

    /** Nesterov's momentum for responses whose eigenvalues over the masses differ by up to 16, as
     * those of the kernels do: (√16 - 1)/(√16 + 1). */
    constexpr double momentum_of_sweeps = 0.6;

    void make_unique_nodes(std::vector<unsigned int> &nodes)
    {
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    }
  } // namespace

  /**
   * Kinematic contact, the predictor and corrector known from explicit codes: a candidate node that
   * would be behind the surface at t_{n+1} without a force of contact receives at t_n the force
   * that moves it onto the surface, and along the surface the one by which it moves with the
   * surface, up to Coulomb's limit,
   *
   * @verbatim
   *   0 <= N  ⟂  g_{n+1} >= 0,   |T| <= µ N,   f = N n + T
   * @endverbatim
   *
   * with the gap g and the normal n linear about the predicted position. Forces at positions move
   * those of their neighbours too: the forces f are found by sweeps of projected Jacobi steps with
   * the momentum of Nesterov, of all contacts at once,
   *
   * @verbatim
   *   N <- max(0, N - m g / (Δt Δt_n)),   T <- T - m s / (Δt Δt_n), back to the limit,
   * @endverbatim
   *
   * with the slip s of the step and the mass m of the position, see PositionResponse. Only nodes
   * near the surface are predicted. There is no spring and no stored energy. An impact dissipates
   * the work of the normal forces, by the mean of those at both ends of each step, which is
   * accounted for as damping.
   */
  template <int dim>
  class KinematicContact : public SurfaceContact<dim>
  {
  public:
    /** As that of SurfaceContact. Throws InputError. Collective. */
    explicit KinematicContact(ContactScene<dim> &scene)
        : SurfaceContact<dim>(scene), normal_forces(this->candidates.size())
    {
      this->records.sums("loss of tool", loss_of_tool);
      this->records.at_nodes(this->candidates, normal_forces)
          .vector(
              "normal force", [](Tensor<1, dim> & force) -> auto & { return force; });
    }

    /** Finds the candidates whose gap is below @p distance at the positions @p guess at the end of
     * the coming step, and appends them to @p nodes. */
    void find_near_candidates(const NodalVector &guess, const Clock &clock, double distance,
                              std::vector<unsigned int> &nodes)
    {
      this->find_gaps(guess, this->candidates, clock.time + clock.next_step, this->gap);
      if (this->surface->translation().has_mass())
        distance += this->surface->translation().free_motion(clock).norm();
      near.clear();
      near_nodes.clear();
      for (std::size_t k = 0; k < this->candidates.size(); ++k)
        if (this->gap[k] < distance)
        {
          near.push_back(k);
          near_nodes.push_back(this->candidates[k]);
        }
      nodes.insert(nodes.end(), near_nodes.begin(), near_nodes.end());
    }

    /** Begins a step: finds the nodes that would be behind the surface at the @p predicted
     * positions at t_{n+1}, of those that find_near_candidates() has found. @p mass (scalar or by
     * component) is that of positions, @p constrained has a bit per prescribed component of an
     * owned node, or is empty: nodes that cannot move along the normal are left out. Returns the
     * deepest penetration of this rank [L]. */
    double begin_step(const NodalState &state, const NodalVector &predicted,
                      const NodalVector &mass, const std::vector<std::uint8_t> &constrained,
                      const Clock &clock, const NodalHeat &nodal_heat)
    {
      const ContactSurface<dim> &surface = *this->surface;
      const double end = clock.time + clock.next_step;
      const bool has_mass = this->surface->translation().has_mass();
      const Tensor<1, dim> free_motion =
          has_mass ? this->surface->translation().free_motion(clock) : Tensor<1, dim>();
      if (has_mass)
        set_positions_from_mass(predicted, free_motion);
      const NodalVector &positions = has_mass ? positions_from_mass : predicted;
      this->find_gaps(positions, near_nodes, end, this->gap);
      this->find_surroundings(state);
      constraints.clear();
      double largest = 0;
      for (std::size_t i = 0; i < near.size(); ++i)
      {
        const std::size_t k = near[i];
        const unsigned int node = near_nodes[i];
        if (*state.mass.node(node) == 0. || !(this->gap[i] < 0.))
          continue;
        const auto position = vector_of<dim>(positions.node(node));
        const Tensor<1, dim> motion = position - vector_of<dim>(state.position.node(node)) -
                                      surface.motion(position, clock.time, end);
        add_constraint(k, this->gap[i], position, motion, mass,
                       constrained.empty() ? 0u : constrained[node], clock, nodal_heat);
        if (!constraints.empty() && constraints.back().candidate == k)
          largest = std::max(largest, -this->gap[i]);
      }
      return largest;
    }

    /** Appends the owned nodes with a constraint in this step. */
    void append_nodes_behind(std::vector<unsigned int> &nodes) const
    {
      for (const Constraint &constraint : constraints)
        nodes.push_back(this->candidates[constraint.candidate]);
    }

    /** Adds one to owned nodes of @p count (scalar) for each constraint. */
    void count_constraints(NodalVector &count) const
    {
      for (const Constraint &constraint : constraints)
        *count.node(this->candidates[constraint.candidate]) += 1.;
    }

    /** Softens the steps of correct() by the @p count of constraints of all contacts at each node,
     * and by the ratio to the mass of the surface. Collective where the surface has a mass. */
    void share_masses(const NodalVector &count)
    {
      double mass = 0;
      for (Constraint &constraint : constraints)
      {
        constraint.mass /= *count.node(this->candidates[constraint.candidate]);
        mass += constraint.mass;
      }
      if (!this->surface->translation().has_mass())
        return;
      const double ratio =
          1. + ordered_sum(mass, this->communicator) / this->surface->translation().mass();
      for (Constraint &constraint : constraints)
        constraint.mass /= ratio;
    }

    /** Adds the trial forces to owned nodes of @p loads. */
    void add_trial_forces(NodalVector &loads) const
    {
      for (const Constraint &constraint : constraints)
      {
        const Tensor<1, dim> force =
            constraint.trial_normal_force * constraint.normal + constraint.trial_friction_force;
        for (unsigned int d = 0; d < dim; ++d)
          loads.node(this->candidates[constraint.candidate])[d] += force[d];
      }
    }

    /** One sweep: corrects the forces by the displacement by the trial forces over Δt Δt_n, and
     * sets the next trial forces, further by @p momentum of the correction. Returns the largest
     * correction of this rank as a displacement [L]. Collective where the surface has a mass. */
    double correct(const NodalVector &response, const Clock &clock, const double momentum)
    {
      const double compliance = clock.next_step * clock.velocity_step();
      const Tensor<1, dim> surface_response = response_of_surface();
      double largest = 0;
      for (Constraint &c : constraints)
      {
        c.response = compliance * vector_of<dim>(response.node(this->candidates[c.candidate]));
        c.response_of_surface = compliance * surface_response;
        const Tensor<1, dim> relative = c.response - c.response_of_surface;
        const double per_mass = compliance / c.mass;
        const double normal_before = c.normal_force;
        c.normal_force =
            std::max(0., c.trial_normal_force - (c.gap + relative * c.normal) / per_mass);
        const Tensor<1, dim> friction_before = c.friction_force;
        c.friction_force = 0.;
        if (const double limit = std::min(c.friction * c.normal_force, c.shear_limit); limit > 0.)
        {
          c.friction_force =
              c.trial_friction_force - (c.slip + along_surface(relative, c.normal)) / per_mass;
          const double norm = c.friction_force.norm();
          if (norm > limit)
            c.friction_force *= limit / norm;
        }
        const double normal_change = c.normal_force - normal_before;
        const Tensor<1, dim> friction_change = c.friction_force - friction_before;
        largest = std::max(largest, per_mass * std::sqrt(normal_change * normal_change +
                                                         friction_change.norm_square()));
        c.trial_normal_force = c.normal_force + momentum * normal_change;
        c.trial_friction_force = c.friction_force + momentum * friction_change;
      }
      return largest;
    }

    /** Ends the step: forces at t_n, works and heat of the last step. Adds the forces to owned
     * nodes of @p loads, and appends these nodes to @p loaded_nodes. Collective. */
    void end_step(const NodalState &state, const Clock &clock, const NodalHeat &nodal_heat,
                  NodalVector &loads, std::vector<unsigned int> &loaded_nodes)
    {
      if (this->begin_forces(state, clock, nodal_heat))
        this->find_areas(state);
      measure_depths(state, clock.time);
      const double begin = clock.time - clock.previous_step;
      if (clock.step > 0)
        this->totals.damping += std::exchange(loss_of_tool, 0.);
      auto constraint = constraints.begin();
      for (std::size_t k = 0; k < this->candidates.size(); ++k)
      {
        NodeHistory &history = this->histories[k];
        const unsigned int node = this->candidates[k];
        const auto x = vector_of<dim>(state.position.node(node));
        const bool is_behind = constraint != constraints.end() && constraint->candidate == k;
        const bool touches = is_behind && constraint->normal_force > 0.;
        const Tensor<1, dim> normal_force_before = normal_forces[k];
        const Tensor<1, dim> friction_force_before = history.force - normal_force_before;
        Tensor<1, dim> friction_force;
        normal_forces[k] = 0.;
        if (touches)
        {
          normal_forces[k] = constraint->normal_force * constraint->normal;
          friction_force = constraint->friction_force;
        }
        const Tensor<1, dim> force_before = history.force;
        const Tensor<1, dim> force = normal_forces[k] + friction_force;
        if (touches || force_before.norm_square() > 0.)
        {
          const Tensor<1, dim> surface_motion = this->surface->motion(x, begin, clock.time);
          const Tensor<1, dim> motion = x - history.position - surface_motion;
          this->totals.damping -= 0.5 * (normal_force_before + normal_forces[k]) * motion;
          double friction_heat = -0.5 * (friction_force_before + friction_force) * motion;
          if (touches && clock.step == 0)
          {
            // The kinetic energy of bodies at t_0 lacks the square of the change by forces in half
            // a step; that of a tool loses it in the next one.
            this->totals.damping += 0.25 * normal_forces[k] * constraint->response;
            friction_heat += 0.25 * friction_force * constraint->response;
            loss_of_tool -= 0.25 * force * constraint->response_of_surface;
          }
          if (this->settings.friction.largest() > 0.)
            this->add_friction_heat(k, friction_heat, nodal_heat);
          this->set_force(k, x, force, surface_motion, touches, loads, loaded_nodes);
        }
        else
          history = {force, x};
        if (touches)
          this->add_contact(k, constraint->normal_force, this->area(k, constraint->normal), clock);
        if (is_behind)
          ++constraint;
      }
      this->end_forces();
      constraints.clear();
    }

  private:
    using typename SurfaceContact<dim>::NodeHistory;

    /** A node that would be behind the surface. */
    struct Constraint
    {
      std::size_t candidate;
      double gap;            ///< predicted at t_{n+1} [L]
      Tensor<1, dim> normal; ///< of the surface there
      Tensor<1, dim> slip;   ///< predicted of the step, along the surface [L]
      double friction;       ///< Coulomb's coefficient
      double shear_limit;    ///< of the force along the surface [M L/T^2]
      double mass;           ///< of a step of correct() [M]
      double normal_force = 0, trial_normal_force = 0;     ///< N [M L/T^2]
      Tensor<1, dim> friction_force, trial_friction_force; ///< T [M L/T^2]
      Tensor<1, dim> response;            ///< displacement by the forces in the step [L]
      Tensor<1, dim> response_of_surface; ///< likewise
    };

    void add_node_sums(ContactBalance &shares) const override
    {
      for (const Tensor<1, dim> &force : normal_forces)
        shares.n_nodes += force.norm_square() > 0. ? 1. : 0.;
      shares.penetration = deepest;
    }

    /** The predicted positions of candidates less @p free_motion, that of a surface with a mass. */
    void set_positions_from_mass(const NodalVector &predicted, const Tensor<1, dim> &free_motion)
    {
      positions_from_mass.fit_to(predicted.partition(), predicted.quantity());
      for (const unsigned int node : near_nodes)
        for (unsigned int d = 0; d < dim; ++d)
          positions_from_mass.node(node)[d] = predicted.node(node)[d] - free_motion[d];
    }

    /** Appends a constraint of a candidate behind the surface unless its node is held. */
    void add_constraint(const std::size_t candidate, const double gap,
                        const Tensor<1, dim> &position, const Tensor<1, dim> &motion,
                        const NodalVector &mass, const unsigned int held_components,
                        const Clock &clock, const NodalHeat &nodal_heat)
    {
      const unsigned int node = this->candidates[candidate];
      Constraint constraint;
      constraint.candidate = candidate;
      constraint.gap = gap;
      constraint.normal = this->surface->normal(position, clock.time + clock.next_step);
      constraint.slip = along_surface(motion, constraint.normal);
      constraint.friction = this->friction_coefficient(candidate, nodal_heat);
      constraint.shear_limit =
          this->shear_limit(candidate, this->area(candidate, constraint.normal));
      constraint.mass = std::numeric_limits<double>::max();
      double free_share = 0;
      for (unsigned int d = 0; d < dim; ++d)
      {
        constraint.mass =
            std::min(constraint.mass, mass.node(node)[mass.n_slots_per_node() == 1 ? 0 : d]);
        if (!((held_components >> d) & 1u))
          free_share += constraint.normal[d] * constraint.normal[d];
      }
      if (free_share < smallest_free_share)
        return;
      // The forces of the last step are the first ones to try.
      const Tensor<1, dim> &normal_force = normal_forces[candidate];
      constraint.normal_force = constraint.trial_normal_force =
          std::max(0., normal_force * constraint.normal);
      constraint.friction_force = constraint.trial_friction_force =
          along_surface(this->histories[candidate].force - normal_force, constraint.normal);
      constraints.push_back(constraint);
    }

    /** Finds the largest depth of nodes that forces hold on the surface. */
    void measure_depths(const NodalState &state, const double time)
    {
      std::vector<unsigned int> nodes;
      for (std::size_t k = 0; k < this->candidates.size(); ++k)
        if (normal_forces[k].norm_square() > 0.)
          nodes.push_back(this->candidates[k]);
      this->find_gaps(state.position, nodes, time, this->gap);
      deepest = 0.;
      for (std::size_t k = 0; k < nodes.size(); ++k)
        deepest = std::max(deepest, -this->gap[k]);
    }

    /** The motion of a surface with a mass by the trial forces, over Δt Δt_n [M]. Collective there.
     */
    Tensor<1, dim> response_of_surface() const
    {
      if (!this->surface->translation().has_mass())
        return Tensor<1, dim>();
      std::array<double, dim> sum{};
      for (const Constraint &constraint : constraints)
        for (unsigned int d = 0; d < dim; ++d)
          sum[d] += constraint.trial_normal_force * constraint.normal[d] +
                    constraint.trial_friction_force[d];
      sum = ordered_sum(sum, this->communicator);
      Tensor<1, dim> reaction;
      for (unsigned int d = 0; d < dim; ++d)
        reaction[d] = -sum[d];
      return this->surface->translation().motion_by(reaction, 1.);
    }

    std::vector<std::size_t> near;        ///< candidates that can come behind the surface
    std::vector<unsigned int> near_nodes; ///< their nodes
    std::vector<Constraint> constraints;
    NodalVector positions_from_mass;           ///< of candidates, where the surface has a mass
    std::vector<Tensor<1, dim>> normal_forces; ///< N n of each candidate at t_n
    double loss_of_tool = 0; ///< of t_0, accounted for in the next step [M L^2/T^2]
    double deepest = 0;      ///< of the nodes in contact at t_n, on this rank [L]
  };

  template <int dim>
  KinematicSolver<dim>::KinematicSolver(std::vector<KinematicContact<dim> *> scene_contacts,
                                        const Model<dim> &model)
      : contacts(std::move(scene_contacts)), position_response(*model.bridge)
  {
    for (const KinematicContact<dim> *const contact : contacts)
      candidates.insert(candidates.end(), contact->candidate_nodes().begin(),
                        contact->candidate_nodes().end());
    make_unique_nodes(candidates);
  }

  template <int dim>
  bool KinematicSolver<dim>::find_near_nodes(const Model<dim> &model, const Clock &clock)
  {
    const auto square = [](const double *const vector)
    { return vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]; };
    double largest[2] = {0., 0.};
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      largest[0] = std::max(largest[0], square(model.state.velocity.node(i)));
      largest[1] = std::max(largest[1], square(model.state.acceleration.node(i)));
    }
    Utilities::MPI::max(ArrayView<const double>(largest, 2), model.communicator,
                        ArrayView<double>(largest, 2));
    const double speed = std::sqrt(largest[0]), acceleration = std::sqrt(largest[1]);
    for (const unsigned int node : candidates)
      store_node(load_node(model.state.position.node(node)) +
                     load_node(model.state.velocity.node(node)) * clock.next_step,
                 predicted.node(node));
    // B differs from I by the values of nodes around, and can raise the largest one a little.
    constexpr double factor = 4.;
    const double difference =
        (position_response.is_global() ? 0. : speed) + clock.velocity_step() * acceleration;
    near.clear();
    for (KinematicContact<dim> *const contact : contacts)
      contact->find_near_candidates(predicted, clock, factor * clock.next_step * difference, near);
    make_unique_nodes(near);
    return Utilities::MPI::max(near.empty() ? 0 : 1, model.communicator) == 1;
  }

  template <int dim>
  double KinematicSolver<dim>::find_constraints(const Model<dim> &model, const Clock &clock,
                                                const NodalHeat &nodal_heat)
  {
    position_response.predict(model.state, clock, near, predicted);
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
  void KinematicSolver<dim>::set_responding_nodes(const Model<dim> &model)
  {
    const std::vector<std::uint8_t> &constrained = model.conditions->constrained_components();
    const bool is_kept =
        rows_of == model.state.partition() && stencils_of_rows == model.revisions.stencils &&
        cells_of_rows == model.revisions.cells && constrained_of_rows == constrained &&
        responding.size() <= most_responding * (near.size() + 1) &&
        std::includes(responding.begin(), responding.end(), nodes.begin(), nodes.end());
    if (Utilities::MPI::min(is_kept ? 1 : 0, model.communicator) == 1)
    {
      position_response.keep_nodes();
      return;
    }
    rows_of = model.state.partition();
    stencils_of_rows = model.revisions.stencils;
    cells_of_rows = model.revisions.cells;
    constrained_of_rows = constrained;
    responding = near;
    position_response.set_nodes(responding);
  }

  template <int dim>
  void KinematicSolver<dim>::sweep(const Model<dim> &model, const Clock &clock,
                                   const double tolerance)
  {
    for (const unsigned int node : nodes)
      *count.node(node) = 0.;
    for (const KinematicContact<dim> *const contact : contacts)
      contact->count_constraints(count);
    for (KinematicContact<dim> *const contact : contacts)
      contact->share_masses(count);
    set_responding_nodes(model);
    double change = std::numeric_limits<double>::max();
    for (unsigned int k = 0; k < most_sweeps && change > tolerance; ++k)
    {
      for (const unsigned int node : responding)
        store_node(NodeLanes(0.), trial_loads.node(node));
      for (const KinematicContact<dim> *const contact : contacts)
        contact->add_trial_forces(trial_loads);
      position_response.respond(trial_loads, model.conditions->constrained_components(), response,
                                model.conditions->oblique_nodes());
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
  void KinematicSolver<dim>::solve(const Model<dim> &model, const Clock &clock,
                                   const NodalHeat &nodal_heat, NodalVector &loads,
                                   std::vector<unsigned int> &loaded_nodes)
  {
    const auto &partition = model.state.partition();
    for (NodalVector *const vector : {&predicted, &trial_loads, &response})
      vector->fit_to(partition);
    count.fit_to(partition, Quantity::scalar);
    position_response.begin_step(partition);
    if (find_near_nodes(model, clock))
    {
      const double deepest = find_constraints(model, clock, nodal_heat);
      if (deepest > 0.)
        sweep(model, clock, sweep_tolerance * deepest);
    }
    for (KinematicContact<dim> *const contact : contacts)
      contact->end_step(model.state, clock, nodal_heat, loads, loaded_nodes);
  }

  template <int dim>
  std::unique_ptr<SurfaceContact<dim>>
  make_kinematic_contact(ContactScene<dim> &scene, std::vector<KinematicContact<dim> *> &contacts)
  {
    auto result = std::make_unique<KinematicContact<dim>>(scene);
    contacts.push_back(result.get());
    return result;
  }

  template std::unique_ptr<SurfaceContact<2>>
  make_kinematic_contact(ContactScene<2> &, std::vector<KinematicContact<2> *> &);
  template std::unique_ptr<SurfaceContact<3>>
  make_kinematic_contact(ContactScene<3> &, std::vector<KinematicContact<3> *> &);
  template class KinematicSolver<2>;
  template class KinematicSolver<3>;
} // namespace tombolo
