// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tombolo
{
  /**
   * Detects forward Euler steps that are too long by their effect. A step amplifies modes with an
   * eigenvalue λ of C⁻¹A above 2/Δt, and then the rates of temperature d = C⁻¹ dH/dt are made of
   * such modes sooner or later. The largest rate is followed. Whenever it is twice the usual one, A
   * is applied to the rates once, for the quotient (y · C⁻¹ y)/(d · y) with y = A d: a lower bound
   * of the largest eigenvalue, since A is symmetric. Sources and prescribed values make rates grow,
   * too, but are not in A: no step that is stable exceeds 2/λ.
   */
  template <int dim>
  class GrowingRates
  {
  public:
    /** λ [1/T] from @p rate, dH/dt of owned nodes at @p time; the areas of surfaces are those of
     * the present. Zero where the largest rate is not twice the usual one, which is that at the
     * last λ and follows smaller ones by 3 % a step, and where a step of @p time_step changes
     * temperatures by round-off only. Collective. */
    double find_eigenvalue(const Model<dim> &model, const double time, const NodalVector &rate,
                           const double time_step)
    {
      const ThermalModel<dim> &heat = *model.heat;
      largest = 0;
      visit_free_nodes(heat, [&](const unsigned int node, const double capacity)
                       { largest = std::max(largest, std::abs(*rate.node(node)) / capacity); });
      largest = dealii::Utilities::MPI::max(largest, model.communicator);

      if (usual > 0. && largest > 2. * usual)
      {
        usual = largest;
        return changes_are_round_off(heat, time_step)
                   ? 0.
                   : quotient_of_rates(model, time, rate, time_step);
      }
      // Oscillating rates need a quotient in less than one of twenty steps.
      constexpr double memory = 0.97;
      if (usual == 0.)
        usual = largest;
      else if (largest < usual)
        usual = std::max(largest, memory * usual);
      return 0.;
    }

    /** Lists the state between steps. */
    void list(Records &records)
    {
      records.value("usual rate", usual);
    }

  private:
    /** Calls @p action with each owned node whose temperature is free, and its capacity. */
    template <typename Action>
    static void visit_free_nodes(const ThermalModel<dim> &heat, const Action &action)
    {
      const auto &held = heat.conditions.constrained_components();
      const NodalVector &temperature = heat.state.unsmoothed_temperature;
      for (unsigned int i = 0; i < temperature.partition()->n_owned(); ++i)
        if (held.empty() || held[i] == 0)
          if (const double capacity = heat.nodal_enthalpy.capacity(i, *temperature.node(i));
              capacity > 0.)
            action(i, capacity);
    }

    /** Whether the largest rate is that of a uniform temperature. Collective. */
    bool changes_are_round_off(const ThermalModel<dim> &heat, const double time_step) const
    {
      constexpr double round_off = 1e-12;
      const NodalVector &temperature = heat.state.unsmoothed_temperature;
      double magnitude = 0;
      for (unsigned int i = 0; i < temperature.partition()->n_owned(); ++i)
        magnitude = std::max(magnitude, std::abs(*temperature.node(i)));
      magnitude = dealii::Utilities::MPI::max(magnitude, temperature.partition()->communicator());
      return !(largest * time_step > round_off * magnitude);
    }

    /** The quotient for the rates. Collective. */
    double quotient_of_rates(const Model<dim> &model, const double time, const NodalVector &rate,
                             const double time_step)
    {
      ThermalModel<dim> &heat = *model.heat;
      const auto &partition = rate.partition();
      for (NodalVector *const vector : {&direction, &image})
        vector->fit_to(partition, Quantity::scalars);
      direction.set_zero();
      change_owned({&direction},
                   [&]
                   {
                     visit_free_nodes(
                         heat, [&](const unsigned int node, const double capacity)
                         { *direction.node(node) = *rate.node(node) / capacity / largest; });
                   });
      heat.apply_conduction(model.state.position, heat.state.temperature, time, direction, image);
      double norm = 0, direction_product = 0, image_product = 0;
      visit_free_nodes(heat,
                       [&](const unsigned int node, const double capacity)
                       {
                         const double d = *direction.node(node), y = *image.node(node);
                         norm += d * capacity * d;
                         direction_product += d * y;
                         image_product += y / capacity * y;
                       });
      const auto sums = ordered_sum(std::array<double, 3>{{norm, direction_product, image_product}},
                                    model.communicator);
      // Rates that are the same at all nodes have an image of round-off.
      constexpr double smallest_share = 1e-6;
      return sums[1] * time_step > smallest_share * sums[0] ? sums[2] / sums[1] : 0.;
    }

    double largest = 0;           ///< of the last rates, of all ranks [temperature/T]
    double usual = 0;             ///< largest rate that was no growth; zero at the start
    NodalVector direction, image; ///< d/largest and y, where a quotient was needed
  };
} // namespace tombolo
