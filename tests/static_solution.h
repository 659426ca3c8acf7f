// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <cmath>
#include <functional>

namespace tombolo
{
  namespace testing
  {
    /** A linear problem on the nodes of a model: the elastic displacement, or the temperature, of
     * given values at some nodes and given loads, by conjugate gradients. */
    template <int dim>
    struct StaticProblem
    {
      using Field = std::function<dealii::Tensor<1, dim>(const dealii::Point<dim> &)>;

      /** Adds +K v to the second vector; ghosts of the first are current. */
      std::function<void(const NodalVector &, NodalVector &)> apply;
      Field exact; ///< also the prescribed values
      Field load;  ///< per mass
      std::function<bool(const dealii::Point<dim> &, unsigned int)> is_prescribed;
      unsigned int n_components = dim;
    };

    /** The error of the solution at the nodes, weighted with their masses, over the solution. */
    template <int dim>
    double relative_error(const Model<dim> &model, const StaticProblem<dim> &problem)
    {
      const NodalVector &mass = model.state.mass;
      const unsigned int n_owned = model.state.partition()->n_owned();
      const auto make = [&]
      {
        NodalVector vector(model.state.partition(), Quantity::scalars);
        return vector;
      };
      const auto position_of = [&](const unsigned int i)
      {
        dealii::Point<dim> x;
        for (unsigned int d = 0; d < dim; ++d)
          x[d] = model.state.position.node(i)[d];
        return x;
      };
      const auto for_components = [&](const auto &use)
      {
        for (unsigned int i = 0; i < n_owned; ++i)
          for (unsigned int c = 0; c < problem.n_components; ++c)
            use(i, c);
      };
      NodalVector solution = make(), residual = make(), direction = make(), image = make();
      const auto apply = [&](NodalVector &vector)
      {
        vector.update_ghosts();
        image.set_zero();
        problem.apply(vector, image);
        image.add_to_owners();
        for_components(
            [&](const unsigned int i, const unsigned int c)
            {
              if (problem.is_prescribed(position_of(i), c))
                image.node(i)[c] = 0.;
            });
      };
      for_components(
          [&](const unsigned int i, const unsigned int c)
          {
            if (problem.is_prescribed(position_of(i), c))
              solution.node(i)[c] = problem.exact(position_of(i))[c];
          });
      apply(solution);
      for_components(
          [&](const unsigned int i, const unsigned int c)
          {
            if (!problem.is_prescribed(position_of(i), c))
              residual.node(i)[c] =
                  *mass.node(i) * problem.load(position_of(i))[c] - image.node(i)[c];
          });
      direction.copy_from(residual);
      double square = residual.dot(residual);
      const double target = 1e-20 * square;
      for (unsigned int iteration = 0; iteration < 5000 && square > target; ++iteration)
      {
        apply(direction);
        const double step = square / direction.dot(image);
        for_components(
            [&](const unsigned int i, const unsigned int c)
            {
              solution.node(i)[c] += step * direction.node(i)[c];
              residual.node(i)[c] -= step * image.node(i)[c];
            });
        const double next = residual.dot(residual);
        for_components(
            [&](const unsigned int i, const unsigned int c)
            { direction.node(i)[c] = residual.node(i)[c] + next / square * direction.node(i)[c]; });
        square = next;
      }
      AssertThrow(!(square > target), dealii::ExcMessage("The iteration has not converged."));
      double error = 0, scale = 0;
      for_components(
          [&](const unsigned int i, const unsigned int c)
          {
            const double exact = problem.exact(position_of(i))[c];
            error += *mass.node(i) * std::pow(solution.node(i)[c] - exact, 2);
            scale += *mass.node(i) * std::pow(exact, 2);
          });
      return std::sqrt(dealii::Utilities::MPI::sum(error, MPI_COMM_WORLD) /
                       dealii::Utilities::MPI::sum(scale, MPI_COMM_WORLD));
    }
  } // namespace testing
} // namespace tombolo
