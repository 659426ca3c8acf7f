// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/mesh/cell_divisions.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/remeshing/model_content.h>
#include <tombolo/physics/remeshing/refinement_criterion.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Says between two steps which cells a criterion wants to be divided or joined, and keeps the
   * books of what each new mesh takes: the run itself makes a new model of the same parameters
   * there (Simulation). A cell is divided once in a check; the mesh never becomes coarser than
   * that of the file, from which levels count.
   */
  template <int dim>
  class AdaptiveRefinement : public Process<dim>
  {
  public:
    /** Throws InputError. */
    explicit AdaptiveRefinement(const Entries &e);

    AdaptiveRefinement(const Parameters &parameters, const Model<dim> &model);

    /** Refuses scenes with what cannot go over to another mesh. Throws InputError. */
    void validate(const std::vector<Part<dim>> &parts) const;

    /** The divided cells of the mesh to go over to before the step number @p step; nothing where
     * the present mesh stays. Where cells become smaller than all that there are, one step that
     * suits them is taken before: a long one would excite what only the new mesh can hold. Throws
     * InputError where the mesh does not fit into memory. Collective. */
    std::optional<CellDivisions> next_divisions(const Model<dim> &model, unsigned long step);

    /** Books that a new mesh has @p after of what the one before had. */
    void book(const ModelContent &before, const ModelContent &after, const Model<dim> &model);

    void model_changed(const Model<dim> &model) override;

  private:
    /** What the criterion wants. */
    struct Wanted
    {
      CellDivisions divisions;
      bool has_smaller_cells = false;
    };
    std::optional<Wanted> find_wanted(const Model<dim> &model) const;
    /** Whether each cell of for_cells() is so near to one that the criterion wants fine that it is
     * to be fine, too. Collective. */
    std::vector<bool> cells_to_be_fine(const Model<dim> &model,
                                       const std::vector<double> &values) const;
    /** The coarsest and the finest level of the mesh of the file. Collective. */
    std::pair<int, int> levels_of_file(const Model<dim> &model) const;

    void count_cells(const Model<dim> &model)
    {
      n_cells = static_cast<double>(model.mesh.triangulation.n_global_active_cells());
      most_cells = std::max(most_cells, n_cells);
    }

    void refuse_too_many_levels(const Model<dim> &model) const;

    Section section;
    std::unique_ptr<RefinementCriterion<dim>> criterion;
    std::optional<Predicate<dim>> where; ///< none: everywhere
    double refine_above;
    std::optional<double> coarsen_below;
    unsigned int most_levels, layers, interval;

    CellDivisions of_file;      ///< of the mesh of the file, which the run never makes coarser
    bool is_announced = false;  ///< smaller cells come after this step
    unsigned long n_meshes = 0; ///< that the run has made
    double n_cells = 0, most_cells = 0;
    // On the first rank.
    double lost = 0;
    std::array<double, 3> lost_momentum{}, lost_angular_momentum{};
  };
} // namespace tombolo
