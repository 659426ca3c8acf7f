// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/statics/rigid_modes.h>

#include <tombolo/base/input/parameter_scanner.h>
#include <tombolo/mesh/bodies.h>

#include <deal.II/base/mpi.h>
#include <deal.II/lac/lapack_full_matrix.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <vector>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    constexpr unsigned int n_rigid_modes = dim == 2 ? 3 : 6;

    /** Sums over the nodes of a body: number and places of held components, the largest distance,
     * what rigid motions move them. */
    using BodySums = std::map<types::global_dof_index, std::vector<double>>;

    BodySums sum_over_ranks(const BodySums &local, const MPI_Comm communicator)
    {
      BodySums result;
      for (const BodySums &of_rank : Utilities::MPI::all_gather(communicator, local))
        for (const auto &[body, values] : of_rank)
        {
          std::vector<double> &sums = result[body];
          sums.resize(values.size(), 0.);
          for (std::size_t i = 0; i < values.size(); ++i)
            sums[i] += values[i];
        }
      return result;
    }

    /** By mode: what it moves along component @p d at @p arm from the centre. */
    template <int dim>
    std::array<double, 6> motion_along(const unsigned int d, const std::array<double, 3> &arm)
    {
      std::array<double, 6> result{};
      result[d] = 1.;
      for (unsigned int mode = dim; mode < n_rigid_modes<dim>; ++mode)
      {
        const unsigned int c = dim == 2 ? 2 : mode - dim;
        const unsigned int a = (c + 1) % 3, b = (c + 2) % 3;
        result[mode] = d == a ? -arm[b] : d == b ? arm[a] : 0.;
      }
      return result;
    }

    template <int dim>
    std::vector<std::string> free_motions(const std::vector<double> &gram, const double extent)
    {
      constexpr unsigned int n = n_rigid_modes<dim>;
      LAPACKFullMatrix<double> matrix(n, n);
      double trace = 0;
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          matrix(i, j) = gram[i * n + j] / ((i < dim ? 1. : extent) * (j < dim ? 1. : extent));
      for (unsigned int i = 0; i < n; ++i)
        trace += matrix(i, i);
      const double small = 1e-12 * std::max(trace, 1e-300);
      std::vector<std::string> result;
      for (unsigned int i = 0; i < n; ++i)
        if (!(matrix(i, i) > small))
        {
          const unsigned int axis = i < dim ? i : dim == 2 ? 2 : i - dim;
          result.push_back(std::string(i < dim ? "move along " : "turn about ") + "xyz"[axis]);
        }
      matrix.compute_eigenvalues();
      std::size_t n_free = 0;
      for (unsigned int i = 0; i < n; ++i)
        n_free += matrix.eigenvalue(i).real() > small ? 0 : 1;
      if (n_free > result.size())
        result.emplace_back("turn about a point or an axis elsewhere");
      return result;
    }
  } // namespace

  template <int dim>
  std::string free_rigid_modes(const Model<dim> &model, const NodalVector &constrained)
  {
    std::optional<Bodies<dim>> of_elements;
    if (model.bodies == nullptr)
      of_elements.emplace(*model.nodes);
    const Bodies<dim> &bodies = of_elements ? *of_elements : *model.bodies;
    const NodePartition &partition = *model.state.partition();
    const NodalVector &position = model.state.position;

    BodySums places; // number of nodes, their sum, number of held components, their sum
    const auto for_nodes = [&](const auto &action)
    {
      for (unsigned int i = 0; i < partition.n_owned(); ++i)
        action(i, bodies.body_of(partition.global_index(i)));
    };
    for_nodes(
        [&](const unsigned int i, const types::global_dof_index body)
        {
          std::vector<double> &sums = places[body];
          sums.resize(8, 0.);
          sums[0] += 1.;
          for (unsigned int d = 0; d < dim; ++d)
            sums[1 + d] += position.node(i)[d];
          for (unsigned int held = 0; held < dim; ++held)
            if (constrained.node(i)[held] > 0.)
            {
              sums[4] += 1.;
              for (unsigned int d = 0; d < dim; ++d)
                sums[5 + d] += position.node(i)[d];
            }
        });
    places = sum_over_ranks(places, model.communicator);

    constexpr unsigned int n = n_rigid_modes<dim>;
    BodySums grams; // and the sum of squared distances from the middle of the nodes
    for_nodes(
        [&](const unsigned int i, const types::global_dof_index body)
        {
          const std::vector<double> &sums = places[body];
          std::vector<double> &gram = grams[body];
          gram.resize(n * n + 1, 0.);
          std::array<double, 3> arm{};
          for (unsigned int d = 0; d < dim; ++d)
          {
            arm[d] = sums[4] > 0. ? position.node(i)[d] - sums[5 + d] / sums[4] : 0.;
            const double from_middle = position.node(i)[d] - sums[1 + d] / sums[0];
            gram[n * n] += from_middle * from_middle / sums[0];
          }
          for (unsigned int held = 0; held < dim; ++held)
          {
            if (!(constrained.node(i)[held] > 0.))
              continue;
            const std::array<double, 6> motion = motion_along<dim>(held, arm);
            for (unsigned int a = 0; a < n; ++a)
              for (unsigned int b = 0; b < n; ++b)
                gram[a * n + b] += motion[a] * motion[b];
          }
        });
    grams = sum_over_ranks(grams, model.communicator);

    std::string result;
    for (const auto &[body, gram] : grams)
    {
      const std::vector<std::string> free = free_motions<dim>(gram, std::sqrt(gram[n * n]));
      if (free.empty())
        continue;
      std::ostringstream text;
      const std::vector<double> &sums = places[body];
      text << "the body around (" << sums[1] / sums[0];
      for (unsigned int d = 1; d < dim; ++d)
        text << ", " << sums[1 + d] / sums[0];
      text << ") can " << joined(free, ", ");
      result += (result.empty() ? "" : "; ") + text.str();
    }
    return result;
  }

  template std::string free_rigid_modes(const Model<2> &, const NodalVector &);
  template std::string free_rigid_modes(const Model<3> &, const NodalVector &);
} // namespace tombolo
