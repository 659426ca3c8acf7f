// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/strain_measure.h>

namespace tombolo
{
  void declare_strain_measure(const Entries &e, const StrainMeasure by_default)
  {
    e.choice(
        "Strain measure", by_default == StrainMeasure::rate ? "rate" : "logarithmic",
        "rate|logarithmic",
        "What the stress follows: the rate of deformation with an objective rate of the Cauchy "
        "stress, or the elastic logarithmic strain, from whose energy the forces derive: in "
        "motions of large amplitude over long times energy neither grows nor decays.");
  }

  StrainMeasure read_strain_measure(const Section &section)
  {
    return section.get("Strain measure") == "logarithmic" ? StrainMeasure::logarithmic
                                                          : StrainMeasure::rate;
  }
} // namespace tombolo
