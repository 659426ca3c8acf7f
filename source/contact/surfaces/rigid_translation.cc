// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/clock.h>
#include <tombolo/contact/surfaces/rigid_translation.h>

#include <tombolo/base/input/read_vector.h>
#include <tombolo/base/input/text.h>
#include <tombolo/state/records.h>

#include <cmath>
#include <cstdlib>

namespace tombolo
{
  template <int dim>
  RigidTranslation<dim>::RigidTranslation(const Entries &e)
  {
    const bool is_given = !e.text("Displacement", "", "L",
                                  "How far the body has moved at time t: components separated by "
                                  "`;`, functions of t; empty for a body at rest.")
                               .empty();
    const bool has_mass =
        !e.text("Mass", "", "M",
                "The mass of a body that forces move, instead of `Displacement`: that of the "
                "bodies which it touches, and `Force`. A process time factor of the section "
                "`Scaling` multiplies its inertia as that of the bodies, a mass factor does not.")
             .empty();
    if (e.when(has_mass))
    {
      e.text("Force", "", "M L/T^2",
             "On a body with a mass: components separated by `;`, functions of t; none if empty.");
      e.text("Initial velocity", "", "L/T",
             "Of a body with a mass, as numbers separated by commas; at rest if empty.");
      e.text("Directions", "", "",
             "Along which a body with a mass can move: vectors separated by `;`, such as `0, 0, "
             "1`; all if empty.");
    }
    if (has_mass)
      free.emplace(read_mass(e.section()));
    else if (is_given)
    {
      function.emplace(e.section(), "Displacement", dim);
      e.refuse(function->depends_on_position(), "Displacement",
               "allowed are functions of t alone.");
    }
  }

  template <int dim>
  Tensor<2, dim> RigidTranslation<dim>::read_directions(const Section &section)
  {
    constexpr const char *entry = "Directions";
    Tensor<2, dim> projection;
    if (section.get(entry).empty())
    {
      for (unsigned int d = 0; d < dim; ++d)
        projection[d][d] = 1.;
      return projection;
    }
    for (Tensor<1, dim> direction : read_vectors<dim>(section, entry))
    {
      const double length = direction.norm();
      direction -= projection * direction;
      if (!(direction.norm() > 1e-9 * length))
        section.fail(entry, "a vector has no length, or adds nothing to those before.");
      direction /= direction.norm();
      projection += outer_product(direction, direction);
    }
    return projection;
  }

  namespace
  {
    /** Of a mass whose process is run faster: forces stay in the time of the process, inertia grows
     * as that of the bodies does. Read as text, since nothing is scaled without a section
     * "Scaling". */
    double inertia_factor(const Section &section)
    {
      const std::string factor = section.all().raw("Scaling/Process time factor", "1");
      return std::pow(std::strtod(factor.c_str(), nullptr), 2);
    }
  } // namespace

  template <int dim>
  typename RigidTranslation<dim>::Mass RigidTranslation<dim>::read_mass(const Section &section)
  {
    Mass result;
    if (!is_number(section.get("Mass"), result.mass) || !(result.mass > 0.) ||
        !std::isfinite(result.mass))
      section.fail("Mass", "allowed is a number larger than zero.");
    result.mass *= inertia_factor(section);
    if (!section.get("Displacement").empty())
      section.fail("Displacement", "a body with a mass moves by forces; without `Mass` it moves by "
                                   "this function.");
    if (!section.get("Force").empty())
    {
      result.force.emplace(section, "Force", dim);
      if (result.force->depends_on_position())
        section.fail("Force", "allowed are functions of t alone.");
    }
    result.free_directions = read_directions(section);
    if (!section.get("Initial velocity").empty())
    {
      result.velocity = read_vector<dim>(section, "Initial velocity");
      if ((result.free_directions * result.velocity - result.velocity).norm() >
          1e-9 * result.velocity.norm())
        section.fail("Initial velocity", "the body cannot move so: allowed is a velocity along "
                                         "`Directions`.");
    }
    result.next_velocity = result.velocity;
    result.kinetic_energy = 0.5 * result.mass * result.velocity.norm_square();
    return result;
  }

  template <int dim>
  Tensor<1, dim> RigidTranslation<dim>::displacement(const double time) const
  {
    if (free)
      return std::abs(time - free->time) <= std::abs(time - free->previous_time)
                 ? free->displacement
                 : free->previous_displacement;
    Tensor<1, dim> result;
    if (function)
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = function->value(Point<dim>(), time, d);
    return result;
  }

  template <int dim>
  void RigidTranslation<dim>::accelerate(const Clock &clock, const Tensor<1, dim> &reaction)
  {
    const double step = clock.velocity_step();
    const Tensor<1, dim> impulse = given_impulse(clock);
    free->work_of_force += free->velocity * impulse_of_step(impulse, free->previous_impulse, clock);
    free->next_velocity =
        free->velocity + free->free_directions * (impulse + step * reaction) / free->mass;
    free->kinetic_energy = 0.5 * free->mass * free->velocity *
                           (clock.has_present_velocities() ? free->velocity : free->next_velocity);
  }

  template <int dim>
  void RigidTranslation<dim>::list(Records &records)
  {
    if (!free)
      return;
    Records &motion_records = records.group("motion");
    motion_records.value("time", free->time);
    motion_records.value("previous time", free->previous_time);
    motion_records.value("displacement", free->displacement);
    motion_records.value("previous displacement", free->previous_displacement);
    motion_records.value("velocity", free->velocity);
    motion_records.value("previous impulse", free->previous_impulse);
    motion_records.value("work of the force", free->work_of_force);
    motion_records.value("kinetic energy",
                         free->kinetic_energy); // between steps that of the last one
  }

  template class RigidTranslation<2>;
  template class RigidTranslation<3>;
} // namespace tombolo
