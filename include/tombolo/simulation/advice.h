// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/log.h>
#include <tombolo/contact/surface_contact.h>
#include <tombolo/mesh/extent.h>
#include <tombolo/model/model.h>
#include <tombolo/output/exact_solution.h>
#include <tombolo/output/unit_labels.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>
#include <tombolo/physics/mechanics/step_size.h>
#include <tombolo/physics/mechanics/subcycling.h>
#include <tombolo/physics/statics/static_steps.h>
#include <tombolo/simulation/initial_state.h>
#include <tombolo/simulation/short_number.h>
#include <tombolo/simulation/spacings.h>
#include <tombolo/simulation/unit_warnings.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/map.hpp>
#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace tombolo
{
  /** The largest extent of the body over the largest wave speed [T]. Collective. */
  template <int dim>
  double crossing_time(const Model<dim> &model)
  {
    double speed = 0;
    for (const Part<dim> &part : model.parts)
      speed = std::max(speed, part.material->longitudinal_wave_speed());
    return extent_of<dim>(model.state.initial_position).longest() / speed;
  }

  template <int dim>
  void warn_of_early_end(const Model<dim> &model, const double end_time, Log &log)
  {
    const double crossing = crossing_time(model);
    if (end_time < crossing && std::isfinite(crossing)) // rigid parts have no waves
      log.warn("The run ends at " + format_number(end_time) + ", before a wave has crossed the " +
               "body, which takes " + short_number(crossing) +
               ": is `End time` in the unit of time of the densities and moduli?");
  }

  /** The prescribed velocity of a component at an initial position. */
  template <int dim>
  double prescribed_rate(const MechanicalCondition<dim> &condition, const Point<dim> &point,
                         const unsigned int component, const double time, const double interval)
  {
    if (condition.type == MechanicalConditionType::displacement)
      return (condition.displacement(point, component, time + interval) -
              condition.displacement(point, component, time)) /
             interval;
    return condition.function ? condition.function->value(point, time, component) : 0.;
  }

  template <int dim>
  bool prescribe_differently(const MechanicalCondition<dim> &a, const MechanicalCondition<dim> &b,
                             const Point<dim> &point, const unsigned int component,
                             const double end_time)
  {
    constexpr unsigned int n_times = 9;
    double difference = 0, scale = 0;
    for (unsigned int k = 0; k < n_times; ++k)
    {
      const double time = end_time * (k + 0.5) / n_times, interval = 1e-4 * end_time;
      const double rate_a = prescribed_rate(a, point, component, time, interval);
      const double rate_b = prescribed_rate(b, point, component, time, interval);
      difference = std::max(difference, std::abs(rate_a - rate_b));
      scale = std::max({scale, std::abs(rate_a), std::abs(rate_b)});
    }
    return difference > 1e-6 * scale;
  }

  /** Warns of conditions that prescribe different motions of one node. Collective. */
  template <int dim>
  void warn_of_conflicts(const Model<dim> &model, const double end_time, Log &log)
  {
    using Pair = std::pair<unsigned int, unsigned int>;
    std::map<Pair, std::pair<unsigned int, std::vector<double>>> found; // components, a position
    const auto &conditions = model.conditions->all();
    for (const auto &overlap : model.conditions->overlaps())
      try
      {
        if (!prescribe_differently(conditions[overlap.earlier], conditions[overlap.later],
                                   overlap.point, overlap.component, end_time))
          continue;
        auto &[components, position] = found[{overlap.earlier, overlap.later}];
        components |= 1u << overlap.component;
        std::vector<double> point(&overlap.point[0], &overlap.point[0] + dim);
        position = position.empty() ? point : std::min(position, point);
      }
      catch (const RunError &)
      {
        // A function without a value stops the run with its own message.
      }
    std::map<Pair, std::pair<unsigned int, std::vector<double>>> conflicts;
    for (const auto &rank_conflicts : Utilities::MPI::all_gather(model.communicator, found))
      for (const auto &[pair, what] : rank_conflicts)
      {
        auto &[components, position] = conflicts[pair];
        components |= what.first;
        position = position.empty() ? what.second : std::min(position, what.second);
      }
    for (const auto &[pair, what] : conflicts)
    {
      std::string components, position;
      for (unsigned int d = 0; d < dim; ++d)
      {
        if (what.first & (1u << d))
          components += (components.empty() ? "" : ", ") + std::string(1, "xyz"[d]);
        position += (d > 0 ? ", " : "") + short_number(what.second[d]);
      }
      log.warn("The conditions \"" + conditions[pair.first].name + "\" and \"" +
               conditions[pair.second].name + "\" prescribe different motions (" + components +
               ") of the same nodes, for example at (" + position + "): \"" +
               conditions[pair.second].name +
               "\" acts there, since it comes later in `Conditions`.");
    }
  }

  /** Warns of conditions that begin to act when the run has ended. */
  template <int dim>
  void warn_of_late_conditions(const Model<dim> &model, const double end_time, Log &log)
  {
    for (const MechanicalCondition<dim> &condition : model.conditions->all())
      if (condition.start >= end_time)
        log.warn("The condition \"" + condition.name + "\" does nothing: it begins at " +
                 format_number(condition.start) + ", and the run ends at " +
                 format_number(end_time) + ".");
  }

  /** A moment of the run when a contact is nearest to the body. */
  struct Approach
  {
    double gap = 1e300, time = 0;
    bool touches = false;
  };

  /** The smallest distance of the nodes that can touch from the surface at @p time, where they
   * are at @p position [L]; 1e300 without such nodes. Of this rank. */
  template <int dim>
  double smallest_gap(const SurfaceContact<dim> &contact, const NodalVector &position,
                      const double time)
  {
    std::vector<double> gaps(contact.candidate_nodes().size());
    contact.find_gaps(position, contact.candidate_nodes(), time, gaps);
    double smallest = 1e300;
    for (const double gap : gaps)
      smallest = std::min(smallest, gap);
    return smallest;
  }

  /** How near a surface comes, at moments of the run, to a body that flies on as it begins. One
   * that lies at it and leaves it at once does not touch it. Collective. */
  template <int dim>
  Approach nearest_approach(const SurfaceContact<dim> &contact, const Model<dim> &model,
                            const double end_time)
  {
    constexpr unsigned int n_moments = 100;
    constexpr double round_off = 1e-12; // of coordinates
    const NodalState &state = model.state;
    NodalVector position(state.partition(), Quantity::position);
    const Extent<dim> extent = extent_of<dim>(state.initial_position);
    double tolerance = 0;
    for (unsigned int d = 0; d < dim; ++d)
      tolerance = std::max({tolerance, round_off * std::abs(extent.lowest[d]),
                            round_off * std::abs(extent.highest[d])});
    Approach nearest;
    for (unsigned int k = 0; k <= n_moments && !nearest.touches; ++k)
    {
      const double time = end_time * k / n_moments;
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          position.node(i)[d] =
              state.initial_position.node(i)[d] + time * state.unsmoothed_velocity.node(i)[d];
      const double gap =
          Utilities::MPI::min(smallest_gap(contact, position, time), model.communicator);
      if (gap < nearest.gap)
        nearest = {gap, time};
      nearest.touches = gap < (k > 0 ? tolerance : -tolerance);
    }
    return nearest;
  }

  template <int dim>
  bool is_moved(const SurfaceContact<dim> &contact, const double end_time)
  {
    const ContactSurface<dim> &surface = contact.contact_surface();
    const Tensor<1, dim> start = surface.reference_point(0.);
    for (unsigned int k = 1; k <= 8; ++k)
      if (surface.reference_point(end_time * k / 8.) != start)
        return true;
    return false;
  }

  /** Warns of surfaces that the body will not reach. How it deforms is not known: where something
   * else moves it, only surfaces that are moved themselves are judged. Collective. */
  template <int dim>
  void warn_of_idle_contacts(const Model<dim> &model, const double end_time, Log &log)
  {
    const auto &conditions = model.conditions->all();
    bool is_driven = model.heat != nullptr || model.conditions->has_loads() ||
                     std::any_of(conditions.begin(), conditions.end(),
                                 [](const MechanicalCondition<dim> &condition) {
                                   return prescribes(condition.type) &&
                                          condition.type != MechanicalConditionType::clamp;
                                 });
    std::vector<std::pair<const SurfaceContact<dim> *, Approach>> idle;
    for (const auto *const contact : shown_by_processes<SurfaceContact<dim>>(model))
    {
      const Approach approach = contact->has_tool_mass() || contact->is_with_part()
                                    ? Approach{0., 0., true} // where it goes is not known
                                    : nearest_approach(*contact, model, end_time);
      if (approach.touches)
        is_driven = true;
      else
        idle.emplace_back(contact, approach);
    }
    for (const auto &[contact, approach] : idle)
      if (!is_driven || is_moved(*contact, end_time))
        log.warn("The surface of the contact \"" + contact->name() +
                 "\" will hardly touch anything: until the end it comes no nearer than " +
                 short_number(approach.gap) + ", at t = " + short_number(approach.time) +
                 ". This is an estimate, in which the body flies on as it begins and does not "
                 "deform.");
  }

  /** Warns of particles that move at the nodes of elements of a higher degree. */
  template <int dim>
  void warn_of_degree(const Model<dim> &model, Log &log)
  {
    for (const Part<dim> &part : model.parts)
      if (model.nodes->degree() > 1 && part.particles != nullptr && part.material->has_mechanics())
        log.warn(
            "The particles of part \"" + part.name + "\" are the nodes of cells of degree " +
            std::to_string(model.nodes->degree()) +
            ", and carry waves badly: the stress of a pulse in a coupled rod "
            "erred by 20 % with degree 2, by 71 % with degree 3 and by 1 % with degree 1. Take "
            "elements of degree 1.");
  }

  /** Judges the safety factor, or a step that is given. Collective. */
  template <int dim>
  void judge_step(const Model<dim> &model, const StepSize<dim> &step_size,
                  const Parameters &parameters, const double n_steps, Log &log)
  {
    const Section section = parameters.section("Time step");
    const double fixed = section.get_double("Fixed");
    const double taken = step_size.largest();
    // Above √3/2 of the limit the third harmonic of a mode is in step with it.
    constexpr double largest_factor = 0.866, many_steps = 1e4;
    if (fixed == 0.)
    {
      if (section.get_double("Safety factor") > largest_factor && n_steps > many_steps)
        log.print("Advice: `Time step/Safety factor = 0.85`: above 0.87 vibrations that last grow. "
                  "In a million steps the largest energy error was 0.14 at 0.9 and 0.008 at 0.85 "
                  "(doc/choosing.md, Spin).");
      return;
    }
    const double limit = spectral_limit(model);
    if (taken > 1.001 * limit)
      log.warn("The step " + short_number(taken) + " of `Time step/Fixed` is above the limit " +
               short_number(limit) + " of the spectral estimate: the motion will not be stable.");
  }

  /**
   * The speed of the outermost node of a model that spins, by the rotation that has its angular
   * momentum about its centre of mass [L/T]:
   * @verbatim
   *   |L| R / I,  I about the axis of L, R the largest distance from this axis
   * @endverbatim
   * Zero where less than half of the kinetic energy about the centre is that of this rotation.
   * Collective.
   */
  template <int dim>
  double speed_of_rim(const Model<dim> &model)
  {
    const MPI_Comm communicator = model.communicator;
    const NodalVector &positions = model.state.position,
                      &velocities = model.state.unsmoothed_velocity;
    const unsigned int n_nodes = model.state.partition()->n_owned();
    const auto mass = [&](const unsigned int i) { return *model.state.mass.node(i); };

    double total = 0;
    Tensor<1, 3> centre, mean;
    for (unsigned int i = 0; i < n_nodes; ++i)
    {
      total += mass(i);
      centre += mass(i) * vector_of<3>(positions.node(i));
      mean += mass(i) * vector_of<3>(velocities.node(i));
    }
    total = Utilities::MPI::sum(total, communicator);
    centre = Utilities::MPI::sum(centre, communicator) / total;
    mean = Utilities::MPI::sum(mean, communicator) / total;

    double energy = 0;
    Tensor<1, 3> momentum;
    for (unsigned int i = 0; i < n_nodes; ++i)
    {
      const Tensor<1, 3> velocity = vector_of<3>(velocities.node(i)) - mean;
      energy += 0.5 * mass(i) * velocity.norm_square();
      momentum += mass(i) * cross_product_3d(vector_of<3>(positions.node(i)) - centre, velocity);
    }
    energy = Utilities::MPI::sum(energy, communicator);
    momentum = Utilities::MPI::sum(momentum, communicator);
    if (!(momentum.norm() > 0.))
      return 0.;

    const Tensor<1, 3> axis = momentum / momentum.norm();
    double inertia = 0, radius = 0;
    for (unsigned int i = 0; i < n_nodes; ++i)
    {
      const double distance =
          cross_product_3d(axis, vector_of<3>(positions.node(i)) - centre).norm();
      inertia += mass(i) * distance * distance;
      radius = std::max(radius, distance);
    }
    inertia = Utilities::MPI::sum(inertia, communicator);
    radius = Utilities::MPI::max(radius, communicator);
    const bool spins = 0.5 * momentum.norm_square() / inertia > 0.5 * energy;
    return spins ? momentum.norm() / inertia * radius : 0.;
  }

  /** Advises against a smoothing with which such scenes were measured to be wrong. @p speed is
   * that of the rim of a body that spins, or zero. Collective. */
  template <int dim>
  void advise_smoothing(const Model<dim> &model, const Part<dim> &part, const double speed,
                        const bool is_elastic, Log &log)
  {
    constexpr double few_across = 10.; // an error of contact of 0.3 % with `fe matched`
    const SmoothingSettings smoothing = part.particles->smoothing();
    if (!smoothing.is_active || smoothing.affine)
      return;
    const bool is_paper = smoothing.gamma == 0.,
               may_tear = part.particles->breaking_bonds() != nullptr;
    const auto contacts = shown_by_processes<SurfaceContact<dim>>(model);
    const bool is_cut = std::any_of(contacts.begin(), contacts.end(),
                                    [](const auto *const contact)
                                    { return contact->contact_settings().cutting_speed > 0.; });
    std::string reason;
    if (speed > 0.)
      reason = "the body spins, its rim with " +
               short_number(speed / part.material->longitudinal_wave_speed()) +
               " of the speed of P waves, and this smoothing strains what turns. The stress of "
               "a disc at 0.04 of it was wrong by " +
               (is_paper ? "450" : "180") +
               " % after half a turn, with affine smoothing by 0.7 %, and at 0.01 by more "
               "(doc/tables/closed_forms.md).";
    else if (is_elastic && !may_tear)
      reason =
          is_paper
              ? "`paper` damps waves and holds them back. The error of a rod's stress is 0.161 "
                "with it, 0.020 with affine smoothing and cell averages (doc/choosing.md, Shape "
                "functions)."
              : "a surface that a load leaves rings on. Of the velocity of a pulse 1.09 are left "
                "there with `fe matched`, 0.024 with affine smoothing and cell averages "
                "(doc/tables/closed_forms.md).";
    else if (is_cut && is_paper && may_tear)
      reason =
          "`paper` creates energy in fine cuts. The energy of one erred by 1.0 % with particles "
          "of 0.105 mm, and it stopped with 0.05 mm; with affine smoothing 0.35 and 0.07 % "
          "(doc/tables/machining.md). Here they are up to " +
          short_number(spacings_of(part, model.communicator)[1]) + " wide.";
    else if (const auto n_particles =
                 contacts.empty()
                     ? 0
                     : Utilities::MPI::sum(part.formulation->points().size(), model.communicator);
             n_particles > 0 && std::pow(n_particles, 1. / dim) < few_across)
      reason =
          "positions move by other velocities than those that strain, so that what a contact "
          "stores is not what it gives back. The energy of a block that met a plane erred by 1.9 % "
          "with 2 cells a side, 0.8 % with 4, 0.3 % with 8; with affine smoothing by 0.01 % "
          "(doc/tables/contact.md). Here are " +
          std::to_string(n_particles) + " particles.";
    if (!reason.empty())
      log.print("Advice: `Smoothing = affine` in the section of part \"" + part.name +
                "\": " + reason);
  }

  /** @p at_rest: velocities are zero, and nothing smooths them. */
  template <int dim>
  void advise_parts(const Model<dim> &model, const Parameters &parameters, const bool at_rest,
                    Log &log)
  {
    constexpr double large_defect = 0.01;
    constexpr double nearly_incompressible = 9.; // Poisson's ratio above 0.446
    const bool all_have_waves =
        std::all_of(model.parts.begin(), model.parts.end(),
                    [](const Part<dim> &part) { return part.material->has_mechanics(); });
    const double speed = !at_rest && all_have_waves ? speed_of_rim(model) : 0.;
    for (const Part<dim> &part : model.parts)
    {
      if (part.particles == nullptr)
        continue;
      const Section section = parameters.section("Part: " + part.name);
      const std::string part_section = " in the section of part \"" + part.name + "\": ";
      const PatchTest test = part.particles->patch_test(model.state.initial_position);
      if (test.is_known && test.defect > large_defect && !test.cure.empty())
        log.print("Advice: `" + test.cure + "`" + part_section +
                  "a constant stress makes false forces there, " + percent(test.defect) +
                  " of those of its boundary. On disordered nodes the error of a rod's stress fell "
                  "from 0.216 to 0.028 (doc/choosing.md, Shape functions).");
      if (part.material->has_mechanics() && !part.particles->follows_positions() &&
          part.material->bulk_modulus() > nearly_incompressible * part.material->shear_modulus())
        log.print("Advice: `Dilatation = of cells`" + part_section +
                  "nearly incompressible particles with a dilatation of their own lock. The "
                  "stress in a tube with eight cells through its wall erred by 14 % with Poisson's "
                  "ratio 0.49 and by 140 % with 0.499, `of cells` by 0.6 % (doc/choosing.md, "
                  "Volume, has what it needs).");
      if (at_rest)
        continue;
      const std::string material = "Material: " + section.get("Material");
      advise_smoothing(model, part, speed, parameters.section(material).get("Model") == "elastic",
                       log);
    }
  }

  template <int dim>
  void advise_scaling(const Model<dim> &model, const double end_time, Log &log)
  {
    constexpr double many_crossings = 1000.;
    const double n_crossings = end_time / crossing_time(model);
    if (n_crossings < many_crossings || !model.inertia_is_mass || moves_at_start(model))
      return;
    log.print("Advice: waves cross the body " + short_number(n_crossings) +
              " times before the end. If the process is that slow, `Scaling/Process time factor` "
              "divides the steps, as long as the kinetic energy stays below 5 %: the thrust of a "
              "drill was 898, 901 and 894 N with factors of 500, 1000 and 2000 (doc/choosing.md, "
              "Forming)." +
              (model.heat ? " If only heat matters, `Model = heat conductor` of the material has "
                            "no waves."
                          : ""));
  }

  template <int dim>
  void advise_longer_steps(const Model<dim> &model, const double limit, const double n_steps,
                           Log &log)
  {
    constexpr double many_steps = 1000., low_cost = 0.7;
    if (n_steps < many_steps || !(limit > 0.) || !model.step_groups.parts.empty())
      return;
    const double cost = cost_with_longer_steps(model, limit);
    if (cost < low_cost)
      log.print(
          "Advice: `Time step/Subcycling/Largest ratio = 8`: small cells set the step of all. "
          "With longer steps of the others forces cost about " +
          percent(cost) +
          " of the present time, and results stay: a Taylor bar with small cells at its "
          "foot took 0.58 of "
          "the time, with the same shape (doc/performance.md, Longer steps).");
  }

  /**
   * Before the first step of a scene with mechanics: warns of what will hardly be meant, and
   * advises settings from which this scene would profit, each with the number of a page of doc
   * that decides it.
   *
   * A scene with an exact solution compares methods and gets no advice about its settings.
   *
   * Bodies at rest have no waves, no stable step and no smoothing of velocities, and get none of
   * the sentences about them. @p n_steps are those expected. Collective.
   */
  template <int dim>
  void print_advice(const Model<dim> &model, const StepSize<dim> &step_size,
                    const Parameters &parameters, const double end_time, const double n_steps,
                    Log &log)
  {
    const UnitLabels labels(parameters.section(""));
    warn_of_heat_capacities(model, labels, log);
    if (!model.has_mechanics)
      return;
    const bool at_rest = StaticSteps<dim>::are_chosen(parameters);
    if (!at_rest)
    {
      warn_of_wave_speeds(model, labels, log);
      warn_of_degree(model, log);
    }
    warn_of_yield_stresses(model, labels, log);
    warn_of_conflicts(model, end_time, log);
    warn_of_late_conditions(model, end_time, log);
    if (parameters.section("").get(initial_state_entry).empty())
    {
      warn_of_initial_flow(model, log);
      warn_of_idle_contacts(model, end_time, log);
    }
    if (!at_rest)
      judge_step(model, step_size, parameters, n_steps, log);
    if (ExactSolution<dim>::is_given(parameters.section("Exact solution")))
      return;
    advise_parts(model, parameters, at_rest, log);
    if (at_rest)
      return; // what follows is of waves and of steps that are short
    warn_of_early_end(model, end_time, log);
    advise_scaling(model, end_time, log);
    advise_longer_steps(model, step_size.limit().time_step, n_steps, log);
  }

  /** The stable step of bodies and contacts in the present state by the spectral estimate with its
   * defaults, whichever the scene uses [T]. Collective. */
  template <int dim>
  double spectral_limit(const Model<dim> &model)
  {
    // With its defaults: the scene does not use its entries, and a resumed run has none of them.
    const std::string name = "spectral";
    Parameters defaults(model.communicator);
    declare_section<SpectralEstimator<dim>>(defaults, name);
    defaults.assign();
    SpectralEstimator<dim> estimator(defaults.section(name));
    double limit = estimator.estimate(model).time_step;
    double fraction = 1.;
    for (const auto &process : model.processes)
      process->observed.step_limits(limit, fraction);
    return fraction * limit;
  }

  /** Warns of what processes have to say now. Collective. */
  template <int dim>
  void print_warnings(const Model<dim> &model, const Clock &clock,
                      const typename Process<dim>::Occasion occasion, Log &log)
  {
    std::vector<std::string> warnings;
    for (const auto &process : model.processes)
      process->observed.warnings(clock, occasion, warnings);
    for (const std::string &warning : warnings)
      log.warn(warning);
  }
} // namespace tombolo
