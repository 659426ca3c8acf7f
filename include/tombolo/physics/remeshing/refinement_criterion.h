// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>
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
    virtual std::string missing(const std::vector<Part<dim>> &parts) const = 0;

    /** The value in each owned cell of each part, in the order of cells_of_part(). Collective. */
    virtual std::vector<std::vector<double>> values(Model<dim> &model) const = 0;
  };

  template <int dim>
  struct PluginKind<RefinementCriterion<dim>>
  {
    static constexpr const char *name = "refinement criterion";
  };
} // namespace tombolo
