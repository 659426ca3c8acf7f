// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <deal.II/base/utilities.h>

namespace tombolo
{
  /** What `Heat fraction` says where the heat of friction is split by effusivities. */
  constexpr const char *by_effusivity = "by effusivity";

  /** The entry `Heat fraction` of a contact where it is a number. Throws InputError. */
  inline double read_heat_fraction(const Section &section)
  {
    const std::string text = section.get("Heat fraction");
    double value = -1.;
    try
    {
      value = dealii::Utilities::string_to_double(text);
    }
    catch (const dealii::ExceptionBase &)
    {
      section.fail("Heat fraction", "allowed is a number from 0 to 1, or \"by effusivity\".");
    }
    if (!(value >= 0. && value <= 1.))
      section.fail("Heat fraction", "allowed is a number from 0 to 1.");
    return value;
  }
} // namespace tombolo
