// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/picture_fields.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/registry.h>

#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    const std::vector<std::pair<std::string, bool PictureFields::*>> &further_fields()
    {
      static const std::vector<std::pair<std::string, bool PictureFields::*>> fields = {
          {"logarithmic strain", &PictureFields::logarithmic_strain},
          {"principal stresses", &PictureFields::principal_stresses},
          {"internal fields", &PictureFields::internal_fields}};
      return fields;
    }
  } // namespace

  PictureFields::PictureFields(const Entries &e)
  {
    xdmf = e.choice("Format", "vtu", "vtu|xdmf",
                    "`vtu`: a file for each rank and output, compressed, listed in solution.pvd. "
                    "`xdmf`: HDF5 files that all ranks write together, one for cells, one for "
                    "particles and one for tools, each with all outputs of the run and a file "
                    ".xdmf to open; for big runs.") == "xdmf";
    double_precision = e.choice("Precision", "single", "single|double",
                                "How real numbers are written. Single precision has seven digits "
                                "and half of the size; identifiers are exact in both.") == "double";
    std::vector<std::string> names;
    std::string allowed;
    for (const auto &[name, field] : further_fields())
    {
      names.push_back(name);
      allowed += (allowed.empty() ? "" : ", ") + name;
    }
    for (const std::string &wanted :
         e.list("Further fields", "",
                "Fields that are written only on request, separated by commas: `logarithmic "
                "strain` (Hencky's, ½ ln(F Fᵀ)), `principal stresses` (`principal stress 1` is the "
                "largest), `internal fields` (what elements and particles remember for themselves, "
                "such as hourglass forces)."))
    {
      bool is_known = false;
      for (const auto &[name, field] : further_fields())
        if (name == wanted)
          is_known = this->*field = true;
      if (is_known)
        continue;
      const std::string nearest = nearest_name(wanted, names);
      e.section().fail("Further fields",
                       "there is no field \"" + wanted + "\" that is written on request" +
                           (nearest.empty() ? "." : ", did you mean \"" + nearest + "\"?") +
                           " Allowed: " + allowed + ".");
    }
  }
} // namespace tombolo
