// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/json.h>
#include <tombolo/base/log.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/statics/static_problem.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

namespace tombolo
{
  /**
   * The mechanics of a run whose bodies are at rest at every time: instead of the steps of
   * MechanicalStep, those of a StaticSolver, which `Time integration` names. A step that does not
   * converge is divided in two, with the temperature interpolated between its ends; the next ones
   * are shorter, and grow again when steps are easy. Works and impulses of conditions are those of
   * forces that change linearly between the times of the run.
   */
  template <int dim>
  class StaticSteps
  {
  public:
    /** Declares `Time integration` and the section "Statics". */
    static void declare_parameters(const Entries &e);

    /** Whether the scene has such steps. */
    static bool are_chosen(const Parameters &parameters);

    /** Refuses what can be seen to be wrong without a mesh. Throws InputError. */
    static void validate(const Parameters &parameters);

    /** Refuses parts, contacts and a bridge that static steps do not know. Throws InputError. */
    static void refuse_unfit(const Parameters &parameters, const std::vector<Part<dim>> &parts);

    /** For a model as it is at the start. Throws InputError where it has what static steps do not
     * know, or where nothing holds a body. Collective. */
    StaticSteps(const Parameters &parameters, Model<dim> &model, Log &log);

    /** From the equilibrium at the time of the last call to that at clock.time, with the present
     * temperature of the model. @p must_stop is asked between systems of linear equations and must
     * answer alike on all ranks: returns false, with the model at the last equilibrium, where it
     * asked for the end. Throws RunError on all ranks where the smallest step does not converge:
     * the model is then as it was. Collective. */
    bool solve(const Clock &clock, const std::function<bool()> &must_stop = {});

    /** The step from the clock's time towards @p target, not beyond it. */
    double next(const Clock &clock, const double target) const
    {
      const double remaining = target - clock.time;
      return remaining / std::max(1., std::ceil(remaining / step * (1. - 1e-9)));
    }

    /** Books the step that ends at the clock's time, and what begins there; the size of the next
     * step is known. Collective. */
    void account(const Clock &clock);

    /** The temperatures of the material points are those of a state of before: nothing is to be set
     * at the start. */
    void continue_from_state()
    {
      is_continued = true;
    }

    /** What residuals within the tolerance, or round-off, can have done so far: the energy balance
     * of a body that is hardly strained holds to this [M L^2/T^2]. */
    double unresolved_work() const
    {
      return unresolved;
    }

    /** Fills columns of the table over time. */
    void report(TimeTable &table) const
    {
      table.add("static iterations", "1", last.n_iterations);
      table.add("static residual", "1", last.residual);
    }

    /** After the entries of explicit steps, which it takes away. */
    void add_to_summary(Json &summary) const;

    /** For the audit: how many steps at least. */
    double n_steps(const double end_time) const
    {
      return std::ceil(end_time / largest_step);
    }

    /** Lists what is kept from step to step. */
    void list(Records &records)
    {
      records.value("step", step);
      records.value("easy steps", n_easy_steps);
      records.value("force scale", problem.force_scale);
      records.value("unresolved work", unresolved);
      if (model.heat)
        records.nodal("last temperature", 1, last_temperature);
    }

  private:
    static void refuse_unfit_part(const Section &section, const Part<dim> &part);
    void refuse_unfit_model(const Parameters &parameters);
    /** Sets the temperatures of the points at the start, which expand nothing. Collective. */
    void set_initial_temperature();
    /** From @p begin to @p end in one step or several. Returns false where it was stopped. */
    bool solve_interval(const Clock &clock, double begin, double end);
    const NodalVector *temperature_at(double share);
    /** Works and impulses of the present forces over half of both steps of @p clock, with the
     * velocities that nodes have. Collective. */
    void book(const Clock &clock, double previous, double next);
    /** The same of the second half of the step of @p clock, in which the displacement since the
     * last booking is booked. Collective. */
    void book_displacement(const Clock &clock);
    /** Works of an interval of a step that was divided, by the forces at both of its ends. Mean
     * forces of the step stay those at its own ends. Collective. */
    void book_part(const Clock &clock);
    [[noreturn]] void give_up(const StaticInterval &interval, const StaticSolution &solution,
                              const std::string &place) const;

    Model<dim> &model;
    Log &log;
    std::string name;
    double largest_step, smallest_step, tolerance;
    std::unique_ptr<StaticSolver<dim>> solver;
    StaticProblem<dim> problem;
    double step;                   ///< that was good last
    unsigned int n_easy_steps = 0; ///< one after the other
    bool is_continued = false;
    unsigned long n_divisions = 0;
    double unresolved = 0;
    double shortest = 0, longest = 0; ///< steps of this process
    StaticSolution last;
    NodalVector last_position;                       ///< where the last booking was
    NodalVector last_temperature, mixed_temperature; ///< only with heat
  };
} // namespace tombolo
