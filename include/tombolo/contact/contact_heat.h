// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/contact/contact_balance.h>
#include <tombolo/contact/contact_settings.h>
#include <tombolo/contact/part_heat.h>
#include <tombolo/contact/tool_heat.h>

#include <array>
#include <memory>
#include <tuple>
#include <vector>

namespace tombolo
{
  class StateArchive;

  /** The heat of the contact of nodes with a surface: that of friction, which body and surface
   * share, and what is conducted, until the nodes are given it. In scenes with heat only. */
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

    /** The enthalpy and the temperature of a candidate's node with its pending heat. */
    double enthalpy(std::size_t candidate, const NodalHeat &nodal_heat) const;
    double temperature(std::size_t candidate, const NodalHeat &nodal_heat) const;

    /** Splits the heat of friction at a candidate. */
    void add_friction(std::size_t candidate, double heat, const NodalHeat &nodal_heat);

    /** @p heat is that of friction of this rank in the step. */
    void end_forces(double heat);

    /** Exchanges heat with the partner. Collective. */
    void exchange(const NodalHeat &nodal_heat, MPI_Comm communicator);

    /** Adds what nodes have not been given yet to owned nodes of @p heat (scalar). */
    void add_pending_heat(NodalVector &heat) const;
    void forget_pending_heat();
    /** Its sum on this rank. */
    double heat_to_give() const;

    /** This rank's shares of heat. */
    void add_shares(ContactBalance &shares) const;
    /** What follows for @p sums over ranks. */
    void complete(ContactBalance &sums) const;

    /** What a static step changes. */
    using State = std::tuple<std::vector<double>, double, typename ToolHeat<dim>::State>;
    State state() const;
    void restore(const State &state);

    /** Writes to a checkpoint or reads from it. Collective. */
    void serialize(StateArchive &archive);
    /** Takes the heat that another run had not given yet. Collective. */
    void continue_from(StateArchive &archive);

  private:
    void serialize_pending(StateArchive &archive);

    const ContactSettings &settings;
    const std::vector<unsigned int> &candidates;
    std::unique_ptr<ToolHeat<dim>> tool; ///< null where the tool has no temperature
    std::unique_ptr<PartHeat<dim>> part; ///< null where the surface is that of no part
    double friction_of_tool = 0;         ///< its share of the heat of friction in this step
    double friction_of_bodies = 0;       ///< of this rank since the start, by effusivities
    std::vector<double> pending;         ///< of each candidate
  };
} // namespace tombolo
