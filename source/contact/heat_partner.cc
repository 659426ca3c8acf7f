// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/heat_partner.h>

#include <cmath>

namespace tombolo
{
  double HeatPartner::mean_capacity(const NodalEnthalpy &of_nodes, const unsigned int node,
                                    const double enthalpy, const double temperature,
                                    const double other)
  {
    const double mean = (of_nodes.enthalpy(node, other) - enthalpy) / (other - temperature);
    // The mean is all round-off where the temperatures are alike.
    return !of_nodes.is_linear() && mean > 0. && std::isfinite(mean)
               ? mean
               : of_nodes.capacity(node, temperature);
  }

  double HeatPartner::response(const Touch &touch, const NodalHeat &nodal_heat,
                               const double capacity)
  {
    const double exposure =
        nodal_heat.exposure != nullptr ? *nodal_heat.exposure->node(touch.node) : touch.exposure;
    const double share = exposure > 0. ? touch.exposure / exposure : 1.;
    return share * (-capacity * std::expm1(-exposure / capacity));
  }
} // namespace tombolo
