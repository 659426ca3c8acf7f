// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "cloud_functions.h"

#include <mpi.h>

#include <map>
#include <optional>
#include <vector>

namespace tombolo
{
  /** Points that carry values, or targets of values, of this rank. */
  template <int dim>
  struct Cloud
  {
    std::vector<dealii::Point<dim>> positions;
    std::vector<double> bodies;                  ///< the numbers of the bodies they belong to
    std::vector<dealii::Tensor<2, dim>> metrics; ///< of CloudFunctions [1/L]; not of targets
  };

  /**
   * Interpolation from a cloud of points to other points, as in the remap of Wu et al. 2015,
   * eqs (68), (69), (73) and (74): with the functions φ of CloudFunctions
   *
   * @verbatim
   *   s(x) = Σ_j φ_j(x) s̃_j,   Σ_j φ_j(x_k) s̃_j = s_k
   * @endverbatim
   *
   * At the points themselves s has their values, and linear fields are reproduced inside of the
   * hull of the cloud. Bodies are independent.
   */
  template <int dim>
  class CloudInterpolation
  {
  public:
    /** From @p cloud to @p targets. Throws a RunError for a target without a point near it.
     * Collective. */
    CloudInterpolation(const Cloud<dim> &cloud, const Cloud<dim> &targets, MPI_Comm communicator);

    /** Values at the targets, from those at the points of this rank, @p n each, by point and
     * component. Throws a RunError where the second equation is not solved. Collective. */
    std::vector<double> interpolate(const std::vector<double> &values, unsigned int n) const;

    /** Puts @p at_targets within the values of the points around, and the second invariant of the
     * stress whose six components begin at @p stress within theirs. Collective. */
    void limit(const std::vector<double> &values, unsigned int n,
               const std::optional<unsigned int> &stress, std::vector<double> &at_targets) const;

  private:
    /** φ of points: the neighbours of point i are those from start[i] to start[i + 1]. */
    struct Rows
    {
      std::vector<std::size_t> start{0};
      std::vector<unsigned int> neighbour; // own points come first, then those of other ranks
      std::vector<double> value;
    };
    class Builder;

    /** Sends points to ranks with targets within twice their supports. Returns what others have
     * sent. */
    Cloud<dim> exchange(const Cloud<dim> &cloud, const Cloud<dim> &targets);

    /** @p n values of each of the own and the other points. Collective. */
    std::vector<double> with_others(const std::vector<double> &values, unsigned int n) const;

    /** The values of Σ φ s̃ at the points of @p rows, from @p n coefficients of each own point.
     * Collective. */
    std::vector<double> apply(const Rows &rows, const std::vector<double> &own_coefficients,
                              unsigned int n) const;
    std::vector<double> residual_of(const std::vector<double> &coefficients,
                                    const std::vector<double> &values, unsigned int n) const;
    /** s̃. Collective. */
    std::vector<double> coefficients_of(const std::vector<double> &values, unsigned int n) const;

    std::size_t n_points;
    std::map<unsigned int, std::vector<unsigned int>> sent; // own points, by rank
    Rows point_rows, target_rows;
    MPI_Comm communicator;
  };
} // namespace tombolo
