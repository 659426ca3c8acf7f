// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/run_statistics.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The largest speed, stress component and internal variables. Collective. */
    template <int dim>
    void add_extremes(const Model<dim> &model, TimeTable &statistics)
    {
      double largest[2] = {0., 0.}; // speed, stress component
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      {
        const double *const v = model.state.velocity.node(i);
        largest[0] = std::max(largest[0], v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      }
      for (const Part<dim> &part : model.parts)
        for (unsigned int c = 0; c < 6; ++c)
        {
          const MaterialPoints &points = part.formulation->points();
          const double *const stress = points.component(MaterialPoints::stress, c);
          const double *const volume = points.component(MaterialPoints::volume, 0);
          for (unsigned int i = 0; i < points.size(); ++i)
            if (volume[i] > 0.) // not an unused lane of a batch of cells
              largest[1] = std::max(largest[1], std::abs(stress[i]));
        }
      statistics.add("largest speed", "L/T",
                     std::sqrt(Utilities::MPI::max(largest[0], model.communicator)));
      statistics.add("largest stress component", "M/(L T^2)",
                     Utilities::MPI::max(largest[1], model.communicator));
      const auto add_largest = [&](const std::string &field, const std::string &unit)
      {
        bool is_known = false;
        double value = std::numeric_limits<double>::lowest();
        for (const Part<dim> &part : model.parts)
        {
          const MaterialPoints &points = part.formulation->points();
          const unsigned int f = points.find_field(field);
          if (f == points.fields().size())
            continue;
          is_known = true;
          const double *const values = points.component(f, 0);
          const double *const volume = points.component(MaterialPoints::volume, 0);
          for (unsigned int i = 0; i < points.size(); ++i)
            if (volume[i] > 0.)
              value = std::max(value, values[i]);
        }
        if (is_known)
          statistics.add("largest " + field, unit, Utilities::MPI::max(value, model.communicator));
      };
      add_largest("effective plastic strain", "1");
      add_largest("temperature", "K");
      add_largest("damage", "1");
    }
  } // namespace

  template <int dim>
  void add_mechanical_statistics(const Model<dim> &model, const EnergyBalance &balance,
                                 TimeTable &statistics)
  {
    for (const EnergyAccounts::Account &account : balance.energies.accounts())
    {
      statistics.add(account.name, "M L^2/T^2", account.value);
      if (account.name == "kinetic energy")
        statistics.add("smoothed kinetic energy", "M L^2/T^2", balance.smoothed_kinetic);
    }
    statistics.add("total energy", "M L^2/T^2", balance.total);
    statistics.add("energy error", "1", balance.error);
    for (unsigned int d = 0; d < dim; ++d)
      statistics.add(std::string("momentum ") + "xyz"[d], "M L/T", balance.momentum[d]);
    for (unsigned int d = 0; d < dim; ++d)
      statistics.add(std::string("impulse ") + "xyz"[d], "M L/T", balance.impulse[d]);
    statistics.add("momentum drift", "1", balance.momentum_drift);
    for (unsigned int d = dim == 2 ? 2 : 0; d < 3; ++d)
      statistics.add(std::string("angular momentum ") + "xyz"[d], "M L^2/T",
                     balance.angular_momentum[d]);
    statistics.add("angular momentum drift", "1", balance.angular_momentum_drift);
    statistics.add("lattice mode share", "1", balance.short_wave_share);
    for (const auto &process : model.processes)
      process->report(model, statistics);
    add_extremes(model, statistics);
  }

  template <int dim>
  void add_thermal_statistics(const Model<dim> &model, const ThermalStep<dim> &thermal_step,
                              const HeatBalance &balance, TimeTable &statistics)
  {
    const std::string energy = "M L^2/T^2";
    statistics.add("thermal steps", "1", static_cast<double>(thermal_step.n_steps()));
    for (const EnergyAccounts::Account &account : balance.heat.accounts())
      statistics.add(account.name, energy, account.value);
    for (const auto &process : model.processes)
      if (!model.has_mechanics)
        process->report(model, statistics);
    statistics.add("heat balance error", "1", balance.error);
    double smallest = std::numeric_limits<double>::max(), largest = -smallest;
    const NodalVector &temperature = model.heat->state.present_temperature;
    for (unsigned int i = 0; i < temperature.partition()->n_owned(); ++i)
    {
      if (*model.heat->bridge.mass().node(i) == 0.) // all its cells were removed
        continue;
      smallest = std::min(smallest, *temperature.node(i));
      largest = std::max(largest, *temperature.node(i));
    }
    smallest = Utilities::MPI::min(smallest, model.communicator);
    largest = Utilities::MPI::max(largest, model.communicator);
    const bool is_left = smallest <= largest; // something of the body
    statistics.add("smallest nodal temperature", "temperature", is_left ? smallest : 0.);
    statistics.add("largest nodal temperature", "temperature", is_left ? largest : 0.);
  }

  template void add_mechanical_statistics(const Model<2> &, const EnergyBalance &, TimeTable &);
  template void add_thermal_statistics(const Model<2> &, const ThermalStep<2> &,
                                       const HeatBalance &, TimeTable &);
  template void add_mechanical_statistics(const Model<3> &, const EnergyBalance &, TimeTable &);
  template void add_thermal_statistics(const Model<3> &, const ThermalStep<3> &,
                                       const HeatBalance &, TimeTable &);
} // namespace tombolo
