// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/eight_doubles.h>

#include <array>
#include <cmath>
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

    /** The rest of a shape behind a plane. */
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

  /** The common part of an old and a new simplex, in pieces that are simplices. */
  namespace SimplexOverlap
  {
    /** A point by its barycentric coordinates in the new simplex. */
    template <int dim>
    struct Vertex
    {
      double in_new[dim + 1];
    };

    template <int dim>
    using Piece = std::array<Vertex<dim>, dim + 1>;

    /** The volume of a piece over that of the new simplex. */
    template <int dim>
    double fraction(const Piece<dim> &piece)
    {
      double e[dim][dim];
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int j = 0; j < dim; ++j)
          e[k][j] = piece[k + 1].in_new[j] - piece[0].in_new[j];
      if constexpr (dim == 2)
        return std::abs(e[0][0] * e[1][1] - e[0][1] * e[1][0]);
      else
        return std::abs(e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                        e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                        e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]));
    }

    /** Where the edge from @p inside to @p outside has coordinate @p plane zero. */
    template <int dim>
    Vertex<dim> cut(const Vertex<dim> &inside, const Vertex<dim> &outside, const unsigned int plane)
    {
      const double share = inside.in_new[plane] / (inside.in_new[plane] - outside.in_new[plane]);
      Vertex<dim> result;
      for (unsigned int k = 0; k <= dim; ++k)
        result.in_new[k] = inside.in_new[k] + share * (outside.in_new[k] - inside.in_new[k]);
      result.in_new[plane] = 0.;
      return result;
    }

    /** Calls @p use with the pieces of @p piece within the new simplex: where all of its
     * coordinates from @p plane on are not negative. */
    template <int dim, typename Use>
    void clip(const Piece<dim> &piece, const unsigned int plane, const Use &use)
    {
      if (plane > dim)
      {
        use(piece);
        return;
      }
      unsigned int inside[dim + 1], outside[dim + 1], n_inside = 0, n_outside = 0;
      for (unsigned int k = 0; k <= dim; ++k)
        if (piece[k].in_new[plane] >= 0.)
          inside[n_inside++] = k;
        else
          outside[n_outside++] = k;
      if (n_inside == 0)
        return;
      if (n_outside == 0)
      {
        clip<dim>(piece, plane + 1, use);
        return;
      }
      if (n_inside == 1)
      {
        Piece<dim> corner;
        corner[0] = piece[inside[0]];
        for (unsigned int k = 0; k < dim; ++k)
          corner[k + 1] = cut<dim>(piece[inside[0]], piece[outside[k]], plane);
        clip<dim>(corner, plane + 1, use);
        return;
      }
      // A prism over a simplex of dim vertices.
      std::array<Vertex<dim>, dim> below, above;
      if (n_inside == dim)
        for (unsigned int k = 0; k < dim; ++k)
        {
          below[k] = piece[inside[k]];
          above[k] = cut<dim>(piece[inside[k]], piece[outside[0]], plane);
        }
      else
      {
        below[0] = piece[inside[0]];
        above[0] = piece[inside[1]];
        for (unsigned int k = 1; k < dim; ++k)
        {
          below[k] = cut<dim>(piece[inside[0]], piece[outside[k - 1]], plane);
          above[k] = cut<dim>(piece[inside[1]], piece[outside[k - 1]], plane);
        }
      }
      for (unsigned int last = dim; last-- > 0;)
      {
        Piece<dim> part;
        for (unsigned int k = 0; k <= last; ++k)
          part[k] = below[k];
        for (unsigned int k = last; k < dim; ++k)
          part[k + 1] = above[k];
        clip<dim>(part, plane + 1, use);
      }
    }
  } // namespace SimplexOverlap

  /**
   * Integrals over what an old and a new simplex have in common, over the volume of the new one: of
   * the products of 1, b_1, ..., b_dim with each other, where b are the barycentric coordinates of
   * the new simplex. Fields that are linear in the old simplex need no others. Entries beyond are
   * zero.
   */
  template <int dim>
  struct OverlapMoments
  {
    alignas(64) double products[4][4] = {};

    /** ∫ 1 */
    double volume() const
    {
      return products[0][0];
    }

    void add(const SimplexOverlap::Piece<dim> &piece)
    {
      const double share = SimplexOverlap::fraction<dim>(piece);
      const double weight = share / ((dim + 1) * (dim + 2));
      double sum[dim + 1] = {dim + 1.};
      for (const auto &vertex : piece)
        for (unsigned int j = 1; j <= dim; ++j)
          sum[j] += vertex.in_new[j];
      for (unsigned int j = 0; j <= dim; ++j)
        for (unsigned int k = 0; k <= dim; ++k)
        {
          double product = sum[j] * sum[k];
          for (const auto &vertex : piece)
            product += (j == 0 ? 1. : vertex.in_new[j]) * (k == 0 ? 1. : vertex.in_new[k]);
          products[j][k] += weight * product;
        }
    }
  };

  /**
   * The common parts of old simplices and one new simplex, many at a time: tetrahedra are cut as
   * convex polyhedra (ClippedTetrahedra), plane by plane for all of them. So there are no branches
   * by what a plane leaves.
   */
  template <int dim>
  class SimplexOverlaps
  {
  public:
    /** Coordinates of 16 points in the new simplex, by coordinate. */
    using Points = double[dim + 1][16];

    /** Removes all old simplices. Buffers are kept. */
    void clear()
    {
      n_polyhedra = 0;
    }

    /** Adds the old simplex with the vertices @p numbers, of eight entries, among @p points. */
    void add(const Points &points, const std::uint8_t *const numbers)
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

    /** Cuts away what is outside of the new simplex. */
    void clip();

    /** The simplices that may have a rest, by the order in which they were added. */
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
} // namespace tombolo
