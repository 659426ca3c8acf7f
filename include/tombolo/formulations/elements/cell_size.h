// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>

#include <tombolo/base/format.h>
#include <tombolo/base/simd/vectorization.h>

#include <cmath>
#include <sstream>
#include <string>

namespace tombolo
{
  /** The message about a cell with a volume that is not positive, or not finite: at its centre, or
   * at its initial one where the nodes are lost. */
  template <int dim>
  std::string describe_unusable_cell(const dealii::Point<dim> &centre,
                                     const dealii::Point<dim> &initial_centre, const double volume)
  {
    bool is_finite = true;
    for (unsigned int d = 0; d < dim; ++d)
      is_finite = is_finite && std::isfinite(centre[d]);
    std::ostringstream message;
    message << "the cell at " << position_text(is_finite ? centre : initial_centre);
    if (is_finite && std::isfinite(volume))
      message << " is turned inside out, at least in one of its integration points (volume "
              << volume << ")";
    else
      message << (is_finite ? "" : " at the start") << " has nodes that are not finite";
    return message.str();
  }

  namespace internal
  {
    template <int dim>
    inline Lanes squared_distance(const Lanes (&a)[dim], const Lanes (&b)[dim])
    {
      Lanes sum = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        sum += (a[d] - b[d]) * (a[d] - b[d]);
      return sum;
    }

    /** Squared area of the quadrilateral with diagonals a1-a0 and b1-b0. */
    inline Lanes squared_area(const Lanes (&a0)[3], const Lanes (&a1)[3], const Lanes (&b0)[3],
                              const Lanes (&b1)[3])
    {
      Lanes p[3], q[3];
      for (unsigned int d = 0; d < 3; ++d)
      {
        p[d] = a1[d] - a0[d];
        q[d] = b1[d] - b0[d];
      }
      const Lanes x = p[1] * q[2] - p[2] * q[1];
      const Lanes y = p[2] * q[0] - p[0] * q[2];
      const Lanes z = p[0] * q[1] - p[1] * q[0];
      return 0.25 * (x * x + y * y + z * z);
    }
  } // namespace internal

  /** The largest stable c Δt over the smallest distance of neighbouring nodes, in a long row of
   * equal elements of degree 1, 2 or 3 with Gauss-Lobatto mass and central differences. */
  constexpr double stable_courant_number(const unsigned int degree)
  {
    return degree == 1 ? 1. : degree == 2 ? 0.8165 : 0.8394;
  }

  /** The length of eq. (41): volume over the largest area of a face (longest side in two
   * dimensions); for higher degrees the smallest distance of neighbouring nodes, multiplied by
   * stable_courant_number(). */
  template <int dim, unsigned int degree, unsigned int n_nodes>
  inline Lanes characteristic_length(const Lanes (&x)[n_nodes][dim], const Lanes &volume)
  {
    using namespace internal;
    if constexpr (degree == 1 && dim == 3)
    {
      Lanes area = squared_area(x[0], x[6], x[2], x[4]);
      area = max(area, squared_area(x[1], x[7], x[3], x[5]));
      area = max(area, squared_area(x[0], x[5], x[1], x[4]));
      area = max(area, squared_area(x[2], x[7], x[3], x[6]));
      area = max(area, squared_area(x[0], x[3], x[1], x[2]));
      area = max(area, squared_area(x[4], x[7], x[5], x[6]));
      return volume / square_root(area);
    }
    else if constexpr (degree == 1)
    {
      Lanes side = squared_distance(x[0], x[1]);
      side = max(side, squared_distance(x[2], x[3]));
      side = max(side, squared_distance(x[0], x[2]));
      side = max(side, squared_distance(x[1], x[3]));
      return volume / square_root(side);
    }
    else
    {
      Lanes distance = 1e300;
      unsigned int stride = 1;
      for (unsigned int d = 0; d < dim; ++d)
      {
        for (unsigned int k = 0; k < n_nodes; ++k)
          if (k / stride % (degree + 1) < degree)
            distance = min(distance, squared_distance(x[k], x[k + stride]));
        stride *= degree + 1;
      }
      return stable_courant_number(degree) * square_root(distance);
    }
  }
} // namespace tombolo
