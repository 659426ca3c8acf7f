// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_settings.h>

#include <tombolo/contact/heat_fraction.h>

#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    double read_mortar_stiffness(const Section &section)
    {
      constexpr double stiffest = 100.;
      const double stiffness = section.get_positive("Stiffness");
      if (stiffness > stiffest)
        section.fail("Stiffness", "allowed is a number above 0 and up to 100.");
      return stiffness;
    }

    double read_fraction(const Section &section, const std::string &entry)
    {
      const double value = section.get_double(entry);
      if (!(value >= 0. && value <= 1.))
        section.fail(entry, "allowed is a number from 0 to 1.");
      return value;
    }
  } // namespace

  void MortarSettings::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry(
        "Type", "touching", Patterns::Selection("touching|tied"),
        "`touching`: the bodies push each other, with friction. `tied`: they are one where they "
        "meet at the start, also in tension.");
    handler.declare_entry(
        "Initial overlap", "refuse", Patterns::Selection("refuse|resolve"),
        "What happens where bodies overlap at the start: `refuse` ends with the depth and the "
        "place, `resolve` takes the overlap as it is for no overlap, until the bodies separate.");
    handler.declare_entry(
        "Stiffness", "1", Patterns::Double(),
        "The penalty stiffness of both sides as a fraction of their mass over the square of the "
        "stable time step, above 0 and up to 100. The step becomes smaller by 1/sqrt(1 + a/4) at "
        "least.");
    handler.declare_entry("Damping", "0.2", Patterns::Double(),
                          "Fraction of critical damping while bodies approach, from 0 to 1. Tied "
                          "bodies have none.");
    handler.declare_entry("Friction", "0", Patterns::Anything(),
                          "Coulomb's coefficient of friction, from 0 to 10; 0 is frictionless "
                          "contact. In scenes with heat also pairs `temperature: value` separated "
                          "by commas, over the mean temperature of both sides.");
    handler.declare_entry("Shear limit", "", Patterns::Anything(),
                          "The largest traction along the surface, which friction does not exceed "
                          "however large the pressure. Empty: there is no limit. Only with "
                          "`Friction`. Units: M/(L T^2).");
    handler.declare_entry(
        "Heat fraction", "0.5", Patterns::Anything(),
        "Share of the heat of friction that enters the slave, from 0 to 1; the rest enters the "
        "master. `by effusivity`: e_s/(e_s + e_m) with the √(k ρ c) of slave and master at the "
        "present temperatures. Only in scenes with heat.");
    handler.declare_entry(
        "Conductance", "0", Patterns::Anything(),
        "h of the heat h (temperature of the master - temperature of the slave) that enters the "
        "slave per area in contact and time, and leaves the master: one number, or pairs "
        "`pressure: value` separated by commas, joined by straight lines. 0: nothing is conducted. "
        "Only in scenes with heat. Units: M/(T^3 temperature).");
    handler.declare_entry("Bonding temperature", "", Patterns::Anything(),
                          "Where the mean temperature of both sides reaches it while they press, "
                          "they are tied from then on. Empty: never. Only in scenes with heat. "
                          "Units: temperature.");
  }

  MortarSettings::MortarSettings(const Section &section, const bool has_heat)
      : is_tied(section.get("Type") == "tied"),
        resolves_overlap(section.get("Initial overlap") == "resolve"),
        stiffness(read_mortar_stiffness(section)), law(stiffness, 0.), bond(stiffness, 0.),
        has_heat(has_heat)
  {
    if (!is_tied)
    {
      law = ContactLaw(stiffness, read_fraction(section, "Damping"));
      friction = TemperatureTable(section, "Friction");
      if (!(friction.smallest() >= 0. && friction.largest() <= 10.))
        section.fail("Friction", friction.is_constant() ? "allowed is a number from 0 to 10."
                                                        : "allowed are coefficients from 0 to 10.");
      if (!friction.is_constant() && !has_heat)
        section.fail("Friction", "the scene has no temperature; allowed is one number, or "
                                 "materials with a section \"Heat\".");
      if (!section.get("Shear limit").empty())
      {
        if (!(friction.largest() > 0.))
          section.fail("Shear limit", "there is no friction; allowed is nothing, or a `Friction` "
                                      "above 0.");
        shear_limit = section.get_positive("Shear limit");
      }
      if (!section.get("Bonding temperature").empty())
      {
        bonding_temperature = section.get_double("Bonding temperature");
        if (!has_heat)
          section.fail("Bonding temperature", "the scene has no temperature; allowed is nothing, "
                                              "or materials with a section \"Heat\".");
        if (!std::isfinite(*bonding_temperature))
          section.fail("Bonding temperature", "allowed is a finite number.");
      }
      splits_by_effusivity = has_heat && section.get("Heat fraction") == by_effusivity;
      if (has_heat && !splits_by_effusivity)
        heat_fraction = read_heat_fraction(section);
    }
    if (!has_heat)
      return;
    conductance = TemperatureTable(section, "Conductance", "pressure");
    if (conductance.smallest() < 0.)
      section.fail("Conductance", "allowed are numbers from zero on.");
  }
} // namespace tombolo
