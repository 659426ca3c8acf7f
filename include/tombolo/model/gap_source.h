// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/nodal_vector.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** A process that knows how far nodes are from surfaces, such as contacts. */
  class GapSource
  {
  public:
    virtual ~GapSource() = default;

    /** Gaps to the surface of this name are needed up to @p distance [L], from now on. Returns
     * whether there is such a surface. */
    virtual bool require_gaps(const std::string &name, double distance) = 0;

    /** The signed distance of local nodes to the surface at @p time [L]; beyond the distance that
     * is required any larger number. Not collective. */
    virtual void find_gaps(const std::string &name, const NodalVector &position,
                           const std::vector<unsigned int> &nodes, double time,
                           std::vector<double> &gaps) const = 0;

    /** How deep nodes with these positions are in the surface in which they are deepest [L];
     * negative outside of all. Not collective. */
    virtual void find_depths(const NodalVector &position, const std::vector<unsigned int> &nodes,
                             double time, std::vector<double> &depths) const = 0;
  };
} // namespace tombolo
