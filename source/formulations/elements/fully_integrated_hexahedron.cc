// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/cell_formulation.h>
#include <tombolo/formulations/elements/fully_integrated_hexahedron.h>

namespace tombolo
{
  template <int dim>
  using BBarHexahedron = CellFormulation<dim, FullyIntegratedHexahedron<dim, true>>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Formulation, BBarHexahedron, "fully integrated hexahedron",
                                  "2^dim Gauss points with mean dilatation (B-bar): no hourglass "
                                  "modes, no volumetric locking")
} // namespace tombolo
