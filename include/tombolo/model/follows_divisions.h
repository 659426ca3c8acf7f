// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  /**
   * What a process is as well whose state goes over to a mesh with other cells by serialize(): sums
   * over ranks stay, values of nodes that both meshes have stay, and new nodes begin with zero
   * (StateArchive::nodal()). Other processes are refused where cells are divided in the run.
   */
  class FollowsDivisions
  {
  public:
    virtual ~FollowsDivisions() = default;
  };
} // namespace tombolo
