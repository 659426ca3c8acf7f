// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include "model_scene.h"

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/materials/material.h>

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace
{
  using namespace tombolo;

  /** As a plug-in that somebody has begun to write. */
  class FaultyMaterial : public Material
  {
  public:
    explicit FaultyMaterial(const Entries &e) : fault(e.text("Fault", "", "", "What is wrong.")) {}

    double density() const override
    {
      return fault == "density" ? -1. : 1.;
    }
    double bulk_modulus() const override
    {
      return fault == "bulk modulus" ? std::numeric_limits<double>::quiet_NaN() : 1.;
    }
    double shear_modulus() const override
    {
      return fault == "shear modulus" ? -0.5 : 0.5;
    }
    std::vector<FieldDescription> internal_variables() const override
    {
      FieldDescription memory{"memory", "1", FieldLocation::material_point};
      memory.turns = fault == "turning number";
      if (fault == "two components")
        memory.n_components = 2;
      if (fault == "node")
        memory.location = FieldLocation::node;
      if (fault == "stress" || fault == "no name")
        memory.name = fault == "stress" ? fault : "";
      return std::vector<FieldDescription>(fault == "twice" ? 2 : 1, memory);
    }
    void update_stress(MaterialBatch &) const override {}

  private:
    std::string fault;
  };

  TOMBOLO_REGISTER(Material, FaultyMaterial, "faulty", "a material with a mistake")

  /** How the model with this mistake is refused; empty if it is not. */
  std::string message_about(const std::string &fault)
  {
    try
    {
      tombolo::testing::make_model<2>(
          "set Dimension = 2\nset Parts = a\nset Materials = m\nsubsection Mesh\nset Type = box\n"
          "subsection box\nset Upper corner = 2, 1\nset Cells = 2, 1\nend\nend\nsubsection Part: "
          "a\nset Cells = all\nset Formulation = hexahedron\nset Material = "
          "m\nend\nsubsection Material: m\nset Model = faulty\nsubsection faulty\nset Fault = " +
          fault + "\nend\nend\n");
    }
    catch (const InputError &error)
    {
      return error.what();
    }
    return "";
  }
} // namespace

TEST(FaultyMaterials, a_material_without_a_mistake_is_taken)
{
  EXPECT_EQ(message_about(""), "");
}

TEST(FaultyMaterials, are_refused_by_the_name_of_what_is_wrong)
{
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"density", "a density of -1; allowed is a finite number above zero."},
      {"bulk modulus", "a bulk modulus of nan"},
      {"shear modulus", "a shear modulus of -0.5"},
      {"stress", "a variable \"stress\"; allowed is a name that no other field has."},
      {"no name", "a variable \"\""},
      {"twice", "a variable \"memory\""},
      {"two components", "a variable \"memory\" of 2 components; allowed is one of 1, 3, 6 or 9"},
      {"node", "at material points"},
      {"turning number", "of 1 components"}};
  for (const auto &[fault, words] : cases)
  {
    const std::string message = message_about(fault);
    EXPECT_NE(message.find(words), std::string::npos) << fault << ": " << message;
    EXPECT_NE(message.find("\"Material: m/Model\" = \"faulty\""), std::string::npos) << message;
  }
}
