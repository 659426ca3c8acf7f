// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/cell_overlap.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/remesh/cell_cutting.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/numerics/rtree.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tombolo
{
  namespace
  {
    template <int dim>
    BoundingBox<dim> box_of_corners(const typename SubCells<dim>::Corners &corners)
    {
      return BoundingBox<dim>(std::vector<Point<dim>>(corners.begin(), corners.end()));
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

  template <int dim>
  CellOverlap<dim>::CellOverlap(const std::vector<RemapCell<dim>> &cells,
                                const std::vector<const NodalVector *> &fields,
                                const MPI_Comm communicator)
      : cells(cells), integrals(cells.size()), covered(cells.size() * n_sub_cells),
        communicator(communicator), n_fields(static_cast<unsigned int>(fields.size()))
  {
    has_motion = any_of_all_ranks(
        cells, [](const RemapCell<dim> &cell) { return cell.has_moved(); }, communicator);
    has_cut_cells = any_of_all_ranks(
        cells, [](const RemapCell<dim> &cell) { return cell.is_cut; }, communicator);
    if (!has_motion)
      return;
    send_cells(fields);
    const std::size_t n_values = std::size_t(n_fields) * n_corners * node_stride;
    const std::size_t size = Received::size(n_values);
    std::vector<Received> received;
    received.reserve(received_data.size() / size);
    for (std::size_t first = 0; first < received_data.size(); first += size)
      received.emplace_back(received_data.data() + first, n_values);
    received_data.clear();
    std::vector<BoundingBox<dim>> boxes;
    for (const Received &cell : received)
      boxes.emplace_back(std::make_pair(cell.simplices.lower, cell.simplices.upper));
    for (unsigned int cell = 0; cell < cells.size(); ++cell)
    {
      integrals[cell].values.assign(n_values, 0.);
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
    // Room for one of each sub-cell that is near; seldom are there more.
    std::size_t n_shares = 0;
    for (const std::vector<std::size_t> &near_cells : near)
      n_shares += near_cells.size() * n_sub_cells;
    shares.reserve(n_shares);
    CellCutting<dim> cutting(received, n_fields);
    for (unsigned int cell = 0; cell < cells.size(); ++cell)
      if (is_target(cell))
        cutting.cut(cell, cells[cell].after, near[cell], integrals[cell], shares);
    if (has_cut_cells)
    {
      change_densities(received, fields.front()->partition());
      for (unsigned int cell = 0; cell < cells.size(); ++cell)
      {
        const auto has_not_changed = [&](const std::size_t r)
        { return received[r].simplices.counts == 0; };
        near[cell].erase(std::remove_if(near[cell].begin(), near[cell].end(), has_not_changed),
                         near[cell].end());
        if (!near[cell].empty())
          cutting.add_changes(cells[cell].after, near[cell], integrals[cell]);
      }
    }
    return_covered(received);
  }

  template <int dim>
  void CellOverlap<dim>::send_cells(const std::vector<const NodalVector *> &fields)
  {
    std::vector<Point<dim>> target_points;
    for (unsigned int c = 0; c < cells.size(); ++c)
      if (is_target(c))
        target_points.insert(target_points.end(), cells[c].after.begin(), cells[c].after.end());
    std::vector<double> own_box;
    if (!target_points.empty())
    {
      const auto box = BoundingBox<dim>(target_points).get_boundary_points();
      for (unsigned int d = 0; d < dim; ++d)
      {
        own_box.push_back(box.first[d]);
        own_box.push_back(box.second[d]);
      }
    }
    const auto boxes = items_by_rank(own_box, communicator);
    std::map<unsigned int, std::vector<double>> messages;
    for (unsigned int c = 0; c < cells.size(); ++c)
    {
      const RemapCell<dim> &cell = cells[c];
      if (!is_source(c))
        continue;
      std::vector<double> data;
      for (const Point<dim> &corner : cell.before)
        data.insert(data.end(), &corner[0], &corner[0] + dim);
      const auto volume = CellSimplices<dim>::volumes(cell.before, true);
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
    const std::size_t size = Received::size(std::size_t(n_fields) * n_corners * node_stride);
    for (const auto &[rank, data] : exchange_by_rank(std::move(messages), communicator))
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
    std::vector<EightDoubles> point_values;
    values_at_points<dim>(values.data(), n_fields, point_values);
    const SimplexPoints<dim> &points = SimplexPoints<dim>::instance();
    double simplex_volumes[SimplexLanes<dim>::n_padded];
    SimplexLanes<dim>(corners).find_volumes(simplex_volumes);
    SimplexIntegrals<dim> sums(n_fields);
    PointIntegrals<dim> point_integrals(n_fields);
    for (unsigned int s = 0; s < SimplexPoints<dim>::n_simplices; ++s)
    {
      const double mass =
          cells[cell].mass[points.sub_cell[s]] * simplex_volumes[s] / volumes[points.sub_cell[s]];
      sums.clear();
      sums.add_whole(mass, point_values, points.vertices[s].data());
      sums.use_barycentric_functions();
      point_integrals.add(sums, points.vertices[s].data());
    }
    point_integrals.add_to(integrals[cell]);
  }

  template <int dim>
  void CellOverlap<dim>::change_densities(std::vector<Received> &received,
                                          const std::shared_ptr<const NodePartition> &partition)
  {
    constexpr double least_share = 1e-6, least_change = 1e-12;
    return_covered(received);
    std::vector<double> factors(covered.size(), 0.);
    std::vector<bool> is_bare(factors.size(), false);
    std::vector<double> mass;
    bool any = false;
    for (unsigned int cell = 0; cell < cells.size(); ++cell)
    {
      mass.insert(mass.end(), cells[cell].mass.begin(), cells[cell].mass.end());
      if (!is_source(cell))
        continue;
      const auto volumes = CellSimplices<dim>::volumes(cells[cell].before, true);
      for (unsigned int q = 0; q < n_sub_cells; ++q)
      {
        const std::size_t i = cell * n_sub_cells + q;
        is_bare[i] = cells[cell].is_cut && !(covered[i].volume > least_share * volumes[q]);
        any = any || is_bare[i];
        factors[i] = !cells[cell].is_cut ? 1. : is_bare[i] ? 0. : volumes[q] / covered[i].volume;
      }
    }
    if (Utilities::MPI::max(any ? 1 : 0, communicator) != 0)
    {
      is_uncovered = is_bare;
      std::vector<double> none;
      distribute_to_neighbours(partition, 0, mass, none);
      for (std::size_t i = 0; i < factors.size(); ++i)
        if (const double sub_cell_mass = cells[i / n_sub_cells].mass[i % n_sub_cells];
            sub_cell_mass > 0.)
          factors[i] *= mass[i] / sub_cell_mass;
    }
    const SimplexPoints<dim> &points = SimplexPoints<dim>::instance();
    const std::vector<double> received_factors = forward(factors, n_sub_cells);
    for (std::size_t r = 0; r < received.size(); ++r)
    {
      Received &cell = received[r];
      for (unsigned int q = 0; q < n_sub_cells; ++q)
      {
        const double change = received_factors[r * n_sub_cells + q] - 1.;
        if (std::abs(change) > least_change)
          cell.change[q] = change * cell.density[q];
        cell.density[q] += cell.change[q];
      }
      for (unsigned int s = 0; s < SimplexPoints<dim>::n_simplices; ++s)
        if (cell.change[points.sub_cell[s]] == 0.)
          cell.simplices.counts &= ~(1u << s);
    }
  }

  template <int dim>
  void CellOverlap<dim>::return_covered(const std::vector<Received> &received)
  {
    std::map<unsigned int, std::vector<double>> messages;
    std::size_t next = 0;
    for (const auto &[rank, n] : n_received)
      for (unsigned int k = 0; k < n; ++k, ++next)
        for (unsigned int q = 0; q < n_sub_cells; ++q)
        {
          std::vector<double> &data = messages[rank];
          const Covered covered_part = received[next].covered(q);
          data.push_back(covered_part.volume);
          data.insert(data.end(), &covered_part.moment[0], &covered_part.moment[0] + dim);
        }
    covered.assign(cells.size() * n_sub_cells, {});
    for (const auto &[rank, data] : exchange_by_rank(std::move(messages), communicator))
    {
      const double *value = data.data();
      for (const unsigned int cell : sent.at(rank))
        for (unsigned int q = 0; q < n_sub_cells; ++q)
        {
          Covered &covered_part = covered[cell * n_sub_cells + q];
          covered_part.volume += *value++;
          for (unsigned int d = 0; d < dim; ++d)
            covered_part.moment[d] += *value++;
        }
    }
  }

  template <int dim>
  void CellOverlap<dim>::distribute_to_neighbours(
      const std::shared_ptr<const NodePartition> &partition, const unsigned int n_components,
      std::vector<double> &mass, std::vector<double> &values) const
  {
    const auto receives = [&](const std::size_t i)
    {
      return !is_uncovered[i] && mass[i] > 0. &&
             is_source(static_cast<unsigned int>(i / n_sub_cells));
    };
    const auto nodes = [&](const std::size_t i) -> auto &
    {
      return cells[i / n_sub_cells].nodes;
    };
    NodalVector receiver_mass(partition, Quantity::scalar), donor_content;
    for (std::size_t i = 0; i < mass.size(); ++i)
      for (const unsigned int node : nodes(i))
        *receiver_mass.node(node) += receives(i) ? mass[i] : 0.;
    receiver_mass.sum_over_ranks();
    std::string failure;
    // The share of the content of a donor for each of its nodes.
    std::vector<double> share(mass.size(), 0.);
    for (std::size_t i = 0; i < mass.size(); ++i)
    {
      if (!is_uncovered[i])
        continue;
      double n_nodes = 0;
      for (const unsigned int node : nodes(i))
        n_nodes += *receiver_mass.node(node) > 0. ? 1. : 0.;
      if (n_nodes > 0.)
        share[i] = 1. / n_nodes;
      else if (failure.empty())
      {
        failure = as_text("A refill finds no cell to put the mass of the cell around (",
                          SubCells<dim>::centre(cells[i / n_sub_cells].before), ") into.");
      }
    }
    throw_on_all_ranks<RunError>(failure, communicator);

    // The first one is the mass itself.
    std::vector<double> received_content(mass.size() * (1 + n_components), 0.);
    for (unsigned int f = 0; f <= n_components; ++f)
    {
      const auto content = [&](const std::size_t i)
      { return mass[i] * (f == 0 ? 1. : values[i * n_components + f - 1]); };
      donor_content.reinit(partition, Quantity::scalar);
      for (std::size_t i = 0; i < mass.size(); ++i)
        if (is_uncovered[i])
          for (const unsigned int node : nodes(i))
            if (*receiver_mass.node(node) > 0.)
              *donor_content.node(node) += share[i] * content(i);
      donor_content.sum_over_ranks();
      for (std::size_t i = 0; i < mass.size(); ++i)
        if (receives(i))
          for (const unsigned int node : nodes(i))
            received_content[i * (1 + n_components) + f] +=
                mass[i] / *receiver_mass.node(node) * *donor_content.node(node);
    }
    for (std::size_t i = 0; i < mass.size(); ++i)
    {
      const double *const added = received_content.data() + i * (1 + n_components);
      if (is_uncovered[i])
        mass[i] = 0.;
      else if (added[0] > 0.)
      {
        for (unsigned int f = 0; f < n_components; ++f)
        {
          double &value = values[i * n_components + f];
          value = (mass[i] * value + added[1 + f]) / (mass[i] + added[0]);
        }
        mass[i] += added[0];
      }
    }
  }

  template <int dim>
  std::vector<double> CellOverlap<dim>::forward(const std::vector<double> &cell_values,
                                                const unsigned int n) const
  {
    std::map<unsigned int, std::vector<double>> messages;
    for (const auto &[rank, rank_cells] : sent)
    {
      std::vector<double> &data = messages[rank];
      data.reserve(rank_cells.size() * n);
      for (const unsigned int cell : rank_cells)
        data.insert(data.end(), cell_values.begin() + std::ptrdiff_t(cell) * n,
                    cell_values.begin() + std::ptrdiff_t(cell + 1) * n);
    }
    std::vector<double> result;
    for (auto &[rank, data] : exchange_by_rank(std::move(messages), communicator))
      if (result.empty())
        result = std::move(data);
      else
        result.insert(result.end(), data.begin(), data.end());
    return result;
  }

  template class CellOverlap<2>;
  template class CellOverlap<3>;
} // namespace tombolo
