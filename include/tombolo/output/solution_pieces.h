// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/output.h>
#include <tombolo/output/picture_fields.h>
#include <tombolo/output/vtu_piece.h>

namespace tombolo
{
  /** The cells of this rank's finite elements, with the data that Visualization describes.
   * Collective. */
  template <int dim>
  VtuPiece make_cell_piece(const OutputView<dim> &view, const PictureFields &wanted);

  /** The particles of this rank, with the data that Visualization describes. Collective. */
  template <int dim>
  VtuPiece make_particle_piece(const OutputView<dim> &view, const PictureFields &wanted);
} // namespace tombolo
