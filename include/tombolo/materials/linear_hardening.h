// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/flow_stress.h>

namespace tombolo
{
  /** σ_y = Y + H ε_p. */
  class LinearHardening : public FlowStress
  {
  public:
    explicit LinearHardening(const Entries &e);
    bool depends_on_temperature() const override;
    void evaluate(const FlowStressBatch &batch) const override;

  private:
    double yield_stress;      // Y [M/(L T^2)]
    double hardening_modulus; // H [M/(L T^2)]
  };
} // namespace tombolo
