// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/state/nodal_vector.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** What it took to make gradients consistent, and how far they still are from it. Defects are
   * |b - Σ_I V_I G_I| / |b|, in the Euclidean norm over all nodes. */
  struct GradientConsistency
  {
    unsigned int iterations = 0;
    double defect_before = 0;
    double defect = 0;
    bool converged = true;
  };

  /** How far the gradients of a part are from passing the linear patch test. */
  struct PatchTest
  {
    bool is_known = false;
    double defect = 0; ///< ConsistentGradients::defect()
    /** What made them consistent; null where they are those of the shape functions. */
    const GradientConsistency *consistency = nullptr;
    std::string cure; ///< the entry that would take the defect away; empty: there is none
  };

  /**
   * Gradients G that pass the linear patch test of the nodally integrated Galerkin form. Rows of
   * moving least squares differentiate linear functions exactly, Σ_J G_IJ ⊗ (x_J - x_I) = 1; but a
   * constant stress makes no force inside, and at the boundary that of its traction alone, only if
   *
   *   Σ_I V_I G_IJ = b_J
   *
   * where b_J is the vector area of the boundary that belongs to J. The smallest change of G in
   * ½ Σ_I V_I Σ_J |δG_IJ|² / w_IJ, w = √|φ_J(x_I)|, that brings it there and keeps the rows is
   * δG_IJ = w_IJ (μ_J - fit_I[μ](x_J)), with the linear least squares fit of μ over the neighbours
   * of I in the weight w. The vectors μ solve a symmetric positive semidefinite system, which
   * behaves as a biharmonic one and whose null space is that of the linear functions. One G serves
   * trial and test functions as before, so that all proofs of conservation stand.
   *
   * The condition number grows with the fourth power of the number of particles along the body; b
   * differs from the integral near the boundary and in disorder only.
   */
  template <int dim>
  struct ConsistentGradients
  {
    /**
     * Changes the gradients of @p shape (the rows of this rank; entries with φ = 0 and rigid rows
     * stay as they are) until the defect is below @p tolerance, by conjugate gradients.
     * @p volume is V of each row, @p position where the shape functions were taken, with current
     * ghosts, @p boundary the vectors b of owned nodes. Where b is not compatible with the volumes
     * (Σ b_J ⊗ x_J = ΣV 1 per connected body), the defect that linear functions see stays, and
     * others down to a tenth of it. The same bits for the same number of ranks. Collective.
     */
    static GradientConsistency establish(const std::vector<double> &volume,
                                         const NodalVector &position, const NodalVector &boundary,
                                         double tolerance, unsigned int largest_n_iterations,
                                         Stencils &shape);

    /** The defect of gradients as they are, |b - Σ_I V_I G_I| / |b|; zero where b is. Arguments as
     * above. Collective. */
    static double defect(const std::vector<double> &volume, const NodalVector &boundary,
                         const Stencils &shape);
  };
} // namespace tombolo
