// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/sub_cells.h>

#include <array>
#include <vector>

namespace tombolo
{
  /**
   * The simplices that the sub-cells of a cell consist of (SubCells): 4 triangles, or 24
   * tetrahedra. Neighbouring cells cut the face between them alike, so that the simplices of all
   * cells cover a body without gaps, warped or not. Functions that are linear in each of them, with
   * the mean of the corners at the centres of faces and cells, are continuous, positive and
   * reproduce linear fields: those of the remap.
   */
  template <int dim>
  class CellSimplices
  {
  public:
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;

    /** Vertices as shares of the corners of the cell. */
    struct Simplex
    {
      std::array<typename SubCells<dim>::Shares, dim + 1> vertices;
      unsigned int sub_cell;
    };

    using Vertices = std::array<dealii::Point<dim>, dim + 1>;

    static const std::vector<Simplex> &all();

    static Vertices vertices(const Simplex &simplex,
                             const typename SubCells<dim>::Corners &corners);

    /** Positive in a cell that is not turned inside out [L^dim]. */
    static double volume(const Vertices &vertices);

    /** Whether no simplex of a cell is turned over or flat. */
    static bool are_positive(const typename SubCells<dim>::Corners &corners);

    /** The volumes of the sub-cells [L^dim]. */
    static std::array<double, SubCells<dim>::n_sub_cells>
    volumes(const typename SubCells<dim>::Corners &corners);
  };

  /** The barycentric coordinates of a simplex as functions of the place. */
  template <int dim>
  class BarycentricCoordinates
  {
  public:
    /** Of a simplex whose volume is not zero. */
    explicit BarycentricCoordinates(const typename CellSimplices<dim>::Vertices &vertices);

    void evaluate(const dealii::Point<dim> &place, double (&coordinates)[dim + 1]) const;

    /** The gradient of coordinate @p k [1/L]. */
    dealii::Tensor<1, dim> gradient(const unsigned int k) const;

  private:
    dealii::Point<dim> origin;
    dealii::Tensor<2, dim> inverse; // rows: gradients of the coordinates from 1 on
  };
} // namespace tombolo
