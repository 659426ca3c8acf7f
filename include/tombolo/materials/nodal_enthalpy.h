// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/thermal_properties.h>

#include <cstddef>
#include <vector>

namespace tombolo
{
  /** The enthalpy of nodes as a function of their temperature: H(θ) = Σ m h(θ) over the parts that
   * meet at the node. Nodes are owned ones of this rank. */
  class NodalEnthalpy
  {
  public:
    /** Forgets all. */
    void reinit(unsigned int n_nodes);

    /** Adds the mass that a part has at a node, and its density, which effusivity() needs. @p
     * properties must outlive this. */
    void add(unsigned int node, double mass, const ThermalProperties &properties,
             double density = 0.);

    /** To be called when all is added. */
    void complete();

    double enthalpy(unsigned int node, double temperature) const;
    /** dH/dθ. */
    double capacity(unsigned int node, double temperature) const;
    /** √(k ρ c), the mean over the masses of the parts that meet at the node; zero at a node
     * without mass. */
    double effusivity(unsigned int node, double temperature) const;
    /** The inverse of enthalpy(); zero at a node without mass. */
    double temperature(unsigned int node, double enthalpy) const;

    /** Mean of the initial temperatures, weighted by the capacities there. */
    double initial_temperature(const unsigned int node) const
    {
      return zero_temperature[node];
    }

    /** Whether no capacity depends on the temperature. */
    bool is_linear() const
    {
      return linear;
    }

  private:
    struct Share
    {
      unsigned int node;
      double mass;
      const ThermalProperties *properties;
      double density;
    };

    std::vector<Share> shares;             // ordered by node when complete
    std::vector<std::size_t> first_share;  // of each node
    std::vector<double> constant_capacity; // of nodes; where all is linear
    std::vector<double> zero_temperature;  // at which H is zero; likewise
    bool linear = true;
  };
} // namespace tombolo
