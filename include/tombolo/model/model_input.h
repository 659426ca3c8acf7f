// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/coupling/bridge.h>
#include <tombolo/model/part.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  /** The selected plug-in of a kind, made from the subsection of its name. */
  template <typename Interface>
  std::unique_ptr<Interface> create_selected(const Section &section, const std::string &entry)
  {
    const std::string name = section.get(entry);
    return Registry<Interface>::instance().create(name, section.subsection(name));
  }

  /** The sections "PREFIX: NAME" of the names in an entry. */
  std::vector<Section> named_sections(const Parameters &parameters, const std::string &list,
                                      const std::string &prefix);

  LatticeFilterSettings filter_settings(const Parameters &parameters);

  /** What a section "Initial condition: NAME" says. */
  template <int dim>
  struct InitialCondition
  {
    explicit InitialCondition(const Section &section)
    {
      if (!section.get("Where").empty())
        where.emplace(section, "Where");
      if (section.is_set("Velocity"))
        velocity.emplace(section, "Velocity", dim);
      if (section.is_set("Stress"))
        stress.emplace(section, "Stress", 6);
      if (section.is_set("Temperature"))
        temperature.emplace(section, "Temperature", 1);
      if (!velocity && !stress && !temperature)
        section.fail("", "an initial condition needs `Velocity`, `Stress` or `Temperature`.");
    }

    std::optional<Predicate<dim>> where;
    std::optional<Expression<dim>> velocity;
    std::optional<Expression<dim>> stress;
    std::optional<Expression<dim>> temperature;
  };

  /** The parts with their materials and formulations, not yet initialized. Throws InputError. */
  template <int dim>
  std::vector<Part<dim>> create_parts(const Parameters &parameters);

  /** Finds which parts take the cells of others as particles. Throws InputError where that does
   * not fit together. */
  template <int dim>
  void link_conversions(const Parameters &parameters, std::vector<Part<dim>> &parts);

  /** What the parts together are: with stresses, with heat, or both. Throws the InputError that
   * they do not fit together. */
  template <int dim>
  struct Physics
  {
    Physics(const std::vector<Part<dim>> &parts, const std::vector<Section> &part_sections);

    bool has_mechanics = false;
    bool has_heat = false;
  };
} // namespace tombolo
