// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/nodal_enthalpy.h>
#include <tombolo/materials/temperature_table.h>
#include <tombolo/state/nodal_source.h>
#include <tombolo/state/records.h>

#include <mpi.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace tombolo
{
  /** What contacts see of the heat of a scene, and where they put heat: pointers that are null
   * without heat. */
  struct NodalHeat
  {
    const NodalVector *temperature = nullptr; ///< at the present time, slot 0 of owned nodes
    const NodalEnthalpy *enthalpy = nullptr;
    /** Of owned nodes (scalar), what they have got since the thermal step began. */
    const NodalVector *pending = nullptr;
    /** Likewise h A Δt of all contacts in this step [M L^2/(T^2 K)]; null where there is no other
     * contact. */
    const NodalVector *exposure = nullptr;
    NodalSource *friction = nullptr;   ///< gets the heat of friction of bodies
    NodalSource *conduction = nullptr; ///< gets what is conducted into bodies

    /** The enthalpy of an owned node with what it has got. */
    double enthalpy_of(const unsigned int node) const
    {
      return enthalpy->enthalpy(node, *temperature->node(node)) + *pending->node(node);
    }
    double temperature_of(const unsigned int node) const
    {
      return enthalpy->temperature(node, enthalpy_of(node));
    }
  };

  /** Whom the nodes of a contact exchange heat with, through the conductance h(p) of the surface:
   * a tool with one temperature, or the nodes of a part. */
  class HeatPartner
  {
  public:
    virtual ~HeatPartner() = default;

    bool conducts() const
    {
      return conductance.largest() > 0.;
    }

    /** Begins a step: nothing touches. */
    void begin_step()
    {
      touches.clear();
    }

    /** A node in contact in a step of size @p time_step: candidate @p k, pressed with @p
     * normal_force on @p area. */
    void add_contact(const std::size_t k, const unsigned int node, const double normal_force,
                     const double area, const double time_step)
    {
      if (conducts() && area > 0.)
        touches.push_back({k, node, conductance.value(normal_force / area) * area * time_step});
    }

    /** Adds h A Δt of the nodes touched in this step to owned nodes of @p exposure (scalar). */
    void add_exposure(NodalVector &exposure) const
    {
      for (const Touch &touch : touches)
        *exposure.node(touch.node) += touch.exposure;
    }

    /** Ends the step: gives each node what it has received. @p friction is what the partner has
     * received on this rank from sliding. Collective. */
    virtual void end_step(double friction, const NodalHeat &nodal_heat, MPI_Comm communicator) = 0;

    /** Into the bodies since the start, on this rank [M L^2/T^2]. */
    double conducted() const
    {
      return conducted_heat;
    }

    /** Lists what is kept between two steps. */
    virtual void list(Records &records) = 0;

  protected:
    explicit HeatPartner(TemperatureTable conductance) : conductance(std::move(conductance)) {}

    struct Touch
    {
      std::size_t candidate;
      unsigned int node;
      double exposure; ///< h A Δt [M L^2/(T^2 K)]
    };

    /** The mean heat capacity of a node with this @p enthalpy from its @p temperature to @p other,
     * that of the partner. */
    static double mean_capacity(const NodalEnthalpy &of_nodes, unsigned int node, double enthalpy,
                                double temperature, double other);

    /** What a node with this capacity takes in the step per difference of temperatures: its share
     * of C (1 - exp(-E/C)) with the exposure E to all contacts. */
    static double response(const Touch &touch, const NodalHeat &nodal_heat, double capacity);

    TemperatureTable conductance; ///< h over the pressure [M/(T^3 K)]
    std::vector<Touch> touches;   ///< of the step
    double conducted_heat = 0;
  };
} // namespace tombolo
