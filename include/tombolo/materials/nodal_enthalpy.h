// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/thermal_properties.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tombolo
{
  /** The enthalpy of owned nodes: H(θ) = Σ m h(θ) over the parts that meet at the node. */
  class NodalEnthalpy
  {
  public:
    void reinit(const unsigned int n_nodes)
    {
      shares.clear();
      first_share.assign(n_nodes + 1, 0);
      linear = true;
    }

    /** Adds mass and density (for effusivity()) of a part; @p properties must outlive this. */
    void add(const unsigned int node, const double mass, const ThermalProperties &properties,
             const double density = 0.)
    {
      shares.push_back({node, mass, &properties, density});
      linear = linear && properties.capacity().is_constant();
    }

    /** To be called when all is added. */
    void complete()
    {
      std::stable_sort(shares.begin(), shares.end(),
                       [](const Share &a, const Share &b) { return a.node < b.node; });
      const std::size_t n_nodes = first_share.size() - 1;
      std::size_t next = 0;
      for (std::size_t node = 0; node <= n_nodes; ++node)
      {
        while (next < shares.size() && shares[next].node < node)
          ++next;
        first_share[node] = next;
      }
      constant_capacity.assign(n_nodes, 0.);
      zero_temperature.assign(n_nodes, 0.);
      for (const Share &share : shares)
      {
        const double start = share.properties->initial_temperature();
        constant_capacity[share.node] += share.mass * share.properties->capacity().value(start);
      }
      // Relative to the first part, so that equal temperatures stay what they are to the last
      // digit.
      for (std::size_t node = 0; node < n_nodes; ++node)
      {
        if (first_share[node] == first_share[node + 1])
          continue;
        const double first = shares[first_share[node]].properties->initial_temperature();
        double sum = 0;
        for (std::size_t k = first_share[node]; k < first_share[node + 1]; ++k)
        {
          const double start = shares[k].properties->initial_temperature();
          sum += shares[k].mass * shares[k].properties->capacity().value(start) * (start - first);
        }
        zero_temperature[node] = first + sum / constant_capacity[node];
      }
    }

    double enthalpy(const unsigned int node, const double temperature) const
    {
      if (linear)
        return constant_capacity[node] * (temperature - zero_temperature[node]);
      double sum = 0;
      for (std::size_t k = first_share[node]; k < first_share[node + 1]; ++k)
        sum += shares[k].mass * shares[k].properties->enthalpy(temperature);
      return sum;
    }
    /** dH/dθ. */
    double capacity(const unsigned int node, const double temperature) const
    {
      if (linear)
        return constant_capacity[node];
      double sum = 0;
      for (std::size_t k = first_share[node]; k < first_share[node + 1]; ++k)
        sum += shares[k].mass * shares[k].properties->capacity().value(temperature);
      return sum;
    }
    /** √(k ρ c), the mean over the masses of the parts at the node; zero without mass. */
    double effusivity(const unsigned int node, const double temperature) const
    {
      double sum = 0, mass = 0;
      for (std::size_t k = first_share[node]; k < first_share[node + 1]; ++k)
      {
        const ThermalProperties &properties = *shares[k].properties;
        sum += shares[k].mass *
               std::sqrt(properties.conductivity().value(temperature) * shares[k].density *
                         properties.capacity().value(temperature));
        mass += shares[k].mass;
      }
      return mass > 0. ? sum / mass : 0.;
    }
    /** The inverse of enthalpy(); zero at a node without mass. */
    double temperature(const unsigned int node, const double enthalpy) const
    {
      const std::size_t begin = first_share[node], end = first_share[node + 1];
      if (begin == end)
        return zero_temperature[node];
      if (linear)
        return zero_temperature[node] + enthalpy / constant_capacity[node];
      if (end == begin + 1)
        return shares[begin].properties->temperature(enthalpy / shares[begin].mass);
      // H is increasing and piecewise quadratic: Newton's method, kept within bounds that close in.
      double theta = zero_temperature[node] + enthalpy / constant_capacity[node];
      double lower = -1e300, upper = 1e300;
      for (unsigned int iteration = 0; iteration < 100; ++iteration)
      {
        const double residual = enthalpy - this->enthalpy(node, theta);
        (residual > 0. ? lower : upper) = theta;
        const double next = theta + residual / capacity(node, theta);
        const bool is_inside = next > lower && next < upper;
        const double last = theta;
        theta = is_inside || lower < -1e299 || upper > 1e299 ? next : 0.5 * (lower + upper);
        if (std::abs(theta - last) <= 4e-16 * std::abs(theta))
          break;
      }
      return theta;
    }

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
