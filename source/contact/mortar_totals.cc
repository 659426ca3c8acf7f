// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_totals.h>

#include <tombolo/base/ordered_sum.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  ContactBalance MortarTotals<dim>::balance(const std::vector<MortarHistory<dim>> &histories,
                                            const MPI_Comm communicator) const
  {
    ContactBalance result;
    double elastic = 0, n_closed = 0, deepest = 0, area = 0;
    for (const MortarHistory<dim> &history : histories)
    {
      elastic += history.area * history.spring.elastic_energy();
      n_closed += history.spring.is_closed() ? 1. : 0.;
      area += history.spring.is_closed() ? history.area : 0.;
      deepest = std::max(deepest, history.spring.depth);
    }
    std::vector<double> sums{elastic, friction, damping, n_closed, conducted, area};
    const std::size_t first_vector = sums.size();
    for (unsigned int d = 0; d < dim; ++d)
      sums.insert(sums.end(), {force[d], impulse[d]});
    sums = ordered_sum(sums, communicator);
    result.elastic = sums[0];
    result.friction = sums[1];
    result.damping = sums[2];
    result.n_nodes = sums[3];
    result.conducted = sums[4];
    result.area = sums[5];
    for (unsigned int d = 0; d < dim; ++d)
    {
      result.force[d] = sums[first_vector + 2 * d];
      result.impulse[d] = sums[first_vector + 2 * d + 1];
    }
    result.penetration = Utilities::MPI::max(deepest, communicator);
    return result;
  }

  template struct MortarTotals<2>;
  template struct MortarTotals<3>;
} // namespace tombolo
