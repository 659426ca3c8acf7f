// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/refill_settings.h>

#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    const char *const stretch_entry = "Refill stretch";
    const char *const refill_layers_entry = "Refill layers";
    const char *const surface_entry = "Refill surface";
    const char *const motion_entry = "Refill motion";
    const char *const void_entry = "Refill void cells";
    const char *const remap_entry = "Refill remap";
    const char *const looks_entry = "Steps between refill checks";
  } // namespace

  template <int dim>
  void RefillSettings::declare_parameters(const Entries &e)
  {
    e.text(stretch_entry, "", "1",
           "The part is refilled where the ratio of the largest to the smallest principal stretch "
           "of a point since the last refill is above this: inner nodes go back to places like "
           "those of the initial mesh, and the present configuration becomes the reference of the "
           "functions. 1.8 is a good value. It is refilled as well where a point has less than a "
           "fifth of its volume at the last refill. Empty: never.");
    e.integer(refill_layers_entry, "2", between(0, 1000000),
              "With a cell beyond a limit, the inner nodes of so many layers of cells around it "
              "are placed anew. Nodes elsewhere stay.");
    e.choice(
        surface_entry, "held", "held|sliding",
        "What a refill does with nodes on the surface of the part: held, they stay; sliding, those "
        "on smooth sides of the body move along the surface to places like those of the initial "
        "mesh, and keep the volume. Nodes at edges of the body, where names of boundaries meet, "
        "beside other parts, on planes of symmetry and with prescribed components stay.");
    e.text(motion_entry, "", "L",
           "The displacement of the mesh to whose places a refill takes nodes, a function of the "
           "initial x, y, z and of t, components separated by ';'. Material flows through a mesh "
           "that moves. For a tool that goes far into or along a part: its way times a weight that "
           "is 1 around the tool and 0 at the nodes that stay. Empty: the initial mesh. Only where "
           "the surface is sliding.");
    e.text(void_entry, "", "",
           "A predicate of the place of cells that are void at the start: without material, such "
           "as those above a plate into which metal is pushed. With it refills fill cells and "
           "empty others, so that surfaces that meet become one: a cell is full where the body has "
           "at least half of it. Never true (`0`): all cells are full at the start. Empty: cells "
           "stay full. Only where the surface is sliding.");
    std::string remaps = conservative;
    for (const std::string &name : Registry<ValueRemap<dim>>::instance().names())
      remaps += "|" + name;
    e.choice(remap_entry, conservative, remaps,
             "How a refill carries fields over: conservative, by integrals over the overlap of old "
             "and new cells, which keep mass, momentum and enthalpy, and lose little; or the name "
             "of a plug-in that gives values at the new places and keeps the mass alone.");
    e.plugins<ValueRemap<dim>>();
    e.integer(looks_entry, "20", between(1, 1000000),
              "Cells are compared with the limits of refills every so many steps.");
  }

  RefillSettings::RefillSettings(const Section &of_part)
  {
    if (of_part.get(stretch_entry).empty())
      return;
    section = of_part;
    largest_stretch = of_part.get_positive(stretch_entry);
    if (!(largest_stretch > 1.))
      of_part.fail(stretch_entry, "allowed is a number above 1, such as 1.8; the ratio is 1 where "
                                  "nothing is deformed");
    layers = of_part.get_unsigned(refill_layers_entry);
    steps_between_looks = of_part.get_unsigned(looks_entry);
    is_sliding = of_part.get(surface_entry) == "sliding";
    if (!of_part.get(motion_entry).empty() && !is_sliding)
      of_part.fail(motion_entry, "nodes of the surface are held (`Refill surface`), so that the "
                                 "mesh cannot move; allowed with it is sliding.");
    has_void_cells = !of_part.get(void_entry).empty();
    if (has_void_cells && !is_sliding)
      of_part.fail(void_entry, "nodes of the surface are held (`Refill surface`), so that cells "
                               "cannot be filled or emptied; allowed with it is sliding.");
    remap = of_part.get(remap_entry);
    if (has_void_cells && !is_conservative())
      of_part.fail(void_entry,
                   "values at new places (`Refill remap`) say nothing of cells that are "
                   "filled or emptied; allowed with it is conservative.");
    if (has_void_cells && of_part.get("Integration") != "smoothed")
      of_part.fail(void_entry,
                   "cells are filled and emptied by their sub-cells; allowed with it is "
                   "\"Integration = smoothed\".");
  }

  template <int dim>
  std::unique_ptr<ValueRemap<dim>> RefillSettings::value_remap() const
  {
    if (is_conservative())
      return nullptr;
    return Registry<ValueRemap<dim>>::instance().create(remap, section->subsection(remap));
  }

  template <int dim>
  std::optional<Expression<dim>> RefillSettings::motion() const
  {
    if (section->get(motion_entry).empty())
      return {};
    return Expression<dim>(*section, motion_entry, dim);
  }

  template <int dim>
  std::optional<Predicate<dim>> RefillSettings::void_cells() const
  {
    if (section->get(void_entry).empty())
      return {};
    return std::optional<Predicate<dim>>(std::in_place, *section, void_entry);
  }

  void RefillSettings::refuse(const std::string &message) const
  {
    section->fail(stretch_entry, message);
  }

  void RefillSettings::refuse_sliding(const std::string &message) const
  {
    section->fail(surface_entry, message);
  }

  void RefillSettings::refuse_motion(const std::string &message) const
  {
    section->fail(motion_entry, message);
  }

  void RefillSettings::refuse_void_cells(const std::string &message) const
  {
    section->fail(void_entry, message);
  }

  template void RefillSettings::declare_parameters<2>(const Entries &);
  template void RefillSettings::declare_parameters<3>(const Entries &);
  template std::unique_ptr<ValueRemap<2>> RefillSettings::value_remap() const;
  template std::unique_ptr<ValueRemap<3>> RefillSettings::value_remap() const;
  template std::optional<Predicate<2>> RefillSettings::void_cells() const;
  template std::optional<Predicate<3>> RefillSettings::void_cells() const;
  template std::optional<Expression<2>> RefillSettings::motion() const;
  template std::optional<Expression<3>> RefillSettings::motion() const;
} // namespace tombolo
