// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/cell_quality.h>
#include <tombolo/mesh/mesh_source.h>

#include <memory>

namespace tombolo
{
  /** The corners of @p cell moved towards its centre by this @p share of their distance to it. */
  template <int dim>
  CellVertices<dim> shrunk_corners(const CellVertices<dim> &cell, double share);

  /** Whether the convex hulls of two cells have points in common: those of which no normal of a
   * face, and in space no normal of two edges, is a direction in which one lies behind the other.
   * Faces that are not plane have the normal of their diagonals. */
  template <int dim>
  bool have_points_in_common(const CellVertices<dim> &a, const CellVertices<dim> &b);

  /** Declares what chooses the cells of a scene: section Mesh, or several meshes. */
  template <int dim>
  void declare_mesh_sources(Parameters &parameters);

  /** The source of the mesh of the whole scene. Throws InputError. */
  template <int dim>
  std::unique_ptr<MeshSource<dim>> mesh_source(const Parameters &parameters);
} // namespace tombolo
