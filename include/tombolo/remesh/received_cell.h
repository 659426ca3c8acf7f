// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/simplex_integrals.h>
#include <tombolo/remesh/simplex_pairs.h>

#include <deal.II/base/tensor.h>

#include <array>
#include <cstddef>
#include <vector>

namespace tombolo
{
  /** A cell of before that reaches cells of after of this rank (CellOverlap), and what they have of
   * it. */
  template <int dim>
  struct ReceivedCell
  {
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;
    static constexpr unsigned int n_sub_cells = SubCells<dim>::n_sub_cells;
    static constexpr unsigned int n_simplices = SimplexPoints<dim>::n_simplices;

    SimplexCell<dim> simplices;
    /** Of sub-cells, and what it has changed by since cells of after have got something of them. */
    std::array<double, n_sub_cells> density, change{};
    bool is_cut;
    std::vector<double> values;         ///< of fields at its points (SimplexPoints)
    double centre[4] = {};              ///< and zeros
    double common[n_simplices][4] = {}; ///< of each simplex: ∫ (x - centre), and at the end ∫ 1

    /** The numbers that a cell with @p n_values at its corners is sent as. */
    static std::size_t size(const std::size_t n_values)
    {
      return n_corners * dim + n_sub_cells + 1 + n_values;
    }

    /** From corners, densities, whether it is cut, and values at corners. */
    ReceivedCell(const double *data, const std::size_t n_values) : simplices(corners_in(data))
    {
      for (unsigned int d = 0; d < dim; ++d)
        centre[d] = simplices.place[d][SimplexPoints<dim>::centre];
      data += n_corners * dim;
      for (double &of_sub_cell : density)
        of_sub_cell = *data++;
      is_cut = *data++ > 0.;
      values_at_points<dim>(data, n_values / (n_corners * node_stride), values);
    }

    /** ∫ 1 and ∫ x over what cells of after have of a sub-cell. */
    void find_covered(const unsigned int sub_cell, double &volume,
                      dealii::Tensor<1, dim> &moment) const
    {
      volume = 0;
      moment = {};
      for (unsigned int s = 0; s < n_simplices; ++s)
        if (SimplexPoints<dim>::instance().sub_cell[s] == sub_cell)
        {
          volume += common[s][3];
          for (unsigned int d = 0; d < dim; ++d)
            moment[d] += common[s][d] + common[s][3] * centre[d];
        }
    }

  private:
    static typename SubCells<dim>::Corners corners_in(const double *data)
    {
      typename SubCells<dim>::Corners corners;
      for (dealii::Point<dim> &corner : corners)
        for (unsigned int d = 0; d < dim; ++d)
          corner[d] = *data++;
      return corners;
    }
  };
} // namespace tombolo
