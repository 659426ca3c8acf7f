// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/initial_condition.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/name_hints.h>
#include <tombolo/base/input/read_vector.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_input.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <stdexcept>

namespace tombolo
{
  namespace
  {
    template <int dim>
    Tensor<1, 3> read_spin(const Section &section)
    {
      Tensor<1, 3> result;
      const std::vector<double> rate = section.get_doubles("Spin");
      constexpr unsigned int n_numbers = dim == 2 ? 1 : 3;
      if (rate.size() != n_numbers)
        section.fail("Spin", dim == 2 ? "allowed is a finite number."
                                      : "allowed are three finite numbers, separated by commas.");
      for (unsigned int c = 0; c < n_numbers; ++c)
        result[dim == 2 ? 2 : c] = rate[c];
      return result;
    }
  } // namespace

  template <int dim>
  InitialCondition<dim>::InitialCondition(const Entries &e)
  {
    where = e.optional<Predicate<dim>>("Where", "",
                                       "A predicate of the initial position; everywhere if empty.");
    parts = e.list("Part", "",
                   "Names of parts, separated by commas: their nodes, shared ones included, and "
                   "their material points; all parts if empty. With `Where` both must hold.");
    velocity = e.if_set<Expression<dim>>("Velocity", "L/T",
                                         "Components separated by `;`, functions of x, y, z.", dim);
    if (e.when(e.is_set("Spin")))
    {
      e.text("Spin", "", "1/T",
             dim == 2 ? "The angular velocity about `Centre of spin`, a number; its velocities add "
                        "to `Velocity`."
                      : "The angular velocity about `Centre of spin`, three numbers separated by "
                        "commas; its velocities add to `Velocity`.");
      const Tensor<1, dim> centre =
          e.read("Centre of spin", dim == 2 ? "0, 0" : "0, 0, 0", "L",
                 "A point of the axis of `Spin`, numbers separated by commas.", &read_vector<dim>);
      if (!e.declares())
        spin = Spin{read_spin<dim>(e.section()), centre};
    }
    else
      e.refuse(e.is_set("Centre of spin"), "Centre of spin",
               "there is no `Spin`; it would do nothing.");
    stress = e.if_set<Expression<dim>>(
        "Stress", "M/(L T^2)",
        "Six components xx; yy; zz; yz; xz; xy of the Cauchy stress, functions of x, y, z.", 6);
    temperature = e.if_set<Expression<dim>>(
        "Temperature", "temperature",
        "A function of x, y, z, instead of the initial temperature of the materials.", 1);
    e.refuse(!velocity && !spin && !stress && !temperature, "",
             "an initial condition needs `Velocity`, `Spin`, `Stress` or `Temperature`.");
  }

  namespace
  {
    void refuse_unknown_parts(const Section &section, const std::vector<std::string> &named,
                              const std::vector<std::string> &known)
    {
      for (const std::string &name : named)
        if (std::find(known.begin(), known.end(), name) == known.end())
          section.fail("Part", "there is no part " + in_quotes(name) + "." +
                                   did_you_mean(name, known) +
                                   " The entry \"Parts\" lists: " + joined(known, ", ") + ".");
    }
  } // namespace

  template <int dim>
  void validate_initial_conditions(const Parameters &parameters, const Physics<dim> &physics)
  {
    const auto validate = [&](const Section &section)
    {
      const InitialCondition<dim> condition(section);
      refuse_unknown_parts(section, condition.parts, section_names(parameters, "Parts"));
      if (condition.temperature && !physics.has_heat)
        section.fail("Temperature",
                     "the scene has no heat; give its materials a section \"Heat\".");
      if (condition.velocity && !physics.has_mechanics)
        section.fail("Velocity", "the scene has no mechanics; nothing moves.");
      if (condition.spin && !physics.has_mechanics)
        section.fail("Spin", "the scene has no mechanics; nothing moves.");
      if (condition.stress && !physics.has_mechanics)
        section.fail("Stress", "the scene has no mechanics; nothing has stresses.");
    };
    for (const Section &section :
         named_sections(parameters, "Initial conditions", "Initial condition"))
      parameters.attempt([&] { validate(section); });
  }

  namespace
  {
    template <int dim>
    bool is_selected(const InitialCondition<dim> &condition, const Point<dim> &point)
    {
      return !condition.where || (*condition.where)(point);
    }

    template <int dim>
    bool is_named(const InitialCondition<dim> &condition, const Part<dim> &part)
    {
      return condition.parts.empty() || std::find(condition.parts.begin(), condition.parts.end(),
                                                  part.name) != condition.parts.end();
    }

    /** Whether a cell of the named parts has each owned node; empty: all parts are meant. */
    template <int dim>
    std::vector<bool> nodes_of_parts(const InitialCondition<dim> &condition,
                                     const Model<dim> &model)
    {
      if (condition.parts.empty())
        return {};
      std::vector<bool> result(model.state.partition()->n_owned(), false);
      std::vector<types::global_dof_index> cell_nodes;
      for (const auto &cell : model.nodes->dof_handler().active_cell_iterators())
      {
        if (cell->is_artificial() ||
            !is_named(condition, model.parts[model.part_cells->part_of(cell)]))
          continue;
        model.nodes->cell_nodes(cell, cell_nodes);
        for (const types::global_dof_index node : cell_nodes)
          if (model.nodes->owned().is_element(node))
            result[model.state.partition()->local_index(node)] = true;
      }
      return result;
    }

