// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/contact/contact_balance.h>
#include <tombolo/contact/contact_settings.h>
#include <tombolo/contact/part_heat.h>
#include <tombolo/contact/tool_heat.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  /** The heat of the contact of nodes with a surface: that of friction, which body and surface
   * share, and what is conducted. In scenes with heat only. */
  template <int dim>
  class ContactHeat
  {
  public:
    /** @p surface is null where the surface is that of no part. What is referred to must outlive
     * this. Throws InputError. */
    ContactHeat(const Section &section, const ContactSettings &settings,
                const std::vector<unsigned int> &candidates, PartSurface<dim> *surface);

    /** Whom nodes exchange heat with; null where nobody is. */
    HeatPartner *partner() const
    {
      return part ? static_cast<HeatPartner *>(part.get()) : tool.get();
    }
    const ToolHeat<dim> *of_tool() const
    {
      return tool.get();
    }
    const PartHeat<dim> *of_part() const
    {
      return part.get();
    }

    /** Begins a step: nothing touches. Collective. */
    void begin_step(const NodalHeat &nodal_heat);

    /** Splits the heat of friction at a candidate. */
    void add_friction(std::size_t candidate, double heat, const NodalHeat &nodal_heat);

    /** @p heat is that of friction of this rank in the step. */
    void end_forces(double heat);

    /** Exchanges heat with the partner. Collective. */
    void exchange(const NodalHeat &nodal_heat, MPI_Comm communicator);

    /** This rank's shares of heat. */
    void add_shares(ContactBalance &shares) const;
    /** What follows for @p sums over ranks. */
    void complete(ContactBalance &sums) const;

    /** Lists what is kept from step to step. */
    void list(Records &records)
    {
      if (settings.splits_by_effusivity)
        records.sums("friction heat of bodies", friction_of_bodies);
      if (partner() != nullptr)
        partner()->list(records);
    }

  private:
    const ContactSettings &settings;
    const std::vector<unsigned int> &candidates;
    std::unique_ptr<ToolHeat<dim>> tool; ///< null where the tool has no temperature
    std::unique_ptr<PartHeat<dim>> part; ///< null where the surface is that of no part
    double friction_of_tool = 0;         ///< its share of the heat of friction in this step
    double friction_of_bodies = 0;       ///< of this rank since the start, by effusivities
  };
} // namespace tombolo
