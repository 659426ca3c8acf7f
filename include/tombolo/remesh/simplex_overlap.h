// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cmath>

namespace tombolo
{
  /** What an old and a new simplex have in common, in pieces that are simplices. */
  namespace SimplexOverlap
  {
    /** A place by its barycentric coordinates in the new simplex. */
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
} // namespace tombolo
