// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/particles/pair_conduction.h>
#include <tombolo/formulations/particles/pair_terms.h>
#include <tombolo/formulations/particles/particle_formulation.h>

namespace tombolo
{
  /** What particle formulations have whose particles act on each other in pairs, beside what their
   * rows do: with radial kernels. */
  template <int dim>
  class PairInteractions
  {
  public:
    virtual ~PairInteractions() = default;

    /** Forces and motion of pairs. */
    virtual const PairTerms<dim> &pair_terms() const = 0;

    /** The pairs, with the present volumes. Valid until the partition, the rows or the points of
     * the part change. */
    virtual PairRows pair_rows() const = 0;

    /** Where heat is conducted between pairs and not by the gradients of the rows, calls @p visit
     * for the local numbers and conductances of all pairs of the rows, and returns true. Arguments
     * as in Formulation::add_conduction(). */
    virtual bool visit_conductances(const NodalVector &position, const NodalVector &of_conductivity,
                                    const typename PairConduction<dim>::Visitor &visit) const = 0;
  };
} // namespace tombolo
