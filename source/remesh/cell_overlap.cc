// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/cell_overlap.h>

#include <tombolo/remesh/overlap_moments.h>
#include <tombolo/remesh/uncovered_mass.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/numerics/rtree.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    BoundingBox<dim> box_of(const std::vector<Point<dim>> &points)
    {
      return BoundingBox<dim>(points);
    }

    template <int dim>
    BoundingBox<dim> box_of_corners(const typename SubCells<dim>::Corners &corners)
    {
      return box_of<dim>(std::vector<Point<dim>>(corners.begin(), corners.end()));
    }

    template <int dim>
    bool overlap(const Point<dim> &lower, const Point<dim> &upper, const Point<dim> &other_lower,
                 const Point<dim> &other_upper)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (upper[d] < other_lower[d] || other_upper[d] < lower[d])
          return false;
      return true;
    }

    /** The volumes of the sub-cells without simplices that are turned over. */
    template <int dim>
    std::array<double, SubCells<dim>::n_sub_cells>
    positive_volumes(const typename SubCells<dim>::Corners &corners)
    {
      std::array<double, SubCells<dim>::n_sub_cells> result{};
      for (const auto &simplex : CellSimplices<dim>::all())
        result[simplex.sub_cell] += std::max(
            0., CellSimplices<dim>::volume(CellSimplices<dim>::vertices(simplex, corners)));
      return result;
    }

    /** A simplex with the box around it. */
    template <int dim>
    struct BoxedSimplex
    {
      typename CellSimplices<dim>::Vertices vertices;
      Point<dim> lower, upper;
      double volume;
      std::optional<BarycentricCoordinates<dim>> coordinates; ///< if the volume is positive

      BoxedSimplex(const typename CellSimplices<dim>::Simplex &simplex,
                   const typename SubCells<dim>::Corners &corners)
          : vertices(CellSimplices<dim>::vertices(simplex, corners)), lower(vertices[0]),
            upper(vertices[0]), volume(CellSimplices<dim>::volume(vertices))
      {
        for (const Point<dim> &vertex : vertices)
          for (unsigned int d = 0; d < dim; ++d)
          {
            lower[d] = std::min(lower[d], vertex[d]);
            upper[d] = std::max(upper[d], vertex[d]);
          }
        if (volume > 0.)
          coordinates.emplace(vertices);
      }

      /** Finds the coordinates of @p others, by vertex, and whether all of these are behind one of
       * the sides. */
      bool is_apart_from(const typename CellSimplices<dim>::Vertices &others,
                         double (&of_others)[dim + 1][dim + 1]) const
      {
        for (unsigned int k = 0; k <= dim; ++k)
          coordinates->evaluate(others[k], of_others[k]);
        for (unsigned int j = 0; j <= dim; ++j)
        {
          bool is_behind = true;
          for (unsigned int k = 0; k <= dim; ++k)
            is_behind = is_behind && of_others[k][j] <= 0.;
          if (is_behind)
            return true;
        }
        return false;
      }
    };

    /** For each simplex of before that @p target has something of: calls @p add(piece of it), and
     * then @p end(its number, its coordinates at the vertices of @p target). */
    template <int dim, typename Add, typename End>
    void for_pieces(const BoxedSimplex<dim> &target, const std::vector<BoxedSimplex<dim>> &before,
                    const Add &add, const End &end)
    {
      double old_at_new[dim + 1][dim + 1], new_at_old[dim + 1][dim + 1];
      for (unsigned int s = 0; s < before.size(); ++s)
      {
        const BoxedSimplex<dim> &source = before[s];
        if (!(source.volume > 0.) ||
            !overlap<dim>(source.lower, source.upper, target.lower, target.upper) ||
            source.is_apart_from(target.vertices, old_at_new) ||
            target.is_apart_from(source.vertices, new_at_old))
          continue;
        SimplexOverlap::Piece<dim> piece;
        for (unsigned int k = 0; k <= dim; ++k)
          std::copy_n(new_at_old[k], dim + 1, piece[k].in_new);
        SimplexOverlap::clip<dim>(piece, 0, add);
        end(s, old_at_new);
      }
    }

    /** Calls @p use(number of a simplex of before, OverlapMoments with it) for all that @p target
     * has of simplices of before. */
    template <int dim, typename Use>
    void for_pairs(const BoxedSimplex<dim> &target, const std::vector<BoxedSimplex<dim>> &before,
                   const Use &use)
    {
      OverlapMoments<dim> moments;
      for_pieces<dim>(
          target, before, [&](const SimplexOverlap::Piece<dim> &piece) { moments.add(piece); },
          [&](const unsigned int s, const double(&old_at_new)[dim + 1][dim + 1])
          {
            moments.finish(old_at_new);
            if (moments.volume > 0.)
              use(s, moments);
            moments = {};
          });
    }

    /** Integrals over one simplex of after, in its barycentric coordinates. */
    template <int dim>
    struct SimplexIntegrals
    {
      double matrix[dim + 1][dim + 1] = {}, mass[dim + 1] = {};
      std::vector<double> values; // by field, vertex and slot

      explicit SimplexIntegrals(const unsigned int n_fields)
          : values(std::size_t(n_fields) * (dim + 1) * node_stride, 0.)
      {}

      /** What it has of an old simplex, of whose density it would have the mass @p of_simplex in
       * all; the fields have @p of_old at the vertices of the old one, by vertex, field and slot.
       */
      void add(const OverlapMoments<dim> &moments, const double of_simplex,
               const std::vector<double> &of_old)
      {
        for (unsigned int j = 0; j <= dim; ++j)
        {
          mass[j] += of_simplex * moments.of_new[j];
          for (unsigned int k = 0; k <= dim; ++k)
            matrix[j][k] += of_simplex * moments.new_by_new[j][k];
        }
        const std::size_t n = of_old.size() / (dim + 1); // fields times slots
        for (std::size_t field = 0; field < n / node_stride; ++field)
          for (unsigned int j = 0; j <= dim; ++j)
          {
            double *const sums = values.data() + (field * (dim + 1) + j) * node_stride;
            for (unsigned int i = 0; i <= dim; ++i)
            {
              const double weight = of_simplex * moments.new_by_old[j][i];
              const double *const z = of_old.data() + i * n + field * node_stride;
              for (unsigned int slot = 0; slot < node_stride; ++slot)
                sums[slot] += weight * z[slot];
            }
          }
      }

      void give(const typename CellSimplices<dim>::Simplex &simplex,
                typename CellOverlap<dim>::Integrals &cell) const
      {
        constexpr unsigned int n_corners = CellOverlap<dim>::n_corners;
        const std::size_t n_fields = values.size() / ((dim + 1) * node_stride);
        for (unsigned int j = 0; j <= dim; ++j)
          for (unsigned int a = 0; a < n_corners; ++a)
          {
            const double share = simplex.vertices[j][a];
            if (share == 0.)
              continue;
            cell.mass[a] += share * mass[j];
            for (unsigned int k = 0; k <= dim; ++k)
              for (unsigned int b = 0; b < n_corners; ++b)
                cell.matrix[a * n_corners + b] += share * simplex.vertices[k][b] * matrix[j][k];
            for (std::size_t field = 0; field < n_fields; ++field)
              for (unsigned int slot = 0; slot < node_stride; ++slot)
                cell.values[(field * n_corners + a) * node_stride + slot] +=
                    share * values[(field * (dim + 1) + j) * node_stride + slot];
          }
      }
    };

    template <int dim>
    OverlapMoments<dim> moments_of_whole_simplex()
    {
      SimplexOverlap::Piece<dim> piece;
      double unit[dim + 1][dim + 1];
      for (unsigned int k = 0; k <= dim; ++k)
        for (unsigned int j = 0; j <= dim; ++j)
          piece[k].in_new[j] = unit[k][j] = k == j ? 1. : 0.;
      OverlapMoments<dim> result;
      result.add(piece);
      result.finish(unit);
      return result;
    }

    /** Values at the vertices of a simplex, by vertex and component, from those at corners. */
    template <int dim>
    void at_vertices(const typename CellSimplices<dim>::Simplex &simplex, const double *of_corners,
                     const std::size_t n, std::vector<double> &result)
    {
      result.assign((dim + 1) * n, 0.);
      for (unsigned int k = 0; k <= dim; ++k)
        for (unsigned int a = 0; a < CellOverlap<dim>::n_corners; ++a)
          if (simplex.vertices[k][a] != 0.)
            for (std::size_t c = 0; c < n; ++c)
              result[k * n + c] += simplex.vertices[k][a] * of_corners[a * n + c];
    }

    /** The fields at the corners of a cell, by corner, field and slot. */
    template <int dim>
    std::vector<double> values_at_corners(const RemapCell<dim> &cell,
                                          const std::vector<const NodalVector *> &fields)
    {
      std::vector<double> result;
      for (const unsigned int node : cell.nodes)
        for (const NodalVector *const field : fields)
          result.insert(result.end(), field->node(node), field->node(node) + node_stride);
      return result;
    }
  } // namespace

  std::map<unsigned int, std::vector<double>>
  exchange_by_rank(const std::map<unsigned int, std::vector<double>> &for_ranks,
                   const MPI_Comm communicator)
  {
    const unsigned int self = Utilities::MPI::this_mpi_process(communicator);
    auto for_others = for_ranks;
    for_others.erase(self);
    auto result = Utilities::MPI::some_to_some(communicator, for_others);
    const auto own = for_ranks.find(self);
    if (own != for_ranks.end())
      result[self] = own->second;
    return result;
  }

  /** A cell of before that reaches cells of after of this rank. */
  template <int dim>
  struct CellOverlap<dim>::Received
  {
    std::vector<BoxedSimplex<dim>> simplices;
    BoundingBox<dim> box;
    std::array<double, n_sub_cells> density;
    bool is_cut;
    std::vector<std::vector<double>> values; ///< at the vertices of each simplex
    std::array<double, n_corners> covered_mass{};
    std::array<Covered, n_sub_cells> covered;

    Received(const double *data, const std::size_t n_values)
    {
      typename SubCells<dim>::Corners corners;
      for (Point<dim> &corner : corners)
        for (unsigned int d = 0; d < dim; ++d)
          corner[d] = *data++;
      for (double &of_sub_cell : density)
        of_sub_cell = *data++;
      is_cut = *data++ > 0.;
      box = box_of_corners<dim>(corners);
      for (const auto &simplex : CellSimplices<dim>::all())
      {
        simplices.emplace_back(simplex, corners);
        values.emplace_back();
        at_vertices<dim>(simplex, data, n_values / n_corners, values.back());
      }
    }
  };

  template <int dim>
  CellOverlap<dim>::CellOverlap(const std::vector<RemapCell<dim>> &cells,
                                const std::vector<const NodalVector *> &fields,
                                const MPI_Comm communicator)
      : cells(cells), integrals(cells.size()), covered_mass(cells.size()),
        covered(cells.size() * n_sub_cells), communicator(communicator),
        n_fields(static_cast<unsigned int>(fields.size()))
  {
    const double moves = std::any_of(cells.begin(), cells.end(),
                                     [](const RemapCell<dim> &cell) { return cell.has_moved(); })
                             ? 1.
                             : 0.;
    has_motion = Utilities::MPI::max(moves, communicator) > 0.;
    has_cut_cells =
        Utilities::MPI::max(std::any_of(cells.begin(), cells.end(),
                                        [](const RemapCell<dim> &cell) { return cell.is_cut; })
                                ? 1.
                                : 0.,
                            communicator) > 0.;
    if (!has_motion)
      return;
    send_cells(fields);
    const std::size_t n_values = std::size_t(n_fields) * n_corners * node_stride;
    const std::size_t size = n_corners * dim + n_sub_cells + 1 + n_values;
    std::vector<Received> received;
    for (std::size_t first = 0; first < received_data.size(); first += size)
      received.emplace_back(received_data.data() + first, n_values);
    received_data.clear();
    std::vector<BoundingBox<dim>> boxes;
    for (const Received &cell : received)
      boxes.push_back(cell.box);
    for (unsigned int cell = 0; cell < cells.size(); ++cell)
    {
      integrals[cell].values.assign(n_values, 0.);
      covered_mass[cell] = {};
      if (!cells[cell].has_moved() && !cells[cell].is_void_after)
        add_unmoved(cell, fields);
    }
    const auto tree = pack_rtree_of_indices(boxes);
    std::vector<std::vector<std::size_t>> near(cells.size());
    for (unsigned int cell = 0; cell < cells.size(); ++cell)
      if (is_target(cell))
      {
        tree.query(boost::geometry::index::intersects(box_of_corners<dim>(cells[cell].after)),
                   std::back_inserter(near[cell]));
        std::sort(near[cell].begin(), near[cell].end());
      }
    if (has_cut_cells)
      gather_densities(near, received, fields.front()->partition());
    for (unsigned int cell = 0; cell < cells.size(); ++cell)
      if (is_target(cell))
        add_moved(cell, near[cell], received);
    return_covered(received);
  }

  template <int dim>
  void CellOverlap<dim>::send_cells(const std::vector<const NodalVector *> &fields)
  {
    std::vector<Point<dim>> places;
    for (unsigned int c = 0; c < cells.size(); ++c)
      if (is_target(c))
        places.insert(places.end(), cells[c].after.begin(), cells[c].after.end());
    std::vector<double> own_box;
    if (!places.empty())
    {
      const auto box = box_of<dim>(places).get_boundary_points();
      for (unsigned int d = 0; d < dim; ++d)
      {
        own_box.push_back(box.first[d]);
        own_box.push_back(box.second[d]);
      }
    }
    const auto boxes = Utilities::MPI::all_gather(communicator, own_box);
    std::map<unsigned int, std::vector<double>> messages;
    for (unsigned int c = 0; c < cells.size(); ++c)
    {
      const RemapCell<dim> &cell = cells[c];
      if (!is_source(c))
        continue;
      std::vector<double> data;
      for (const Point<dim> &corner : cell.before)
        data.insert(data.end(), corner.begin_raw(), corner.end_raw());
      const auto volume = positive_volumes<dim>(cell.before);
      for (unsigned int q = 0; q < n_sub_cells; ++q)
        data.push_back(volume[q] > 0. ? cell.mass[q] / volume[q] : 0.);
      data.push_back(cell.is_cut ? 1. : 0.);
      const std::vector<double> values = values_at_corners(cell, fields);
      data.insert(data.end(), values.begin(), values.end());
      const auto box = box_of_corners<dim>(cell.before).get_boundary_points();
      for (unsigned int rank = 0; rank < boxes.size(); ++rank)
      {
        bool meets = !boxes[rank].empty();
        for (unsigned int d = 0; d < dim && meets; ++d)
          meets = box.first[d] <= boxes[rank][2 * d + 1] && boxes[rank][2 * d] <= box.second[d];
        if (!meets)
          continue;
        sent[rank].push_back(c);
        messages[rank].insert(messages[rank].end(), data.begin(), data.end());
      }
    }
    const std::size_t size =
        n_corners * dim + n_sub_cells + 1 + std::size_t(n_fields) * n_corners * node_stride;
    for (const auto &[rank, data] : exchange_by_rank(messages, communicator))
    {
      n_received[rank] = static_cast<unsigned int>(data.size() / size);
      received_data.insert(received_data.end(), data.begin(), data.end());
    }
  }

  template <int dim>
  void CellOverlap<dim>::add_unmoved(const unsigned int cell,
                                     const std::vector<const NodalVector *> &fields)
  {
    const auto &corners = cells[cell].before;
    const auto volumes = CellSimplices<dim>::volumes(corners);
    const std::vector<double> values = values_at_corners(cells[cell], fields);
    std::vector<double> of_vertices;
    for (const auto &simplex : CellSimplices<dim>::all())
    {
      const double volume =
          CellSimplices<dim>::volume(CellSimplices<dim>::vertices(simplex, corners));
      const double mass = cells[cell].mass[simplex.sub_cell] * volume / volumes[simplex.sub_cell];
      at_vertices<dim>(simplex, values.data(), values.size() / n_corners, of_vertices);
      SimplexIntegrals<dim> sums(n_fields);
      sums.add(moments_of_whole_simplex<dim>(), mass, of_vertices);
      sums.give(simplex, integrals[cell]);
    }
    covered_mass[cell] = integrals[cell].mass; // the functions are the same
  }

  template <int dim>
  void CellOverlap<dim>::add_moved(const unsigned int cell, const std::vector<std::size_t> &near,
                                   std::vector<Received> &received)
  {
    const auto &all = CellSimplices<dim>::all();
    std::map<std::pair<unsigned int, unsigned int>, Covered> found; // by sub-cells, to and from
    for (const auto &after : all)
    {
      const BoxedSimplex<dim> target(after, cells[cell].after);
      if (!(target.volume > 0.))
        continue;
      SimplexIntegrals<dim> sums(n_fields);
      for (const std::size_t r : near)
      {
        Received &from = received[r];
        for_pairs<dim>(
            target, from.simplices,
            [&](const unsigned int s, const OverlapMoments<dim> &moments)
            {
              const BoxedSimplex<dim> &source = from.simplices[s];
              const unsigned int sub_cell = all[s].sub_cell;
              const double mass = from.density[sub_cell] * target.volume;
              sums.add(moments, mass, from.values[s]);
              Covered &share =
                  found[{after.sub_cell, static_cast<unsigned int>(r) * n_sub_cells + sub_cell}];
              share.volume += moments.volume * target.volume;
              for (unsigned int i = 0; i <= dim; ++i)
              {
                share.moment += target.volume * moments.of_old[i] * source.vertices[i];
                for (unsigned int a = 0; a < n_corners; ++a)
                  from.covered_mass[a] += mass * moments.of_old[i] * all[s].vertices[i][a];
              }
            });
      }
      sums.give(after, integrals[cell]);
    }
    for (const auto &[pair, share] : found)
    {
      if (!(share.volume > 0.))
        continue;
      shares.push_back({cell * n_sub_cells + pair.first, pair.second, share.volume, share.moment});
      Covered &of_source = received[pair.second / n_sub_cells].covered[pair.second % n_sub_cells];
      of_source.volume += share.volume;
      of_source.moment += share.moment;
    }
  }

  template <int dim>
  std::vector<double>
  CellOverlap<dim>::covered_volumes(const std::vector<std::vector<std::size_t>> &near,
                                    const std::vector<Received> &received) const
  {
    const auto &all = CellSimplices<dim>::all();
    std::vector<std::array<double, n_sub_cells>> here(received.size());
    for (auto &of_cell : here)
      of_cell = {};
    for (std::size_t cell = 0; cell < cells.size(); ++cell)
    {
      if (std::none_of(near[cell].begin(), near[cell].end(),
                       [&](const std::size_t r) { return received[r].is_cut; }))
        continue;
      for (const auto &after : all)
      {
        const BoxedSimplex<dim> target(after, cells[cell].after);
        if (!(target.volume > 0.))
          continue;
        for (const std::size_t r : near[cell])
          if (received[r].is_cut)
          {
            double volume = 0;
            for_pieces<dim>(
                target, received[r].simplices,
                [&](const SimplexOverlap::Piece<dim> &piece)
                { volume += SimplexOverlap::fraction<dim>(piece) * target.volume; },
                [&](const unsigned int s, const auto &)
                {
                  here[r][all[s].sub_cell] += volume;
                  volume = 0;
                });
          }
      }
    }
    std::map<unsigned int, std::vector<double>> messages;
    std::size_t next = 0;
    for (const auto &[rank, n] : n_received)
      for (unsigned int k = 0; k < n; ++k, ++next)
        messages[rank].insert(messages[rank].end(), here[next].begin(), here[next].end());
    std::vector<double> result(cells.size() * n_sub_cells, 0.);
    for (const auto &[rank, data] : exchange_by_rank(messages, communicator))
    {
      const double *value = data.data();
      for (const unsigned int cell : sent.at(rank))
        for (unsigned int q = 0; q < n_sub_cells; ++q)
          result[cell * n_sub_cells + q] += *value++;
    }
    return result;
  }

  template <int dim>
  void CellOverlap<dim>::gather_densities(const std::vector<std::vector<std::size_t>> &near,
                                          std::vector<Received> &received,
                                          const std::shared_ptr<const NodePartition> &partition)
  {
    constexpr double least_share = 1e-6;
    std::vector<double> factors = covered_volumes(near, received);
    std::vector<bool> is_bare(factors.size(), false);
    std::vector<double> mass;
    bool any = false;
    for (unsigned int cell = 0; cell < cells.size(); ++cell)
    {
      mass.insert(mass.end(), cells[cell].mass.begin(), cells[cell].mass.end());
      if (!is_source(cell))
        continue;
      const auto volumes = positive_volumes<dim>(cells[cell].before);
      for (unsigned int q = 0; q < n_sub_cells; ++q)
      {
        const std::size_t i = cell * n_sub_cells + q;
        is_bare[i] = cells[cell].is_cut && !(factors[i] > least_share * volumes[q]);
        any = any || is_bare[i];
        factors[i] = !cells[cell].is_cut ? 1. : is_bare[i] ? 0. : volumes[q] / factors[i];
      }
    }
    if (Utilities::MPI::max(any ? 1 : 0, communicator) != 0)
    {
      is_uncovered = is_bare;
      std::vector<double> none;
      give_to_neighbours(*this, partition, 0, mass, none);
      for (std::size_t i = 0; i < factors.size(); ++i)
        if (const double of_cell = cells[i / n_sub_cells].mass[i % n_sub_cells]; of_cell > 0.)
          factors[i] *= mass[i] / of_cell;
    }
    const std::vector<double> of_received = forward(factors, n_sub_cells);
    for (std::size_t r = 0; r < received.size(); ++r)
      for (unsigned int q = 0; q < n_sub_cells; ++q)
        received[r].density[q] *= of_received[r * n_sub_cells + q];
  }

  template <int dim>
  void CellOverlap<dim>::return_covered(const std::vector<Received> &received)
  {
    std::map<unsigned int, std::vector<double>> messages;
    std::size_t next = 0;
    for (const auto &[rank, n] : n_received)
      for (unsigned int k = 0; k < n; ++k, ++next)
      {
        std::vector<double> &data = messages[rank];
        data.insert(data.end(), received[next].covered_mass.begin(),
                    received[next].covered_mass.end());
        for (const Covered &of_sub_cell : received[next].covered)
        {
          data.push_back(of_sub_cell.volume);
          data.insert(data.end(), of_sub_cell.moment.begin_raw(), of_sub_cell.moment.end_raw());
        }
      }
    for (const auto &[rank, data] : exchange_by_rank(messages, communicator))
    {
      const double *value = data.data();
      for (const unsigned int cell : sent.at(rank))
      {
        for (double &of_corner : covered_mass[cell])
          of_corner += *value++;
        for (unsigned int q = 0; q < n_sub_cells; ++q)
        {
          Covered &of_sub_cell = covered[cell * n_sub_cells + q];
          of_sub_cell.volume += *value++;
          for (unsigned int d = 0; d < dim; ++d)
            of_sub_cell.moment[d] += *value++;
        }
      }
    }
  }

  template <int dim>
  std::vector<double> CellOverlap<dim>::forward(const std::vector<double> &of_cells,
                                                const unsigned int n) const
  {
    std::map<unsigned int, std::vector<double>> messages;
    for (const auto &[rank, of_rank] : sent)
      for (const unsigned int cell : of_rank)
        messages[rank].insert(messages[rank].end(), of_cells.begin() + std::ptrdiff_t(cell) * n,
                              of_cells.begin() + std::ptrdiff_t(cell + 1) * n);
    std::vector<double> result;
    for (const auto &[rank, data] : exchange_by_rank(messages, communicator))
      result.insert(result.end(), data.begin(), data.end());
    return result;
  }

  template class CellOverlap<2>;
  template class CellOverlap<3>;
} // namespace tombolo
