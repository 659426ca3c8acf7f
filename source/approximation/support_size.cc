// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/support_size.h>

#include <tombolo/state/node_partition.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace SupportSize
  {
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

    template void accumulate<2>(const std::vector<unsigned int> &, unsigned int, const double *,
                                double *);
    template void accumulate<3>(const std::vector<unsigned int> &, unsigned int, const double *,
                                double *);
    template void stretch<2>(const double *, const double *, double *);
    template void stretch<3>(const double *, const double *, double *);
  } // namespace SupportSize
} // namespace tombolo
