// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/mesh/mesh.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  /** The part NAME of an entry `Cells` that is `from NAME`, empty where the name is missing;
   * nothing where it is another entry. */
  std::optional<std::string> source_of_cells(const std::string &cells);

  /**
   * Which part each cell belongs to, from the entry `Cells` of each "Part: NAME" section:
   * a predicate of the cell's centre (`x < 5`), `material 2`, `group NAME`, `mesh NAME`, `all`,
   * `otherwise` (cells that are in no other part), or `from NAME` (none: those that the part NAME
   * loses in the run). Works for owned and ghost cells, and before partitioning.
   */
  template <int dim>
  class PartCells
  {
  public:
    using Cell = typename dealii::Triangulation<dim>::cell_iterator;

    /** @p part_sections are the "Part: NAME" sections in the order of `Parts`. */
    PartCells(const std::vector<Section> &part_sections, const Mesh<dim> &mesh);
    ~PartCells();

    /** The part of a cell. Only meaningful after check(), or as a guess for weights before. */
    unsigned int part_of(const Cell &cell) const;

    /** The part of the cell beyond an inner face, or of one of the smaller cells there. */
    unsigned int part_beyond(const Cell &cell, const unsigned int face) const
    {
      return part_of(cell->face(face)->has_children() ? cell->neighbor_child_on_subface(face, 0)
                                                      : cell->neighbor(face));
    }

    /** Throws InputError where a cell is in no part or in two (with the position of the cell), or a
     * part has no cells. Collective. */
    void check(const dealii::Triangulation<dim> &triangulation) const;

  private:
    struct Rule;
    struct Survey;

    /** Counts the cells of each part, and those in none or in two, over all ranks. Collective. */
    Survey survey(const dealii::Triangulation<dim> &triangulation) const;
    /** Collective. */
    void refuse_empty_parts(const Survey &survey,
                            const dealii::Triangulation<dim> &triangulation) const;
    void refuse_cells_without_one_part(const Survey &survey) const;

    std::vector<Section> sections;
    std::vector<Rule> rules;
  };

  /** What a step costs in relative units. */
  struct StepCost
  {
    double per_cell = 0.;
    double per_node = 0.; ///< for each vertex of a part's cells, on the rank that owns the node
  };

  /**
   * Redistributes the mesh so that all ranks have the same work, with @p cost_of_part[k](ratio)
   * of the cells of part k, where the box along the axes around a cell has `ratio` times its
   * volume. Call it after PartCells::check() and before anything is numbered on the mesh.
   * Collective.
   */
  template <int dim>
  void balance(Mesh<dim> &mesh, const PartCells<dim> &part_cells,
               const std::vector<std::function<StepCost(double)>> &cost_of_part);

  extern template class PartCells<2>;
  extern template class PartCells<3>;
} // namespace tombolo
