// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "mesh_testing.h"
#include "plugin_interpolated_remap/interpolated_remap.h"

#include <tombolo/base/ordered_sum.h>
#include <tombolo/formulations/smoothed/sub_cells.h>
#include <tombolo/remesh/nodal_projection.h>
#include <tombolo/remesh/point_remap.h>

#include <cmath>
#include <functional>
#include <numeric>

namespace tombolo
{
  namespace testing
  {
    using namespace dealii;

    /** Cells of a box with spacing @p h whose nodes are moved about, with a nodal field and points
     * of eight components: a stress, and two numbers. */
    template <int dim>
    class RemapBody
    {
    public:
      static constexpr unsigned int n_corners = SubCells<dim>::n_corners;
      static constexpr unsigned int n_sub_cells = SubCells<dim>::n_sub_cells;
      using Motion = std::function<Point<dim>(const Point<dim> &)>;

      explicit RemapBody(const std::vector<unsigned int> &n) : n(n)
      {
        std::string corner, cells;
        for (unsigned int d = 0; d < dim; ++d)
        {
          corner += (d > 0 ? ", " : "") + std::to_string(n[d]);
          cells += (d > 0 ? ", " : "") + std::to_string(n[d]);
        }
        scene = std::make_unique<MeshScene<dim>>("box", "set Upper corner = " + corner +
                                                            "\nset Cells = " + cells);
        mesh = scene->create_mesh();
        nodes = std::make_unique<Nodes<dim>>(*mesh, 1);
        partition =
            std::make_shared<NodePartition>(nodes->owned(), nodes->relevant(), MPI_COMM_WORLD);
        for (NodalVector *const vector : {&lattice, &position})
          vector->reinit(partition);
        field.reinit(partition, Quantity::scalars);
        std::vector<types::global_dof_index> numbers;
        std::vector<Point<dim>> corner_positions;
        for (const auto &cell : nodes->dof_handler().active_cell_iterators())
        {
          if (!cell->is_locally_owned())
            continue;
          nodes->cell_nodes(cell, numbers);
          nodes->cell_points(cell, corner_positions);
          for (unsigned int k = 0; k < n_corners; ++k)
            for (unsigned int d = 0; d < dim; ++d)
              lattice.node(partition->local_index(numbers[k]))[d] = corner_positions[k][d];
          cell_nodes.emplace_back();
          for (unsigned int k = 0; k < n_corners; ++k)
            cell_nodes.back()[k] = partition->local_index(numbers[k]);
        }
        lattice.update_ghosts();
      }

      /** Moves nodes by @p motion and makes the state there, of density @p density of the cell's
       * centre; masses are the integrals. */
      void start(const Motion &motion, const std::function<double(const Point<dim> &)> &density)
      {
        put(motion, position);
        points.n_components = 8;
        points.stress = 0;
        points.mass.clear();
        const std::vector<RemapCell<dim>> all = cells(position, position);
        for (const RemapCell<dim> &cell : all)
          for (const double volume : CellSimplices<dim>::volumes(cell.before))
          {
            Point<dim> centre;
            for (const Point<dim> &corner : cell.before)
              centre += corner / static_cast<double>(n_corners);
            points.mass.push_back(volume * density(centre));
          }
        points.values.assign(points.mass.size() * points.n_components, 0.);
        corner_mass.assign(all.size() * n_corners, 0.);
        for (std::size_t c = 0; c < all.size(); ++c)
          for (const auto &simplex : CellSimplices<dim>::all())
          {
            const double volume =
                CellSimplices<dim>::volume(CellSimplices<dim>::vertices(simplex, all[c].before));
            const double simplex_mass =
                points.mass[c * n_sub_cells + simplex.sub_cell] * volume /
                CellSimplices<dim>::volumes(all[c].before)[simplex.sub_cell];
            for (unsigned int v = 0; v <= dim; ++v)
              for (unsigned int k = 0; k < n_corners; ++k)
                corner_mass[c * n_corners + k] += simplex_mass / (dim + 1) * simplex.vertices[v][k];
          }
      }

