// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/generators/axis_segments.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The section of a cylinder or disc in quadrilaterals: a core of n x n cells, a square with round
   * edges, and rings of 4 n cells around it up to the circle. Entries: `Radius`, `Core cells`,
   * `Rings`, `Core radius`, `Core corner angle`, `Symmetry planes`.
   *
   * The edges of the core are circular arcs that meet at the corner angle; at 120 degrees the core
   * cell and the two ring cells at a corner are alike. The first segment of rings leads from the
   * core to a circle; the rings of the others are concentric circles. With symmetry planes the
   * section is the part of the full one on their positive sides, with the same vertices to the last
   * bit; vertices on a plane have the coordinate zero.
   */
  class RoundSection
  {
  public:
    /** A vertex of the section. */
    struct Vertex
    {
      dealii::Point<2> place; ///< relative to the centre
      bool is_at_rim = false;
    };

    /** @p axes are the names of the two axes of the section, @p whole the name of the body for
     * messages. Throws InputError where the entries make no section. */
    RoundSection(const Entries &e, const std::array<char, 2> &axes, const std::string &whole);

    /** The vertices of the cells() in the order of the full section: core, then ring by ring. */
    const std::vector<Vertex> &vertices() const;

    /** Vertices of each cell in deal.II's order, turning positively. */
    const std::vector<std::array<unsigned int, 4>> &cells() const;

    /** Whether the section is cut by the plane through the centre that is normal to this axis. */
    bool is_cut(unsigned int axis) const;

    double radius() const;

  private:
    void read_cuts(const Section &section, const std::array<char, 2> &axes,
                   const std::string &whole);
    void read_core_radius(const Section &section, const std::string &whole);

    /** A point of the core, (u, v) in [-1, 1]^2. */
    dealii::Point<2> core_point(double u, double v) const;

    void make_full_section();
    void keep_positive_sides();

    unsigned int n_core_cells = 0;
    std::vector<AxisSegment> rings; ///< the first one begins at `core_radius`
    double core_radius = 0;         ///< from the centre to the middle of an edge of the core
    double arc = 0;                 ///< half of the angle of each edge of the core [rad]
    std::array<bool, 2> cuts = {};
    std::vector<Vertex> section_vertices;
    std::vector<std::array<unsigned int, 4>> section_cells;
  };
} // namespace tombolo
