// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <array>
#include <optional>
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

  class Entries;

  /**
   * The axes along which the components of a condition are: those of the coordinates, fixed other
   * ones, or the radial, the circumferential and the axial direction about an axis at the initial
   * position of a node.
   */
  template <int dim>
  class LocalAxes
  {
  public:
    /** Those of the coordinates. */
    LocalAxes() = default;

    /** Declares `Axes`. */
    static void declare_parameters(const Entries &e);

    /** Reads `Axes`, and `Axis` and `Centre` of cylindrical ones. Throws InputError. */
    explicit LocalAxes(const Section &section);

    /** Whether they are others than those of the coordinates. */
    bool are_local() const
    {
      return fixed || cylinder;
    }

    bool depend_on_place() const
    {
      return cylinder.has_value();
    }

    /** Whether there are directions at @p initial: not on the axis of cylindrical ones. */
    bool are_defined_at(const dealii::Point<dim> &initial) const;

    /** The axes at a place where they are defined, by rows: orthonormal. */
    dealii::Tensor<2, dim> at(const dealii::Point<dim> &initial) const;

  private:
    struct Cylinder
    {
      dealii::Point<dim> centre;
      dealii::Tensor<1, dim> axis; ///< of length one; zero in two dimensions
    };

    /** From the axis, normal to it. */
    dealii::Tensor<1, dim> radius(const dealii::Point<dim> &initial) const;

    std::optional<dealii::Tensor<2, dim>> fixed;
    std::optional<Cylinder> cylinder;
  };
} // namespace tombolo
