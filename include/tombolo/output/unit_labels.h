// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dealii
{
  class ParameterHandler;
}

namespace tombolo
{
  class Entries;

  /**
   * The names of the units that a run is computed in. Descriptions have units in terms of L
   * (length), M (mass), T (time) and K (temperature), for example "M/(L T^2)"; label() inserts the
   * names: "t/(mm s^2)", or "MPa" where the entry `Unit labels` has a name for the quantity or
   * where it follows from those of mass, length and time. Without labels the symbols stand for
   * themselves. Labels change no number.
   */
  class UnitLabels
  {
  public:
    /** No labels: symbols stay. */
    UnitLabels() = default;

    /** Reads `Unit labels` of the root section. Throws InputError. */
    explicit UnitLabels(const Entries &e);

    /** The unit with names inserted; "1" stays. */
    std::string label(const std::string &unit) const;

    /** The same of a quantity of this name: a moment has the unit of a torque, not of an energy. */
    std::string label_of(const std::string &name, const std::string &unit) const;

    /** "name [unit]", or only the name where the unit is "1" or empty. */
    std::string heading(const std::string &name, const std::string &unit) const;

    /** How many metres, kilograms or seconds the unit of "L", "M" or "T" is; nothing where it has
     * no label, or one that is not known. */
    std::optional<double> in_si(const std::string &symbol) const;

    /** The labels as given, quantity and name, for the summary. */
    const std::vector<std::pair<std::string, std::string>> &labels() const
    {
      return given;
    }

  private:
    void derive(const std::string &quantity, double in_si);

    std::vector<std::pair<std::string, std::string>> given, derived;
  };
} // namespace tombolo
