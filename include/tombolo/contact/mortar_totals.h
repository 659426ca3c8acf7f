// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_balance.h>
#include <tombolo/contact/mortar_history.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>

#include <vector>

namespace tombolo
{
  /** Sums of one rank over the forces of a mortar contact on its slave: the force at t_n, and
   * impulse, heat and work since the start. */
  template <int dim>
  struct MortarTotals
  {
    dealii::Tensor<1, dim> force;   ///< at t_n [M L/T^2]
    dealii::Tensor<1, dim> impulse; ///< since the start [M L/T]
    double friction = 0;            ///< heat of friction, likewise [M L^2/T^2]
    double damping = 0;             ///< taken by damping, likewise
    double conducted = 0;           ///< heat into the slave, likewise

    /** The sums over ranks of these and of owned nodes with @p histories. Collective. */
    ContactBalance balance(const std::vector<MortarHistory<dim>> &histories,
                           MPI_Comm communicator) const;

    /** What a checkpoint keeps. */
    std::vector<double *> shares()
    {
      std::vector<double *> result{&friction, &damping, &conducted};
      for (unsigned int d = 0; d < dim; ++d)
      {
        result.push_back(&impulse[d]);
        result.push_back(&force[d]);
      }
      return result;
    }
  };
} // namespace tombolo
