// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/symmetry.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace tombolo
{
  /** Whether a face of a cell is in one of the planes of symmetry (null: there are none), beyond
   * which the body goes on. */
  template <typename Cell>
  bool is_in_plane_of_symmetry(const Cell &cell, const unsigned int face, const Symmetry *symmetry)
  {
    if (symmetry == nullptr)
      return false;
    const double tolerance = 1e-6 * cell->diameter();
    const auto vertices = cell->face(face)->vertex_indices();
    return std::any_of(symmetry->planes.begin(), symmetry->planes.end(),
                       [&](const SymmetryPlane &plane)
                       {
                         return std::all_of(vertices.begin(), vertices.end(),
                                            [&](const unsigned int v)
                                            {
                                              const double distance =
                                                  cell->face(face)->vertex(v)[plane.axis] -
                                                  plane.coordinate;
                                              return std::abs(distance) <= tolerance;
                                            });
                       });
  }

  /** Whether the body ends at a face of a cell: at the boundary of the mesh, unless it is in a
   * plane of symmetry. What acts on the surface of a body acts on these faces. */
  template <typename Cell>
  bool is_outer_face(const Cell &cell, const unsigned int face, const Symmetry *symmetry)
  {
    return cell->face(face)->at_boundary() && !is_in_plane_of_symmetry(cell, face, symmetry);
  }

  /** What an outer face is in messages. */
  inline std::string outer_face_text(const Symmetry *symmetry)
  {
    return std::string("face of the boundary") +
           (symmetry == nullptr ? "" : " outside of planes of symmetry");
  }
} // namespace tombolo
