// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/failure/threshold_failure.h>

#include <deal.II/base/symmetric_tensor.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    class PrincipalStressFailure : public ThresholdFailure
    {
    public:
      explicit PrincipalStressFailure(const Entries &e)
          : ThresholdFailure(e, "M/(L T^2)",
                             "The mean largest principal stress of a pair, tension positive, from "
                             "which on its bond can break.")
      {}

      void measure(const MaterialPoints &points, const std::vector<Tensor<2, 3>> & /*deformation*/,
                   std::vector<double> &value) const override
      {
        const double *component[6];
        for (unsigned int c = 0; c < 6; ++c)
          component[c] = points.component(MaterialPoints::stress, c);
        value.resize(points.size());
        for (unsigned int i = 0; i < points.size(); ++i)
        {
          SymmetricTensor<2, 3> stress;
          for (unsigned int d = 0; d < 3; ++d)
            stress[d][d] = component[d][i];
          stress[1][2] = component[3][i];
          stress[0][2] = component[4][i];
          stress[0][1] = component[5][i];
          value[i] = eigenvalues(stress)[0];
        }
      }
    };
  } // namespace

  TOMBOLO_REGISTER(BondFailure, PrincipalStressFailure, "principal stress",
                   "bonds break by the largest principal stress and stretch")
} // namespace tombolo
