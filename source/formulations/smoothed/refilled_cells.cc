// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/refilled_cells.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/mesh/cells_of_part.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    /** Whether cells lie beside cells of half their size. Collective. */
    template <int dim>
    bool has_cells_with_further_nodes(const PartSetup<dim> &setup)
    {
      bool result = false;
      for (const SmoothedCell<dim> &cell : smoothed_cells_of(setup))
        result = result || cell.has_further_nodes();
      return Utilities::MPI::max(result ? 1 : 0, setup.communicator) != 0;
    }

    /** The place of a full cell at which one of the smaller cells beside it is void. Collective. */
    template <int dim>
    std::string cell_at_smaller_void_ones(const PartSetup<dim> &setup)
    {
      std::string result;
      for (const auto &cell : cells_of_part(*setup.nodes, *setup.part_cells, setup.index))
        for (const unsigned int face : cell->face_indices())
          for (unsigned int child = 0; child < FaceNodes<dim>::n_parts; ++child)
            if (result.empty() && cell->face(face)->has_children() &&
                !setup.void_cells->is_void(cell) &&
                setup.void_cells->is_void(cell->neighbor_child_on_subface(face, child)))
            {
              result = as_text("(", cell->center(), ")");
            }
      for (const std::string &of_rank : texts_of_ranks(setup.communicator, result))
        if (!of_rank.empty())
          return of_rank;
      return {};
    }

    template <int dim>
    void check_conversion(const PartSetup<dim> &of_part, const RefillSettings<dim> &refill,
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
      if (has_cells_with_further_nodes(of_part))
        conversion.refuse("the part has cells beside cells of half their size (`Refine where`); "
                          "allowed are parts without such faces.");
    }
  } // namespace

  template <int dim>
  void VoidCells<dim>::initialize(const PartSetup<dim> &setup)
  {
    nodes = setup.nodes;
    part_cells = setup.part_cells;
    part = setup.index;
    set(std::vector<bool>(cells_of_part(*nodes, *part_cells, part).size(), false));
  }

  template <int dim>
  void VoidCells<dim>::initialize(const PartSetup<dim> &setup, const Predicate<dim> &is_void)
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

  template <int dim>
  void VoidCells<dim>::set(const std::vector<bool> &is_void)
  {
    of_owned = is_void;
    flags.assign(nodes->dof_handler().get_triangulation().n_active_cells(), false);
    std::size_t c = 0;
    for (const Cell &cell : cells_of_part(*nodes, *part_cells, part))
      flags[cell->active_cell_index()] = is_void[c++];
    update_ghost_flags(*nodes, flags);
  }

  template <int dim>
  PartSetup<dim> with_void_cells(const PartSetup<dim> &of_part, const RefillSettings<dim> &refill,
                                 const ConversionCriterion &conversion, VoidCells<dim> &voids)
  {
    PartSetup<dim> result = of_part;
    if (conversion.is_on())
    {
      check_conversion(of_part, refill, conversion);
      voids.initialize(of_part);
      result.void_cells = &voids;
    }
    if (!refill.is_on())
      return result;
    if (!of_part.has_mechanics)
      refill.refuse("the scene has no mechanics, since its materials have no stresses; "
                    "nothing is deformed.");
    if (refill.motion() && has_cells_with_further_nodes(of_part))
      refill.refuse("the part has cells beside cells of half their size (`Refine where`), "
                    "whose nodes stay; allowed is one of both.",
                    "Refill motion");
    const auto is_void = refill.void_cells();
    if (!is_void)
      return result;
    if (!of_part.nodes->images()->empty())
      refill.refuse("the scene has " + Images::words(false) +
                        ", at which cells are neither filled nor emptied; allowed is the "
                        "whole body.",
                    "Refill void cells");
    voids.initialize(of_part, *is_void);
    result.void_cells = &voids;
    if (const std::string place = cell_at_smaller_void_ones(result); !place.empty())
      refill.refuse("smaller cells beside the full cell around " + place +
                        " are void; allowed are void cells beside full ones of their own "
                        "size, or of half of it.",
                    "Refill void cells");
    const auto &flags = voids.of_cells();
    const bool has_full = std::find(flags.begin(), flags.end(), false) != flags.end();
    if (Utilities::MPI::max(has_full ? 1 : 0, of_part.communicator) == 0)
      refill.refuse("all cells of the part are void; allowed is a predicate that is false "
                    "at the centre of some.",
                    "Refill void cells");
    return result;
  }

  template class VoidCells<2>;
  template class VoidCells<3>;
  template PartSetup<2> with_void_cells(const PartSetup<2> &, const RefillSettings<2> &,
                                        const ConversionCriterion &, VoidCells<2> &);
  template PartSetup<3> with_void_cells(const PartSetup<3> &, const RefillSettings<3> &,
                                        const ConversionCriterion &, VoidCells<3> &);
} // namespace tombolo
