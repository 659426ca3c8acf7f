// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/cell_cutting.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The number of the lowest bit that is set; there must be one. */
    unsigned int first_bit(const unsigned int bits)
    {
      return static_cast<unsigned int>(__builtin_ctz(bits));
    }
  } // namespace

  template <int dim>
  SimplexCell<dim>::SimplexCell(const typename SubCells<dim>::Corners &corners)
  {
    constexpr unsigned int n_simplices = SimplexPoints<dim>::n_simplices;
    const SimplexLanes<dim> lanes(corners);
    for (unsigned int d = 0; d < dim; ++d)
    {
      std::copy_n(lanes.place[d], 16, place[d]);
      lower[d] = *std::min_element(place[d], place[d] + 16);
      upper[d] = *std::max_element(place[d], place[d] + 16);
    }
    for (unsigned int group = 0; group < SimplexLanes<dim>::n_groups; ++group)
    {
      const auto edges = lanes.edges(group);
      counts |= bits_of(SimplexLanes<dim>::volume_factor * edges.determinant > 0.) << (8 * group);
      store_eight(SimplexLanes<dim>::volume_factor * edges.determinant,
                  volume + std::size_t(8) * group);
      EightDoubles determinant = edges.determinant;
      std::experimental::where(determinant == 0., determinant) = 1.;
      const EightDoubles inverse = 1. / determinant;
      double gradient[dim + 1][dim][8];
      for (unsigned int d = 0; d < dim; ++d)
      {
        EightDoubles of_centre = 0.;
        for (unsigned int k = 0; k < dim; ++k)
        {
          const EightDoubles value = inverse * edges.cofactor[k][d];
          store_eight(value, gradient[k][d]);
          of_centre -= value;
        }
        store_eight(of_centre, gradient[dim][d]);
      }
      for (unsigned int s = 8 * group; s < std::min(8 * (group + 1), n_simplices); ++s)
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int k = 0; k < 4; ++k)
            gradients_of_simplices[s].entries[d][k] = k <= dim ? gradient[k][d][s % 8] : 0.;
    }
    counts &= (1u << n_simplices) - 1;
  }

  template <int dim>
  void SimplexPairs<dim>::add_cell(const SimplexCell<dim> &cell)
  {
    constexpr double nowhere = 1e300;
    const std::size_t number = cells.size(), first = number / 8 * dim * 16;
    if (number % 8 == 0)
    {
      if (box.size() < first + dim * 16)
        box.resize(first + dim * 16);
      std::fill_n(box.begin() + std::ptrdiff_t(first), dim * 16, nowhere);
    }
    for (unsigned int d = 0; d < dim; ++d)
    {
      box[first + d * 16 + number % 8] = cell.lower[d];
      box[first + d * 16 + 8 + number % 8] = cell.upper[d];
    }
    cells.push_back(&cell);
  }

  template <int dim>
  void SimplexPairs<dim>::start(const SimplexCell<dim> &of_new, const unsigned int simplex)
  {
    overlaps.clear();
    n_pairs = 0;
    set_place(of_new, simplex);
    for (unsigned int first = 0; first < cells.size(); first += 8)
    {
      unsigned int is_apart = 0;
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double *const of_group = box.data() + (std::size_t(first) / 8 * dim + d) * 16;
        is_apart |=
            bits_of(load_eight(of_group) > upper[d]) | bits_of(load_eight(of_group + 8) < lower[d]);
      }
      for (unsigned int is_near = ~is_apart & 0xFFu; is_near != 0; is_near &= is_near - 1)
        add_pairs(first + first_bit(is_near));
    }
  }

  template <int dim>
  void SimplexPairs<dim>::set_place(const SimplexCell<dim> &of_new, const unsigned int simplex)
  {
    const std::uint8_t *const points = SimplexPoints<dim>::instance().vertices[simplex].data();
    for (unsigned int d = 0; d < dim; ++d)
    {
      lower[d] = upper[d] = origin[d] = of_new.place[d][points[0]];
      for (unsigned int k = 0; k < 4; ++k)
      {
        const double of_vertex = of_new.place[d][points[k <= dim ? k : 0]];
        std::fill_n(place[d] + 4 * k, 4, of_vertex);
        lower[d] = std::min(lower[d], of_vertex);
        upper[d] = std::max(upper[d], of_vertex);
      }
      for (unsigned int k = 0; k < dim; ++k)
        gradient[k][d] = of_new.gradients(simplex)[d][k + 1];
    }
  }

  template <int dim>
  void SimplexPairs<dim>::add_pairs(const unsigned int number)
  {
    const SimplexCell<dim> &cell = *cells[number];
    const SimplexPoints<dim> &of_cell = SimplexPoints<dim>::instance();
    typename SimplexOverlaps<dim>::Points points; // in the new simplex
    unsigned int in_front[dim + 1] = {};
    for (unsigned int first = 0; first < 16; first += 8)
    {
      EightDoubles offset[dim], last = 1.;
      TOMBOLO_UNROLL
      for (unsigned int d = 0; d < dim; ++d)
        offset[d] = load_eight(cell.place[d] + first) - origin[d];
      TOMBOLO_UNROLL
      for (unsigned int k = 0; k < dim; ++k)
      {
        EightDoubles value = gradient[k][0] * offset[0];
        TOMBOLO_UNROLL
        for (unsigned int d = 1; d < dim; ++d)
          value += gradient[k][d] * offset[d];
        last -= value;
        store_eight(value, points[k + 1] + first);
        in_front[k + 1] |= bits_of(value > 0.) << first;
      }
      store_eight(last, points[0] + first);
      in_front[0] |= bits_of(last > 0.) << first;
    }
    // Those that are not all behind one side of the new simplex.
    unsigned int candidates = cell.counts;
    for (const unsigned int of_side : in_front)
      candidates &= of_cell.simplices_at(of_side);
    const std::size_t first_pair = n_pairs;
    if (pairs.size() < n_pairs + SimplexPoints<dim>::n_simplices)
      pairs.resize(n_pairs + SimplexPoints<dim>::n_simplices);
    for (; candidates != 0; candidates &= candidates - 1)
      add_pair(cell, number, first_bit(candidates));
    for (std::size_t pair = first_pair; pair < n_pairs; ++pair)
      overlaps.add(points, of_cell.vertices[pairs[pair].simplex].data());
  }

  template <int dim>
  TOMBOLO_ALWAYS_INLINE void SimplexPairs<dim>::add_pair(const SimplexCell<dim> &cell,
                                                         const unsigned int number,
                                                         const unsigned int simplex)
  {
    Pair &pair = pairs[n_pairs];
    // Coordinates at the centre; with an entry beyond, which is always in front.
    alignas(32) static constexpr double of_centre[4] = {0., 0., dim == 2 ? 1. : 0., 1.};
    const double(&of_old)[dim][4] = cell.gradients(simplex);
    EightDoubles low = repeat_four(of_centre), high = low; // of two vertices each
    TOMBOLO_UNROLL
    for (unsigned int d = 0; d < dim; ++d)
    {
      const EightDoubles of_component = repeat_four(of_old[d]);
      const double centre = cell.place[d][SimplexPoints<dim>::centre];
      low += (load_eight(place[d]) - centre) * of_component;
      high += (load_eight(place[d] + 8) - centre) * of_component;
    }
    store_eight(low, pair.old_at_new[0]);
    store_eight(high, pair.old_at_new[2]);
    pair.cell = number;
    pair.simplex = simplex;
    // Unless the new one is behind a side of the old one; a sum in place of a branch, which would
    // follow no pattern.
    const unsigned int in_front = bits_of(std::experimental::max(low, high) > 0.);
    n_pairs += ((in_front | (in_front >> 4)) & 15u) == 15u ? 1 : 0;
  }

  template class SimplexCell<2>;
  template class SimplexCell<3>;
  template class SimplexPairs<2>;
  template class SimplexPairs<3>;

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
