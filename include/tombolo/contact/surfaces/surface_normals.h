// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surfaces/closed_surface.h>

#include <vector>

namespace tombolo
{
  /** Finds the normals of facets, and at vertices and edges the unit vectors along their sums, at
   * vertices weighted with angles. Facets without area keep their normals; the edges of facets must
   * be known. */
  template <int dim>
  void set_normals(ClosedSurface<dim> &surface);

  /** Vertices go to other places, one for each; normals and the box around the surface follow.
   * What the surface was refused for at the start is not looked at again. */
  template <int dim>
  void move_vertices(ClosedSurface<dim> &surface,
                     const std::vector<dealii::Tensor<1, dim>> &places);
} // namespace tombolo
