// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/smoothed/refill_settings.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/mesh/nodes.h>

#include <vector>

namespace tombolo
{
  /**
   * Which cells of a part are void: cells of the mesh without material, which a refill can fill, as
   * it can empty others. Holds owned and ghost cells. Off, all cells are full.
   */
  template <int dim>
  class VoidCells
  {
  public:
    using Cell = typename Nodes<dim>::Cell;

    /** Void are cells whose centre fulfils @p is_void. Throws its InputError. Collective. */
    void initialize(const PartSetup<dim> &setup, const Predicate<dim> &is_void)
    {
      initialize(setup);
      std::vector<bool> found;
      attempt_on_all_ranks<InputError>(setup.communicator,
                                       [&]
                                       {
                                         for (const Cell &cell :
                                              cells_of_part(*nodes, *part_cells, part))
                                           found.push_back(is_void(cell->center()));
                                       });
      set(found);
    }

    /** None is void yet. Collective. */
    void initialize(const PartSetup<dim> &setup)
    {
      nodes = setup.nodes;
      part_cells = setup.part_cells;
      part = setup.index;
      set(std::vector<bool>(cells_of_part(*nodes, *part_cells, part).size(), false));
    }

    bool is_on() const
    {
      return nodes != nullptr;
    }

    /** Of an owned or ghost cell of the part. */
    bool is_void(const Cell &cell) const
    {
      return is_on() && flags[cell->active_cell_index()];
    }

    /** Of the owned cells of the part, in the order of active cells. */
    const std::vector<bool> &is_void_by_cell() const
    {
      return owned_flags;
    }

    /** Sets other void cells, in this order. Collective. */
    void set(const std::vector<bool> &is_void)
    {
      owned_flags = is_void;
      flags.assign(nodes->dof_handler().get_triangulation().n_active_cells(), false);
      std::size_t c = 0;
      for (const Cell &cell : cells_of_part(*nodes, *part_cells, part))
        flags[cell->active_cell_index()] = is_void[c++];
      update_ghost_flags(*nodes, flags);
    }

  private:
    const Nodes<dim> *nodes = nullptr;
    const PartCells<dim> *part_cells = nullptr;
    unsigned int part = 0;
    std::vector<bool> owned_flags;
    std::vector<bool> flags; // by the index of active cells
  };

  namespace internal
  {
    /** Whether cells lie beside cells of half their size. Collective. */
    template <int dim>
    bool has_cells_with_further_nodes(const PartSetup<dim> &setup)
    {
      return any_of_all_ranks(
          smoothed_cells_of(setup),
          [](const SmoothedCell<dim> &cell) { return cell.has_further_nodes(); },
          setup.communicator);
    }

    /** The centre of a full cell beside a smaller void one. Collective. */
    template <int dim>
    std::string cell_beside_void_cells(const PartSetup<dim> &setup)
    {
      std::string result;
      for (const auto &cell : setup.cells())
        for (const unsigned int face : cell->face_indices())
          for (unsigned int child = 0; child < FaceNodes<dim>::n_parts; ++child)
            if (result.empty() && cell->face(face)->has_children() &&
                !setup.void_cells->is_void(cell) &&
                setup.void_cells->is_void(cell->neighbor_child_on_subface(face, child)))
            {
              result = as_text("(", cell->center(), ")");
            }
      return first_text(setup.communicator, result);
    }

    template <int dim>
    void check_conversion(const PartSetup<dim> &setup, const RefillSettings<dim> &refill,
                          const ConversionCriterion &conversion)
    {
      if (refill.fills_cells)
        conversion.refuse(
            "refills fill and empty cells of the part (`Refill void cells`), and none "
            "is lost; allowed is one of both.");
      if (refill.is_on() && refill.motion())
        conversion.refuse(
            "the mesh of the part moves (`Refill motion`), and particles would not go "
            "with it; allowed is one of both.");
      if (refill.is_on() && !refill.is_conservative())
        conversion.refuse("values at new places (`Refill remap`) say nothing of cells that have "
                          "become particles; allowed with it is conservative.");
      if (has_cells_with_further_nodes(setup))
        conversion.refuse("the part has cells beside cells of half their size (`Refine where`); "
                          "allowed are parts without such faces.");
    }
  } // namespace internal

  /** @p setup with void cells: those that its refills begin with, and those that become particles
   * by @p conversion. They are kept in @p voids. Throws InputError where a part cannot be refilled,
   * or its cells cannot become particles. Collective. */
  template <int dim>
  PartSetup<dim> with_void_cells(const PartSetup<dim> &setup, const RefillSettings<dim> &refill,
                                 const ConversionCriterion &conversion, VoidCells<dim> &voids)
  {
    PartSetup<dim> result = setup;
    if (conversion.is_on())
    {
      internal::check_conversion(setup, refill, conversion);
      voids.initialize(setup);
      result.void_cells = &voids;
    }
    if (!refill.is_on())
      return result;
    if (!setup.has_mechanics)
      refill.refuse("the scene has no mechanics, since its materials have no stresses; "
                    "nothing is deformed.");
    if (refill.motion() && internal::has_cells_with_further_nodes(setup))
      refill.refuse("the part has cells beside cells of half their size (`Refine where`), "
                    "whose nodes stay; allowed is one of both.",
                    "Refill motion");
    const auto is_void = refill.void_cells();
    if (!is_void)
      return result;
    if (!setup.nodes->images()->empty())
      refill.refuse("the scene has " + Images::words(false) +
                        ", at which cells are neither filled nor emptied; allowed is the "
                        "whole body.",
                    "Refill void cells");
    voids.initialize(setup, *is_void);
    result.void_cells = &voids;
    if (const std::string centre = internal::cell_beside_void_cells(result); !centre.empty())
      refill.refuse("smaller cells beside the full cell around " + centre +
                        " are void; allowed are void cells beside full ones of their own "
                        "size, or of half of it.",
                    "Refill void cells");
    if (!any_of_all_ranks(
            voids.is_void_by_cell(), [](const bool is_void_cell) { return !is_void_cell; },
            setup.communicator))
      refill.refuse("all cells of the part are void; allowed is a predicate that is false "
                    "at the centre of some.",
                    "Refill void cells");
    return result;
  }
} // namespace tombolo
