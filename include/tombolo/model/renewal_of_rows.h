// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>

namespace tombolo
{
  template <int dim>
  class Model;

  /** What Model::update_stencils() calls around a change of rows. Both are collective. */
  struct RenewalOfRows
  {
    /** Before any row of a part changes, for each such part. */
    std::function<void()> before;
    /** With the partition of before. */
    std::function<void()> after;
    bool has_begun = false; ///< in this step
  };

  /** Lets the particle parts of @p model tell before their rows change: the model begins to change
   * then, and calls RenewalOfRows::before. */
  template <int dim>
  void watch_rows(Model<dim> &model);
} // namespace tombolo
