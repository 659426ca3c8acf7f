// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <array>

namespace tombolo
{
  /**
   * Rotations of rigid bodies and the momentum of a step of them. With the rotations R_n at t_n and
   * R_{n+1} = R_n exp(f^), the nodes of a body that move straight from their positions at t_n to
   * those at t_{n+1} have the angular momentum about the centre
   *
   * @verbatim
   *   L = R_n g(f)/Δt,   g(f) = (sin φ/φ) J f + ((1 - cos φ)/φ²) f × J f,   φ = |f|
   * @endverbatim
   *
   * with the tensor of inertia J in the body's own axes (Moser and Veselov, Commun. Math. Phys.
   * 139, 217-243, 1991; in this form Lee, Leok and McClamroch, Comput. Methods Appl. Mech. Engrg.
   * 196, 2907-2924, 2007). The step that follows from L is the one of central differences with
   * rigid links between the nodes: it keeps L exactly and its energy does not drift.
   */
  namespace rigid_rotation
  {
    using Vector = dealii::Tensor<1, 3>;
    using Matrix = dealii::Tensor<2, 3>;
    using Quaternion = std::array<double, 4>; ///< (cos φ/2, axis sin φ/2), of length one

    /** The matrix of the cross product with a vector. */
    Matrix cross_matrix(const Vector &vector);

    /** The rotation by a rotation vector: its direction is the axis, its length the angle. */
    Matrix exponential(const Vector &rotation);

    /** exponential() less the identity, with all digits of small rotations. */
    Matrix exponential_less_one(const Vector &rotation);

    /** The rotation @p first followed, in the axes turned by it, by a rotation vector. Of length
     * one. */
    Quaternion turned(const Quaternion &first, const Vector &then);

    Matrix matrix_of(const Quaternion &quaternion);

    /** The rotation vector, of a length up to π. */
    Vector rotation_vector(const Quaternion &quaternion);

    /** g(f) above. */
    Vector discrete_momentum(const Matrix &inertia, const Vector &rotation);

    /** The rotation f with g(f) = @p momentum, by Newton's method from J⁻¹ @p momentum. Returns
     * whether there is one: the body must not turn too far in a step. */
    bool find_rotation(const Matrix &inertia, const Vector &momentum, Vector &rotation);
  } // namespace rigid_rotation
} // namespace tombolo
