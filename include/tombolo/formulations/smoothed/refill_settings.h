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
  class RefillSettings
  {
  public:
    template <int dim>
    static void declare_parameters(const Entries &e);

    /** Throws InputError. */
    explicit RefillSettings(const Section &section);

    bool is_on() const
    {
      return section.has_value();
    }

    /** The largest ratio of the principal stretches of a point since the last refill. */
    double stretch() const
    {
      return largest_stretch;
    }

    /** How many layers of cells around one beyond a limit are refilled with it. */
    unsigned int n_layers() const
    {
      return layers;
    }

    /** Cells are looked at every so many steps. */
    unsigned int interval() const
    {
      return steps_between_looks;
    }

    /** Whether nodes of the surface slide on it, and do not stay. */
    bool surface_slides() const
    {
      return is_sliding;
    }

    /** The displacement of the mesh to whose places nodes go; nothing if it stays. Throws
     * InputError. Collective. */
    template <int dim>
    std::optional<Expression<dim>> motion() const;

    /** Where cells are void at the start, by their centre, so that refills fill and empty cells;
     * nothing if they do not. Throws InputError. */
    template <int dim>
    std::optional<Predicate<dim>> void_cells() const;

    /** Whether refills fill and empty cells: void_cells() has something. */
    bool fills_cells() const
    {
      return has_void_cells;
    }

    /** Whether fields go over by integrals over the overlap of old and new cells. */
    bool is_conservative() const
    {
      return remap == conservative;
    }

    /** What carries fields over otherwise; null where the remap is conservative. Throws InputError.
     */
    template <int dim>
    std::unique_ptr<ValueRemap<dim>> value_remap() const;

    /** Throws InputError for the entry that switches refills on. Only if on. */
    [[noreturn]] void refuse(const std::string &message) const;
    /** The same for the entry of surface_slides(). */
    [[noreturn]] void refuse_sliding(const std::string &message) const;
    /** The same for the entry of motion(). */
    [[noreturn]] void refuse_motion(const std::string &message) const;
    /** The same for the entry of void_cells(). */
    [[noreturn]] void refuse_void_cells(const std::string &message) const;

  private:
    std::optional<Section> section;
    double largest_stretch = 0;
    unsigned int layers = 0, steps_between_looks = 1;
    bool is_sliding = false, has_void_cells = false;
    static constexpr const char *conservative = "conservative";
    std::string remap = conservative;
  };
} // namespace tombolo
