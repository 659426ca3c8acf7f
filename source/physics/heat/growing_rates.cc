// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/heat/growing_rates.h>

#include <tombolo/base/ordered_sum.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    /** Calls @p action with each owned node whose temperature is free, and its capacity. */
    template <int dim, typename Action>
    void visit_free_nodes(const ThermalModel<dim> &heat, const Action &action)
    {
      const auto &held = heat.conditions.constrained_components();
      const NodalVector &temperature = heat.state.unsmoothed_temperature;
      for (unsigned int i = 0; i < temperature.partition()->n_owned(); ++i)
        if (held.empty() || held[i] == 0)
          if (const double capacity = heat.nodal_enthalpy.capacity(i, *temperature.node(i));
              capacity > 0.)
            action(i, capacity);
    }
  } // namespace

  template <int dim>
  double GrowingRates<dim>::find_eigenvalue(const Model<dim> &model, const double time,
                                            const NodalVector &rate, const double time_step)
  {
    const ThermalModel<dim> &heat = *model.heat;
    largest = 0;
    visit_free_nodes(heat, [&](const unsigned int node, const double capacity)
                     { largest = std::max(largest, std::abs(*rate.node(node)) / capacity); });
    largest = Utilities::MPI::max(largest, model.communicator);

    if (usual > 0. && largest > 2. * usual)
    {
      usual = largest;
      return changes_are_round_off(heat, time_step)
                 ? 0.
                 : quotient_of_rates(model, time, rate, time_step);
    }
    // Of what goes up and down, quotients are found in less than one of twenty steps.
    constexpr double memory = 0.97;
    if (usual == 0.)
      usual = largest;
    else if (largest < usual)
      usual = std::max(largest, memory * usual);
    return 0.;
  }

  template <int dim>
  bool GrowingRates<dim>::changes_are_round_off(const ThermalModel<dim> &heat,
                                                const double time_step) const
  {
    constexpr double round_off = 1e-12;
    const NodalVector &temperature = heat.state.unsmoothed_temperature;
    double magnitude = 0;
    for (unsigned int i = 0; i < temperature.partition()->n_owned(); ++i)
      magnitude = std::max(magnitude, std::abs(*temperature.node(i)));
    magnitude = Utilities::MPI::max(magnitude, temperature.partition()->communicator());
    return !(largest * time_step > round_off * magnitude);
  }

  template <int dim>
  double GrowingRates<dim>::quotient_of_rates(const Model<dim> &model, const double time,
                                              const NodalVector &rate, const double time_step)
  {
    ThermalModel<dim> &heat = *model.heat;
    const auto &partition = rate.partition();
    if (direction.partition() != partition)
      for (NodalVector *const vector : {&direction, &image})
        vector->reinit(partition, Quantity::scalars);
    direction.set_zero();
    change_owned({&direction},
                 [&]
                 {
                   visit_free_nodes(heat,
                                    [&](const unsigned int node, const double capacity) {
                                      *direction.node(node) = *rate.node(node) / capacity / largest;
                                    });
                 });
    heat.apply_conduction(model.state.position, heat.state.temperature, time, direction, image);
    double norm = 0, of_direction = 0, of_image = 0;
    visit_free_nodes(heat,
                     [&](const unsigned int node, const double capacity)
                     {
                       const double d = *direction.node(node), y = *image.node(node);
                       norm += d * capacity * d;
                       of_direction += d * y;
                       of_image += y / capacity * y;
                     });
    const auto sums =
        ordered_sum(std::array<double, 3>{{norm, of_direction, of_image}}, model.communicator);
    // Rates that are the same at all nodes have an image of round-off.
    constexpr double smallest_share = 1e-6;
    return sums[1] * time_step > smallest_share * sums[0] ? sums[2] / sums[1] : 0.;
  }

  template class GrowingRates<2>;
  template class GrowingRates<3>;
} // namespace tombolo
