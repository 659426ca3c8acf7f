// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/strain_measure.h>

namespace tombolo
{
  void declare_strain_measure(dealii::ParameterHandler &handler, const StrainMeasure by_default)
  {
    handler.declare_entry(
        "Strain measure", by_default == StrainMeasure::rate ? "rate" : "logarithmic",
        dealii::Patterns::Selection("rate|logarithmic"),
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
