// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <array>
#include <vector>

namespace tombolo
{
  /** A component of a condition that prescribes the motion of a node along a direction. */
  template <int dim>
  struct PrescribedRow
  {
    int condition; ///< its number
    unsigned int component;
    dealii::Tensor<1, dim> direction; ///< of length one
  };

  /**
   * What several conditions prescribe of one node: an orthonormal frame with some prescribed axes.
   * An axis of the coordinates that is prescribed is one of the frame, and where one
   * condition prescribes all of the motion, the frame is that of the coordinates.
   */
  template <int dim>
  struct PrescribedFrame
  {
    dealii::Tensor<2, dim> axes;          ///< by rows
    std::array<int, dim> condition;       ///< that prescribes along an axis, or -1
    std::array<bool, dim> is_turned;      ///< whether an axis is not that of the coordinates
    std::vector<PrescribedRow<dim>> rows; ///< that act, at most dim
    /** The value along axis k is Σ_r weights[k][r] times the value of row r. */
    dealii::Tensor<2, dim> weights;

    /** Of the rows of one node. Of those whose directions are not independent the later conditions
     * act. */
    explicit PrescribedFrame(std::vector<PrescribedRow<dim>> all);

    /** Sets the prescribed part of a vector by the values of the rows. */
    void prescribe(const dealii::Tensor<1, dim> &values, double *const vector) const
    {
      for (unsigned int k = 0; k < dim; ++k)
      {
        if (condition[k] < 0)
          continue;
        const double wanted = weights[k] * values;
        if (!is_turned[k])
        {
          vector[k] = wanted;
          continue;
        }
        double change = wanted;
        for (unsigned int d = 0; d < dim; ++d)
          change -= axes[k][d] * vector[d];
        for (unsigned int d = 0; d < dim; ++d)
          vector[d] += change * axes[k][d];
      }
    }

  private:
    void choose(std::vector<PrescribedRow<dim>> all);
    void prescribe_all();
    void prescribe_some();
    void complete();
  };
} // namespace tombolo
