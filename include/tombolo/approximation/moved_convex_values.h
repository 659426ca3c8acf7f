// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>
#include <tombolo/base/simd/eight_doubles.h>

#include <deal.II/base/point.h>

#include <array>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * Values of ConvexApproximation::evaluate_moved() at up to eight places with the same neighbours,
   * one a lane: the same functions to round-off. Newton's method takes whole steps only, and gives
   * up a place where one is not accepted.
   */
  template <int dim>
  class MovedConvexValues
  {
  public:
    static constexpr unsigned int most_places = 8;

    explicit MovedConvexValues(std::shared_ptr<const Kernel> kernel);

    /** @p n neighbours of all places, with arrays as of ConvexApproximation::evaluate_moved(). */
    void set_neighbours(unsigned int n, const double *position, const double *support,
                        const double *present);

    using Places = std::array<dealii::Point<dim>, most_places>;

    /** At @p n places @p x, which are now at @p present_x. Returns those that have values, as
     * bits. */
    unsigned int evaluate(unsigned int n, const Places &x, const Places &present_x);

    /** The number of neighbours whose supports reach a place. */
    unsigned int n_values(const unsigned int place) const
    {
      return n_active[place];
    }

    /** The neighbour of a value, below n_values(); ascending. */
    unsigned int neighbour(const unsigned int place, const unsigned int k) const
    {
      return numbers[k * most_places + place];
    }

    double value(const unsigned int place, const unsigned int k) const
    {
      return basis_value[k * most_places + place];
    }

  private:
    /** F = Σ w exp, r and the lower half of the Hessian at one λ a lane. */
    struct Sums
    {
      EightDoubles total, residual[dim], hessian[dim * (dim + 1) / 2];
    };

    void find_neighbours(unsigned int place, const dealii::Point<dim> &x,
                         const dealii::Point<dim> &present_x);
    void find_weights();
    void find_basis(const EightDoubles (&multiplier)[dim]);
    Sums sums_at(const EightDoubles (&multiplier)[dim]);

    /** |r| / Σ w exp */
    static EightDoubles norm_of(const Sums &sums);
    /** Newton's step; returns its product with r. */
    static EightDoubles find_step(const Sums &sums, EightDoubles (&step)[dim]);

    std::shared_ptr<const Kernel> kernel;
    // Of neighbours, padded to multiples of eight by ones that reach nothing.
    std::array<std::vector<double>, dim> initial, inverse_support, moved;
    std::size_t n_neighbours = 0;

    // Of those that reach a place, by row, component and lane: rows of a lane beyond its own ones
    // have no weight.
    std::size_t n_rows = 0;
    std::array<unsigned int, most_places> n_active{};
    std::vector<unsigned int> numbers;
    std::vector<double> coordinate, offset, factor, slope;
    std::vector<double> weight, basis_value; // by row and lane
  };
} // namespace tombolo
