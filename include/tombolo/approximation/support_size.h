// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/node_partition.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace tombolo
{
  /** Half widths of cuboidal supports, node_stride doubles a node, z zero in the plane [L]. */
  namespace SupportSize
  {
    /**
     * Raises @p half_width of every node of some cells to the largest coordinate difference, axis
     * by axis, to any node of the same cell. @p cell_nodes lists the local numbers of the nodes of
     * one cell after the other, @p nodes_per_cell each; cells of higher degree are given as the
     * 2^dim-node subcells between their support points. @p position and @p half_width have
     * node_stride doubles a node; the latter starts from zero. A node is complete when all cells
     * around it have been given, those of other ranks too.
     */
    template <int dim>
    void accumulate(const std::vector<unsigned int> &cell_nodes, const unsigned int nodes_per_cell,
                    const double *const position, double *const half_width)
    {
      Assert(nodes_per_cell > 0 && cell_nodes.size() % nodes_per_cell == 0,
             dealii::ExcInternalError());
      for (std::size_t cell = 0; cell < cell_nodes.size(); cell += nodes_per_cell)
        for (unsigned int d = 0; d < dim; ++d)
        {
          double lowest = position[std::size_t(cell_nodes[cell]) * node_stride + d];
          double highest = lowest;
          for (unsigned int v = 1; v < nodes_per_cell; ++v)
          {
            const double x = position[std::size_t(cell_nodes[cell + v]) * node_stride + d];
            lowest = std::min(lowest, x);
            highest = std::max(highest, x);
          }
          for (unsigned int v = 0; v < nodes_per_cell; ++v)
          {
            const std::size_t slot = std::size_t(cell_nodes[cell + v]) * node_stride + d;
            half_width[slot] =
                std::max({half_width[slot], position[slot] - lowest, highest - position[slot]});
          }
        }
    }

    /**
     * The support of a particle that has deformed by @p deformation_gradient since the initial
     * configuration (row-major dim × dim): half width i becomes (Σ_j (F_ij a_j)²)^½, the bounding
     * box of the deformed ellipsoid with the initial half axes @p initial.
     *
     * The box of the deformed cuboid, Σ_j |F_ij| a_j, would hold every initial neighbour under any
     * F, but a rotation by 45° about an axis alone inflates it by √2 along the two others and so
     * doubles its volume. The ellipsoid does not grow when a cube is rotated, and since
     * |Σ_j F_ij h_j| <= √dim (Σ_j (F_ij h_j)²)^½ a lattice particle still keeps all its diagonal
     * neighbours under any F where the dilation a_j/h_j exceeds √dim (and those along the edges of
     * the lattice at any dilation above one).
     */
    template <int dim>
    void stretch(const double *const deformation_gradient, const double *const initial,
                 double *const half_width)
    {
      double result[dim];
      for (unsigned int i = 0; i < dim; ++i)
      {
        double sum = 0;
        for (unsigned int j = 0; j < dim; ++j)
        {
          const double axis = deformation_gradient[i * dim + j] * initial[j];
          sum += axis * axis;
        }
        result[i] = std::sqrt(sum);
      }
      std::copy(result, result + dim, half_width);
    }
  } // namespace SupportSize
} // namespace tombolo
