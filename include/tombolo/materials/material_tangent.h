// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/material.h>

#include <array>

namespace tombolo
{
  /**
   * The derivative of the stress of update_stress() with respect to the strain increment of the
   * step, of the points of a batch: entry 6 i + j is the array of ∂σ_i/∂Δε_j by components xx, yy,
   * zz, yz, xz, xy, where the strain has tensor components and a shear component stands for both of
   * its entries. As the stress that comes in and the strain increment make one trial stress, a
   * change δσ of the former acts as the strain C⁻¹ : δσ. [M/(L T^2)]
   */
  using MaterialTangent = std::array<double *, 36>;

  /** A material that knows its tangent. */
  class MaterialWithTangent
  {
  public:
    virtual ~MaterialWithTangent() = default;

    /** Material::update_stress(), and its consistent tangent. */
    virtual void update_stress_and_tangent(MaterialBatch &batch,
                                           const MaterialTangent &tangent) const = 0;
  };

  /** Material::update_stress(), and its tangent, for any material: by its own, or by difference
   * quotients in seven updates. */
  void update_stress_and_tangent(const Material &material, MaterialBatch &batch,
                                 const MaterialTangent &tangent);

  /** Sets the tangent of isotropic elasticity at point @p i. */
  inline void set_elastic_tangent(const double bulk, const double shear, const unsigned int i,
                                  const MaterialTangent &tangent)
  {
    for (unsigned int row = 0; row < 6; ++row)
      for (unsigned int column = 0; column < 6; ++column)
        tangent[6 * row + column][i] = (row == column ? 2. * shear : 0.) +
                                       (row < 3 && column < 3 ? bulk - 2. / 3. * shear : 0.);
  }
} // namespace tombolo
