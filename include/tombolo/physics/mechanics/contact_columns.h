// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surface_contact.h>
#include <tombolo/output/history.h>

#include <array>
#include <string>

namespace tombolo
{
  /** The table `contact.csv` of surfaces and bodies that touch. */
  constexpr const char *contact_history = "contact history";
  /** The forces that pictures have of both kinds together. */
  constexpr const char *contact_force = "contact force";

  /** Adds the columns of a contact; @p tool is null for a contact between bodies. */
  template <int dim>
  void add_contact_columns(const ContactBalance &now, const SurfaceContact<dim> *const tool,
                           const bool has_area, const bool conducts, BalanceHistory<dim> &row)
  {
    const std::string energy = "M L^2/T^2";
    row.begin_item(now);
    row.add_mean("mean force", "M L/T^2", &ContactBalance::impulse);
    row.add("impulse", "M L/T", now.impulse);
    if (tool != nullptr)
      row.add_mean("mean torque", energy, &ContactBalance::angular_impulse, true);
    row.add("friction heat", energy, now.friction);
    row.add("damping", energy, now.damping);
    row.add("stored energy", energy, now.elastic);
    if (tool != nullptr)
      row.add("work", energy, now.work);
    row.add("nodes", "1", now.n_nodes);
    row.add("penetration", "L", now.penetration);
    if (has_area)
      row.add("area in contact", dim == 2 ? "L" : "L^2", now.area);
    if (tool != nullptr)
    {
      row.add_mean("mean power", "M L^2/T^3", &ContactBalance::work);
      row.add("position", "L", now.position);
      if (tool->has_tool_mass())
        row.add("velocity", "L/T", now.velocity);
      if (tool->contact_settings().has_heat)
      {
        row.add("heat of bodies", energy, now.heat_of_bodies);
        row.add("heat of tool", energy, now.heat_of_tool);
      }
    }
    if (conducts)
      row.add("conducted heat", energy, now.conducted);
    if (tool != nullptr && tool->has_tool_temperature())
      row.add("tool temperature", "temperature", now.tool_temperature);
    row.summarize("friction_heat", now.friction);
    row.summarize("damping", now.damping);
    row.summarize_largest(now.penetration);
  }

  /** Adds mean and largest temperature of nodes in contact. */
  template <int dim>
  void add_temperatures(const std::string &of, const std::array<double, 2> &mean_and_largest,
                        BalanceHistory<dim> &row)
  {
    row.add(of + " mean temperature", "temperature", mean_and_largest[0]);
    row.add(of + " largest temperature", "temperature", mean_and_largest[1]);
  }
} // namespace tombolo
