// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  template <int dim>
  class Model;
  class StateArchive;

  /**
   * What a process is as well whose state goes on where a run starts from the end of another one
   * (`Initial state`): springs of contacts, the place of rigid bodies. Other processes begin anew.
   */
  template <int dim>
  class ContinuedState
  {
  public:
    virtual ~ContinuedState() = default;

    /** Takes from the archive of the other run what fits to this one. The model has the state of
     * its nodes and points; balances begin at zero. Collective. */
    virtual void continue_state(Model<dim> &model, StateArchive &archive) = 0;
  };
} // namespace tombolo
