// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/internal_power.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/model/assembly.h>
#include <tombolo/model/trial.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <limits>

namespace tombolo
{
  template <int dim>
  double internal_power(const Model<dim> &model, const double step)
  {
    const NodalState &state = model.state;
    Trial<dim> trial(model); // undone at its end
    NodalVector force(state.partition());
    bool is_known = true;
    const NodalVector *const temperature =
        model.heat ? &model.heat->state.present_temperature : nullptr;
    Assembly<dim>(model.parts)
        .assemble(*model.bridge, state.velocity, force,
                  [&](const Part<dim> &part, const NodalVector &velocity, NodalVector &result)
                  {
                    // In so short a time stresses stay, at the rates that they have.
                    constexpr double moment = 1e-6;
                    try
                    {
                      part.formulation->add_internal_force(
                          {&state.position, &velocity, moment * step, temperature}, result);
                    }
                    catch (const RunError &)
                    {
                      // The forces of the step, which follow, fail too and notify all ranks,
                      // unless the change isolates the particle.
                      is_known = false;
                    }
                  });
    double power = is_known ? 0. : std::numeric_limits<double>::quiet_NaN();
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        power -= force.node(i)[d] * state.velocity.node(i)[d];
    return power;
  }

  double energy_of_change(const double before, const double after, const double step,
                          const MPI_Comm communicator)
  {
    const double dissipated = 0.5 * step * (before - after);
    return std::isfinite(dealii::Utilities::MPI::sum(dissipated, communicator)) ? dissipated : 0.;
  }

  template double internal_power(const Model<2> &, double);
  template double internal_power(const Model<3> &, double);
} // namespace tombolo
