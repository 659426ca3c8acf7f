// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/one_point_hexahedron.h>

namespace tombolo
{
  template <int dim>
  using Hexahedron = CellFormulation<dim, OnePointHexahedron<dim>>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, Hexahedron, "hexahedron",
      "one integration point with hourglass control: the fastest element")
} // namespace tombolo
