// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  /** A formulation whose cells may have nodes in the middle of their faces and edges, because the
   * cells of the part beside them are half as large. Parts of others are refused where the size of
   * cells changes. */
  class GradedCells
  {
  public:
    virtual ~GradedCells() = default;
  };
} // namespace tombolo