      void set_field(const std::function<double(const Point<dim> &, unsigned int)> &value)
      {
        for (unsigned int i = 0; i < partition->n_owned(); ++i)
          for (unsigned int slot = 0; slot < node_stride; ++slot)
            field.node(i)[slot] = value(position_of(i), slot);
        field.update_ghosts();
      }

      void set_points(const std::function<double(const Point<dim> &, unsigned int)> &value)
      {
        const auto centres = point_centres();
        for (std::size_t i = 0; i < centres.size(); ++i)
          for (unsigned int f = 0; f < points.n_components; ++f)
            points.values[i * points.n_components + f] = value(centres[i], f);
      }

      /** The remap of points, masses and the field between these cells, which must stay. */
      CellOverlap<dim> remap(const std::vector<RemapCell<dim>> &moved)
      {
        CellOverlap<dim> overlap(moved, {&field}, MPI_COMM_WORLD);
        const NodalVector before = nodal_mass();
        remap_points(overlap, partition, points);
        for (std::size_t c = 0; c < moved.size(); ++c)
        {
          double *const cell_corner_mass = corner_mass.data() + c * n_corners;
          if (moved[c].is_void_after)
            std::fill_n(cell_corner_mass, n_corners, 0.);
          else if (moved[c].has_moved())
            std::copy_n(overlap.integrals[c].mass.begin(), n_corners, cell_corner_mass);
        }
        project_nodal_field(overlap, 0, before, nodal_mass(), field);
        return overlap;
      }

      void move(const Motion &motion)
      {
        NodalVector next(partition);
        put(motion, next);
        const std::vector<RemapCell<dim>> moved = cells(position, next);
        remap(moved);
        position.copy_from(next);
      }

      /** One value a cell instead of one a sub-cell, at these centres. */
      void set_cells(const std::function<double(const Point<dim> &, unsigned int)> &value,
                     const std::vector<Point<dim>> &centres)
      {
        points.mass.resize(cell_nodes.size());
        points.values.resize(cell_nodes.size() * points.n_components);
        std::size_t c = 0;
        for (const RemapCell<dim> &cell : cells(position, position))
        {
          const auto volumes = CellSimplices<dim>::volumes(cell.before);
          points.mass[c] = std::accumulate(volumes.begin(), volumes.end(), 0.);
          for (unsigned int f = 0; f < points.n_components; ++f)
            points.values[c * points.n_components + f] = value(centres[c], f);
          ++c;
        }
      }

      /** The conservative remap of one value a cell, without nodal fields. */
      void move_cells(const Motion &motion)
      {
        NodalVector next(partition);
        put(motion, next);
        std::vector<RemapCell<dim>> moved = cells(position, next);
        for (std::size_t c = 0; c < moved.size(); ++c)
        {
          const auto volumes = CellSimplices<dim>::volumes(moved[c].before);
          const double total = std::accumulate(volumes.begin(), volumes.end(), 0.);
          for (unsigned int q = 0; q < n_sub_cells; ++q)
            moved[c].mass[q] = points.mass[c] * volumes[q] / total;
        }
        const CellOverlap<dim> overlap(moved, {&field}, MPI_COMM_WORLD);
        PointValues sub_cell_values = values_of_sub_cells(moved, partition, points);
        remap_points(overlap, partition, sub_cell_values);
        set_means_of_cells(moved, sub_cell_values, points);
        position.copy_from(next);
      }

      /** The middles of the corners of all cells. */
      std::vector<Point<dim>> middles() const
      {
        std::vector<Point<dim>> result;
        for (const RemapCell<dim> &cell : cells(position, position))
        {
          result.emplace_back();
          for (const Point<dim> &corner : cell.before)
            result.back() += corner / static_cast<double>(n_corners);
        }
        return result;
      }

