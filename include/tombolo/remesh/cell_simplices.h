// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/eight_doubles.h>
#include <tombolo/formulations/smoothed/sub_cells.h>
#include <tombolo/state/nodal_vector.h>

#include <array>
#include <cstdint>
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

    /** The volumes of the sub-cells [L^dim]; with @p only_positive without simplices that are
     * turned over. */
    static std::array<double, SubCells<dim>::n_sub_cells>
    volumes(const typename SubCells<dim>::Corners &corners, bool only_positive = false);
  };

  /** The barycentric coordinates of a simplex as functions of the point. */
  template <int dim>
  class BarycentricCoordinates
  {
  public:
    /** Of a simplex whose volume is not zero. */
    explicit BarycentricCoordinates(const typename CellSimplices<dim>::Vertices &vertices);

    void evaluate(const dealii::Point<dim> &point, double (&coordinates)[dim + 1]) const;

  private:
    dealii::Point<dim> origin;
    dealii::Tensor<2, dim> inverse; // rows: gradients of the coordinates from 1 on
  };

  /** The corners of a cell with these local @p nodes, lexicographic, at @p position [L]. */
  template <int dim>
  typename SubCells<dim>::Corners
  corners_at(const std::array<unsigned int, SubCells<dim>::n_corners> &nodes,
             const NodalVector &position)
  {
    typename SubCells<dim>::Corners result;
    for (unsigned int k = 0; k < nodes.size(); ++k)
      result[k] = point_of<dim>(position.node(nodes[k]));
    return result;
  }

  /** Those of several cells. */
  template <int dim>
  std::vector<typename SubCells<dim>::Corners>
  corners_at(const std::vector<std::array<unsigned int, SubCells<dim>::n_corners>> &nodes,
             const NodalVector &position)
  {
    std::vector<typename SubCells<dim>::Corners> result;
    for (const auto &cell_nodes : nodes)
      result.push_back(corners_at<dim>(cell_nodes, position));
    return result;
  }

  /** The points of a cell that are vertices of its simplices (CellSimplices): corners, centres of
   * faces in three dimensions, and the centre. */
  template <int dim>
  struct SimplexPoints
  {
    static constexpr unsigned int n_points = dim == 3 ? 15 : 5;
    static constexpr unsigned int n_simplices = dim == 3 ? 24 : 4;
    static constexpr unsigned int n_padded = dim == 3 ? 24 : 8; ///< of simplices, to eight
    static constexpr unsigned int centre = n_points - 1; ///< the last vertex of all simplices
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;

    std::array<typename SubCells<dim>::Shares, n_points> shares;
    /** The points of each simplex of CellSimplices::all(); entries beyond repeat the first. */
    std::array<std::array<std::uint8_t, 8>, n_simplices> vertices;
    /** Of each simplex. */
    std::array<unsigned int, n_simplices> sub_cell;
    /** The points of each sub-cell, as bits. */
    std::array<unsigned int, SubCells<dim>::n_sub_cells> points_of_sub_cell{};

    /** The same by vertex and simplex, eight simplices at a time; those beyond repeat the first. */
    std::uint8_t vertex_points[dim + 1][n_padded];
    /** The shares by corner and point; points beyond repeat the first. */
    double corner_shares[n_corners][16];
    /** The shares by point and corner, and their sums over the vertices of each simplex. Corners
     * beyond are zero. */
    double point_shares[n_points][8], simplex_shares[n_simplices][8];

    /** The simplices, as bits, that have at least one of these @p points, which are 16 bits. */
    unsigned int simplices_at(const unsigned int points) const
    {
      return simplices_of_low[points & 255u] | simplices_of_high[points >> 8];
    }

    /** A matrix of the corners, by rows, from one of the points: Pᵀ M P with the shares P. */
    std::array<double, n_corners * n_corners>
    matrix_of_corners(const double (&point_matrix)[n_points][n_points]) const
    {
      EightDoubles rows[n_corners];
      for (EightDoubles &row : rows)
        row = 0.;
      for (unsigned int p = 0; p < n_points; ++p)
      {
        EightDoubles half = 0.;
        for (unsigned int q = 0; q < n_points; ++q)
          half += point_matrix[p][q] * load_eight(point_shares[q]);
        for (unsigned int a = 0; a < n_corners; ++a)
          if (shares[p][a] != 0.)
            rows[a] += shares[p][a] * half;
      }
      std::array<double, n_corners * n_corners> result;
      for (unsigned int a = 0; a < n_corners; ++a)
      {
        double row[8];
        store_eight(rows[a], row);
        std::copy_n(row, n_corners, result.data() + std::size_t(a) * n_corners);
      }
      return result;
    }

    static const SimplexPoints &instance()
    {
      static const SimplexPoints result;
      return result;
    }

  private:
    SimplexPoints();
    void fill_tables();

    std::array<unsigned int, 256> simplices_of_low{}, simplices_of_high{}; // by bits of points
  };

  /** A cell by the coordinates of its points (SimplexPoints), and its simplices, eight at a
   * time. */
  template <int dim>
  class SimplexLanes
  {
  public:
    static constexpr unsigned int n_padded = SimplexPoints<dim>::n_padded;
    static constexpr unsigned int n_groups = n_padded / 8;
    /** The volume of a simplex over the determinant of its edges. */
    static constexpr double volume_factor = dim == 3 ? -1. / 6. : 1. / 2.;

    explicit SimplexLanes(const typename SubCells<dim>::Corners &corners)
    {
      const auto &shares = SimplexPoints<dim>::instance().corner_shares;
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int first = 0; first < 16; first += 8)
        {
          EightDoubles sum = corners[0][d] * load_eight(shares[0] + first);
          for (unsigned int a = 1; a < corners.size(); ++a)
            sum += corners[a][d] * load_eight(shares[a] + first);
          store_eight(sum, coordinates[d] + first);
        }
    }

    double coordinates[dim][16]; ///< of points; those beyond repeat the first

    dealii::Point<dim> point(const unsigned int number) const
    {
      dealii::Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = coordinates[d][number];
      return result;
    }

    /** Of eight simplices: edges from the centre of the cell to the other vertices, by vertex and
     * component, and their determinant, which the gradients of the coordinates of these vertices
     * have as a common divisor of their @p cofactors. */
    struct Edges
    {
      EightDoubles edge[dim][dim], cofactor[dim][dim], determinant;
    };

    Edges edges(const unsigned int group) const
    {
      const auto &vertex_points = SimplexPoints<dim>::instance().vertex_points;
      Edges result;
      EightDoubles(&e)[dim][dim] = result.edge;
      EightDoubles(&c)[dim][dim] = result.cofactor;
      TOMBOLO_UNROLL
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double centre = coordinates[d][SimplexPoints<dim>::centre];
        TOMBOLO_UNROLL
        for (unsigned int k = 0; k < dim; ++k)
          e[k][d] = pick_eight(coordinates[d], vertex_points[k] + std::size_t(8) * group) - centre;
      }
      if constexpr (dim == 2)
      {
        c[0][0] = e[1][1];
        c[0][1] = -e[1][0];
        c[1][0] = -e[0][1];
        c[1][1] = e[0][0];
      }
      else
      {
        TOMBOLO_UNROLL
        for (unsigned int k = 0; k < 3; ++k)
          TOMBOLO_UNROLL
        for (unsigned int d = 0; d < 3; ++d)
          c[k][d] = e[(k + 1) % 3][(d + 1) % 3] * e[(k + 2) % 3][(d + 2) % 3] -
                    e[(k + 1) % 3][(d + 2) % 3] * e[(k + 2) % 3][(d + 1) % 3];
      }
      result.determinant = e[0][0] * c[0][0];
      TOMBOLO_UNROLL
      for (unsigned int d = 1; d < dim; ++d)
        result.determinant += e[0][d] * c[0][d];
      return result;
    }

    /** The volumes of all simplices, and behind them what repeats the first. */
    void find_volumes(double (&volumes)[n_padded]) const
    {
      for (unsigned int group = 0; group < n_groups; ++group)
        store_eight(volume_factor * edges(group).determinant, volumes + std::size_t(8) * group);
    }
  };
} // namespace tombolo
