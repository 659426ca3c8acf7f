// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <optional>

namespace tombolo
{
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
