// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

namespace tombolo
{
  template <int dim>
  class Model;

  /** What nodes, parts and processes hold, over all ranks: to be compared before and after a change
   * of the mesh. */
  struct ModelContent
  {
    /** Of @p model between two steps. Collective. */
    template <int dim>
    static ModelContent of(const Model<dim> &model);

    double energy = 0;                        ///< held and kinetic [M L^2/T^2]
    std::array<double, 3> momentum{};         ///< [M L/T]
    std::array<double, 3> angular_momentum{}; ///< about the origin [M L^2/T]
    double enthalpy = 0, next_enthalpy = 0;   ///< with the heat that is to be given [M L^2/T^2]
  };
} // namespace tombolo
