// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  /** What a material with plastic flow tells others of its flow stress. */
  class YieldStrength
  {
  public:
    virtual ~YieldStrength() = default;

    /** The flow stress of a slow test at an effective plastic strain and a temperature, without
     * damage [M/(L T^2)]. */
    virtual double slow_yield_stress(double plastic_strain, double temperature) const = 0;
  };
} // namespace tombolo
