// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/generators/axis_segments.h>
#include <tombolo/mesh/mesh_source.h>

#include <vector>

namespace tombolo
{
  /**
   * The octant x, y, z >= 0 of a spherical shell about the origin, in hexahedra: three blocks of
   * the cubed sphere with equal angles between their lines, which meet on the diagonal, in layers.
   * Boundaries are called "inner", "outer", "symmetry x", "symmetry y" and "symmetry z", the planes
   * by their normals; vertices on a plane have the coordinate zero. All cells are coarse.
   */
  class SphericalShell : public MeshSource<3>
  {
  public:
    /** Throws InputError where the entries make no shell. */
    explicit SphericalShell(const Entries &e);

    void create(Mesh<3> &mesh) const override;

  private:
    Section section;
    unsigned int n_block_cells = 0; ///< along each edge of a block, half of those of the octant
    std::vector<double> radii;      ///< of the vertices, from the inner surface on
  };
} // namespace tombolo
