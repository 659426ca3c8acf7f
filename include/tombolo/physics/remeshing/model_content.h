// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/moment.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>

#include <array>

namespace tombolo
{
  /** The content of nodes, parts and processes over all ranks, to be compared before and after a
   * change of the mesh. */
  struct ModelContent
  {
    /** Of @p model between two steps. Collective. */
    template <int dim>
    static ModelContent of(const Model<dim> &model)
    {
      EnergyAccounts energies;
      std::array<double, 9> sums{};
      const unsigned int n_owned = model.state.partition()->n_owned();
      if (model.has_mechanics)
      {
        for (const Part<dim> &part : model.parts)
          energies.add(part.formulation->energies());
        for (const auto &process : model.processes)
          process->add_energies(energies);
        for (unsigned int i = 0; i < n_owned; ++i)
        {
          const double mass = *model.bridge->mass().node(i);
          const double *const v = model.state.unsmoothed_velocity.node(i);
          std::array<double, 3> momentum{}, angular{};
          for (unsigned int d = 0; d < dim; ++d)
          {
            sums[0] += 0.5 * mass * v[d] * v[d];
            momentum[d] = mass * v[d];
          }
          add_moment(model.state.position.node(i), momentum.data(), angular);
          for (unsigned int d = 0; d < 3; ++d)
          {
            sums[1 + d] += momentum[d];
            sums[4 + d] += angular[d];
          }
        }
      }
      if (model.heat)
      {
        for (unsigned int i = 0; i < n_owned; ++i)
        {
          const double pending = *model.heat->state.pending.node(i);
          sums[7] += *model.heat->state.enthalpy.node(i) + pending;
          sums[8] += *model.heat->state.next_enthalpy.node(i) + pending;
        }
      }
      sums = ordered_sum(sums, model.communicator);
      energies.sum_over_ranks(model.communicator);
      return {sums[0] + energies.total(),
              {{sums[1], sums[2], sums[3]}},
              {{sums[4], sums[5], sums[6]}},
              sums[7],
              sums[8]};
    }

    double energy = 0;                        ///< held and kinetic [M L^2/T^2]
    std::array<double, 3> momentum{};         ///< [M L/T]
    std::array<double, 3> angular_momentum{}; ///< about the origin [M L^2/T]
    double enthalpy = 0, next_enthalpy = 0;   ///< with pending heat [M L^2/T^2]
  };
} // namespace tombolo
