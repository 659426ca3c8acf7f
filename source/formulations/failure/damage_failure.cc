// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/failure/threshold_failure.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    class DamageFailure : public ThresholdFailure
    {
    public:
      explicit DamageFailure(const Entries &e)
          : ThresholdFailure(e, "1",
                             "The mean damage of a pair from which on its bond can break; 1 where "
                             "the material has failed.")
      {}

      void check(const MaterialPoints &points) const override
      {
        if (points.find_field("damage") == points.fields().size())
          section.parent().fail("Bond failure",
                                "the material of the part has no damage; choose one that has, such "
                                "as \"j2 plasticity\" with \"Damage = johnson cook damage\", or "
                                "another criterion");
      }

      void measure(const MaterialPoints &points, const std::vector<Tensor<2, 3>> & /*deformation*/,
                   std::vector<double> &value) const override
      {
        const double *const damage = points.component(points.find_field("damage"), 0);
        value.assign(damage, damage + points.size());
      }
    };
  } // namespace

  TOMBOLO_REGISTER(BondFailure, DamageFailure, "damage", "bonds break by damage and stretch")
} // namespace tombolo
