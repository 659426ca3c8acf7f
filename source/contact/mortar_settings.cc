// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_settings.h>

#include <cmath>

namespace tombolo
{
  using namespace dealii;

  MortarSettings::MortarSettings(const Entries &e, const bool has_heat) : FrictionSettings(has_heat)
  {
    is_tied = e.choice("Type", "touching", "touching|tied",
                       "`touching`: the bodies push each other, with friction. `tied`: they are "
                       "one where they meet at the start, also in tension.") == "tied";
    resolves_overlap = e.choice("Initial overlap", "refuse", "refuse|resolve",
                                "What happens where bodies overlap at the start: `refuse` ends "
                                "with the depth and the place, `resolve` takes the overlap as it "
                                "is for no overlap, until the bodies separate.") == "resolve";
    stiffness = e.number("Stiffness", "1", positive_up_to(100.), "",
                         "The penalty stiffness of both sides as a fraction of their mass over the "
                         "square of the stable time step, above 0 and up to 100. The step becomes "
                         "smaller by 1/sqrt(1 + a/4) at least.");
    law = bond = ContactLaw(stiffness, 0.);
    if (e.when(!is_tied))
    {
      law = ContactLaw(stiffness, e.number("Damping", "0.2", from_to(0., 1.), "",
                                           "Fraction of critical damping while bodies approach, "
                                           "from 0 to 1. Tied bodies have none."));
      read_friction(
          e,
          "Coulomb's coefficient of friction, from 0 to 10; 0 is frictionless contact. In scenes "
          "with heat also pairs `temperature: value` separated by commas, over the mean "
          "temperature of both sides.");
      if (!e.text("Shear limit", "", "M/(L T^2)",
                  "The largest traction along the surface, which friction does not exceed however "
                  "large the pressure. Empty: there is no limit. Only with `Friction`.")
               .empty())
      {
        e.refuse(!(friction.largest() > 0.), "Shear limit",
                 "there is no friction; allowed is nothing, or a `Friction` above 0.");
        shear_limit = e.section().get_positive("Shear limit");
      }
    }
    if (e.when(!is_tied && has_heat))
      read_heat_fraction(
          e, "Share of the heat of friction that enters the slave, from 0 to 1; the rest "
             "enters the master. `by effusivity`: e_s/(e_s + e_m) with the √(k ρ c) of slave "
             "and master at the present temperatures. Only in scenes with heat.");

    if (e.when(has_heat))
    {
      conductance = e.object<TemperatureTable>(
          "Conductance", "0", "M/(T^3 temperature)",
          "h of the heat h (temperature of the master - temperature of the slave) that enters the "
          "slave per area in contact and time, and leaves the master: one number, or pairs "
          "`pressure: value` separated by commas, joined by straight lines. 0: nothing is "
          "conducted. Only in scenes with heat.",
          "pressure");
      e.refuse(conductance.smallest() < 0., "Conductance", "allowed are numbers from zero on.");
    }
    if (!e.when(!is_tied))
      return;
    bonding_temperature =
        e.optional_number("Bonding temperature", any_number(), "temperature",
                          "Where the mean temperature of both sides reaches it while they press, "
                          "they are tied from then on. Empty: never. Only in scenes with heat.");
    e.refuse(
        bonding_temperature && !has_heat, "Bonding temperature",
        "the scene has no temperature; allowed is nothing, or materials with a section \"Heat\".");
  }
} // namespace tombolo
