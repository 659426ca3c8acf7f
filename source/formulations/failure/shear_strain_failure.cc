// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/failure/threshold_failure.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    class ShearStrainFailure : public ThresholdFailure
    {
    public:
      explicit ShearStrainFailure(const Entries &e)
          : ThresholdFailure(
                e, "1",
                "The mean shear strain of a pair, the difference of its largest and its smallest "
                "principal logarithmic strain, from which on its bond can break.")
      {}

      bool needs_deformation() const override
      {
        return true;
      }

      void measure(const MaterialPoints & /*points*/, const std::vector<Tensor<2, 3>> &deformation,
                   std::vector<double> &value) const override
      {
        value.resize(deformation.size());
        for (std::size_t i = 0; i < deformation.size(); ++i)
        {
          // Of C = FᵀF, whose eigenvalues are exp(2ε).
          const auto squares = eigenvalues(symmetrize(transpose(deformation[i]) * deformation[i]));
          value[i] =
              0.5 * std::log(squares[0] / std::max(squares[2], std::numeric_limits<double>::min()));
        }
      }
    };
  } // namespace

  TOMBOLO_REGISTER(BondFailure, ShearStrainFailure, "shear strain",
                   "bonds break by the largest shear strain and stretch")
} // namespace tombolo
