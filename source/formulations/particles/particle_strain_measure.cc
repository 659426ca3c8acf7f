// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_strain_measure.h>

#include <string>

namespace tombolo
{
  void declare_particle_strain_measure(const Entries &e)
  {
    e.choice(
        "Strain measure", "automatic", "automatic|logarithmic|rate",
        "What the stress follows: the elastic logarithmic strain, from whose energy the forces "
        "derive, or the rate of deformation with an objective rate of the Cauchy stress. The first "
        "needs positions that move with the velocity that strains: `automatic` is `logarithmic` "
        "with the smoothings affine and none, and `rate` with others.");
  }

  StrainMeasure read_particle_strain_measure(const Section &section)
  {
    const std::string measure = section.get("Strain measure"), smoothing = section.get("Smoothing");
    const bool positions_follow = smoothing == "affine" || smoothing == "none";
    if (measure == "logarithmic" && !positions_follow)
      section.fail(
          "Strain measure",
          "the logarithmic strain is that of the positions, and with `Smoothing = " + smoothing +
              "` these do not move with the velocity that strains; allowed is rate, or "
              "the smoothing affine or none");
    return measure != "rate" && positions_follow ? StrainMeasure::logarithmic : StrainMeasure::rate;
  }
} // namespace tombolo
