// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/log.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/mesh/cell_divisions.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/mechanical_step.h>

#include <functional>
#include <optional>

namespace tombolo
{
  /**
   * Where AdaptiveRefinement wants another division of the mesh, takes the state over to it: writes
   * it to a file of @p directory, lets @p rebuild make the model of the new divisions in the place
   * of the old one, reads the state there and books what the new mesh takes. Throws RunError where
   * it cannot be; the file is removed. Collective.
   */
  template <int dim>
  void adapt_mesh(std::optional<Model<dim>> &model, MechanicalStep<dim> &step, const Clock &clock,
                  const OutputDirectory &directory, Log &log,
                  const std::function<void(const CellDivisions &)> &rebuild);

  /** Builds the model anew with these cells divided. Returns all that are divided then, since
   * neighbours may be for others. Collective. */
  template <int dim>
  CellDivisions rebuild_model(const Parameters &parameters, const CellDivisions &divisions,
                              std::optional<Model<dim>> &model);
} // namespace tombolo
