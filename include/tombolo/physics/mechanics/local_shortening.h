// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace tombolo
{
  class StateArchive;
  template <int dim>
  class Model;

  /**
   * Which cells and particles have become shorter since the stable step was estimated. The smallest
   * length over wave speed of a body tells nothing of a cell that was twice as long and now is the
   * one that limits the step, or of a layer that shears while another one grows.
   */
  template <int dim>
  class LocalShortening
  {
  public:
    /** Keeps the length over wave speed of each cell and particle of this rank. */
    void remember(const Model<dim> &model);

    /** Whether any of those within twice the smallest of all has lost more than @p fraction since
     * remember(). Parts whose cells are others since then do not count. Collective. */
    bool exceeds(const Model<dim> &model, double fraction) const;

    /** Writes to a checkpoint or reads from it, by cell and particle. Collective. */
    void serialize(StateArchive &archive, const Model<dim> &model);

  private:
    std::vector<std::vector<double>> times; // by part, in the order of courant_limits() [T]
  };
} // namespace tombolo
