// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace tombolo
{
  class NodalVector;

  /** A formulation whose cells may lie beside cells of half their size. Parts of others are refused
   * where the size of cells changes. */
  class GradedCells
  {
  public:
    virtual ~GradedCells() = default;

    /** Whether the nodes in the middle of faces and edges of a cell move by themselves, since its
     * field follows them; otherwise they follow the corners between which they lie. */
    virtual bool follows_middle_nodes() const = 0;

    /** Gives the points that @p are_new the volumes that they have at these positions, which have
     * ghosts. Their volumes so far say how the points of a cell share its volume, where they do. */
    virtual void find_volumes(const NodalVector &position, const std::vector<bool> &are_new) = 0;
  };
} // namespace tombolo
