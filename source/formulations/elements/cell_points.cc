// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/cell_points.h>

#include <algorithm>

namespace tombolo
{
  void interpolate_at_points(const unsigned int *const nodes,
                             const std::vector<std::vector<double>> &shape_values,
                             const NodalVector &vector, double *const at_points)
  {
    std::fill_n(at_points, shape_values.size() * n_lanes, 0.);
    for (std::size_t k = 0; k < shape_values.front().size(); ++k)
    {
      const Lanes value([&](const auto lane) { return *vector.node(nodes[k * n_lanes + lane]); });
      for (std::size_t q = 0; q < shape_values.size(); ++q)
        store_lanes(load_lanes(at_points + q * n_lanes) + shape_values[q][k] * value,
                    at_points + q * n_lanes);
    }
  }

  template <int dim>
  void PointsInCells<dim>::take_cells(const PartSetup<dim> &setup, const unsigned int degree,
                                      const MassLumping lumping, const bool can_change,
                                      const unsigned int most_groups)
  {
    batches.reinit(setup, degree, lumping, can_change, most_groups);
    initial_points.clear();
    shape_values.clear();
  }

  template <int dim>
  void PointsInCells<dim>::create_points(const std::vector<std::vector<double>> &values,
                                         const unsigned int n_batches)
  {
    shape_values = values;
    const unsigned int n_points = n_points_per_cell(), per_batch = n_points * n_lanes;
    initial_points.assign(std::size_t(n_batches) * per_batch, Point<dim>());
    for (unsigned int place = 0; place < batches.n_batches() * n_lanes; ++place)
    {
      const double *const x = batches.initial_positions(place / n_lanes) + place % n_lanes;
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int k = 0; k < shape_values[q].size(); ++k)
          for (unsigned int d = 0; d < dim; ++d)
            initial_points[point_of_place(place, q)][d] +=
                shape_values[q][k] * x[(k * dim + d) * n_lanes];
    }
    for (std::size_t i = std::size_t(batches.n_batches()) * per_batch;
         i < initial_points.size() && batches.n_batches() > 0; ++i)
      initial_points[i] = initial_points[i - per_batch]; // as unused lanes
  }

  template <int dim>
  void PointsInCells<dim>::remove(const std::vector<bool> &is_removed, MaterialPoints &points)
  {
    rearrange(points, [&] { batches.remove(is_removed); });
  }

  template <int dim>
  void PointsInCells<dim>::group(const std::vector<unsigned int> &group_of_cells,
                                 MaterialPoints &points)
  {
    rearrange(points, [&] { batches.group(group_of_cells); });
  }

  template <int dim>
  template <typename Change>
  void PointsInCells<dim>::rearrange(MaterialPoints &points, const Change &change)
  {
    const unsigned int n_points = n_points_per_cell();
    const unsigned int n_places = batches.n_batches_of_places() * n_lanes;
    std::vector<unsigned int> from(n_places, 0), old_place(batches.n_cells());
    for (unsigned int cell = 0; cell < batches.n_cells(); ++cell)
      old_place[cell] = batches.place(cell);
    change();
    for (unsigned int cell = 0; cell < batches.n_cells(); ++cell)
      from[batches.place(cell)] = old_place[cell];
    std::vector<bool> is_cell(n_places, false);
    for (unsigned int batch = 0; batch < batches.n_batches(); ++batch)
      for (unsigned int lane = 0, last = 0; lane < n_lanes; ++lane)
      {
        const unsigned int place = batch * n_lanes + lane;
        is_cell[place] = lane < batches.n_valid(batch);
        if (is_cell[place])
          last = place;
        else
          from[place] = from[last];
      }

    const auto move = [&](auto *const values, const auto &old)
    {
      for (unsigned int place = 0; place < n_places; ++place)
        for (unsigned int q = 0; q < n_points; ++q)
          values[point_of_place(place, q)] = old[point_of_place(from[place], q)];
    };
    move(initial_points.data(), std::vector<Point<dim>>(initial_points));
    if (points.size() == 0) // they are not made yet
      return;
    for (unsigned int f = 0; f < points.fields().size(); ++f)
      for (unsigned int c = 0; c < points.fields()[f].n_components; ++c)
      {
        double *const values = points.component(f, c);
        move(values, std::vector<double>(values, values + points.size()));
      }
    for (unsigned int place = 0; place < n_places; ++place)
      for (unsigned int q = 0; q < n_points && !is_cell[place]; ++q)
      {
        points.component(MaterialPoints::volume, 0)[point_of_place(place, q)] = 0.;
        points.component(MaterialPoints::volume_ratio, 0)[point_of_place(place, q)] = 1.;
      }
  }

  template <int dim>
  void PointsInCells<dim>::fill_unused_lanes(MaterialPoints &points, const unsigned int field) const
  {
    for (unsigned int batch = 0; batch < batches.n_batches(); ++batch)
      for (unsigned int q = 0; q < n_points_per_cell(); ++q)
        for (unsigned int c = 0; c < points.fields()[field].n_components; ++c)
        {
          double *const lanes = points.component(field, c) + point_of_place(batch * n_lanes, q);
          const unsigned int n = batches.n_valid(batch);
          std::fill(lanes + n, lanes + n_lanes, lanes[n - 1]);
        }
  }

  template <int dim>
  void PointsInCells<dim>::find_positions(const NodalVector &position,
                                          std::vector<Point<dim>> &positions) const
  {
    positions.assign(initial_points.size(), Point<dim>());
    for (unsigned int place = 0; place < batches.n_batches() * n_lanes; ++place)
      for (unsigned int k = 0; k < batches.n_nodes_per_cell(); ++k)
      {
        const double *const node =
            position.node(batches.nodes(place / n_lanes)[k * n_lanes + place % n_lanes]);
        for (unsigned int q = 0; q < n_points_per_cell(); ++q)
          for (unsigned int d = 0; d < dim; ++d)
            positions[point_of_place(place, q)][d] += shape_values[q][k] * node[d];
      }
  }

  template <int dim>
  void PointsInCells<dim>::add_plastic_heat(PartPoints &points, NodalVector &heat,
                                            std::vector<double> *const of_cells) const
  {
    if (of_cells != nullptr)
      of_cells->assign(batches.n_cells(), 0.);
    if (!points.heating().has_plastic_heat())
      return;
    for (unsigned int batch = 0; batch < batches.n_batches(); ++batch)
      for (unsigned int q = 0; q < n_points_per_cell(); ++q)
        for (unsigned int lane = 0; lane < batches.n_valid(batch); ++lane)
        {
          const unsigned int place = batch * n_lanes + lane;
          const double given = points.heating().give(points.points(), point_of_place(place, q));
          if (of_cells != nullptr)
            (*of_cells)[batches.cell_at(place)] += given;
          for (unsigned int k = 0; k < shape_values[q].size(); ++k)
            *heat.node(batches.nodes(batch)[k * n_lanes + lane]) += shape_values[q][k] * given;
        }
  }

  template class PointsInCells<2>;
  template class PointsInCells<3>;
} // namespace tombolo
