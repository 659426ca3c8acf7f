// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/logarithmic_strain.h>
#include <tombolo/materials/tensor_function.h>

namespace tombolo
{
  MotionIncrement<Lanes> logarithmic_increment(const Matrix3<Lanes> &h,
                                               const Compliance &compliance, Lanes (&stress)[6])
  {
    MotionIncrement<Lanes> motion;
    // With the invariants of H, det(I - H) and det(I - H/2), and with its symmetric part S and the
    // axial vector a of H - Hᵀ the spin, (a - ½ S a) / (2 det(I - H/2)).
    const Lanes first = h(0, 0) + h(1, 1) + h(2, 2);
    const Lanes second = h(0, 0) * h(1, 1) - h(0, 1) * h(1, 0) + h(0, 0) * h(2, 2) -
                         h(0, 2) * h(2, 0) + h(1, 1) * h(2, 2) - h(1, 2) * h(2, 1);
    const Lanes third = determinant(h);
    motion.volume_factor = 1. / (1. - first + second - third);
    const Lanes factor = 0.5 / (1. - 0.5 * first + 0.25 * second - 0.125 * third);
    const Lanes a[3] = {h(2, 1) - h(1, 2), h(0, 2) - h(2, 0), h(1, 0) - h(0, 1)};
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < 3; ++i)
    {
      const unsigned int j = (i + 1) % 3, k = (i + 2) % 3;
      motion.spin[i] = factor * (a[i] - 0.5 * h(i, i) * a[i] -
                                 0.25 * ((h(i, j) + h(j, i)) * a[j] + (h(i, k) + h(k, i)) * a[k]));
    }

    const Lanes mean = (stress[0] + stress[1] + stress[2]) * (1. / 3.);
    const Lanes volumetric = mean * compliance.volumetric;
    SymmetricTensor3 old;
    TOMBOLO_UNROLL
    for (unsigned int c = 0; c < 6; ++c)
    {
      if (c < 3)
        stress[c] -= mean;
      old.entry[c] = stress[c] * compliance.deviatoric;
      if (c < 3)
        old.entry[c] += volumetric;
    }
    const SymmetricTensor3 k = function_of<InverseStretch>(old);

    // b⁻¹ - I = K - Pᵀ - (I - H)ᵀ P, P = (I + K) H, K = exp(-2ε) - I, in which nothing is lost of
    // small strains.
    Matrix3<Lanes> p;
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < 3; ++i)
      TOMBOLO_UNROLL
    for (unsigned int j = 0; j < 3; ++j)
      p(i, j) = h(i, j) + k(i, 0) * h(0, j) + k(i, 1) * h(1, j) + k(i, 2) * h(2, j);
    SymmetricTensor3 inverse;
    TOMBOLO_UNROLL
    for (unsigned int c = 0; c < 6; ++c)
    {
      const unsigned int i = SymmetricTensor3::row[c], j = SymmetricTensor3::column[c];
      inverse.entry[c] = k.entry[c] + h(0, i) * p(0, j) + h(1, i) * p(1, j) + h(2, i) * p(2, j) -
                         (p(i, j) + p(j, i));
    }
    const SymmetricTensor3 strain = function_of<StrainOfInverseStretch>(inverse);

    rotate(motion.spin, stress);
    TOMBOLO_UNROLL
    for (unsigned int c = 0; c < 6; ++c)
    {
      motion.strain[c] = strain.entry[c] - stress[c] * compliance.deviatoric;
      if (c < 3)
      {
        motion.strain[c] -= volumetric;
        stress[c] += mean;
      }
    }
    return motion;
  }
} // namespace tombolo
