// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/contact/contact_balance.h>
#include <tombolo/contact/contact_settings.h>
#include <tombolo/contact/part_surface.h>
#include <tombolo/materials/nodal_enthalpy.h>
#include <tombolo/materials/temperature_table.h>
#include <tombolo/state/nodal_source.h>
#include <tombolo/state/records.h>

#include <mpi.h>

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace tombolo
{
  /** The heat of a scene as contacts read it, and the sources that they add to: pointers that are
   * null without heat. */
  struct NodalHeat
  {
    const NodalVector *temperature = nullptr; ///< at the present time, slot 0 of owned nodes
    const NodalEnthalpy *enthalpy = nullptr;
    /** The heat received by owned nodes (scalar) since the thermal step began. */
    const NodalVector *pending = nullptr;
    /** Likewise h A Δt of all contacts in this step [M L^2/(T^2 K)]; null where there is no other
     * contact. */
    const NodalVector *exposure = nullptr;
    NodalSource *friction = nullptr;   ///< receives the heat of friction of bodies
    NodalSource *conduction = nullptr; ///< receives what is conducted into bodies

    /** The enthalpy of an owned node with the heat received. */
    double enthalpy_of(const unsigned int node) const
    {
      return enthalpy->enthalpy(node, *temperature->node(node)) + *pending->node(node);
    }

    double temperature_of(const unsigned int node) const
    {
      return enthalpy->temperature(node, enthalpy_of(node));
    }

    /** The same, and exactly that of the thermal step where the node has received nothing. */
    double present_temperature(const unsigned int node) const
    {
      return *pending->node(node) != 0. ? temperature_of(node) : *temperature->node(node);
    }
  };

  /** The partner of nodes in the exchange of heat, by the entries `Conductance`, `Tool temperature`
   * and `Heat capacity` of the contact. */
  struct HeatPartner
  {
    /** That of a rigid tool, or of a part, which has temperatures of its own. Throws InputError. */
    explicit HeatPartner(const Entries &e, bool is_part = false);

    bool conducts() const
    {
      return conductance.largest() > 0.;
    }

    /** Whether it has a temperature: a tool may have none. */
    bool has_temperature() const
    {
      return is_part || conducts() || capacity > 0.;
    }

    bool is_part;
    TemperatureTable conductance; ///< h over the pressure [M/(T^3 K)]
    double capacity = 0; ///< of a tool; zero: its temperature is prescribed [M L^2/(T^2 K)]
    double initial_temperature = 0; ///< of a tool
  };

  /**
   * The heat of the contact of nodes with a surface: that of friction, which body and surface
   * share, and what is conducted, h(p) (T_surface - T) A. In scenes with heat only.
   *
   * In a step a node i exchanges a_i (T_s - T_i) with a_i = C_i (1 - exp(-h A Δt / C_i)), the exact
   * exchange with a surface of constant temperature T_s, where C_i is the mean heat capacity of the
   * node between the two temperatures: however good the conductance, T_i does not pass T_s. Of
   * several surfaces at one node, each has its share h A Δt / E of C_i (1 - exp(-E / C_i)), with
   * the sum E of all h A Δt: T_i stays between its former value and theirs, and their order does
   * not matter. The step of no solver is limited by any of this.
   *
   * A tool has one temperature, which is prescribed or that of a lumped heat capacity: then it has
   * the temperature T' at the end of the step at which
   *
   *   C_tool (T' - T_tool) = friction heat of the tool - Σ a_i (T' - T_i),
   *
   * so that it does not pass the T_i either, and the heat of tool and nodes together is kept to
   * round-off.
   *
   * The surface of a part has the mean T_s = Σ N_a T_a of the nodes a of the cell there, and
   * C_i / (1 + R_i) replaces C_i, with R_i of PartSurface for heat capacities. What a node receives
   * comes from the nodes a by N_a, and so does the part's share of the heat of friction: the heat
   * of both bodies is kept to round-off.
   */
  template <int dim>
  class ContactHeat
  {
  public:
    /** @p surface is null where it is that of no part. What is referred to must outlive this.
     * Throws InputError. */
    ContactHeat(const Section &section, const ContactSettings &settings,
                const std::vector<unsigned int> &candidates, PartSurface<dim> *surface);

    bool conducts() const
    {
      return partner.conducts();
    }

    bool has_tool_temperature() const
    {
      return surface == nullptr && partner.has_temperature();
    }

    /** Begins a step, without contacts. Collective. */
    void begin_step(const NodalHeat &nodal_heat);

    /** In a step of size @p time_step candidate @p k is pressed with @p normal_force on @p area. */
    void add_contact(const std::size_t k, const double normal_force, const double area,
                     const double time_step)
    {
      if (conducts() && area > 0.)
        touches.push_back(
            {k, candidates[k], partner.conductance.value(normal_force / area) * area * time_step});
    }

    /** Adds h A Δt of the nodes touched in this step to owned nodes of @p exposure (scalar). */
    void add_exposure(NodalVector &exposure) const
    {
      for (const Touch &touch : touches)
        *exposure.node(touch.node) += touch.exposure;
    }

    /** Splits the heat of friction at a candidate. Returns what the body receives. */
    double add_friction(std::size_t candidate, double heat, const NodalHeat &nodal_heat);

    /** The body's share of the heat of friction at a candidate. */
    double share_of_body(std::size_t candidate, const NodalHeat &nodal_heat) const;

    /** @p heat is that of friction of this rank in the step. */
    void end_forces(const double heat)
    {
      if (!settings.splits_by_effusivity)
        friction_of_tool = (1. - settings.heat_fraction) * heat;
    }

    /** Ends the step: adds to each node what it has received. Collective. */
    void exchange(const NodalHeat &nodal_heat, MPI_Comm communicator);

    /** This rank's shares of heat. */
    void add_shares(ContactBalance &shares) const
    {
      shares.conducted = conducted;
      shares.friction_of_bodies = friction_of_bodies;
    }

    /** Sets the values that follow from @p sums over ranks. */
    void complete(ContactBalance &sums) const;

    /** Mean and largest T_s of a part in the last step; zero where nothing touches. Collective. */
    std::array<double, 2> temperatures_of_part(const MPI_Comm communicator) const
    {
      return mean_and_largest(below, communicator);
    }

    /** Lists what is kept from step to step. */
    void list(Records &records);

  private:
    struct Touch
    {
      std::size_t candidate;
      unsigned int node;
      double exposure; ///< h A Δt [M L^2/(T^2 K)]
    };

    /** Values of nodes of the part, which @p write sets from the number and the temperature of
     * owned nodes, with the pending heat. Collective. */
    std::vector<double>
    gather(const NodalHeat &nodal_heat, unsigned int n_values,
           const std::function<void(unsigned int node, double temperature, double *)> &write) const;
    /** The mean of every @p stride -th value at the contact point of a candidate. */
    double value_at(std::size_t candidate, const std::vector<double> &node_values,
                    unsigned int stride = 1) const;
    void add_to_part(const std::size_t candidate, const double heat)
    {
      const auto &contact_point = surface->contact_point(candidate);
      for (unsigned int c = 0; c < contact_point.weights.size(); ++c)
        incoming[surface->cell(contact_point)[c]] += contact_point.weights[c] * heat;
    }
    /** The temperature T_s below touches, and of touches the heat capacity in the exchange. */
    void find_capacities(const NodalHeat &nodal_heat, const std::vector<double> &temperatures,
                         std::vector<double> &capacities);

    const ContactSettings &settings;
    const std::vector<unsigned int> &candidates;
    PartSurface<dim> *surface; ///< null where the surface is that of no part
    HeatPartner partner;
    double tool_temperature;
    std::vector<Touch> touches;                  ///< of the step
    std::vector<double> below;                   ///< T_s of these
    std::vector<double> temperatures, responses; ///< buffers, of touches
    std::vector<double> effusivities;            ///< of nodes of the part
    std::vector<double> incoming;                ///< likewise, heat from this rank in this step
    double conducted = 0;                        ///< into the bodies, of this rank since the start
    double friction_of_tool = 0;                 ///< its share of the heat of friction in this step
    double friction_of_bodies = 0;               ///< of this rank since the start, by effusivities
  };
} // namespace tombolo
