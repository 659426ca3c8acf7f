// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/eight_doubles.h>
#include <tombolo/remesh/clipped_tetrahedra.h>
#include <tombolo/remesh/overlap_moments.h>

#include <vector>

namespace tombolo
{
  /**
   * What old simplices have in common with one new simplex, many at a time: tetrahedra are cut as
   * convex polyhedra (ClippedTetrahedra), plane by plane for all of them. So processors need not
   * guess what a plane leaves of the next one.
   */
  template <int dim>
  class SimplexOverlaps
  {
  public:
    /** Coordinates of 16 points in the new simplex, by coordinate. */
    using Points = double[dim + 1][16];

    /** Forgets all old simplices. Buffers are kept. */
    void clear()
    {
      n_polyhedra = 0;
    }

    /** Adds the old simplex with the vertices @p numbers, of eight entries, among @p points. */
    void add(const Points &points, const std::uint8_t *numbers);

    /** Cuts away what is outside of the new simplex. */
    void clip();

    /** The simplices that may have something left, by the order in which they came. */
    const std::vector<unsigned int> &left() const
    {
      return kept;
    }

    /** Of what is left of a simplex. */
    void find_moments(unsigned int number, OverlapMoments<dim> &moments) const;

  private:
    static constexpr unsigned int none = dim + 1;

    struct Polyhedron
    {
      alignas(64) double in_new[dim + 1][16]; // coordinates of vertices, the first until it has cut
      unsigned int shape, n_vertices, inside;
      /** Where round-off let a plane leave no convex polyhedron: this plane and those after it have
       * not cut. */
      unsigned int next_plane;
    };

    /** Cuts by the plane where this coordinate is zero. */
    template <unsigned int plane>
    void clip_by();

    template <unsigned int plane>
    static void cut(Polyhedron &polyhedron, const ClippedTetrahedra::Rest &rest);

    /** Calls @p use with simplices that fill what is left. */
    template <typename Use>
    void for_pieces(const Polyhedron &polyhedron, const Use &use) const;

    std::vector<Polyhedron> polyhedra; // the first n_polyhedra of them
    std::size_t n_polyhedra = 0;
    std::vector<unsigned int> kept, cut_ones;
  };

  template <int dim>
  inline void SimplexOverlaps<dim>::add(const Points &points, const std::uint8_t *const numbers)
  {
    if (n_polyhedra == polyhedra.size())
      polyhedra.emplace_back();
    Polyhedron &polyhedron = polyhedra[n_polyhedra++];
    for (unsigned int j = 0; j <= dim; ++j)
      store_eight(pick_eight(points[j], numbers), polyhedron.in_new[j]);
    polyhedron.shape = ClippedTetrahedra::tetrahedron;
    polyhedron.n_vertices = dim + 1;
    polyhedron.next_plane = dim == 3 ? none : 0;
  }
} // namespace tombolo
