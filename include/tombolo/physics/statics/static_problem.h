// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/assembly.h>
#include <tombolo/model/model.h>
#include <tombolo/model/tangent.h>
#include <tombolo/model/trial.h>
#include <tombolo/physics/statics/nodal_frames.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /** A step of a body at rest, from one time to the next. */
  struct StaticInterval
  {
    double begin = 0, end = 0;
    unsigned long step = 0; ///< its number, for messages
    /** Prescribed velocities move nothing: the state at the start looks for its equilibrium. */
    bool is_start = false;
    const NodalVector *temperature = nullptr; ///< at the end, ghosts current; null without heat

    double duration() const
    {
      return end - begin;
    }
  };

  /**
   * The equations of a static step, R(u) = F_int(x_n + u) + F_ext(x_n + u) = 0 at the components of
   * nodes that nothing prescribes, where u is the displacement of the step, and u itself at the
   * others: the force evaluation of explicit steps with the velocity u/Δt from the material points
   * as they were at the start (Trial), so that it can be asked at any u, any number of times; and
   * so can processes (ModelSignals::trials). Springs of contacts are those of explicit steps at
   * the step of eq. (41), α m c²/h² at a node, which no longer depends on any time, times a factor.
   *
   * Vectors have the partition of the model, without images; ghosts of u must be current.
   */
  template <int dim>
  class StaticProblem
  {
  public:
    /** Springs of contacts are by @p spring_factor stiffer than those of explicit steps.
     * Collective. */
    StaticProblem(Model<dim> &model, double spring_factor);

    /** Begins a step from the present state. Collective. */
    void begin(const StaticInterval &interval);

    /** Evaluates R at @p displacement. Returns false, on all ranks, where there is none: a cell is
     * turned inside out, for example; failure() says what. Collective. */
    bool evaluate(const NodalVector &displacement);

    /** Keeps the last evaluation. */
    void commit()
    {
      trial->commit();
      trial.reset();
      model.state.velocity.set_zero();
    }

    /** Goes back to the start of the step: positions, points. Collective. */
    void undo();

    /** Material points as at the start of the step, for whoever evaluates parts of it himself. */
    void restart_points()
    {
      trial->restart();
    }

    /** R of owned nodes, zero at prescribed components [M L/T^2]. */
    const NodalVector &residual() const
    {
      return free_force;
    }

    /** |R| over all ranks; the same bits on all. Collective. */
    double residual_norm() const;

    /** A node with the largest R, for a message. Collective. */
    std::string largest_residual() const;

    /** The prescribed displacements of the step, zero elsewhere; ghosts current. */
    const NodalVector &prescribed() const
    {
      return prescribed_displacement;
    }

    /** Whether any of them is not zero. */
    bool is_driven() const
    {
      return has_driven_nodes;
    }

    /** The frames of nodes of which directions are prescribed that are no axes. */
    const NodalFrames<dim> &frames() const
    {
      return nodal_frames;
    }

    /** One at prescribed components of nodes, along their frames, zero at the others; ghosts
     * current. */
    const NodalVector &constrained() const
    {
      return mask;
    }

    /** The largest sum of forces of cells at the nodes so far (its norm): what residuals are
     * compared with [M L/T^2]. */
    double force_scale = 0;

    /** What positions that are rounded do to R; zero until the stiffness of the step is known [M
     * L/T^2]. */
    double round_off = 0;

    /** The forces that R is compared with where it may be @p tolerance of them: the force scale,
     * or, where next to nothing is strained, those of which round-off is such a part. */
    double scale(const double tolerance) const
    {
      return std::max(force_scale, round_off / tolerance);
    }

    /** @p norm over this scale, at most @p tolerance where R with that norm is small. */
    double relative(const double norm, const double tolerance) const
    {
      const double of_forces = scale(tolerance);
      return of_forces > 0. ? norm / of_forces : norm > 0. ? 1. : 0.;
    }

    /** What the forces that are left in the last evaluation, or their round-off, do over the
     * displacement of the step: no work is known better than this [M L^2/T^2]. Collective. */
    double unresolved_work() const;

    /** Whether the run is asked to end, the same on all ranks; null: never. Collective. */
    std::function<bool()> must_stop;

    Model<dim> &model;
    const StaticInterval &interval() const
    {
      return present;
    }

    /** How the forces of processes in the last evaluation change with positions: @p springs, and
     * in @p bound a diagonal matrix at owned nodes. Collective. */
    void linearize_processes(std::vector<ContactStiffness<dim>> &springs, NodalVector &bound)
    {
      linearize(process_clock(), springs, bound);
    }

    /** The springs of processes in the present state, at the start of the run. Collective. */
    std::vector<ContactStiffness<dim>> springs_at_start();

    const std::string &failure() const
    {
      return failure_text;
    }
    std::uint64_t n_evaluations() const
    {
      return count;
    }

    MechanicalInput input() const
    {
      return {&model.state.position, &model.state.velocity, present.duration(),
              present.temperature};
    }

  private:
    void set_constrained();
    /** Sets the prescribed components of an owned node to zero. */
    void remove_constrained(unsigned int node, double *vector) const;
    std::string evaluate_parts();
    /** What processes see of the step. */
    Clock process_clock() const;
    void begin_trials(const Clock &clock);
    void restart_processes();
    void linearize(const Clock &clock, std::vector<ContactStiffness<dim>> &springs,
                   NodalVector &bound);
    /** Calls @p use for processes that act in such steps. */
    template <typename Use>
    void for_acting(const Use &use)
    {
      for (const auto &process : model.processes)
        if (process->roles.rest == ProcessRole::acts)
          use(*process);
    }

    Assembly<dim> assembly;
    std::unique_ptr<Trial<dim>> trial;
    StaticInterval present;
    NodalVector start_position;
    NodalFrames<dim> nodal_frames;
    NodalVector mask, prescribed_displacement, free_force;
    Records of_nodes;      ///< what processes give to nodes
    double spring_time;    ///< of which springs of contacts are made [T]
    double touch_distance; ///< what is nearer touches [L]
    bool has_driven_nodes = false;
    std::string failure_text;
    std::uint64_t count = 0;
  };
} // namespace tombolo
