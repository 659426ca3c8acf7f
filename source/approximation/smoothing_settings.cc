// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/smoothing_settings.h>

#include <tombolo/approximation/kernel.h>
#include <tombolo/approximation/smoothing_strength.h>
#include <tombolo/base/input/entries.h>

#include <cmath>
#include <cstdlib>

namespace tombolo
{
  using namespace dealii;

  void SmoothingSettings::declare_parameters(const Entries &e)
  {
    e.text("Smoothing", "affine", "",
           "How velocities are smoothed: `paper` (momentum-consistent smoothing of Pan et al. "
           "2019), `fe matched` and `phase` (sharpened to the phase speed of finite elements, and "
           "to fourth order), `affine` (linear fields are reproduced, so that angular momentum is "
           "conserved), `none`, or a number gamma for S (I + gamma (I - Phi S)).");
    e.number("Smallest smoothed mass", "0.01", between(0., 0.15), "1",
             "Where neighbours mix, a node can have hardly any smoothed mass m left; its velocity, "
             "a sum of positive and negative shares over m, is then far from those around it. "
             "Where m is at most this share of the node's own mass, rows with a negative share of "
             "it lose their negative shares. On lattices, disordered ones too, m is above 0.18. "
             "0.1 for flows that stir.");
  }

  SmoothingSettings SmoothingSettings::read(const Section &section, const Kernel &kernel,
                                            const double dilation)
  {
    SmoothingSettings settings;
    settings.smallest_mass_share = section.get_double("Smallest smoothed mass");
    const std::string smoothing = section.get("Smoothing");
    if (smoothing == "none")
      settings.is_active = false;
    else if (smoothing == "affine")
      settings.affine = true;
    else if (smoothing == "fe matched")
      settings.gamma =
          SmoothingStrength::fe_matched(SmoothingStrength::lattice_row(kernel, dilation));
    else if (smoothing == "phase")
      settings.gamma = SmoothingStrength::phase(SmoothingStrength::lattice_row(kernel, dilation));
    else if (smoothing != "paper")
    {
      char *end = nullptr;
      settings.gamma = std::strtod(smoothing.c_str(), &end);
      if (smoothing.empty() || *end != '\0' || !(std::abs(settings.gamma) <= 10.))
      {
        const std::string nearest =
            nearest_name(smoothing, {"paper", "fe matched", "phase", "affine", "none"});
        section.fail("Smoothing",
                     "allowed is paper, fe matched, phase, affine, none, or a number "
                     "between -10 and 10" +
                         (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
      }
    }
    return settings;
  }
} // namespace tombolo
