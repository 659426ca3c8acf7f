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

    /** An iteration ends, after at least so many steps, when the eigenvalue has grown by less than
     * this fraction over the last ones. */
    struct Stop
    {
      unsigned int min_iterations, look_back;
      double growth;
    };

    /** Iterations end by @p tolerance, or after @p max_iterations. */
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
    double find(const NodalVector &mass, const Operator &apply, const Stop &stop);

    /** Of the mode as it is. Collective. */
    double rayleigh_quotient(const NodalVector &mass, const Operator &apply) const;

    /** For a mode that was noise: as many iterations as a Krylov space needs for any spectrum,
     * however dense its upper end (Kuczyński and Woźniakowski 1992), and growth by less than the
     * tolerance over ten. */
    Stop from_noise(double n_unknowns) const;
    /** For a later call: growth by less than the tolerance over four iterations. */
    Stop from_last_mode() const
    {
      return {6, 4, tolerance};
    }
    /** Until the eigenvalue grows by less than one percent over four iterations. */
    static Stop to_one_percent()
    {
      return {6, 4, 0.01};
    }

    NodalVector mode;

  private:
    double tolerance;
    unsigned int max_iterations;
    Quantity quantity;
  };
} // namespace tombolo
