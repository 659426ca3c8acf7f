// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/eight_doubles.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/remesh/cell_overlap.h>
#include <tombolo/remesh/simplex_pairs.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tombolo
{
  /** The number of pairs of fields: they are added two at a time. */
  inline std::size_t n_pairs_of(const std::size_t n_fields)
  {
    return (n_fields + 1) / 2;
  }

  /** Integrals over one simplex of after with the functions 1, b_1, ..., b_dim, where b are its
   * barycentric coordinates. */
  template <int dim>
  struct SimplexIntegrals
  {
    alignas(32) double products[dim + 1][4] = {}; ///< of the functions
    std::vector<EightDoubles> values; ///< of two fields each, by slot; by two fields and function

    explicit SimplexIntegrals(const unsigned int n_fields)
        : values(n_pairs_of(n_fields) * (dim + 1), 0.)
    {}

    void clear()
    {
      for (auto &row : products)
        std::fill_n(row, 4, 0.);
      std::fill(values.begin(), values.end(), 0.);
    }

    /** Adds the part within an old simplex, with whose density the new one would have the mass
     * @p simplex_mass. @p old_at_new: the coordinates of the old simplex at the vertices of the new
     * one, rows; the fields have the values @p old_values at points of the old cell
     * (values_at_points()), of which @p vertices are those of the simplex. */
    void add(const OverlapMoments<dim> &moments, const double simplex_mass,
             const double (&old_at_new)[4][4], const std::vector<EightDoubles> &old_values,
             const std::uint8_t *const vertices)
    {
      alignas(32) double mass_moments[dim + 1][4];
      TOMBOLO_UNROLL
      for (unsigned int j = 0; j <= dim; ++j)
      {
        const NodeLanes row = simplex_mass * load_node(moments.products[j]);
        store_node(row, mass_moments[j]);
        store_node(load_node(products[j]) + row, products[j]);
      }
      const std::size_t n_pairs = values.size() / (dim + 1);
      for (std::size_t two = 0; two < n_pairs; ++two)
      {
        // The fields as linear functions of the new coordinates.
        EightDoubles new_values[dim + 1];
        TOMBOLO_UNROLL
        for (unsigned int i = 0; i <= dim; ++i)
        {
          const EightDoubles z = old_values[vertices[i] * n_pairs + two];
          TOMBOLO_UNROLL
          for (unsigned int k = 0; k <= dim; ++k)
            new_values[k] = i == 0 ? old_at_new[k][i] * z : new_values[k] + old_at_new[k][i] * z;
        }
        TOMBOLO_UNROLL
        for (unsigned int k = 1; k <= dim; ++k)
          new_values[k] -= new_values[0];
        TOMBOLO_UNROLL
        for (unsigned int j = 0; j <= dim; ++j)
        {
          EightDoubles sum = values[two * (dim + 1) + j];
          TOMBOLO_UNROLL
          for (unsigned int k = 0; k <= dim; ++k)
            sum += mass_moments[j][k] * new_values[k];
          values[two * (dim + 1) + j] = sum;
        }
      }
    }

    /** Adds the simplex itself. */
    void add_whole(const double mass, const std::vector<EightDoubles> &old_values,
                   const std::uint8_t *const vertices)
    {
      static const OverlapMoments<dim> moments = moments_of_whole_simplex();
      constexpr double unit[4][4] = {
          {1., 0., 0., 0.}, {0., 1., 0., 0.}, {0., 0., 1., 0.}, {0., 0., 0., 1.}};
      add(moments, mass, unit, old_values, vertices);
    }

    /** Changes the functions from 1, b_1, ..., b_dim to b_0, ..., b_dim. */
    void use_barycentric_functions()
    {
      TOMBOLO_UNROLL
      for (unsigned int j = 1; j <= dim; ++j)
        store_node(load_node(products[0]) - load_node(products[j]), products[0]);
      for (auto &row : products)
        for (unsigned int k = 1; k <= dim; ++k)
          row[0] -= row[k];
      for (std::size_t first = 0; first < values.size(); first += dim + 1)
        for (unsigned int j = 1; j <= dim; ++j)
          values[first] -= values[first + j];
    }

  private:
    static OverlapMoments<dim> moments_of_whole_simplex()
    {
      SimplexOverlap::Piece<dim> piece;
      for (unsigned int k = 0; k <= dim; ++k)
        for (unsigned int j = 0; j <= dim; ++j)
          piece[k].in_new[j] = k == j ? 1. : 0.;
      OverlapMoments<dim> result;
      result.add(piece);
      return result;
    }
  };

  /** Values of fields at the points of a cell, by point and two fields, from those at corners.
   * Where the number of fields is odd, there is one more, of zeros. */
  template <int dim>
  void values_at_points(const double *const corner_values, const std::size_t n_fields,
                        std::vector<EightDoubles> &result)
  {
    const auto &shares = SimplexPoints<dim>::instance().shares;
    const std::size_t n = n_fields * node_stride;
    const std::size_t n_pairs = n_pairs_of(n_fields);
    result.assign(shares.size() * n_pairs, 0.);
    for (std::size_t p = 0; p < shares.size(); ++p)
      for (unsigned int a = 0; a < SimplexPoints<dim>::n_corners; ++a)
        for (std::size_t two = 0; two < n_pairs && shares[p][a] != 0.; ++two)
        {
          double two_fields[8] = {};
          std::copy_n(corner_values + a * n + two * 8, std::min<std::size_t>(8, n - two * 8),
                      two_fields);
          result[p * n_pairs + two] += shares[p][a] * load_eight(two_fields);
        }
  }

  /** A cell of before that reaches cells of after of this rank (CellOverlap), and what they have of
   * it. */
  template <int dim>
  struct ReceivedCell
  {
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;
    static constexpr unsigned int n_sub_cells = SubCells<dim>::n_sub_cells;
    static constexpr unsigned int n_simplices = SimplexPoints<dim>::n_simplices;

    SimplexCell<dim> simplices;
    /** Of sub-cells, and its change since the first integrals over them. */
    std::array<double, n_sub_cells> density, change{};
    bool is_cut;
    std::vector<EightDoubles> values;   ///< of fields at its points (values_at_points())
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
        centre[d] = simplices.coordinates[d][SimplexPoints<dim>::centre];
      data += n_corners * dim;
      for (double &sub_cell_density : density)
        sub_cell_density = *data++;
      is_cut = *data++ > 0.;
      values_at_points<dim>(data, n_values / (n_corners * node_stride), values);
    }

    /** The part of a sub-cell that cells of after cover. */
    typename CellOverlap<dim>::Covered covered(const unsigned int sub_cell) const
    {
      typename CellOverlap<dim>::Covered result;
      for (unsigned int s = 0; s < n_simplices; ++s)
        if (SimplexPoints<dim>::instance().sub_cell[s] == sub_cell)
        {
          result.volume += common[s][3];
          for (unsigned int d = 0; d < dim; ++d)
            result.moment[d] += common[s][d] + common[s][3] * centre[d];
        }
      return result;
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

  /** Integrals over a cell of after, with the functions of its points (SimplexPoints). */
  template <int dim>
  class PointIntegrals
  {
  public:
    static constexpr unsigned int n_points = SimplexPoints<dim>::n_points;

    explicit PointIntegrals(const unsigned int n_fields)
        : values(n_pairs_of(n_fields) * n_points, 0.), n_fields(n_fields)
    {}

    void clear()
    {
      std::fill_n(&matrix[0][0], n_points * n_points, 0.);
      std::fill(values.begin(), values.end(), 0.);
    }

    /** Of the simplex with these @p vertices, with its coordinates as functions. */
    void add(const SimplexIntegrals<dim> &integrals, const std::uint8_t *const vertices)
    {
      const std::size_t n_pairs = values.size() / n_points;
      for (unsigned int j = 0; j <= dim; ++j)
      {
        for (unsigned int k = 0; k <= dim; ++k)
          matrix[vertices[j]][vertices[k]] += integrals.products[j][k];
        for (std::size_t two = 0; two < n_pairs; ++two)
          values[vertices[j] * n_pairs + two] += integrals.values[two * (dim + 1) + j];
      }
    }

    /** Adds them to those of a cell. */
    void add_to(typename CellOverlap<dim>::Integrals &cell) const
    {
      constexpr unsigned int n_corners = CellOverlap<dim>::n_corners;
      const SimplexPoints<dim> &points = SimplexPoints<dim>::instance();
      const std::size_t n_pairs = values.size() / n_points;
      for (unsigned int p = 0; p < n_points; ++p)
        for (unsigned int a = 0; a < n_corners; ++a)
          if (const double share = points.shares[p][a]; share != 0.)
            for (unsigned int field = 0; field < n_fields; ++field)
              for (unsigned int slot = 0; slot < node_stride; ++slot)
                cell.values[(std::size_t(field) * n_corners + a) * node_stride + slot] +=
                    share * values[p * n_pairs + field / 2][field % 2 * node_stride + slot];
      const auto corner_matrix = points.matrix_of_corners(matrix);
      for (unsigned int k = 0; k < corner_matrix.size(); ++k)
      {
        cell.matrix[k] += corner_matrix[k];
        cell.mass[k % n_corners] += corner_matrix[k]; // the functions add up to one
      }
    }

  private:
    double matrix[n_points][n_points] = {};
    std::vector<EightDoubles> values; // by point and two fields
    unsigned int n_fields;
  };

  /** Cuts cells of before by the simplices of cells of after. Buffers are kept from one cell to the
   * next. */
  template <int dim>
  class CellCutting
  {
  public:
    using Integrals = typename CellOverlap<dim>::Integrals;
    using Share = typename CellOverlap<dim>::Share;
    using Corners = typename SubCells<dim>::Corners;

    /** @p received must outlive this. */
    CellCutting(std::vector<ReceivedCell<dim>> &received, const unsigned int n_fields)
        : received(received), integrals(n_fields), point_integrals(n_fields)
    {}

    /** Adds the common parts of the cell with the number @p cell and these corners and of received
     * cells, of which only those with the numbers @p near can overlap it: to its integrals, with
     * the densities, to the cells, and its shares. */
    void cut(const unsigned int cell, const Corners &corners, const std::vector<std::size_t> &near,
             Integrals &cell_integrals, std::vector<Share> &shares)
    {
      const SimplexPoints<dim> &simplex_points = SimplexPoints<dim>::instance();
      const SimplexCell<dim> new_cell(corners);
      double centre[4] = {};
      for (unsigned int d = 0; d < dim; ++d)
        centre[d] = new_cell.coordinates[d][SimplexPoints<dim>::centre];
      offsets.resize(near.size() * 4);
      for (std::size_t k = 0; k < near.size(); ++k)
        for (unsigned int d = 0; d < 4; ++d)
          offsets[k * 4 + d] = received[near[k]].centre[d] - centre[d];
      found.assign(n_sub_cells * near.size() * n_sub_cells * 4, 0.);
      const auto note = [&](const unsigned int after, const typename SimplexPairs<dim>::Pair &pair,
                            const NodeLanes &sum)
      {
        const unsigned int sub_cell = simplex_points.sub_cell[pair.simplex];
        double *const share =
            found.data() +
            ((simplex_points.sub_cell[after] * near.size() + pair.cell) * n_sub_cells + sub_cell) *
                4;
        store_node(load_node(share) + sum, share);
        double *const common = received[near[pair.cell]].common[pair.simplex];
        const double volume = sum[3];
        store_node(load_node(common) + (sum - volume * load_node(offsets.data() + pair.cell * 4)),
                   common);
      };
      add_pairs(new_cell, near, &ReceivedCell<dim>::density, cell_integrals, note);
      for (std::size_t i = 0; i < found.size() / 4; ++i)
      {
        const double *const moment = found.data() + i * 4;
        if (!(moment[3] > 0.))
          continue;
        Share share;
        const auto sub_cell = static_cast<unsigned int>(i / (near.size() * n_sub_cells));
        const auto from = static_cast<unsigned int>(near[i / n_sub_cells % near.size()]);
        share.to = cell * n_sub_cells + sub_cell;
        share.from = from * n_sub_cells + static_cast<unsigned int>(i % n_sub_cells);
        share.volume = moment[3];
        for (unsigned int d = 0; d < dim; ++d)
          share.moment[d] = moment[d] + moment[3] * centre[d];
        shares.push_back(share);
      }
    }

    /** Adds the changes of the integrals by those of the densities. */
    void add_changes(const Corners &corners, const std::vector<std::size_t> &near,
                     Integrals &cell_integrals)
    {
      add_pairs(
          SimplexCell<dim>(corners), near, &ReceivedCell<dim>::change, cell_integrals,
          [](const unsigned int, const typename SimplexPairs<dim>::Pair &, const NodeLanes &) {});
    }

  private:
    static constexpr unsigned int n_sub_cells = SubCells<dim>::n_sub_cells;

    using Densities = std::array<double, n_sub_cells> ReceivedCell<dim>::*;

    /** ∫ (x - centre) and, at the end, ∫ 1 over the volume of a new simplex, as linear functions of
     * the first row of moments. */
    static void find_position_rows(const SimplexCell<dim> &cell, const unsigned int simplex,
                                   NodeLanes (&rows)[dim + 1])
    {
      const std::uint8_t *const points = SimplexPoints<dim>::instance().vertices[simplex].data();
      for (unsigned int k = 0; k <= dim; ++k)
      {
        double row[4] = {0., 0., 0., k == 0 ? 1. : 0.};
        for (unsigned int d = 0; d < dim; ++d)
          row[d] = cell.coordinates[d][points[k]] -
                   cell.coordinates[d][k == 0 ? SimplexPoints<dim>::centre : points[0]];
        rows[k] = cell.volume[simplex] * load_node(row);
      }
    }

    /** Calls @p note(simplex of the cell, pair, moments) for each pair as well. */
    template <typename Note>
    void add_pairs(const SimplexCell<dim> &new_cell, const std::vector<std::size_t> &near,
                   const Densities densities, Integrals &cell_integrals, const Note &note)
    {
      const SimplexPoints<dim> &simplex_points = SimplexPoints<dim>::instance();
      pairs.clear_cells();
      for (const std::size_t r : near)
        pairs.add_cell(received[r].simplices);
      point_integrals.clear();
      for (unsigned int after = 0; after < SimplexPoints<dim>::n_simplices; ++after)
      {
        if (((new_cell.counts >> after) & 1u) == 0)
          continue;
        NodeLanes rows[dim + 1];
        find_position_rows(new_cell, after, rows);
        integrals.clear();
        pairs.start(new_cell, after);
        pairs.for_moments(
            [&](const typename SimplexPairs<dim>::Pair &pair, const OverlapMoments<dim> &moments)
            {
              const ReceivedCell<dim> &from = received[near[pair.cell]];
              const double density = (from.*densities)[simplex_points.sub_cell[pair.simplex]];
              integrals.add(moments, density * new_cell.volume[after], pair.old_at_new, from.values,
                            simplex_points.vertices[pair.simplex].data());
              NodeLanes sum = moments.products[0][0] * rows[0];
              TOMBOLO_UNROLL
              for (unsigned int k = 1; k <= dim; ++k)
                sum += moments.products[0][k] * rows[k];
              note(after, pair, sum);
            });
        integrals.use_barycentric_functions();
        point_integrals.add(integrals, simplex_points.vertices[after].data());
      }
      point_integrals.add_to(cell_integrals);
    }

    std::vector<ReceivedCell<dim>> &received;
    SimplexPairs<dim> pairs;
    SimplexIntegrals<dim> integrals;
    PointIntegrals<dim> point_integrals;
    std::vector<double> found; ///< ∫ (x - centre of the cell) and ∫ 1 by sub-cells of both cells
    std::vector<double> offsets; ///< of the centres of cells that are near, with a zero each
  };
} // namespace tombolo
