// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/mesh/mesh.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Local refinement of a mesh, whatever its source: `Refine where` and `Refinement levels` of
   * section Mesh. A cell whose centre fulfils the predicate of a region is divided into 2^dim
   * cells, as often as the region has levels; neighbours across faces, edges and corners differ by
   * one level at most. Nodes in the middle of edges and faces lie there, on the faces of the
   * source.
   */
  template <int dim>
  class MeshRefinement
  {
  public:
    /** Throws InputError. */
    explicit MeshRefinement(const Entries &e);

    /** Refines a mesh whose cells have one level; does nothing where there is no region. Throws the
     * InputError of a region without cells, or of a mesh that does not fit into memory, before it
     * refines anything. Collective. */
    void refine(Mesh<dim> &mesh) const;

  private:
    struct Survey;

    /** Which cells are to be refined, beyond a level that all cells have at least. Collective. */
    Survey survey(const Mesh<dim> &mesh, unsigned int base_level) const;
    void read_regions(const std::string &text);
    void read_levels();
    void check_levels(const Mesh<dim> &mesh, unsigned int base_level) const;

    Section section;
    std::unique_ptr<Expression<dim>> regions; ///< a predicate each; null: none
    std::vector<unsigned int> levels;         ///< of each region
  };
} // namespace tombolo
