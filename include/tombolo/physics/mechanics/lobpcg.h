// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/nodal_vector.h>

#include <functional>
#include <memory>

namespace tombolo
{
  /**
   * The largest eigenvalue of an operator that is self-adjoint in the inner product of nodal
   * masses, by the locally optimal conjugate gradient method (Knyazev 2001) without preconditioner,
   * on three vectors: the estimate, its residual and the last direction. It is approached from
   * below. A later call starts from the last eigenvector.
   */
  class Lobpcg
  {
  public:
    /** image = A field; @p field has current ghosts, owned values of @p image are set. */
    using Operator = std::function<void(const NodalVector &field, NodalVector &image)>;

    /** The iteration ends when the eigenvalue has grown by less than @p tolerance over ten
     * iterations (four, where few are asked for at least), or after @p max_iterations. */
    Lobpcg(double tolerance, unsigned int max_iterations, Quantity quantity = Quantity::vector);

    /** Makes the mode, zero, or moves it. Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);

    /** mode = mode / |mode| + share * noise of that norm, in the first components; the noise
     * follows from the positions alone. @p mass is scalar. Collective. */
    void add_noise(const NodalVector &mass, const NodalVector &initial_position,
                   unsigned int n_components, double share, unsigned int seed);

    /** mode = mode / |mode| + share * @p field / |field|; @p field with owned values. Collective.
     */
    void add(const NodalVector &mass, const NodalVector &field, double share);

    /** Collective. */
    double find(const NodalVector &mass, const Operator &apply, unsigned int min_iterations);

    /** Of the mode as it is. Collective. */
    double rayleigh_quotient(const NodalVector &mass, const Operator &apply) const;

    /** As many iterations as a Krylov space from noise needs for any spectrum, however dense its
     * upper end (Kuczyński and Woźniakowski 1992). */
    static unsigned int sufficient_iterations(double n_unknowns);

    NodalVector mode;

  private:
    double tolerance;
    unsigned int max_iterations;
    Quantity quantity;
  };
} // namespace tombolo