      /** The centres of mass of all cells, which are uniform. */
      std::vector<Point<dim>> centres_of_mass() const
      {
        const std::vector<Point<dim>> sub_cell_centres = point_centres();
        std::vector<Point<dim>> result;
        for (const RemapCell<dim> &cell : cells(position, position))
        {
          const auto volumes = CellSimplices<dim>::volumes(cell.before);
          const double total = std::accumulate(volumes.begin(), volumes.end(), 0.);
          Point<dim> centre;
          for (unsigned int q = 0; q < n_sub_cells; ++q)
            centre += volumes[q] / total * sub_cell_centres[result.size() * n_sub_cells + q];
          result.push_back(centre);
        }
        return result;
      }

      /** The remap by interpolation. Masses stay. */
      void interpolate(const Motion &motion,
                       const SmoothedIntegrationRule rule = SmoothedIntegrationRule::smoothed)
      {
        NodalVector next(partition);
        put(motion, next);
        const std::vector<RemapCell<dim>> moved = cells(position, next);
        interpolate_nodal_fields<dim>(moved, position, next, {&field});
        interpolate_points<dim>(moved, partition, corner_shares_of_points<dim>(rule), points);
        position.copy_from(next);
      }

      /** The same where boundary nodes may leave the surface. */
      void move_surface(const Motion &motion)
      {
        NodalVector next(partition);
        put(motion, next);
        std::vector<RemapCell<dim>> moved = cells(position, next);
        for (RemapCell<dim> &cell : moved)
          for (unsigned int k = 0; k < n_corners; ++k)
            for (unsigned int d = 0; d < dim; ++d)
            {
              const double x = lattice.node(cell.nodes[k])[d];
              if ((x < 0.5 || x > n[d] - 0.5) && cell.before[k] != cell.after[k])
                cell.is_cut = true;
            }
        remap(moved);
        position.copy_from(next);
      }

      using IsVoid = std::function<bool(const Point<dim> &)>;

      /** Empties the cells whose middle in the lattice is void. */
      void empty(const IsVoid &is_void)
      {
        const auto middle = middles_of_lattice();
        for (std::size_t c = 0; c < middle.size(); ++c)
          if (is_void(middle[c]))
          {
            std::fill_n(points.mass.begin() + std::ptrdiff_t(c * n_sub_cells), n_sub_cells, 0.);
            std::fill_n(corner_mass.begin() + std::ptrdiff_t(c * n_corners), n_corners, 0.);
          }
      }

      /** The remap where cells are filled and emptied. */
      void fill(const Motion &motion, const IsVoid &was_void, const IsVoid &is_void)
      {
        NodalVector next(partition);
        put(motion, next);
        std::vector<RemapCell<dim>> moved = cells(position, next);
        const auto middle = middles_of_lattice();
        for (std::size_t c = 0; c < moved.size(); ++c)
        {
          moved[c].is_cut = true;
          moved[c].is_void_before = was_void(middle[c]);
          moved[c].is_void_after = is_void(middle[c]);
        }
        remap(moved);
        position.copy_from(next);
      }

      std::vector<Point<dim>> middles_of_lattice() const
      {
        std::vector<Point<dim>> result;
        for (const auto &corners : lattice_corners())
        {
          result.emplace_back();
          for (const Point<dim> &corner : corners)
            result.back() += corner / static_cast<double>(n_corners);
        }
        return result;
      }

      /** The remap of the field within its former bounds. */
      void move_within_bounds(const Motion &motion)
      {
        NodalVector next(partition), before(partition);
        put(motion, next);
        before.copy_from(field);
        before.update_ghosts();
        const std::vector<RemapCell<dim>> moved = cells(position, next);
        const CellOverlap<dim> overlap = remap(moved);
        limit_nodal_field(overlap, before, nodal_mass(), field);
        position.copy_from(next);
      }

