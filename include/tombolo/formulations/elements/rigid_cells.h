// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

namespace tombolo
{
  /** Mass, centre of mass and second moments of mass about that centre, in three dimensions also
   * where the body is plane: components out of the plane are zero then. */
  struct MassMoments
  {
    double mass = 0;               ///< ∫ρ dV [M]
    dealii::Tensor<1, 3> centre;   ///< ∫ρ x dV / ∫ρ dV [L]
    dealii::Tensor<2, 3> second;   ///< ∫ρ r ⊗ r dV with r = x - centre [M L^2]
    double smallest_jacobian = 0.; ///< of the points of integration; not positive: a cell is bad
  };

  /** The tensor of inertia tr(D) I - D of second moments D [M L^2]. */
  inline dealii::Tensor<2, 3> inertia_of(const dealii::Tensor<2, 3> &second_moment)
  {
    dealii::Tensor<2, 3> result = -1. * second_moment;
    for (unsigned int d = 0; d < 3; ++d)
      result[d][d] += dealii::trace(second_moment);
    return result;
  }

  /** A part that moves as one rigid body, from outside. It has no stress and limits no step. */
  template <int dim>
  class RigidCells
  {
  public:
    virtual ~RigidCells() = default;

    /** Of all cells, over all ranks, by integration that is exact in cells with straight edges:
     * nodal masses have larger second moments. After Formulation::initialize(). */
    virtual const MassMoments &mass_moments() const = 0;
  };
} // namespace tombolo
