// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>

namespace tombolo
{
  /** What has a melting temperature: a material, or what one is made of, derives from it. */
  class Melting
  {
  public:
    virtual ~Melting() = default;

    virtual double melts_at() const = 0;
  };

  /** That of a material or of what one is made of; infinite where it has none. */
  template <typename Object>
  double melting_temperature_of(const Object &object)
  {
    const auto *const melting = dynamic_cast<const Melting *>(&object);
    return melting != nullptr ? melting->melts_at() : std::numeric_limits<double>::infinity();
  }
} // namespace tombolo
