// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/json.h>
#include <tombolo/base/log.h>
#include <tombolo/model/model_input.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/statics/rigid_modes.h>
#include <tombolo/physics/statics/static_problem.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <typeinfo>

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
    /** `Time integration` and the section "Statics". */
    struct Settings
    {
      /** Throws InputError. */
      explicit Settings(const Entries &run_entries)
      {
        name = run_entries.choice(
            integration_entry, explicit_steps,
            std::string(explicit_steps) + "|" + Registry<StaticSolver<dim>>::instance().selection(),
            "How the mechanics goes through time: `explicit` follows the motion by stable steps; "
            "the others find the equilibrium of a body at rest at the end of each step.");
        const Entries e = run_entries.subsection(statics_section);
        if (!e.declares())
          solver =
              Registry<StaticSolver<dim>>::instance().create(name, e.section().subsection(name));
        largest_step = e.number(
            "Largest step", "0", at_least(0.), "T",
            "The largest step, and the first one; 0 is a twentieth of the run. Outputs are met by "
            "equal steps.");
        smallest_step = e.number(
            "Smallest step", "0", at_least(0.), "T",
            "A step that does not converge is halved, down to this one; 0 is a thousandth of the "
            "largest.");
        tolerance = e.number(
            "Tolerance", "1e-08", between(1e-14, 0.1), "1",
            "A step has converged where the norm of the forces that are not in equilibrium is at "
            "most this fraction of the norm of the forces of cells, the largest of the run.");
        contact_stiffness = e.number(
            "Contact stiffness", "100", between(1e-3, 1e6), "1",
            "By how much the springs of contacts are stiffer than their entry `Stiffness` makes "
            "them in explicit steps at the step of eq. (41), which limits them there and not here. "
            "Bodies go into each other by less where it is larger, and the equations become harder "
            "to solve.");
        e.refuse(smallest_step > 0. && largest_step > 0. && smallest_step > largest_step,
                 "Smallest step", "allowed is a step that is not larger than `Largest step`.");
        e.plugins<StaticSolver<dim>>();
      }

      std::string name;
      std::unique_ptr<StaticSolver<dim>> solver;
      double largest_step, smallest_step; ///< [T]; zero: by default
      double tolerance, contact_stiffness;
    };

    /** Whether the scene has such steps. */
    static bool are_chosen(const Parameters &parameters)
    {
      return parameters.section("").get(integration_entry) != explicit_steps;
    }

    /** Refuses parts, contacts and a bridge that static steps do not support. Throws InputError. */
    static void refuse_unfit(const Parameters &parameters, const std::vector<Part<dim>> &parts)
    {
      bool has_particles = false, has_cells = false;
      for (const Part<dim> &part : parts)
        if (part.formulation != nullptr)
        {
          (part.particles != nullptr ? has_particles : has_cells) = true;
          parameters.attempt(
              [&] { refuse_unfit_part(parameters.section("Part: " + part.name), part); });
        }
      if (has_particles && !(parameters.raw_list("Contacts").empty() &&
                             parameters.raw_list("Body contacts").empty()))
        parameters.attempt(
            [&]
            {
              parameters.fail(integration_entry,
                              "the scene has contacts and particles, whose forces are spread by "
                              "shape functions that such steps do not know in their stiffness; "
                              "allowed are contacts of elements and smoothed cells, or particles "
                              "without contacts.");
            });
      const Section coupling = parameters.section("Coupling");
      if (has_particles && has_cells && coupling.get("Bridge") == "trace")
        parameters.attempt(
            [&]
            {
              coupling.fail("Bridge", "elements see the field of particles at shared nodes, and `" +
                                          parameters.raw(integration_entry) +
                                          "` steps (entry \"Time integration\") do not know how "
                                          "that changes their stiffness; allowed is paper.");
            });
    }

    /** For an initial model. Throws InputError where static steps do not support a feature of it,
     * or where nothing holds a body. Collective. */
    StaticSteps(const Parameters &parameters, Model<dim> &model, Log &log)
        : model(model), log(log), settings(parameters.section("")),
          problem(model, settings.contact_stiffness)
    {
      if (settings.largest_step == 0.)
        settings.largest_step = parameters.section("").get_positive("End time") / 20.;
      if (settings.smallest_step == 0.)
        settings.smallest_step = 1e-3 * settings.largest_step;
      step = settings.largest_step;
      refuse_unfit_model(parameters);
      last_position = model.state.position.copy();
      if (model.heat)
        for (NodalVector *const vector : {&last_temperature, &mixed_temperature})
          vector->reinit(model.state.partition(), Quantity::scalars);
    }

    /** From the equilibrium at the time of the last call to that at clock.time, with the present
     * temperature of the model. @p must_stop is called between systems of linear equations and must
     * return the same on all ranks: where it is true, returns false, with the model at the last
     * equilibrium. Throws RunError on all ranks where the smallest step does not converge:
     * the model is then as it was. Collective. */
    bool solve(const Clock &clock, const std::function<bool()> &must_stop = {})
    {
      problem.must_stop = must_stop;
      if (clock.step == 0 && !is_continued)
        set_initial_temperature();
      last_position.copy_from(model.state.position);
      if (clock.step == 0 && model.heat)
        last_temperature.copy_from(model.heat->state.present_temperature);
      const double length = clock.step == 0 ? settings.largest_step : clock.previous_step;
      if (!solve_interval(clock, clock.time - length, clock.time))
        return false;
      if (model.heat)
        last_temperature.copy_from(model.heat->state.present_temperature);
      return true;
    }

    /** The step from the clock's time towards @p target, not beyond it. */
    double next(const Clock &clock, const double target) const
    {
      const double remaining = target - clock.time;
      return remaining / std::max(1., std::ceil(remaining / step * (1. - 1e-9)));
    }

    /** Books the step that ends at the clock's time, and the begin of the next one, whose size is
     * set. Collective. */
    void account(const Clock &clock)
    {
      // The second half of the last step and the first half of the next.
      if (clock.step > 0)
      {
        shortest = shortest > 0. ? std::min(shortest, clock.previous_step) : clock.previous_step;
        longest = std::max(longest, clock.previous_step);
        book_displacement(clock);
      }
      book(clock, 0., clock.next_step);
    }

    /** The temperatures of the material points are those of a former state: none are set at the
     * start. */
    void continue_from_state()
    {
      is_continued = true;
    }

    /** The work of residuals within the tolerance, or of round-off, so far: the uncertainty of the
     * energy balance of a body that is hardly strained [M L^2/T^2]. */
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

    /** Replaces the entries of explicit steps. */
    void add_to_summary(Json &summary) const
    {
      Json result = Json::object();
      result["method"] = settings.name;
      result["force_evaluations"] =
          static_cast<double>(problem.n_evaluations()) + settings.solver->further_evaluations();
      result["force_evaluations_without_matrices"] = problem.n_evaluations();
      result["divided_steps"] = n_divisions;
      settings.solver->add_to_summary(result);
      summary["statics"] = result;
      summary["time_step_min"] = shortest;
      summary["time_step_max"] = longest;
      for (const char *const explicit_entry : {"time_step_limit", "time_step_estimates"})
        summary.erase(std::string(explicit_entry));
    }

    /** For the audit: how many steps at least. */
    double n_steps(const double end_time) const
    {
      return std::ceil(end_time / settings.largest_step);
    }

    /** Lists the state from step to step. */
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
    static constexpr const char *integration_entry = "Time integration";
    static constexpr const char *explicit_steps = "explicit";
    static constexpr const char *statics_section = "Statics";

    static void refuse_unfit_part(const Section &section, const Part<dim> &part)
    {
      const std::string steps =
          "`" + section.all().raw(integration_entry) + "` steps (entry \"Time integration\") ";
      const std::optional<std::string> unfit = part.formulation->unfit_to_linearize();
      if (!unfit)
        section.fail("Formulation", steps + "need a body that deforms; rigid parts are known to "
                                            "explicit steps only.");
      if (!unfit->empty())
        section.fail("Formulation",
                     "it has " + *unfit + "; " + steps + "know stiffness only. Switch it off.");
      if (part.material->remembers("bulk modulus"))
        section.fail("Material", "its pressure is that of an equation of state, which is for "
                                 "shocks; " +
                                     steps + "know the elastic pressure only.");
      if (part.formulation->can_lose_cells())
        section.fail("Formulation", "its cells can leave while the run goes on, by erosion, "
                                    "conversion or refills; " +
                                        steps + "keep all cells.");
    }

    void refuse_unfit_model(const Parameters &parameters)
    {
      for (const Part<dim> &part : model.parts) // some checks need the mesh
        refuse_unfit_part(parameters.section("Part: " + part.name), part);
      for (const auto &process : model.processes)
        if (process->roles.rest == ProcessRole::is_refused)
          parameters.fail(integration_entry,
                          "the scene has the process \"" + words_of_type(typeid(*process)) +
                              "\", which such steps do not know. Take out "
                              "the entry that asks for it, or use `explicit` steps.");
      const std::string free =
          free_rigid_modes(model, problem.constrained(), problem.springs_at_start());
      if (!free.empty())
        parameters.fail(integration_entry,
                        "nothing holds " + free +
                            ". A body at rest needs conditions (clamps, displacements, planes of "
                            "symmetry) that hold all its rigid motions; contacts hold along their "
                            "normal, where bodies touch at the start. Move what is apart together, "
                            "by the mesh or by a stage before, or hold the body.");
    }

    /** Sets the temperatures of the points at the start, which expand nothing. Collective. */
    void set_initial_temperature()
    {
      NodalVector &force = model.state.force;
      for (const Part<dim> &part : model.parts)
        part.formulation->add_internal_force(
            {&model.state.position, &model.state.velocity, 0.,
             model.heat ? &model.heat->state.present_temperature : nullptr},
            force);
      force.set_zero();
    }

    /** From @p begin to @p end in one step or several. Returns false where it was stopped. */
    bool solve_interval(const Clock &clock, const double begin, const double end)
    {
      const bool is_start = clock.step == 0;
      double done = begin, size = end - begin;
      bool was_divided = false, was_easy = true;
      while (done < end)
      {
        const bool is_last = done + size > end - 1e-9 * (end - begin);
        StaticInterval interval;
        interval.begin = done;
        interval.end = is_last ? end : done + size;
        interval.step = clock.step;
        interval.is_start = is_start;
        interval.temperature =
            temperature_at(is_last ? 1. : (interval.end - begin) / (end - begin));
        problem.begin(interval);
        last = settings.solver->solve(problem, settings.tolerance);
        log.record("  statics, step " + std::to_string(clock.step) +
                   " to t = " + format_number(interval.end) + ": " + last.report);
        if (last.has_converged)
        {
          unresolved += problem.unresolved_work();
          problem.commit();
          done = interval.end;
          was_easy = was_easy && settings.solver->was_easy(last);
          if (!is_last)
            book_part(clock);
          continue;
        }
        const std::string worst_node = problem.largest_residual();
        problem.undo();
        if (last.was_stopped)
          return false;
        // A body at the start has no smaller step.
        if (is_start || 0.5 * size < settings.smallest_step)
          give_up(interval, last, worst_node);
        size *= 0.5;
        was_divided = true;
        ++n_divisions;
      }
      if (is_start)
        return true;
      constexpr unsigned int enough = 3;
      n_easy_steps = was_easy && !was_divided ? n_easy_steps + 1 : 0;
      if (was_divided)
        step = size;
      else if (n_easy_steps == enough)
      {
        step = std::min(2. * step, settings.largest_step);
        n_easy_steps = 0;
      }
      return true;
    }

    const NodalVector *temperature_at(const double share)
    {
      if (!model.heat)
        return nullptr;
      const NodalVector &now = model.heat->state.present_temperature;
      if (share == 1.)
        return &now;
      const auto n = std::size_t(now.partition()->n_local()) * node_stride;
      for (std::size_t i = 0; i < n; ++i)
        mixed_temperature.data()[i] =
            (1. - share) * last_temperature.data()[i] + share * now.data()[i];
      return &mixed_temperature;
    }

    /** Works and impulses of the present forces over half of both steps of @p clock, with the
     * velocities that nodes have. Collective. */
    void book(const Clock &clock, const double previous, const double next)
    {
      Clock half = clock;
      half.step = std::max(clock.step, 1ul); // no velocity is given at the start
      half.previous_step = previous;
      half.next_step = next;
      model.impulses.begin_step();
      for (const auto &process : model.processes)
        if (process->roles.rest == ProcessRole::acts)
          process->complete_step(model, half);
    }

    /** The same of the second half of the step of @p clock, in which the displacement since the
     * last booking is booked. Collective. */
    void book_displacement(const Clock &clock)
    {
      NodalState &state = model.state;
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          state.velocity.node(i)[d] =
              2. / clock.previous_step * (state.position.node(i)[d] - last_position.node(i)[d]);
      state.velocity.distribute();
      book(clock, clock.previous_step, 0.);
      state.velocity.set_zero();
      last_position.copy_from(state.position);
    }

    /** Works of an interval of a step that was divided, by the forces at both of its ends. Mean
     * forces of the step stay those at its own ends. Collective. */
    void book_part(const Clock &clock)
    {
      // The first half of the whole step is booked: works are those of its length times a velocity,
      // for any length. Impulses of the time between are added and subtracted.
      book_displacement(clock);
      book(clock, 0., -2. * clock.previous_step);
      book(clock, 0., clock.previous_step);
    }

    [[noreturn]] void give_up(const StaticInterval &interval, const StaticSolution &solution,
                              const std::string &worst_node) const
    {
      // Without a residual the forces were not found, and the report says why.
      const std::string forces =
          solution.residual == 0.
              ? ""
              : as_text("the forces that are not in equilibrium are still ", solution.residual,
                        " of the scale of forces (allowed ", settings.tolerance,
                        "), the largest at ", worst_node, ". By iteration: ");
      const std::string advice = solution.advice + (solution.advice.empty() ? "" : " ");
      const std::string end = solution.report.back() == '.' ? " " : ". ";
      if (interval.is_start)
        throw RunError("The " + settings.name +
                       " step to the equilibrium of the start did not "
                       "converge: " +
                       forces + solution.report + end + advice +
                       "This step is not divided: what acts, or is gone, from the start on can "
                       "come in a run (or stage) before, over time; supports may help, too.");
      throw RunError(as_text(
          "The ", settings.name, " step ", interval.step, " from time ", interval.begin, " to ",
          interval.end, " did not converge: ", forces, solution.report, end, "The state of time ",
          interval.begin, " is the last one in equilibrium, and outputs up to it are complete. ",
          advice,
          "Loads that grow more slowly, a smaller `Smallest step` (section Statics), or supports "
          "may help, too."));
    }

    Model<dim> &model;
    Log &log;
    Settings settings;
    StaticProblem<dim> problem;
    double step;                   ///< the last good one
    unsigned int n_easy_steps = 0; ///< one after the other
    bool is_continued = false;
    unsigned long n_divisions = 0;
    double unresolved = 0;
    double shortest = 0, longest = 0; ///< steps of this process
    StaticSolution last;
    NodalVector last_position;                       ///< at the last booking
    NodalVector last_temperature, mixed_temperature; ///< only with heat
  };
} // namespace tombolo