      /** The smallest volume of a simplex. */
      double smallest_volume() const
      {
        double result = 1e300;
        for (const RemapCell<dim> &cell : cells(position, position))
          for (const auto &simplex : CellSimplices<dim>::all())
            result = std::min(result, CellSimplices<dim>::volume(
                                          CellSimplices<dim>::vertices(simplex, cell.before)));
        return Utilities::MPI::min(result, MPI_COMM_WORLD);
      }

      /** Inner nodes, scalar. */
      NodalVector inner_nodes() const
      {
        NodalVector result(partition, Quantity::scalar);
        for (unsigned int i = 0; i < partition->n_owned(); ++i)
        {
          bool is_inside = true;
          for (unsigned int d = 0; d < dim; ++d)
            is_inside = is_inside && lattice.node(i)[d] > 0.5 && lattice.node(i)[d] < n[d] - 0.5;
          *result.node(i) = is_inside ? 1. : 0.;
        }
        return result;
      }

      std::vector<typename SubCells<dim>::Corners> lattice_corners() const
      {
        std::vector<typename SubCells<dim>::Corners> result;
        for (const RemapCell<dim> &cell : cells(lattice, lattice))
          result.push_back(cell.before);
        return result;
      }

      const std::vector<std::array<unsigned int, n_corners>> &nodes_of_cells() const
      {
        return cell_nodes;
      }

      NodalVector nodal_mass() const
      {
        NodalVector mass(partition, Quantity::scalar);
        for (std::size_t c = 0; c < cell_nodes.size(); ++c)
          for (unsigned int k = 0; k < n_corners; ++k)
            *mass.node(cell_nodes[c][k]) += corner_mass[c * n_corners + k];
        mass.add_to_owners();
        return mass;
      }

      /** Σ m, Σ m z of four slots, Σ m s of eight components and Σ m of the points. */
      std::vector<double> sums() const
      {
        std::vector<double> result(14, 0.);
        const NodalVector mass = nodal_mass();
        for (unsigned int i = 0; i < partition->n_owned(); ++i)
        {
          result[0] += *mass.node(i);
          for (unsigned int slot = 0; slot < node_stride; ++slot)
            result[1 + slot] += *mass.node(i) * field.node(i)[slot];
        }
        for (std::size_t i = 0; i < points.mass.size(); ++i)
        {
          result[13] += points.mass[i];
          for (unsigned int f = 0; f < 8; ++f)
            result[5 + f] += points.mass[i] * points.values[i * 8 + f];
        }
        return ordered_sum(result, MPI_COMM_WORLD);
      }

      Point<dim> position_of(const unsigned int node) const
      {
        Point<dim> result;
        for (unsigned int d = 0; d < dim; ++d)
          result[d] = position.node(node)[d];
        return result;
      }

      /** The centres of the sub-cells. */
      std::vector<Point<dim>> point_centres() const
      {
        std::vector<Point<dim>> result;
        for (const RemapCell<dim> &cell : cells(position, position))
        {
          std::array<Point<dim>, n_sub_cells> centre;
          const auto volumes = CellSimplices<dim>::volumes(cell.before);
          for (const auto &simplex : CellSimplices<dim>::all())
          {
            const auto vertices = CellSimplices<dim>::vertices(simplex, cell.before);
            for (const Point<dim> &vertex : vertices)
              centre[simplex.sub_cell] += CellSimplices<dim>::volume(vertices) / (dim + 1) /
                                          volumes[simplex.sub_cell] * vertex;
          }
          result.insert(result.end(), centre.begin(), centre.end());
        }
        return result;
      }

      double largest(const std::function<double()> &rank_value) const
      {
        return Utilities::MPI::max(rank_value(), MPI_COMM_WORLD);
      }

      double largest_of_field() const
      {
        double result = -1e300;
        for (unsigned int i = 0; i < partition->n_owned(); ++i)
          result = std::max(result, field.node(i)[0]);
        return Utilities::MPI::max(result, MPI_COMM_WORLD);
      }

