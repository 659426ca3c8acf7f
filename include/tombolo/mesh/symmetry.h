// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/types.h>

#include <tuple>
#include <vector>

namespace tombolo
{
  /** A plane of symmetry, normal to a coordinate axis. The body lies on one side of it; the other
   * half is its mirror image. */
  struct SymmetryPlane
  {
    unsigned int axis;
    double coordinate; ///< [L]
  };

  /** The mirror image of a node through some of the planes of a Symmetry, one after the other
   * (their order does not matter): bit p of @p planes stands for plane p. */
  struct MirrorNode
  {
    dealii::types::global_dof_index source;
    unsigned int planes;

    bool operator<(const MirrorNode &other) const
    {
      return std::tie(source, planes) < std::tie(other.source, other.planes);
    }
    bool operator==(const MirrorNode &other) const
    {
      return source == other.source && planes == other.planes;
    }
  };

  /** The planes of symmetry of a scene. An axis can have two planes: a slab between them stands for
   * a body that goes on without end. */
  struct Symmetry
  {
    std::vector<SymmetryPlane> planes;
    /** Owned nodes on each plane, which are their own images; global numbers, ascending. */
    std::vector<std::vector<dealii::types::global_dof_index>> nodes_on_plane;

    /** The image of x through the planes of a bit field is sign * x + offset, by component. */
    struct Reflection
    {
      double sign[4] = {1., 1., 1., 1.};
      double offset[4] = {0., 0., 0., 0.};
    };
    Reflection reflection(const unsigned int through) const
    {
      Reflection result;
      for (unsigned int p = 0; p < planes.size(); ++p)
        if ((through >> p) & 1u)
        {
          result.sign[planes[p].axis] = -1.;
          result.offset[planes[p].axis] = 2. * planes[p].coordinate;
        }
      return result;
    }

    /** The bit fields of all images that a node can have: those with at most one plane an axis. */
    std::vector<unsigned int> combinations() const
    {
      std::vector<unsigned int> result;
      for (unsigned int through = 1; through < (1u << planes.size()); ++through)
      {
        unsigned int n_planes[3] = {0, 0, 0};
        bool is_single = true;
        for (unsigned int p = 0; p < planes.size(); ++p)
          if ((through >> p) & 1u)
            is_single = is_single && ++n_planes[planes[p].axis] == 1;
        if (is_single)
          result.push_back(through);
      }
      return result;
    }
  };
} // namespace tombolo
