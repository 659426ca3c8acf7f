// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/heat_partner.h>
#include <tombolo/contact/outward_areas.h>

#include <mpi.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The heat of a rigid tool: what it exchanges with the nodes in contact, h(p) (T_tool - T) A, and
   * its temperature, which is given or that of a lumped heat capacity.
   *
   * In a step a node i exchanges a_i (T_tool - T_i) with a_i = C_i (1 - exp(-h A Δt / C_i)), the
   * exact exchange with a tool of constant temperature, where C_i is the mean heat capacity of the
   * node between the two temperatures: however good the conductance, the node does not get past the
   * tool. Of several tools at one node, each has its share h A Δt / E of C_i (1 - exp(-E / C_i)),
   * with the sum E of all h A Δt: the node does not get out of their temperatures and its own,
   * and their order does not matter. A lumped tool takes the temperature T' at the end of the step
   * at which
   *
   *   C_tool (T' - T_tool) = friction heat of the tool - Σ a_i (T' - T_i),
   *
   * so that it does not get past the nodes either, and the heat of tool and nodes together is kept
   * to round-off. The step of no solver is limited by any of this.
   */
  template <int dim>
  class ToolHeat : public HeatPartner
  {
  public:
    /** "Conductance", "Tool temperature", "Heat capacity" in the section of a contact. */
    static void declare_parameters(const Entries &e);

    /** Reads them without a mesh. Null where the tool neither conducts nor has a heat capacity.
     * Throws InputError. */
    static std::unique_ptr<ToolHeat> create(const Section &section);

    /** "Conductance" alone. Throws InputError. */
    static TemperatureTable read_conductance(const Section &section);

    bool has_capacity() const;
    double temperature() const; ///< of the tool

    void end_step(double friction, const NodalHeat &nodal_heat, MPI_Comm communicator) override;

    /** What a tool with a heat capacity has more than at the start, the same on all ranks. */
    double stored() const;

    void list(Records &records) override
    {
      Records &of_tool = records.group("heat of the tool");
      of_tool.value("temperature", tool_temperature);
      of_tool.sums("conducted", this->conducted_heat);
    }

  private:
    explicit ToolHeat(const Section &section, TemperatureTable conductance);

    struct Offer
    {
      double response;    ///< a_i [M L^2/(T^2 K)]
      double temperature; ///< T_i
    };

    double initial_temperature;
    double capacity; ///< zero: the temperature is given
    double tool_temperature;
    std::vector<Offer> offers; ///< of the touches of the step
  };
} // namespace tombolo
