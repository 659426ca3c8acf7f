// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/lobpcg.h>

#include <tombolo/base/ordered_sum.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace tombolo
{
  namespace
  {
    template <std::size_t n>
    using Pairs = std::array<std::pair<const NodalVector *, const NodalVector *>, n>;

    /** Adds (a, b) of the nodes from @p begin to @p end in the inner product of M̂ to @p sums. */
    template <std::size_t n>
    void add_products(const NodalVector &mass, const Pairs<n> &pairs, const unsigned int begin,
                      const unsigned int end, std::array<double, n> &sums)
    {
      for (unsigned int i = begin; i < end; ++i)
        for (std::size_t k = 0; k < n; ++k)
        {
          const double *const a = pairs[k].first->node(i);
          const double *const b = pairs[k].second->node(i);
          sums[k] += *mass.node(i) * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
        }
    }

    /** (a, b) for several pairs with one exchange; the same on all ranks, in a fixed order. */
    template <std::size_t n>
    std::array<double, n> inner_products(const NodalVector &mass, const Pairs<n> &pairs)
    {
      std::array<double, n> local{};
      add_products(mass, pairs, 0, mass.partition()->n_owned(), local);
      return ordered_sum(local, mass.partition()->communicator());
    }

    void combine(const double a, NodalVector &x, const double b, const NodalVector &y)
    {
      const std::size_t n =
          static_cast<std::size_t>(x.partition()->n_local()) * x.n_slots_per_node();
      for (std::size_t i = 0; i < n; ++i)
        x.data()[i] = a * x.data()[i] + b * y.data()[i];
    }

    /** Calls @p set(first and last slot) for all nodes by blocks, and returns the inner products of
     * @p pairs, which are computed while a block is in the first cache. Collective. */
    template <std::size_t n, typename Set>
    std::array<double, n> sweep(const NodalVector &mass, const Pairs<n> &pairs, const Set &set)
    {
      constexpr unsigned int n_of_block = 64;
      const std::size_t n_slots = pairs[0].first->n_slots_per_node();
      const unsigned int n_owned = mass.partition()->n_owned();
      const unsigned int n_local = mass.partition()->n_local();
      std::array<double, n> local{};
      for (unsigned int begin = 0, end; begin < n_local; begin = end)
      {
        end = std::min(begin + n_of_block, begin < n_owned ? n_owned : n_local);
        set(begin * n_slots, end * n_slots);
        add_products(mass, pairs, begin, std::min(end, n_owned), local);
      }
      return ordered_sum(local, mass.partition()->communicator());
    }

    double inverse_norm(const double square)
    {
      return square > 0. ? 1. / std::sqrt(square) : 0.;
    }

    using Eigen::Matrix3d;

    /** The combination of three vectors with the largest Rayleigh quotient, by their inner products
     * (Gram matrix, zero in the row of a vector that is left out) and those of one with the image
     * of another; it keeps the sign of the first. */
    Eigen::Vector3d rayleigh_ritz(const Matrix3d &gram, const Matrix3d &projected)
    {
      // The eigenvectors of the Gram matrix with small eigenvalues are directions that the three
      // vectors do not really span.
      const Eigen::SelfAdjointEigenSolver<Matrix3d> gram_modes(gram);
      Matrix3d basis = Matrix3d::Zero();
      int size = 0;
      for (int k = 0; k < 3; ++k)
        if (gram_modes.eigenvalues()[k] > 1e-12)
          basis.col(size++) =
              gram_modes.eigenvectors().col(k) / std::sqrt(gram_modes.eigenvalues()[k]);
      Matrix3d reduced = basis.transpose() * projected * basis;
      // Columns without a vector stay below all others.
      for (const double bound = 2. * reduced.norm() + 1.; size < 3; ++size)
        reduced(size, size) = -bound;
      const Eigen::SelfAdjointEigenSolver<Matrix3d> ritz(reduced);
      const Eigen::Vector3d weights = basis * ritz.eigenvectors().col(2);
      return weights[0] < 0. ? Eigen::Vector3d(-weights) : weights;
    }

    /** The same of three normalized fields and their images, the last one of which may be missing.
     * Collective. */
    Eigen::Vector3d rayleigh_ritz(const NodalVector &mass,
                                  const std::array<const NodalVector *, 3> &field,
                                  const std::array<const NodalVector *, 3> &image,
                                  const bool has_third)
    {
      const auto products = inner_products<9>(mass, {{{field[0], field[1]},
                                                      {field[0], field[2]},
                                                      {field[1], field[2]},
                                                      {field[1], image[0]},
                                                      {field[2], image[0]},
                                                      {field[1], image[1]},
                                                      {field[2], image[1]},
                                                      {field[2], image[2]},
                                                      {field[0], image[0]}}});
      Matrix3d gram, projected;
      gram << 1., products[0], products[1], products[0], 1., products[2], products[1], products[2],
          1.;
      if (!has_third)
      {
        gram.row(2).setZero();
        gram.col(2).setZero();
      }
      projected << products[8], products[3], products[4], products[3], products[5], products[6],
          products[4], products[6], products[7];
      return rayleigh_ritz(gram, projected);
    }

    /** A number in (-1, 1) that depends on the position alone: the start vector is the same on any
     * number of ranks. */
    double noise(const double *position, const unsigned int component)
    {
      std::uint64_t hash = 0x9E3779B97F4A7C15ull * (component + 1);
      for (unsigned int d = 0; d < 3; ++d)
      {
        std::uint64_t bits;
        std::memcpy(&bits, position + d, sizeof(bits));
        hash ^= bits + 0x9E3779B97F4A7C15ull + (hash << 6) + (hash >> 2);
        hash = (hash ^ (hash >> 30)) * 0xBF58476D1CE4E5B9ull;
        hash = (hash ^ (hash >> 27)) * 0x94D049BB133111EBull;
        hash ^= hash >> 31;
      }
      return 2. * (static_cast<double>(hash >> 11) * 0x1.0p-53) - 1.;
    }
  } // namespace

  Lobpcg::Lobpcg(const double tolerance, const unsigned int max_iterations, const Quantity quantity)
      : tolerance(tolerance), max_iterations(max_iterations), quantity(quantity)
  {}

  void Lobpcg::set_partition(const std::shared_ptr<const NodePartition> &partition)
  {
    if (mode.partition() == nullptr)
      mode.reinit(partition, quantity);
    else if (mode.partition() != partition)
      mode.move_to(partition);
  }

  Lobpcg::Stop Lobpcg::from_noise(const double n_unknowns) const
  {
    // For n unknowns a Krylov space of dimension k, started from noise, misses the relative gap ε
    // with a probability below 1.65 √n exp(-√ε (2k - 1)): here 1e-3 for ε = 0.05, half of which is
    // missed in the step.
    return {static_cast<unsigned int>(
                0.5 * (1. + std::log(1.65e3 * std::sqrt(n_unknowns)) / std::sqrt(0.05))),
            10, tolerance};
  }

  void Lobpcg::add_noise(const NodalVector &mass, const NodalVector &initial_position,
                         const unsigned int n_components, const double share,
                         const unsigned int seed)
  {
    NodalVector random(mode.partition(), quantity);
    for (unsigned int i = 0; i < mode.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < n_components; ++d)
        random.node(i)[d] = noise(initial_position.node(i), 3 * seed + d);
    add(mass, random, share);
  }

  void Lobpcg::add(const NodalVector &mass, const NodalVector &field, const double share)
  {
    const auto products = inner_products<2>(mass, {{{&mode, &mode}, {&field, &field}}});
    combine(inverse_norm(products[0]), mode, products[1] > 0. ? share / std::sqrt(products[1]) : 0.,
            field);
    // The norm has no part of nodes without mass.
    mode.fill(
        [&](const unsigned int i, double *const value)
        {
          if (*mass.node(i) == 0.)
            std::fill_n(value, node_stride, 0.);
        });
  }

  double Lobpcg::rayleigh_quotient(const NodalVector &mass, const Operator &apply) const
  {
    NodalVector image(mode.partition(), quantity);
    apply(mode, image);
    const auto products = inner_products<2>(mass, {{{&mode, &image}, {&mode, &mode}}});
    return products[0] / products[1];
  }

  double Lobpcg::find(const NodalVector &mass, const Operator &apply, const Stop &stop)
  {
    NodalVector image, residual, residual_image, direction, direction_image;
    for (NodalVector *vector : {&image, &residual, &residual_image, &direction, &direction_image})
      vector->reinit(mode.partition(), quantity);

    combine(inverse_norm(inner_products<1>(mass, {{{&mode, &mode}}})[0]), mode, 0., mode);
    apply(mode, image);
    double eigenvalue = inner_products<1>(mass, {{{&mode, &image}}})[0];
    std::vector<double> history{eigenvalue};
    bool has_direction = false;
    for (unsigned int iteration = 0; iteration < max_iterations; ++iteration)
    {
      double *const x = mode.data(), *const r = residual.data(), *const d = direction.data();
      double *const x_image = image.data(), *const r_image = residual_image.data(),
                    *const d_image = direction_image.data();
      const double square = sweep<1>(mass, {{{&residual, &residual}}},
                                     [&](const std::size_t first, const std::size_t last)
                                     {
                                       for (std::size_t i = first; i < last; ++i)
                                         r[i] = x_image[i] - eigenvalue * x[i];
                                     })[0];
      combine(inverse_norm(square), residual, 0., residual);
      if (!(std::sqrt(square) > 1e-10 * std::abs(eigenvalue)))
        break;
      apply(residual, residual_image);

      const Eigen::Vector3d weights =
          rayleigh_ritz(mass, {{&mode, &residual, &direction}},
                        {{&image, &residual_image, &direction_image}}, has_direction);
      // direction = the increment of the old mode
      const double a = weights[0], b = weights[1], c = weights[2];
      const auto squares = sweep<2>(mass, {{{&mode, &mode}, {&direction, &direction}}},
                                    [&](const std::size_t first, const std::size_t last)
                                    {
                                      for (std::size_t i = first; i < last; ++i)
                                      {
                                        d[i] = c * d[i] + b * r[i];
                                        x[i] = a * x[i] + d[i];
                                      }
                                      for (std::size_t i = first; i < last; ++i)
                                      {
                                        d_image[i] = c * d_image[i] + b * r_image[i];
                                        x_image[i] = a * x_image[i] + d_image[i];
                                      }
                                    });
      const double mode_scale = inverse_norm(squares[0]),
                   direction_scale = inverse_norm(squares[1]);
      eigenvalue = sweep<1>(mass, {{{&mode, &image}}},
                            [&](const std::size_t first, const std::size_t last)
                            {
                              for (std::size_t i = first; i < last; ++i)
                              {
                                x[i] *= mode_scale;
                                x_image[i] *= mode_scale;
                                d[i] *= direction_scale;
                                d_image[i] *= direction_scale;
                              }
                            })[0];
      has_direction = true;
      history.push_back(eigenvalue);
      if (history.size() > std::max(stop.look_back, stop.min_iterations) &&
          eigenvalue - history[history.size() - 1 - stop.look_back] < stop.growth * eigenvalue)
        break;
    }
    mode.update_ghosts();
    return eigenvalue;
  }
} // namespace tombolo
