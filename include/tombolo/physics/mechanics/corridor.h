// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/contact/surface_contact.h>
#include <tombolo/state/nodal_state.h>

#include <optional>
#include <string>

namespace tombolo
{
  /**
   * Where a contact is meant to be, its entry `Corridor`: a condition on the initial places of
   * nodes, such as those of the particles or of the refined cells along the way of a tool. Cells
   * outside of it are not made for what the surface does to them.
   */
  template <int dim>
  class Corridor
  {
  public:
    /** Of the contact with this section; throws InputError where the condition cannot be read. */
    explicit Corridor(const Section &section);

    /** Throws InputError where the condition has no value at a node that @p contact can touch, and
     * where no such node is inside. Collective. */
    void check(const SurfaceContact<dim> &contact, const NodalState &state) const;

    /** A sentence the first time that @p contact touches a node outside; else nothing. The same on
     * all ranks. Collective. */
    std::optional<std::string> find_exit(const SurfaceContact<dim> &contact,
                                         const NodalState &state, const Clock &clock);

    void list(Records &records)
    {
      records.value("corridor was left", was_left);
    }

  private:
    Section section;
    Predicate<dim> is_inside;
    bool was_left = false;
  };
} // namespace tombolo
