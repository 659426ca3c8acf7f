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
    explicit RefillSettings(const Entries &e);

    bool is_on() const
    {
      return section.has_value();
    }

    /** The displacement of the mesh to whose places nodes go; nothing if it stays. Throws
     * InputError. Collective. */
    std::optional<Expression<dim>> motion() const;

    /** Where cells are void at the start, by their centre, so that refills fill and empty cells;
     * nothing if they do not. Throws InputError. */
    std::optional<Predicate<dim>> void_cells() const;

    /** Whether fields go over by integrals over the overlap of old and new cells. */
    bool is_conservative() const
    {
      return remap == conservative;
    }

    /** What carries fields over otherwise; null where the remap is conservative. Throws InputError.
     */
    std::unique_ptr<ValueRemap<dim>> value_remap() const;

    /** Throws InputError for @p entry, or for the one that switches refills on. Only if on. */
    [[noreturn]] void refuse(const std::string &message,
                             const std::string &entry = "Refill stretch") const;

    double stretch = 0;          ///< largest ratio of principal stretches since the last refill
    unsigned int layers = 0;     ///< of cells around one beyond a limit that are refilled with it
    unsigned int interval = 1;   ///< cells are looked at every so many steps
    bool surface_slides = false; ///< nodes of the surface slide on it, and do not stay
    bool fills_cells = false;    ///< refills fill and empty cells: void_cells() has something

  private:
    std::optional<Section> section;
    static constexpr const char *conservative = "conservative";
    std::string remap = conservative;
  };
} // namespace tombolo
