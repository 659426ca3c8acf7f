// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

#include <utility>

namespace tombolo
{
  /** The heat of the nodes of a part at a refill, by its mass alone. */
  template <int dim>
  class NodalContent
  {
  public:
    /** @p mass: that of the part before the refill, owned. */
    NodalContent(const Model<dim> &model, const unsigned int part, NodalVector part_mass)
        : mass(std::move(part_mass)), part(part)
    {
      if (!model.heat)
        return;
      enthalpy = enthalpies(model, temperatures(model));
      initial = enthalpy.copy();
    }

    NodalVector mass;     ///< before, scalar, owned
    NodalVector enthalpy; ///< per mass, at the three times of ThermalState; after the refill
    NodalVector initial;  ///< before the refill, with ghosts

    /** The three temperatures of ThermalState at the nodes of the part. */
    NodalVector temperatures(const Model<dim> &model) const
    {
      const ThermalState &thermal = model.heat->state;
      return nodal_field(model.state.partition(), Quantity::scalars,
                         [&](const unsigned int i, double *const values)
                         {
                           if (!(*mass.node(i) > 0.))
                             return;
                           values[0] = *thermal.unsmoothed_temperature.node(i);
                           values[1] = *thermal.next_unsmoothed_temperature.node(i);
                           values[2] = *thermal.present_temperature.node(i);
                         });
    }

    /** The enthalpies of these, with ghosts. */
    NodalVector enthalpies(const Model<dim> &model, const NodalVector &temperatures) const
    {
      const ThermalProperties &properties = *model.parts[part].heat;
      return nodal_field(model.state.partition(), Quantity::scalars,
                         [&](const unsigned int i, double *const values)
                         {
                           for (unsigned int slot = 0; slot < 3 && *mass.node(i) > 0.; ++slot)
                             values[slot] = properties.enthalpy(temperatures.node(i)[slot]);
                         });
    }

    /** Sets the enthalpies of after at nodes with the mass @p after of the part (owned).
     */
    void set_enthalpies(const Model<dim> &model, const NodalVector &after) const
    {
      ThermalState &thermal = model.heat->state;
      const ThermalProperties &properties = *model.parts[part].heat;
      const auto change = [&](const unsigned int i, const unsigned int slot, double &node_enthalpy,
                              double &unsmoothed, double &field)
      {
        node_enthalpy +=
            *after.node(i) * enthalpy.node(i)[slot] - *mass.node(i) * initial.node(i)[slot];
        if (*after.node(i) == 0.)
          return;
        field -= unsmoothed;
        unsmoothed = model.heat->nodal_enthalpy.temperature(i, node_enthalpy);
        field += unsmoothed;
      };
      change_owned(
          {&thermal.unsmoothed_temperature, &thermal.temperature,
           &thermal.next_unsmoothed_temperature, &thermal.next_temperature,
           &thermal.present_temperature},
          [&]
          {
            for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
            {
              if (!(*after.node(i) > 0. || *mass.node(i) > 0.))
                continue;
              change(i, 0, *thermal.enthalpy.node(i), *thermal.unsmoothed_temperature.node(i),
                     *thermal.temperature.node(i));
              change(i, 1, *thermal.next_enthalpy.node(i),
                     *thermal.next_unsmoothed_temperature.node(i),
                     *thermal.next_temperature.node(i));
              if (*after.node(i) > 0.)
                *thermal.present_temperature.node(i) = properties.temperature(enthalpy.node(i)[2]);
            }
          });
      model.heat->limit_is_outdated = true;
    }

  private:
    unsigned int part;
  };
} // namespace tombolo
