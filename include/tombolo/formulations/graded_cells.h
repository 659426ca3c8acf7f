// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  /** A formulation whose cells may lie beside cells of half their size. Parts of others are refused
   * where the size of cells changes. */
  class GradedCells
  {
  public:
    virtual ~GradedCells() = default;

    /** Whether the nodes in the middle of faces and edges of a cell move by themselves, since its
     * field follows them; otherwise they follow the corners between which they lie. */
    virtual bool follows_middle_nodes() const = 0;
  };
} // namespace tombolo