    template <int dim>
    void set_velocity(const InitialCondition<dim> &condition, const Point<dim> &point,
                      double *const velocity)
    {
      for (unsigned int d = 0; d < dim; ++d)
        velocity[d] = condition.velocity ? condition.velocity->value(point, 0., d) : 0.;
      if (!condition.spin)
        return;
      Tensor<1, 3> arm;
      for (unsigned int d = 0; d < dim; ++d)
        arm[d] = point[d] - condition.spin->centre[d];
      const Tensor<1, 3> spin_velocity = cross_product_3d(condition.spin->rate, arm);
      for (unsigned int d = 0; d < dim; ++d)
        velocity[d] += spin_velocity[d];
    }

    /** Sets velocities and temperatures; returns at how many nodes of this rank. */
    template <int dim>
    unsigned long set_at_nodes(const InitialCondition<dim> &condition, Model<dim> &model)
    {
      unsigned long n_selected = 0;
      const std::vector<bool> is_of_parts = nodes_of_parts(condition, model);
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      {
        const Point<dim> point = point_of<dim>(model.state.initial_position.node(i));
        if ((!is_of_parts.empty() && !is_of_parts[i]) || !is_selected(condition, point))
          continue;
        ++n_selected;
        if (condition.velocity || condition.spin)
          set_velocity(condition, point, model.state.unsmoothed_velocity.node(i));
        if (condition.temperature)
        {
          const double temperature = condition.temperature->value(point, 0., 0);
          *model.heat->state.unsmoothed_temperature.node(i) = temperature;
          *model.heat->state.enthalpy.node(i) = model.heat->nodal_enthalpy.enthalpy(i, temperature);
        }
      }
      return n_selected;
    }

    /** Sets stresses; returns at how many material points of this rank. */
    template <int dim>
    unsigned long set_at_points(const InitialCondition<dim> &condition, Model<dim> &model)
    {
      unsigned long n_selected = 0;
      for (Part<dim> &part : model.parts)
      {
        if (!is_named(condition, part))
          continue;
        if (part.particles == nullptr && part.formulation->n_cells() == 0)
          continue; // the points that it has here are of no cell
        const std::vector<Point<dim>> &points = part.formulation->initial_point_positions();
        for (unsigned int i = 0; i < points.size(); ++i)
        {
          if (!is_selected(condition, points[i]))
            continue;
          ++n_selected;
          for (unsigned int c = 0; c < 6; ++c)
            part.formulation->points().component(MaterialPoints::stress, c)[i] =
                condition.stress->value(points[i], 0., c);
        }
      }
      return n_selected;
    }

    /** Whether the velocity at the start is to be computed from positions. */
    template <int dim>
    bool has_displacements(const MechanicalConditions<dim> &conditions)
    {
      return std::any_of(conditions.all().begin(), conditions.all().end(),
                         [](const MechanicalCondition<dim> &condition)
                         { return condition.type == MechanicalConditionType::displacement; });
    }
  } // namespace

  template <int dim>
  void set_initial_conditions(const Parameters &parameters, Model<dim> &model)
  {
    for (const Section &section :
         named_sections(parameters, "Initial conditions", "Initial condition"))
    {
      const InitialCondition<dim> condition(section);
      unsigned long n_selected = 0;
      // An expression can be without a value where only one rank evaluates it.
      attempt_on_all_ranks<InputError, std::runtime_error>(
          model.communicator,
          [&]
          {
            if (condition.velocity || condition.spin || condition.temperature)
              n_selected += set_at_nodes(condition, model);
            if (condition.stress)
              n_selected += set_at_points(condition, model);
          });
      if (Utilities::MPI::sum(n_selected, model.communicator) == 0)
        section.fail(section.is_set("Where") ? "Where" : "",
                     "the initial condition selects nothing; it would do nothing.");
    }
    if (!model.has_mechanics)
      return;
    const double interval = has_displacements(*model.conditions) ? short_interval(model) : 0.;
    model.conditions->prescribe_initial_velocity(model.state, 0., interval);
    throw_on_all_ranks<InputError>(model.conditions->failure(), model.communicator);
  }

  template struct InitialCondition<2>;
  template struct InitialCondition<3>;
  template void validate_initial_conditions(const Parameters &, const Physics<2> &);
  template void validate_initial_conditions(const Parameters &, const Physics<3> &);
  template <int dim>
  double short_interval(const Model<dim> &model)
  {
    double interval = StepLimit().time_step;
    for (const Part<dim> &part : model.parts)
      interval = std::min(
          interval, part.formulation->courant_limit(model.state.position, part.inertia).time_step);
    return 1e-3 * Utilities::MPI::min(interval, model.communicator);
  }

  template void set_initial_conditions(const Parameters &, Model<2> &);
  template void set_initial_conditions(const Parameters &, Model<3> &);
  template double short_interval(const Model<2> &);
  template double short_interval(const Model<3> &);
} // namespace tombolo
