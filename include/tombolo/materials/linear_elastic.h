#pragma once

#include <tombolo/base/parameters.h>
#include <tombolo/materials/material.h>

namespace tombolo
{
  /** Isotropic hypoelasticity, σ̇ = C : D in the rotating frame (eq. 5 without plasticity). */
  class LinearElastic : public Material
  {
  public:
    explicit LinearElastic(const Section &section);

    static void declare_parameters(dealii::ParameterHandler &handler);

    double density() const override;
    double bulk_modulus() const override;
    double shear_modulus() const override;
    void update_stress(MaterialBatch &batch) const override;

  private:
    double initial_density; // [M/L^3]
    double bulk;            // [M/(L T^2)]
    double shear;           // [M/(L T^2)]
  };
} // namespace tombolo
