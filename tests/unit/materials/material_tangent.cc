// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include "material_testing.h"

#include <tombolo/materials/material.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      /** A material whose tangent is unknown. */
      class WithoutTangent : public Material
      {
      public:
        explicit WithoutTangent(const Material &material) : material(material) {}
        double density() const override
        {
          return material.density();
        }
        void update_stress(MaterialBatch &batch) const override
        {
          material.update_stress(batch);
        }
        double bulk_modulus() const override
        {
          return material.bulk_modulus();
        }
        double shear_modulus() const override
        {
          return material.shear_modulus();
        }

      private:
        const Material &material;
      };

      /** Points with a stress of their own that are strained by another increment each. */
      struct StrainedBatch
      {
        static constexpr unsigned int n = 2 * n_lanes;

        explicit StrainedBatch(const Material &material)
        {
          const std::vector<FieldDescription> fields = material.internal_variables();
          batch.n = n;
          batch.time_increment = 0.01;
          for (unsigned int c = 0; c < 6; ++c)
          {
            stress[c].resize(n);
            strain[c].resize(n);
            for (unsigned int i = 0; i < n; ++i)
            {
              stress[c][i] = 0.01 * std::sin(1. + c + 0.7 * i);
              // Every second point stays elastic.
              strain[c][i] = (i % 2 == 0 ? 0.01 : 1e-5) * std::cos(0.3 + 1.3 * c + i);
            }
            batch.stress[c] = stress[c].data();
            batch.strain_increment[c] = strain[c].data();
          }
          ratio.assign(n, 1.);
          batch.relative_volume = ratio.data();
          for (const FieldDescription &field : fields)
            for (unsigned int c = 0; c < field.n_components; ++c)
            {
              // Tensors have a deviator.
              const double shares[6] = {2., -1.5, -0.5, 0.3, -0.6, 1.};
              const bool is_strain = field.name == "effective plastic strain";
              variables.emplace_back(n, is_strain                ? 0.02
                                        : field.n_components > 1 ? 0.004 * shares[c]
                                                                 : field.initial_value);
            }
          for (std::vector<double> &values : variables)
            batch.internal_variables.push_back(values.data());
          tangent_values.resize(36 * n);
          for (unsigned int entry = 0; entry < 36; ++entry)
            tangent[entry] = tangent_values.data() + std::size_t(entry) * n;
        }

        MaterialBatch batch;
        std::vector<double> stress[6], strain[6], ratio, tangent_values;
        std::vector<std::vector<double>> variables;
        MaterialTangent tangent;
      };

      void expect_quotients(const std::string &model, const std::string &entries)
      {
        SCOPED_TRACE(entries);
        const auto material =
            make_plugin<Material>(model, "set Density = 2\nset Young's modulus = 10\nset Poisson's "
                                         "ratio = 0.3\n" +
                                             entries);
        StrainedBatch known(*material), quotients(*material), plain(*material);
        material->update_stress_and_tangent(known.batch, known.tangent);
        WithoutTangent(*material).update_stress_and_tangent(quotients.batch, quotients.tangent);
        material->update_stress(plain.batch);
        for (unsigned int c = 0; c < 6; ++c)
        {
          EXPECT_EQ(known.stress[c], plain.stress[c]);
          EXPECT_EQ(quotients.stress[c], plain.stress[c]);
        }
        EXPECT_EQ(known.variables, plain.variables);
        EXPECT_EQ(quotients.variables, plain.variables);
        for (std::size_t i = 0; i < known.tangent_values.size(); ++i)
          EXPECT_NEAR(known.tangent_values[i], quotients.tangent_values[i], 2e-5 * 10.) << i;
      }

      TEST(MaterialTangent, that_of_elasticity_is_its_difference_quotient)
      {
        expect_quotients("elastic", "");
      }

      TEST(MaterialTangent, that_of_plasticity_is_the_difference_quotient_of_the_radial_return)
      {
        const std::string flow = "set Flow stress = ";
        expect_quotients("j2 plasticity", flow + "linear hardening\nsubsection linear "
                                                 "hardening\nset Yield stress = 0.06\nset "
                                                 "Hardening modulus = 0\nend\n");
        expect_quotients("j2 plasticity", flow + "linear hardening\nsubsection linear "
                                                 "hardening\nset Yield stress = 0.06\nset "
                                                 "Hardening modulus = 3\nend\n");
        expect_quotients("j2 plasticity",
                         flow + "tabular\nsubsection tabular\nset Plastic strains = 0, 0.5\nset "
                                "Flow stresses = 0.05, 0.4\nend\n");
      }

      TEST(MaterialTangent, that_of_a_back_stress_is_the_difference_quotient)
      {
        const std::string hardening = "subsection linear hardening\nset Yield stress = 0.05\nset "
                                      "Hardening modulus = 0.3\nend\nset Flow stress = linear "
                                      "hardening\n";
        expect_quotients("chaboche", hardening + "set Back stress moduli = 2\n");
        expect_quotients("chaboche",
                         hardening +
                             "set Back stress moduli = 2, 0.7\nset Recovery rates = 60, 5\n");
      }

      TEST(MaterialTangent, with_flow_its_deviatoric_part_is_softer_and_its_bulk_is_not)
      {
        const auto material = make_plugin<Material>(
            "j2 plasticity",
            "set Density = 2\nset Young's modulus = 10\nset Poisson's ratio = 0.3\nset Flow stress "
            "= linear hardening\nsubsection linear hardening\nset Yield stress = 0.06\nset "
            "Hardening modulus = 0\nend\n");
        StrainedBatch points(*material);
        material->update_stress_and_tangent(points.batch, points.tangent);
        const double bulk = material->bulk_modulus(), twice_shear = 2. * material->shear_modulus();
        unsigned int n_soft = 0;
        for (unsigned int i = 0; i < StrainedBatch::n; ++i)
        {
          double trace = 0;
          for (unsigned int row = 0; row < 3; ++row)
            for (unsigned int column = 0; column < 3; ++column)
              trace += points.tangent[6 * row + column][i] / 9.;
          EXPECT_NEAR(trace, bulk, 1e-12 * bulk);
          n_soft += points.tangent[35][i] < 0.9 * twice_shear ? 1 : 0;
        }
        EXPECT_GE(n_soft, StrainedBatch::n / 4);
        EXPECT_LE(n_soft, StrainedBatch::n / 2 + 1);
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
