// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/boundary/thermal_condition.h>
#include <tombolo/boundary/tributary_areas.h>
#include <tombolo/mesh/nodes.h>

#include <vector>

namespace tombolo
{
  /** The nodes and faces that thermal conditions select, at the start of a run. */
  template <int dim>
  class ThermalSelection
  {
  public:
    /** Finds them, and adds faces that heat crosses to @p areas, by condition. @p conditions are
     * those of @p sections and must outlive this, as @p nodes. No heat crosses planes of symmetry.
     * Throws InputError where a condition selects nothing, or two on one face exclude each other.
     * Collective. */
    ThermalSelection(const std::vector<Section> &sections,
                     const std::vector<ThermalCondition<dim>> &conditions, const Nodes<dim> &nodes,
                     TributaryAreas<dim> &areas);

    /** By condition: owned nodes of a temperature or a source, ascending; none for others. */
    std::vector<std::vector<dealii::types::global_dof_index>> owned_nodes() const;

  private:
    void find_nodes();
    void find_faces(TributaryAreas<dim> &areas);
    void refuse_what_selects_nothing(const std::vector<Section> &sections) const;
    void refuse_conflicts(const std::vector<Section> &sections) const;

    const std::vector<ThermalCondition<dim>> &conditions;
    const Nodes<dim> &nodes;
    /** By condition: owned and ghost nodes of a temperature or a source, ascending. */
    std::vector<std::vector<dealii::types::global_dof_index>> selected_nodes;
    std::vector<unsigned long> n_selected; ///< owned nodes or faces, by condition
    /** Faces of this rank with two conditions that exclude each other: [later][earlier]. */
    std::vector<unsigned int> n_conflicts;
  };
} // namespace tombolo
