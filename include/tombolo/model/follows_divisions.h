// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  struct Clock;
  template <int dim>
  class Model;
  class StateArchive;

  /**
   * What a process is as well whose state goes over to a mesh with other cells by serialize(): sums
   * over ranks stay, values of nodes that both meshes have stay, and new nodes begin with zero
   * (StateArchive::nodal()). Other processes are refused where cells are divided in the run.
   */
  template <int dim>
  class FollowsDivisions
  {
  public:
    virtual ~FollowsDivisions() = default;

    /** After serialize() of all processes: fields of all nodes, of which new nodes get the mean of
     * those between which they lie, and what follows from them on the new mesh. Collective. */
    virtual void follow_division(const Model<dim> & /*model*/, StateArchive & /*archive*/,
                                 const Clock & /*clock*/)
    {}
  };
} // namespace tombolo
