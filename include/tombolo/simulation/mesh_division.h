// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/log.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/mechanical_step.h>
#include <tombolo/simulation/checkpoint_header.h>

#include <functional>
#include <optional>

namespace tombolo
{
  /**
   * Where AdaptiveRefinement wants another division of the mesh, takes the state over to it: writes
   * it to a file of @p directory, lets @p rebuild make the model of a run with another header in
   * the place of the old one, reads the state there and books what the new mesh takes. Throws
   * RunError where it cannot be; the file is removed. Collective.
   */
  template <int dim>
  void adapt_mesh(std::optional<Model<dim>> &model, MechanicalStep<dim> &step, const Clock &clock,
                  const OutputDirectory &directory, Log &log,
                  const std::function<void(CheckpointHeader)> &rebuild);

  /** Makes the mesh of the file that of a run with this header. Collective. */
  template <int dim>
  typename Model<dim>::MeshChange mesh_of(const CheckpointHeader &header);

  /** Whether both runs have the same mesh. */
  bool have_same_mesh(const CheckpointHeader &one, const CheckpointHeader &other);

  /** Builds the model anew on the mesh of @p header, and names there what is divided beside it, for
   * neighbours. Collective. */
  template <int dim>
  void rebuild_model(const Parameters &parameters, CheckpointHeader &header,
                     std::optional<Model<dim>> &model);
} // namespace tombolo
