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
  void add_contact_columns(const ContactBalance &now, const SurfaceContact<dim> *tool,
                           bool has_area, bool conducts, BalanceHistory<dim> &row);

  /** Adds mean and largest temperature of nodes in contact. */
  template <int dim>
  void add_temperatures(const std::string &of, const std::array<double, 2> &mean_and_largest,
                        BalanceHistory<dim> &row)
  {
    row.add(of + " mean temperature", "temperature", mean_and_largest[0]);
    row.add(of + " largest temperature", "temperature", mean_and_largest[1]);
  }
} // namespace tombolo
