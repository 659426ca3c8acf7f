// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  template <int dim>
  class MeshTransfer;
  template <int dim>
  class Model;
  class StateArchive;

  /** Writes to a checkpoint, or reads from it, the state of nodes and parts between two steps: the
   * positions of the coming and the stresses of the last evaluation. Reading makes the neighbours
   * of the run that wrote. Throws InputError where it is not of this model. With @p transfer it
   * reads the state on another division of the mesh. Collective. */
  template <int dim>
  void serialize_model(Model<dim> &model, StateArchive &archive,
                       const MeshTransfer<dim> *transfer = nullptr);

  /** Reads from the checkpoint of another run what nodes and material points are, and nothing of
   * its processes (Records::continue_from()): positions, velocities, stresses, internal variables,
   * temperatures. Where that run had no heat, temperatures stay as they are. Throws InputError
   * where it is of another mesh, or lacks a field. Collective. */
  template <int dim>
  void read_initial_state(Model<dim> &model, StateArchive &archive);
} // namespace tombolo
