// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/elements/cell_size.h>

#include <string>

namespace tombolo
{
  /** What is wrong with the cell at @p lane of a batch, of which a point has no positive volume;
   * the nodes of the batch are at @p x. */
  template <int dim, typename Element, unsigned int n_points>
  std::string describe_unusable_cell(const CellPoints<dim, Element> &points,
                                     const unsigned int batch, const unsigned int lane,
                                     const typename CellPoints<dim, Element>::NodeValues &x,
                                     const Lanes (&volume)[n_points])
  {
    constexpr unsigned int n_nodes = CellPoints<dim, Element>::n_nodes;
    dealii::Point<dim> centre, initial;
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int k = 0; k < n_nodes; ++k)
        centre[d] += x[k][d][lane] / n_nodes;
    for (unsigned int q = 0; q < n_points; ++q)
      initial +=
          points
              .initial_positions()[CellPoints<dim, Element>::point_at(batch * n_lanes + lane, q)] /
          double(n_points);
    double smallest = volume[0][lane];
    for (unsigned int q = 1; q < n_points; ++q)
      if (!(volume[q][lane] >= smallest))
        smallest = volume[q][lane];
    return describe_unusable_cell(centre, initial, smallest);
  }
} // namespace tombolo
