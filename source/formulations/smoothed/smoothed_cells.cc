// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_cells.h>

namespace tombolo
{
  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, SmoothedCells, "smoothed cells",
      "element-free Galerkin cells of degree 1: convex approximation with smoothed gradients")
} // namespace tombolo
