// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <string>

namespace tombolo
{
  /** The functions Γ of ConvexApproximation. */
  enum class ConvexBasis
  {
    exponential,       ///< Γ = exp(t): the functions of largest entropy
    inverse_tangent,   ///< Γ = 1 + 2/π atan(t): those of Wu et al. 2015
    hyperbolic_tangent ///< Γ = 1 + tanh(t)
  };

  /** The names of all bases, as a parameter file has them, separated by |. */
  std::string convex_basis_selection();

  /** Throws for a name that convex_basis_selection() does not have. */
  ConvexBasis convex_basis_of(const std::string &name);

  /** Γ in the place of its @p n arguments in @p value, its derivative and its integral. @p n is a
   * multiple of eight. */
  void evaluate_convex_basis(ConvexBasis basis, std::size_t n, double *value, double *slope,
                             double *integral);
} // namespace tombolo
