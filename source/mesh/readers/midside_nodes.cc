// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/midside_nodes.h>

#include <cmath>
#include <sstream>

namespace tombolo
{
  const std::vector<MidsideEdge> quadrilateral_midsides = {{{0, 1}}, {{1, 2}}, {{2, 3}}, {{3, 0}}};

  void MidsideNodes::add_edge(const std::array<double, 3> &begin, const std::array<double, 3> &end,
                              const std::array<double, 3> &middle, const unsigned int place)
  {
    double distance = 0, length = 0;
    for (unsigned int d = 0; d < 3; ++d)
    {
      distance += std::pow(middle[d] - (begin[d] + end[d]) / 2, 2);
      length += std::pow(end[d] - begin[d], 2);
    }
    const double bend = length > 0 ? std::sqrt(distance / length) : 0;
    if (bend > largest_bend)
    {
      largest_bend = bend;
      place_of_largest = place;
    }
  }

  void MidsideNodes::report(MeshFileContent &content) const
  {
    if (n_cells == 0)
      return;
    std::ostringstream text;
    text << n_cells << " cells of the mesh file are of second order. Their midside nodes are left "
         << "out: cells here have straight edges between their corners. ";
    // Round-off of written coordinates is no bend.
    if (largest_bend > 1e-6)
    {
      text.precision(3);
      text << "A midside node lies off the middle of its edge by up to " << largest_bend
           << " of the length of the edge (" << content.place(place_of_largest)
           << "); smaller cells follow curved surfaces better.";
    }
    else
      text << "All of them are in the middle of their edges, so that the shape is the same.";
    content.remarks.push_back(text.str());
  }
} // namespace tombolo
