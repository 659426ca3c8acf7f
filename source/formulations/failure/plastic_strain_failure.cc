// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/failure/threshold_failure.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    class PlasticStrainFailure : public ThresholdFailure
    {
    public:
      explicit PlasticStrainFailure(const Entries &e)
          : ThresholdFailure(
                e, "1",
                "The mean effective plastic strain of a pair from which on its bond can break.")
      {}

      void check(const MaterialPoints &points) const override
      {
        if (points.find_field(field_name) == points.fields().size())
          section.parent().fail("Bond failure",
                                "the material of the part has no effective plastic strain; choose "
                                "a plastic material or another criterion");
      }

      void measure(const MaterialPoints &points, const std::vector<Tensor<2, 3>> & /*deformation*/,
                   std::vector<double> &value) const override
      {
        const double *const strain = points.component(points.find_field(field_name), 0);
        value.assign(strain, strain + points.size());
      }

    private:
      static constexpr const char *field_name = "effective plastic strain";
    };
  } // namespace

  TOMBOLO_REGISTER(BondFailure, PlasticStrainFailure, "effective plastic strain",
                   "bonds break by effective plastic strain and stretch")
} // namespace tombolo
