// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace tombolo
{
  /**
   * What up to four planes, one after the other, can leave of a tetrahedron: convex polyhedra with
   * three edges at every vertex, of 4 to 8 faces. There are 27 shapes, that is, ways in which
   * vertices and edges are connected; mirror images count twice. For each shape and each side of
   * the plane that its vertices can be on there is a table of what the plane leaves, so that
   * cutting needs no search.
   */
  class ClippedTetrahedra
  {
  public:
    static constexpr unsigned int most_vertices = 12;
    static constexpr std::uint8_t tetrahedron = 0; ///< the number of its shape

    /** Of lists that are read eight entries at a time. */
    using Numbers = std::array<std::uint8_t, 16>;

    /** What a plane leaves of a shape. */
    struct Rest
    {
      /** Unless vertices are on sides of the plane that those of a convex polyhedron cannot be
       * on: round-off can put them there. */
      bool is_possible = false;
      std::uint8_t shape = 0;
      std::uint8_t n_vertices = 0;
      /** The new vertices are where the plane cuts the edges between these old ones; where both
       * are the same one, it stays. */
      Numbers inside{}, outside{};
    };

    /** Tetrahedra that fill a shape: all have the vertex @p apex, and one of these triangles,
     * which has it on its inner side. Lists are filled up with the apex. */
    struct Fan
    {
      std::uint8_t apex = 0;
      unsigned int n_triangles = 0;
      std::array<Numbers, 3> triangles{};
    };

    static const ClippedTetrahedra &instance();

    /** @p inside has a bit for each vertex: neither all nor none is set. */
    const Rest &rest(const unsigned int shape, const unsigned int inside) const
    {
      return rests[first_rest[shape] + inside];
    }

    const Fan &fan(const unsigned int shape) const
    {
      return fans[shape];
    }

    unsigned int n_shapes() const
    {
      return static_cast<unsigned int>(fans.size());
    }

  private:
    ClippedTetrahedra();

    std::vector<std::size_t> first_rest; // by shape
    std::vector<Rest> rests;             // by shape and bits of vertices inside
    std::vector<Fan> fans;               // by shape
  };
} // namespace tombolo
