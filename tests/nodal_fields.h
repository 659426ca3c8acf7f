// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace testing
  {
    /** A vector of @p value(initial position of the node, component), with current ghosts. */
    template <int dim, typename Value>
    NodalVector vector_field(const Model<dim> &model, const Value &value)
    {
      return nodal_field(model.state.partition(), Quantity::vector,
                         [&](const unsigned int i, double *const components)
                         {
                           for (unsigned int d = 0; d < dim; ++d)
                             components[d] = value(model.state.initial_position.node(i), d);
                         });
    }

    /** A vector without any order, another one for each @p seed. */
    template <int dim>
    NodalVector disordered_field(const Model<dim> &model, const double seed = 0.)
    {
      return vector_field(
          model, [&](const double *const x, const unsigned int d)
          { return std::sin(91.7 * x[0] + 57.3 * x[1] + 31.1 * x[2] + 17. * d + seed); });
    }

    /** Σ w a b over nodes and components; the weight is a scalar or has as many components. */
    inline double weighted_product(const NodalVector &weight, const NodalVector &a,
                                   const NodalVector &b)
    {
      const bool is_scalar = weight.n_slots_per_node() == 1;
      double sum = 0;
      for (unsigned int i = 0; i < a.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < 3; ++d)
          sum += weight.node(i)[is_scalar ? 0 : d] * a.node(i)[d] * b.node(i)[d];
      return dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
    }

    /** The sum of a component over the nodes of all ranks. */
    inline double sum_of_nodes(const NodalVector &vector, const unsigned int component = 0)
    {
      double sum = 0;
      for (unsigned int i = 0; i < vector.partition()->n_owned(); ++i)
        sum += vector.node(i)[component];
      return dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
    }

    /** The largest difference of components at the nodes of all ranks; no number where one is not
     * finite, so that no bound holds. */
    inline double largest_difference(const NodalVector &a, const NodalVector &b)
    {
      const unsigned int n_components = std::min(a.n_slots_per_node(), 3u);
      double largest = 0, is_infinite = 0;
      for (unsigned int i = 0; i < a.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < n_components; ++d)
        {
          const double difference = std::abs(a.node(i)[d] - b.node(i)[d]);
          largest = std::max(largest, difference);
          is_infinite = std::isfinite(difference) ? is_infinite : 1.;
        }
      const double largest_of_all = dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
      const bool all_are_finite = dealii::Utilities::MPI::max(is_infinite, MPI_COMM_WORLD) == 0.;
      return all_are_finite ? largest_of_all : std::nan("");
    }

    /** The largest component at the nodes of all ranks. */
    inline double largest_magnitude(const NodalVector &a)
    {
      NodalVector zero;
      zero.reinit_like(a);
      return largest_difference(a, zero);
    }
  } // namespace testing
} // namespace tombolo