      double largest_of_points(const unsigned int component, const double sign = 1.) const
      {
        double result = -1e300;
        for (std::size_t i = 0; i < points.mass.size(); ++i)
          result = std::max(result, sign * points.values[i * 8 + component]);
        return Utilities::MPI::max(result, MPI_COMM_WORLD);
      }

      /** Random positions, others in each @p round: inner nodes are moved by up to @p amount of the
       * spacing, nodes of faces along these; all at the same x alike with @p is_strip. */
      Motion disorder(const double amount, const unsigned int round,
                      const bool is_strip = false) const
      {
        return [=](const Point<dim> &x)
        {
          Point<dim> result = x;
          for (unsigned int d = 0; d < (is_strip ? 1 : dim); ++d)
          {
            if (x[d] < 0.5 || x[d] > n[d] - 0.5)
              continue;
            std::uint64_t number = round * 3 + d + 1;
            for (unsigned int a = 0; a < (is_strip ? 1 : dim); ++a)
              number = number * 6364136223846793005ull + 1442695040888963407ull +
                       static_cast<std::uint64_t>(std::lround(x[a]));
            for (unsigned int k = 0; k < 3; ++k)
            {
              number ^= number >> 33;
              number *= 0xff51afd7ed558ccdull;
            }
            result[d] += amount * (2. * static_cast<double>(number >> 11) / 9007199254740992. - 1.);
          }
          return result;
        };
      }

      NodalVector lattice, position, field;
      PointValues points;
      std::shared_ptr<NodePartition> partition;

    private:
      void put(const Motion &motion, NodalVector &result) const
      {
        for (unsigned int i = 0; i < partition->n_owned(); ++i)
        {
          Point<dim> x;
          for (unsigned int d = 0; d < dim; ++d)
            x[d] = lattice.node(i)[d];
          const Point<dim> to = motion(x);
          for (unsigned int d = 0; d < dim; ++d)
            result.node(i)[d] = to[d];
        }
        result.update_ghosts();
      }

      std::vector<RemapCell<dim>> cells(const NodalVector &before, const NodalVector &after) const
      {
        std::vector<RemapCell<dim>> result(cell_nodes.size());
        for (std::size_t c = 0; c < cell_nodes.size(); ++c)
        {
          result[c].nodes = cell_nodes[c];
          for (unsigned int k = 0; k < n_corners; ++k)
            for (unsigned int d = 0; d < dim; ++d)
            {
              result[c].before[k][d] = before.node(cell_nodes[c][k])[d];
              result[c].after[k][d] = after.node(cell_nodes[c][k])[d];
            }
          const bool has_sub_cells = points.mass.size() == cell_nodes.size() * n_sub_cells;
          for (unsigned int q = 0; q < n_sub_cells && has_sub_cells; ++q)
            result[c].mass[q] = points.mass[c * n_sub_cells + q];
        }
        return result;
      }

      std::vector<unsigned int> n;
      std::unique_ptr<MeshScene<dim>> scene;
      std::unique_ptr<Mesh<dim>> mesh;
      std::unique_ptr<Nodes<dim>> nodes;
      std::vector<std::array<unsigned int, n_corners>> cell_nodes;
      std::vector<double> corner_mass;
    };

    template <int dim>
    std::vector<unsigned int> block()
    {
      return std::vector<unsigned int>(dim, dim == 3 ? 5 : 9);
    }

    template <int dim>
    double uniform(const Point<dim> &)
    {
      return 2.;
    }

    /** Different in each slot. */
    template <int dim>
    double linear(const Point<dim> &x, const unsigned int slot)
    {
      double result = 1. + slot;
      for (unsigned int d = 0; d < dim; ++d)
        result += (0.3 + 0.2 * d - 0.1 * slot) * x[d];
      return result;
    }

    template <int dim>
    double rough(const Point<dim> &x, const unsigned int slot)
    {
      double result = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        result *= std::sin((1.3 + 0.4 * d) * x[d] + slot);
      return slot == 6 ? std::abs(result) : result;
    }
  } // namespace testing
} // namespace tombolo
