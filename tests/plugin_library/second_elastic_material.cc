// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/registry.h>
#include <tombolo/materials/linear_elastic.h>

namespace tombolo
{
  TOMBOLO_REGISTER(Material, LinearElastic, "elastic", "a name that the library has already")
} // namespace tombolo
