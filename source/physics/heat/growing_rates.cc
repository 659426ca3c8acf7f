// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/heat/growing_rates.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Of an owned node, zero where its temperature is prescribed. */
    template <int dim>
    double free_capacity(const ThermalModel<dim> &heat, const unsigned int node)
    {
      const auto &held = heat.conditions.constrained_components();
      return !held.empty() && held[node] != 0
                 ? 0.
                 : heat.nodal_enthalpy.capacity(node,
                                                *heat.state.unsmoothed_temperature.node(node));
    }
  } // namespace

  template <int dim>
  double GrowingRates<dim>::find_eigenvalue(Model<dim> &model, const double time,
                                            const NodalVector &rate, const double time_step)
  {
    const ThermalModel<dim> &heat = *model.heat;
    double temperature = 0;
    largest_of_rank = 0;
    for (unsigned int i = 0; i < rate.partition()->n_owned(); ++i)
    {
      temperature = std::max(temperature, std::abs(*heat.state.unsmoothed_temperature.node(i)));
      const double capacity = free_capacity(heat, i);
      const double rate_of_node = capacity > 0. ? std::abs(*rate.node(i)) / capacity : 0.;
      if (rate_of_node > largest_of_rank)
      {
        largest_of_rank = rate_of_node;
        fastest = i;
      }
    }
    const double of_rank[2] = {largest_of_rank, temperature};
    double of_all[2];
    Utilities::MPI::max(of_rank, model.communicator, of_all);
    largest = of_all[0];

    constexpr double round_off = 1e-12;
    if (!(largest * time_step > round_off * of_all[1]))
      return 0.;
    smallest_largest = std::min(smallest_largest, largest);
    if (largest < 2. * smallest_largest)
      return 0.;
    smallest_largest = largest;
    return quotient_of_rates(model, time, rate, time_step);
  }

  template <int dim>
  double GrowingRates<dim>::quotient_of_rates(Model<dim> &model, const double time,
                                              const NodalVector &rate, const double time_step)
  {
    ThermalModel<dim> &heat = *model.heat;
    const auto &partition = rate.partition();
    const unsigned int n_owned = partition->n_owned();
    if (direction.partition() != partition)
      for (NodalVector *const vector : {&direction, &image})
        vector->reinit(partition, node_stride, ReflectionParity::even);
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const double capacity = free_capacity(heat, i);
      *direction.node(i) = capacity > 0. ? *rate.node(i) / capacity / largest : 0.;
    }
    direction.update_ghosts();
    heat.apply_conduction(model.state.position, heat.state.temperature, time, direction, image);
    double norm = 0, of_direction = 0, of_image = 0;
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const double capacity = free_capacity(heat, i);
      if (!(capacity > 0.))
        continue;
      const double d = *direction.node(i), y = *image.node(i);
      norm += d * capacity * d;
      of_direction += d * y;
      of_image += y / capacity * y;
    }
    const auto sums =
        ordered_sum(std::array<double, 3>{{norm, of_direction, of_image}}, model.communicator);
    // Rates that are the same at all nodes have an image of round-off.
    constexpr double smallest_share = 1e-6;
    return sums[1] * time_step > smallest_share * sums[0] ? sums[2] / sums[1] : 0.;
  }

  template <int dim>
  std::string GrowingRates<dim>::fastest_node(const Model<dim> &model) const
  {
    if (largest_of_rank < largest)
      return "";
    const double *const x = model.state.position.node(fastest);
    std::ostringstream text;
    text.precision(6);
    text << "The temperature of node " << model.nodes->persistent_ids()[fastest] << ", at (" << x[0]
         << ", " << x[1] << ", " << x[2] << "), changes fastest, by " << largest
         << " per unit of time.";
    return text.str();
  }

  template <int dim>
  void GrowingRates<dim>::serialize(StateArchive &archive)
  {
    archive("smallest of largest rates", smallest_largest);
  }

  template class GrowingRates<2>;
  template class GrowingRates<3>;
} // namespace tombolo
