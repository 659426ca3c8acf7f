// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/linear_elastic.h>

namespace tombolo
{
  TOMBOLO_REGISTER(Material, LinearElastic, "elastic",
                   "isotropic elasticity in rate form with an objective stress rate and thermal "
                   "expansion")
} // namespace tombolo
