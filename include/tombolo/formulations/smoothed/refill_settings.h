// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/formulations/smoothed/value_remap.h>

#include <memory>
#include <optional>
#include <string>

namespace tombolo
{
  /** When the cells of a part of smoothed cells are refilled: where the deformation since the last
   * refill reaches a limit. Off unless `Refill stretch` is given. */
  template <int dim>
  struct RefillSettings
  {
    /** Throws InputError. */
    explicit RefillSettings(const Entries &e)
    {
      const auto limit = e.optional_number(
          stretch_entry, positive(), "1",
          "The part is refilled where the ratio of the largest to the smallest principal stretch "
          "of a point since the last refill is above this: inner nodes go back to places like "
          "those of the initial mesh, and the present configuration becomes the reference of the "
          "functions. 1.8 is a good value. It is refilled as well where a point has less than a "
          "fifth of its volume at the last refill. Empty: never.");
      if (!e.when(limit.has_value()))
        return;
      section = e.section();
      stretch = limit.value_or(0.);
      e.refuse(
          !(stretch > 1.), stretch_entry,
          "allowed is a number above 1, such as 1.8; the ratio is 1 where nothing is deformed");
      layers = e.integer(
          "Refill layers", "2", between(0, 1000000),
          "With a cell beyond a limit, the inner nodes of so many layers of cells around it "
          "are placed anew. Nodes elsewhere stay.");
      surface_slides =
          e.choice(
              "Refill surface", "held", "held|sliding",
              "What a refill does with nodes on the surface of the part: held, they stay; sliding, "
              "those on smooth sides of the body move along the surface to places like those of "
              "the initial mesh, and keep the volume. Nodes at edges of the body, where names of "
              "boundaries meet, beside other parts, on planes of symmetry and with prescribed "
              "components stay.") == "sliding";
      const bool moves =
          !e.text(motion_entry, "", "L",
                  "The displacement of the mesh to whose places a refill takes nodes, "
                  "a function of the initial x, y, z and of t, components separated "
                  "by ';'. Material flows through a mesh that moves. For a tool that "
                  "goes far into or along a part: its way times a weight that is 1 "
                  "around the tool and 0 at the nodes that stay. Empty: the initial "
                  "mesh. Only where the surface is sliding.")
               .empty();
      e.refuse(moves && !surface_slides, motion_entry,
               "nodes of the surface are held (`Refill surface`), so that the mesh cannot move; "
               "allowed with it is sliding.");
      fills_cells =
          !e.text(void_entry, "", "",
                  "A predicate of the place of cells that are void at the start: without material, "
                  "such as those above a plate into which metal is pushed. With it refills fill "
                  "cells and empty others, so that surfaces that meet become one: a cell is full "
                  "where the body has at least half of it. Never true (`0`): all cells are full at "
                  "the start. Empty: cells stay full. Only where the surface is sliding.")
               .empty();
      e.refuse(
          fills_cells && !surface_slides, void_entry,
          "nodes of the surface are held (`Refill surface`), so that cells cannot be filled or "
          "emptied; allowed with it is sliding.");
      std::string remaps = conservative;
      for (const std::string &name : Registry<ValueRemap<dim>>::instance().names())
        remaps += "|" + name;
      remap = e.choice(
          remap_entry, conservative, remaps,
          "How a refill carries fields over: conservative, by integrals over the overlap of old "
          "and new cells, which keep mass, momentum and enthalpy, and lose little; or the name "
          "of a plug-in that gives values at the new places and keeps the mass alone.");
      e.plugins<ValueRemap<dim>>();
      e.refuse(fills_cells && !is_conservative(), void_entry,
               "values at new places (`Refill remap`) say nothing of cells that are filled or "
               "emptied; allowed with it is conservative.");
      e.refuse(fills_cells && e.given("Integration") != "smoothed", void_entry,
               "cells are filled and emptied by their sub-cells; allowed with it is "
               "\"Integration = smoothed\".");
      interval = e.integer("Steps between refill checks", "20", between(1, 1000000),
                           "Cells are compared with the limits of refills every so many steps.");
    }

    bool is_on() const
    {
      return section.has_value();
    }

    /** The displacement of the mesh for nodes; none: it stays. Throws InputError. Collective. */
    std::optional<Expression<dim>> motion() const
    {
      if (section->get(motion_entry).empty())
        return {};
      return Expression<dim>(*section, motion_entry, dim);
    }

    /** Where cells are void at the start, by centre; null: refills fill none. Throws InputError. */
    std::optional<Predicate<dim>> void_cells() const
    {
      if (!fills_cells)
        return {};
      return std::optional<Predicate<dim>>(std::in_place, *section, void_entry);
    }

    /** Whether fields go over by integrals over the overlap of old and new cells. */
    bool is_conservative() const
    {
      return remap == conservative;
    }

    /** The plug-in that remaps fields; null where the remap is conservative. Throws InputError. */
    std::unique_ptr<ValueRemap<dim>> value_remap() const
    {
      if (is_conservative())
        return nullptr;
      return Registry<ValueRemap<dim>>::instance().create(remap, section->subsection(remap));
    }

    /** Throws InputError for @p entry, or for the one that switches refills on. Only if on. */
    [[noreturn]] void refuse(const std::string &message,
                             const std::string &entry = "Refill stretch") const
    {
      section->fail(entry, message);
    }

    double stretch = 0;          ///< largest ratio of principal stretches since the last refill
    unsigned int layers = 0;     ///< of cells around one beyond a limit that are refilled with it
    unsigned int interval = 1;   ///< cells are checked every so many steps
    bool surface_slides = false; ///< nodes of the surface slide on it, and do not stay
    bool fills_cells = false;    ///< refills fill and empty cells: void_cells() has something

  private:
    static inline const char *const stretch_entry = "Refill stretch";
    static inline const char *const motion_entry = "Refill motion";
    static inline const char *const void_entry = "Refill void cells";
    static inline const char *const remap_entry = "Refill remap";

    std::optional<Section> section;
    static constexpr const char *conservative = "conservative";
    std::string remap = conservative;
  };
} // namespace tombolo
