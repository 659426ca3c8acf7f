// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/cell_cutting.h>

#include <tombolo/base/simd/vectorization.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** ∫ (x - centre) and, at the end, ∫ 1 over the volume of a new simplex, as linear functions of
     * the first row of moments. */
    template <int dim>
    void find_rows_of_places(const SimplexCell<dim> &cell, const unsigned int simplex,
                             NodeLanes (&rows)[dim + 1])
    {
      const std::uint8_t *const points = SimplexPoints<dim>::instance().vertices[simplex].data();
      for (unsigned int k = 0; k <= dim; ++k)
      {
        double row[4] = {0., 0., 0., k == 0 ? 1. : 0.};
        for (unsigned int d = 0; d < dim; ++d)
          row[d] = cell.place[d][points[k]] -
                   cell.place[d][k == 0 ? SimplexPoints<dim>::centre : points[0]];
        rows[k] = cell.volume[simplex] * load_node(row);
      }
    }
  } // namespace

  template <int dim>
  template <typename Note>
  void CellCutting<dim>::add_pairs(const SimplexCell<dim> &of_after,
                                   const std::vector<std::size_t> &near, const Densities densities,
                                   Integrals &of_cell, const Note &note)
  {
    const SimplexPoints<dim> &of_cells = SimplexPoints<dim>::instance();
    pairs.clear_cells();
    for (const std::size_t r : near)
      pairs.add_cell(received[r].simplices);
    of_points.clear();
    for (unsigned int after = 0; after < SimplexPoints<dim>::n_simplices; ++after)
    {
      if (((of_after.counts >> after) & 1u) == 0)
        continue;
      NodeLanes rows[dim + 1];
      find_rows_of_places<dim>(of_after, after, rows);
      integrals.clear();
      pairs.start(of_after, after);
      pairs.for_moments(
          [&](const typename SimplexPairs<dim>::Pair &pair, const OverlapMoments<dim> &moments)
          {
            const ReceivedCell<dim> &from = received[near[pair.cell]];
            const double density = (from.*densities)[of_cells.sub_cell[pair.simplex]];
            integrals.add(moments, density * of_after.volume[after], pair.old_at_new, from.values,
                          of_cells.vertices[pair.simplex].data());
            NodeLanes sum = moments.products[0][0] * rows[0];
            TOMBOLO_UNROLL
            for (unsigned int k = 1; k <= dim; ++k)
              sum += moments.products[0][k] * rows[k];
            note(after, pair, sum);
          });
      integrals.take_coordinates();
      of_points.add(integrals, of_cells.vertices[after].data());
    }
    of_points.give(of_cell);
  }

  template <int dim>
  void CellCutting<dim>::cut(const unsigned int cell, const Corners &corners,
                             const std::vector<std::size_t> &near, Integrals &of_cell,
                             std::vector<Share> &shares)
  {
    const SimplexPoints<dim> &of_cells = SimplexPoints<dim>::instance();
    const SimplexCell<dim> of_after(corners);
    double centre[4] = {};
    for (unsigned int d = 0; d < dim; ++d)
      centre[d] = of_after.place[d][SimplexPoints<dim>::centre];
    offsets.resize(near.size() * 4);
    for (std::size_t k = 0; k < near.size(); ++k)
      for (unsigned int d = 0; d < 4; ++d)
        offsets[k * 4 + d] = received[near[k]].centre[d] - centre[d];
    found.assign(n_sub_cells * near.size() * n_sub_cells * 4, 0.);
    const auto note = [&](const unsigned int after, const typename SimplexPairs<dim>::Pair &pair,
                          const NodeLanes &sum)
    {
      const unsigned int sub_cell = of_cells.sub_cell[pair.simplex];
      double *const share =
          found.data() +
          ((of_cells.sub_cell[after] * near.size() + pair.cell) * n_sub_cells + sub_cell) * 4;
      store_node(load_node(share) + sum, share);
      double *const common = received[near[pair.cell]].common[pair.simplex];
      const double volume = sum[3];
      store_node(load_node(common) + (sum - volume * load_node(offsets.data() + pair.cell * 4)),
                 common);
    };
    add_pairs(of_after, near, &ReceivedCell<dim>::density, of_cell, note);
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

  template <int dim>
  void CellCutting<dim>::add_changes(const Corners &corners, const std::vector<std::size_t> &near,
                                     Integrals &of_cell)
  {
    add_pairs(
        SimplexCell<dim>(corners), near, &ReceivedCell<dim>::change, of_cell,
        [](const unsigned int, const typename SimplexPairs<dim>::Pair &, const NodeLanes &) {});
  }

  template class CellCutting<2>;
  template class CellCutting<3>;
} // namespace tombolo
