// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace tombolo
{
  /**
   * The outline of a rigid body in the half-plane of (r, z): r the distance from the body's axis, z
   * along it. Turned about the axis it is a body of revolution, mirrored a body in two dimensions.
   * It leads from the axis around the body and back to the axis, the body to its left, in straight
   * lines whose convex corners are rounded by arcs.
   *
   * Nodes in contact are inside of the body, where the point next to them jumps from one side to
   * the other as they pass under a sharp convex corner. Under an arc of radius R the normal turns
   * with the node down to a depth of R, so that its force is continuous; under a concave corner it
   * always does.
   */
  class RigidProfile
  {
  public:
    /** A place, or a direction. */
    struct Place
    {
      double r, z; ///< [L]
    };

    /** The signed distance, positive outside [L], and the unit normal out of the body. */
    struct Nearest
    {
      double gap;
      Place normal;
    };

    RigidProfile() = default;

    /** @p corners from the axis to the axis (r = 0 at the first and the last, above zero between
     * them). Convex corners, those on the axis too, are rounded with @p edge_radius. Throws
     * std::invalid_argument with what is wrong with the corners, or with a radius that the lines
     * between corners are too short for. */
    RigidProfile(const std::vector<Place> &corners, double edge_radius);

    /** @p place with r >= 0. */
    Nearest nearest(const Place &place) const;

    /** A distance that is at most the one to the body, positive only outside of a cylinder around
     * it: cheap. */
    double distance_from_box(const Place &place) const;

    /** Places along the profile from the axis to the axis, for pictures: ends of the lines, and
     * arcs in pieces of at most @p largest_turn [rad]. */
    std::vector<Place> outline(double largest_turn) const;

  private:
    struct Line
    {
      Place begin, along, normal; ///< unit vectors
      double length;
      Place normal_at_begin, normal_at_end; ///< where two lines meet: the mean of theirs
    };
    struct Arc
    {
      Place center, first_normal, last_normal;
      std::size_t next_line; ///< the number of lines before it
    };

    std::vector<Line> lines;
    std::vector<Arc> arcs;
    double radius = 0; ///< of the arcs
    Place low{}, high{};
  };
} // namespace tombolo
