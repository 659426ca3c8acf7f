// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/failure/bond_check.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace tombolo
{
  namespace
  {
    /** A bond breaks where the mean measure of the pair reaches a limit and the pair is stretched
     * beyond a ratio, or either of them. Derived classes define the measure. */
    class ThresholdFailure : public BondFailure
    {
    public:
      double threshold() const override
      {
        return needs_both ? limit : std::numeric_limits<double>::lowest();
      }

      void judge(const unsigned int n, const double *mean, const double *stretch,
                 std::uint8_t *breaks) const override
      {
        // Pairs that are as long as at the start differ from 1 by round-off of their positions.
        constexpr double margin = 1e-9;
        const double largest = (1. + margin) * critical_stretch;
        for (unsigned int k = 0; k < n; ++k)
        {
          const bool is_reached = mean[k] >= limit, is_stretched = stretch[k] > largest;
          breaks[k] =
              (needs_both ? is_reached && is_stretched : is_reached || is_stretched) ? 1 : 0;
        }
      }

    protected:
      /** `Limit` of the measure, with its unit and documentation, `Stretch` and `Combination`. */
      ThresholdFailure(const Entries &e, const std::string &unit,
                       const std::string &documentation_of_limit)
          : section(e.section())
      {
        limit = e.number("Limit", mandatory, positive(), unit, documentation_of_limit);
        critical_stretch =
            e.number("Stretch", "1", positive(), "1",
                     "The present over the initial distance of a pair beyond which it "
                     "can break; at 1 bonds that are shorter than at the start hold.");
        needs_both = e.choice("Combination", "both", "both|either",
                              "A bond breaks where the limit is reached and it is stretched beyond "
                              "`Stretch` (`both`), or where either is so. With `either` all pairs "
                              "are looked at in every check.") == "both";
        e.refuse(!needs_both && critical_stretch <= 1., "Stretch",
                 "where `Combination` is `either`, allowed is a number above 1: at 1 or below, all "
                 "bonds would break at the start");
      }

      Section section;

    private:
      double limit;
      double critical_stretch;
      bool needs_both;
    };

    /** By a field of the points; @p missing: what material to choose. */
    class FieldFailure : public ThresholdFailure
    {
    public:
      FieldFailure(const Entries &e, const std::string &field, const std::string &documentation,
                   const std::string &missing)
          : ThresholdFailure(e, "1", documentation), field(field), missing(missing)
      {}

      void check(const MaterialPoints &points) const override
      {
        if (points.find_field(field) == points.fields().size())
          section.parent().fail("Bond failure", "the material of the part has no " + missing);
      }

      void measure(const MaterialPoints &points, const std::vector<Tensor<2, 3>> & /*deformation*/,
                   std::vector<double> &value) const override
      {
        const double *const values = points.component(points.find_field(field), 0);
        value.assign(values, values + points.size());
      }

    private:
      std::string field, missing;
    };

    class DamageFailure : public FieldFailure
    {
    public:
      explicit DamageFailure(const Entries &e)
          : FieldFailure(e, "damage",
                         "The mean damage of a pair from which on its bond can break; 1 where "
                         "the material has failed.",
                         "damage; choose one that has, such as \"j2 plasticity\" with \"Damage = "
                         "johnson cook damage\", or another criterion")
      {}
    };

    class PlasticStrainFailure : public FieldFailure
    {
    public:
      explicit PlasticStrainFailure(const Entries &e)
          : FieldFailure(
                e, "effective plastic strain",
                "The mean effective plastic strain of a pair from which on its bond can break.",
                "effective plastic strain; choose a plastic material or another criterion")
      {}
    };

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
        value.resize(points.size());
        for (unsigned int i = 0; i < points.size(); ++i)
        {
          SymmetricTensor<2, 3> stress;
          constexpr unsigned int row[6] = {0, 1, 2, 1, 0, 0}, column[6] = {0, 1, 2, 2, 2, 1};
          for (unsigned int c = 0; c < 6; ++c)
            stress[row[c]][column[c]] = points.component(MaterialPoints::stress, c)[i];
          value[i] = eigenvalues(stress)[0];
        }
      }
    };

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

  TOMBOLO_REGISTER(BondFailure, DamageFailure, "damage", "bonds break by damage and stretch")
  TOMBOLO_REGISTER(BondFailure, PlasticStrainFailure, "effective plastic strain",
                   "bonds break by effective plastic strain and stretch")
  TOMBOLO_REGISTER(BondFailure, PrincipalStressFailure, "principal stress",
                   "bonds break by the largest principal stress and stretch")
  TOMBOLO_REGISTER(BondFailure, ShearStrainFailure, "shear strain",
                   "bonds break by the largest shear strain and stretch")
} // namespace tombolo
