// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/cells_of_part.h>
#include <tombolo/model/model.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** What decides where cells are divided in a run: a plug-in, `Criterion` in section
   * `Mesh/Adaptive refinement`. */
  template <int dim>
  class RefinementCriterion
  {
  public:
    virtual ~RefinementCriterion() = default;

    /** What the parts of a scene lack for it; empty: nothing. Parts have no mesh yet. */
    std::string missing(const std::vector<Part<dim>> &parts) const
    {
      std::string result;
      for (const Part<dim> &part : parts)
        if (result = lack(part); result.empty())
          break;
      return result;
    }

    /** The value in each owned cell of all parts, in the order of for_cells(). Collective. */
    virtual std::vector<double> values(const Model<dim> &model) const = 0;

  private:
    /** What a part lacks whose cells have no other values than zero, as a clause of a scene that
     * has such parts only; else nothing. */
    virtual std::string lack(const Part<dim> &part) const = 0;
  };

  template <int dim>
  struct PluginKind<RefinementCriterion<dim>>
  {
    static constexpr const char *name = "refinement criterion";
  };

  /** Calls @p visit(cell, local nodes) for all owned cells, part by part. */
  template <int dim, typename Visitor>
  void for_cells(const Model<dim> &model, const Visitor &visit)
  {
    std::vector<dealii::types::global_dof_index> nodes;
    std::vector<unsigned int> local;
    for (unsigned int part = 0; part < model.parts.size(); ++part)
      for (const auto &cell : cells_of_part(*model.nodes, *model.part_cells, part))
      {
        model.nodes->cell_nodes(cell, nodes);
        local.clear();
        for (const auto node : nodes)
          local.push_back(model.state.partition()->local_index(node));
        visit(cell, local);
      }
  }
} // namespace tombolo
