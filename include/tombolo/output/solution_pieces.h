// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/output.h>
#include <tombolo/output/picture_fields.h>
#include <tombolo/output/vtu_piece.h>

namespace tombolo
{
  /**
   * The surfaces of all contacts of a scene at the present time, for pictures: triangles, lines in
   * two dimensions, and of planes the part next to the bodies. Cells have `contact`, the number of
   * the contact in the field data `contact names`, and of the whole contact `force on the bodies`
   * and `penetration`, the largest. The same on all ranks; without points and cells on those where
   * @p with_facets is false. Collective.
   */
  template <int dim>
  VtuPiece make_tool_piece(const OutputView<dim> &view, bool double_precision,
                           bool with_facets = true);

  /** The cells of this rank's finite elements, with the data that Visualization describes.
   * Collective. */
  template <int dim>
  VtuPiece make_cell_piece(const OutputView<dim> &view, const PictureFields &wanted);

  /** The particles of this rank, with the data that Visualization describes. Collective. */
  template <int dim>
  VtuPiece make_particle_piece(const OutputView<dim> &view, const PictureFields &wanted);
} // namespace tombolo
