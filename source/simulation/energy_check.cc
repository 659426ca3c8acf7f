// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/energy_check.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void check_energy_balance(const Model<dim> &model, const EnergyBalance &balance,
                            const Clock &clock, const double limit)
  {
    if (limit == 0. || std::abs(balance.error) <= limit)
      return;
    // Energies near the smallest numbers have no digits that could balance.
    constexpr double smallest = 1e-280;
    if (std::abs(balance.total) < smallest &&
        std::abs(balance.initial_total + balance.external) < smallest)
      return;
    // The balance of a body at rest is all round-off.
    double speed = 0, mass = 0;
    for (const Part<dim> &part : model.parts)
      speed = std::max(speed, part.material->longitudinal_wave_speed());
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      mass += *model.bridge->mass().node(i);
    mass = Utilities::MPI::sum(mass, model.communicator);
    const double put_in = balance.initial_total + balance.external;
    constexpr double round_off = 1e-20;
    if (std::isfinite(balance.total) &&
        std::abs(balance.total - put_in) <= round_off * mass * speed * speed)
      return;
    std::ostringstream message;
    message.precision(4);
    message << "The energy balance does not hold at time " << clock.time << ", step " << clock.step
            << ": a total energy of " << balance.total << ", where " << put_in
            << " was put in (error " << balance.error << ", allowed " << limit
            << "). The motion is not stable: a smaller step (`Time step/Safety factor`, or the "
               "spectral `Estimator`) or another formulation may help. `Largest energy error` "
               "is the limit.";
    throw RunError(message.str());
  }

  void check_heat_balance(const HeatBalance &balance, const Clock &clock)
  {
    if (!std::isfinite(balance.error))
      throw RunError("The balance of heat is not finite at time " + std::to_string(clock.time) +
                     ": densities, heat capacities or temperatures are beyond all numbers.");
  }

  template void check_energy_balance(const Model<2> &, const EnergyBalance &, const Clock &,
                                     double);
  template void check_energy_balance(const Model<3> &, const EnergyBalance &, const Clock &,
                                     double);
} // namespace tombolo
