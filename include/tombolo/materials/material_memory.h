// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/material.h>

#include <algorithm>
#include <string>
#include <vector>

namespace tombolo
{
  /** Whether an internal variable of the material has this name. */
  inline bool remembers(const Material &material, const std::string &variable)
  {
    const std::vector<FieldDescription> variables = material.internal_variables();
    return std::any_of(variables.begin(), variables.end(),
                       [&](const FieldDescription &field) { return field.name == variable; });
  }
} // namespace tombolo
