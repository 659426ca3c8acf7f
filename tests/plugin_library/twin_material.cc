// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/registry.h>
#include <tombolo/materials/linear_elastic.h>

namespace tombolo
{
  /** An elastic material with twice the density of the parameter file. */
  class TwinMaterial : public LinearElastic
  {
  public:
    using LinearElastic::LinearElastic;

    double density() const override
    {
      return 2 * LinearElastic::density();
    }
  };

  TOMBOLO_REGISTER(Material, TwinMaterial, "twin", "elastic, of twice the density")
} // namespace tombolo
