// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/contact/contact_balance.h>
#include <tombolo/contact/contact_settings.h>
#include <tombolo/contact/heat_partner.h>
#include <tombolo/contact/part_surface.h>
#include <tombolo/contact/tool_heat.h>

#include <array>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The heat of the part whose boundary is the surface of a contact. A node i that touches
   * exchanges heat with the nodes a of the cell there, which have the mean T_m = Σ N_a T_a:
   *
   *   Q = C* (1 - exp(-h A Δt / C*)) (T_m - T_i),   1/C* = (1 + R_i) / C_i,
   *
   * with R_i of PartSurface for heat capacities; Q N_a comes from node a, and so does the part's
   * share of the heat of friction. However good the conductance, temperatures do not get past each
   * other, and the heat of both bodies is kept to round-off.
   */
  template <int dim>
  class PartHeat : public HeatPartner
  {
  public:
    /** Throws InputError. */
    PartHeat(const Section &section, PartSurface<dim> &surface);

    /** Finds the effusivities of nodes of the part. Collective. */
    void find_effusivities(const NodalHeat &nodal_heat);
    /** √(k ρ c) where a candidate touches. */
    double effusivity(std::size_t candidate) const;

    /** Gives the part heat of friction where a candidate touches, at the end of the step. */
    void add_friction(std::size_t candidate, double heat);

    void list(Records &records) override
    {
      records.group("heat of the part").sums("conducted", this->conducted_heat);
    }

    /** The part has got the friction from add_friction() already. */
    void end_step(double friction, const NodalHeat &nodal_heat, MPI_Comm communicator) override;

    /** Mean and largest T_m of the last step; zero where nothing touches. Collective. */
    std::array<double, 2> temperatures_in_contact(MPI_Comm communicator) const;

  private:
    /** Calls @p use with the number and the temperature of each owned node of the part, with the
     * heat that it has not got yet, and gathers what that writes. Collective. */
    std::vector<double>
    gather(const NodalHeat &nodal_heat, unsigned int n_values,
           const std::function<void(unsigned int node, double temperature, double *)> &write) const;

    PartSurface<dim> &surface;
    std::vector<double> effusivities;       ///< of nodes of the layer
    std::vector<double> incoming;           ///< likewise, of this rank in this step
    std::vector<double> temperatures_below; ///< T_m of the touches of the last step
  };

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
