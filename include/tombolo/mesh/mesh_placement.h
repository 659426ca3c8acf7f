// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

namespace tombolo
{
  /** Where a mesh is put: turned about a point, in three dimensions about an axis through it, and
   * then shifted. */
  template <int dim>
  class MeshPlacement
  {
  public:
    /** Throws InputError. */
    explicit MeshPlacement(const Entries &e);

    dealii::Point<dim> operator()(const dealii::Point<dim> &place) const;

  private:
    bool is_turned = false;
    dealii::Tensor<2, dim> rotation;
    dealii::Point<dim> centre;
    dealii::Tensor<1, dim> shift;
  };
} // namespace tombolo
