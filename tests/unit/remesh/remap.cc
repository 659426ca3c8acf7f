// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/base/ordered_sum.h>
#include <tombolo/formulations/smoothed/integration_rule.h>
#include <tombolo/remesh/cloud_functions.h>
#include <tombolo/remesh/cloud_interpolation.h>
#include <tombolo/remesh/inner_places.h>
#include <tombolo/remesh/interpolated_remap.h>
#include <tombolo/remesh/nodal_projection.h>
#include <tombolo/remesh/point_remap.h>

#include "mesh_testing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

namespace
{
  using namespace tombolo;
  using namespace tombolo::testing;
  using namespace dealii;

  /** Cells of a box with spacing @p h whose nodes are moved about, with a nodal field and points of
   * eight components: a stress, and two numbers. */
  template <int dim>
  class RemapBody
  {
  public:
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;
    static constexpr unsigned int n_sub_cells = SubCells<dim>::n_sub_cells;
    using Place = std::function<Point<dim>(const Point<dim> &)>;

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
      field.reinit(partition, node_stride, ReflectionParity::even);
      std::vector<types::global_dof_index> numbers;
      std::vector<Point<dim>> places;
      for (const auto &cell : nodes->dof_handler().active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        nodes->cell_nodes(cell, numbers);
        nodes->cell_points(cell, places);
        for (unsigned int k = 0; k < n_corners; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            lattice.node(partition->local_index(numbers[k]))[d] = places[k][d];
        cell_nodes.emplace_back();
        for (unsigned int k = 0; k < n_corners; ++k)
          cell_nodes.back()[k] = partition->local_index(numbers[k]);
      }
      lattice.update_ghosts();
    }

    /** Puts nodes to places and makes the state there, of density @p density of the cell's centre;
     * masses are the integrals. */
    void start(const Place &place, const std::function<double(const Point<dim> &)> &density)
    {
      put(place, position);
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
          const double of_simplex = points.mass[c * n_sub_cells + simplex.sub_cell] * volume /
                                    CellSimplices<dim>::volumes(all[c].before)[simplex.sub_cell];
          for (unsigned int v = 0; v <= dim; ++v)
            for (unsigned int k = 0; k < n_corners; ++k)
              corner_mass[c * n_corners + k] += of_simplex / (dim + 1) * simplex.vertices[v][k];
        }
    }

    void set_field(const std::function<double(const Point<dim> &, unsigned int)> &value)
    {
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        for (unsigned int slot = 0; slot < node_stride; ++slot)
          field.node(i)[slot] = value(place_of(i), slot);
      field.update_ghosts();
    }

    void set_points(const std::function<double(const Point<dim> &, unsigned int)> &value)
    {
      const auto centres = point_places();
      for (std::size_t i = 0; i < centres.size(); ++i)
        for (unsigned int f = 0; f < points.n_components; ++f)
          points.values[i * points.n_components + f] = value(centres[i], f);
    }

    void move(const Place &place)
    {
      NodalVector next;
      next.reinit(partition);
      put(place, next);
      const std::vector<RemapCell<dim>> moved = cells(position, next);
      const CellOverlap<dim> overlap(moved, {&field}, MPI_COMM_WORLD);
      project_nodal_field(overlap, 0, nodal_mass(), field);
      remap_points(overlap, partition, points);
      if (overlap.has_motion)
      {
        const std::vector<double> gained = gained_masses(overlap);
        for (std::size_t i = 0; i < gained.size(); ++i)
          corner_mass[i] += gained[i];
      }
      position.copy_from(next);
    }

    /** One value a cell in place of one a sub-cell, at these places. */
    void set_cells(const std::function<double(const Point<dim> &, unsigned int)> &value,
                   const std::vector<Point<dim>> &places)
    {
      points.mass.resize(cell_nodes.size());
      points.values.resize(cell_nodes.size() * points.n_components);
      std::size_t c = 0;
      for (const RemapCell<dim> &cell : cells(position, position))
      {
        const auto volumes = CellSimplices<dim>::volumes(cell.before);
        points.mass[c] = std::accumulate(volumes.begin(), volumes.end(), 0.);
        for (unsigned int f = 0; f < points.n_components; ++f)
          points.values[c * points.n_components + f] = value(places[c], f);
        ++c;
      }
    }

    /** The conservative remap of one value a cell, without nodal fields. */
    void move_cells(const Place &place)
    {
      NodalVector next;
      next.reinit(partition);
      put(place, next);
      std::vector<RemapCell<dim>> moved = cells(position, next);
      for (std::size_t c = 0; c < moved.size(); ++c)
      {
        const auto volumes = CellSimplices<dim>::volumes(moved[c].before);
        const double total = std::accumulate(volumes.begin(), volumes.end(), 0.);
        for (unsigned int q = 0; q < n_sub_cells; ++q)
          moved[c].mass[q] = points.mass[c] * volumes[q] / total;
      }
      const CellOverlap<dim> overlap(moved, {&field}, MPI_COMM_WORLD);
      PointValues of_sub_cells = values_of_sub_cells(moved, partition, points);
      remap_points(overlap, partition, of_sub_cells);
      set_means_of_cells(moved, of_sub_cells, points);
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
      const std::vector<Point<dim>> of_sub_cells = point_places();
      std::vector<Point<dim>> result;
      for (const RemapCell<dim> &cell : cells(position, position))
      {
        const auto volumes = CellSimplices<dim>::volumes(cell.before);
        const double total = std::accumulate(volumes.begin(), volumes.end(), 0.);
        Point<dim> centre;
        for (unsigned int q = 0; q < n_sub_cells; ++q)
          centre += volumes[q] / total * of_sub_cells[result.size() * n_sub_cells + q];
        result.push_back(centre);
      }
      return result;
    }

    /** The remap by interpolation. Masses stay. */
    void interpolate(const Place &place,
                     const SmoothedIntegrationRule rule = SmoothedIntegrationRule::smoothed)
    {
      NodalVector next;
      next.reinit(partition);
      put(place, next);
      const std::vector<RemapCell<dim>> moved = cells(position, next);
      interpolate_nodal_fields<dim>(moved, position, next, {&field});
      interpolate_points<dim>(moved, partition, corner_shares_of_points<dim>(rule), points);
      position.copy_from(next);
    }

    /** The same where boundary nodes may leave the surface. */
    void move_surface(const Place &place)
    {
      NodalVector next;
      next.reinit(partition);
      put(place, next);
      std::vector<RemapCell<dim>> moved = cells(position, next);
      for (RemapCell<dim> &cell : moved)
        for (unsigned int k = 0; k < n_corners; ++k)
          for (unsigned int d = 0; d < dim; ++d)
          {
            const double x = lattice.node(cell.nodes[k])[d];
            if ((x < 0.5 || x > n[d] - 0.5) && cell.before[k] != cell.after[k])
              cell.is_cut = true;
          }
      const CellOverlap<dim> overlap(moved, {&field}, MPI_COMM_WORLD);
      const NodalVector before = nodal_mass();
      remap_points(overlap, partition, points);
      for (std::size_t c = 0; c < moved.size(); ++c)
        if (moved[c].has_moved())
        {
          const auto masses =
              masses_of_corners<dim>(moved[c].after, points.mass.data() + c * n_sub_cells);
          std::copy(masses.begin(), masses.end(),
                    corner_mass.begin() + std::ptrdiff_t(c * n_corners));
        }
      const NodalVector after = nodal_mass();
      project_nodal_field(overlap, 0, before, field, &after);
      position.copy_from(next);
    }

    using IsVoid = std::function<bool(const Point<dim> &)>;

    /** Takes what cells have whose middle in the lattice is void. */
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
    void fill(const Place &place, const IsVoid &was_void, const IsVoid &is_void)
    {
      NodalVector next;
      next.reinit(partition);
      put(place, next);
      std::vector<RemapCell<dim>> moved = cells(position, next);
      const auto middle = middles_of_lattice();
      for (std::size_t c = 0; c < moved.size(); ++c)
      {
        moved[c].is_cut = true;
        moved[c].is_void_before = was_void(middle[c]);
        moved[c].is_void_after = is_void(middle[c]);
      }
      const CellOverlap<dim> overlap(moved, {&field}, MPI_COMM_WORLD);
      const NodalVector before = nodal_mass();
      remap_points(overlap, partition, points);
      for (std::size_t c = 0; c < moved.size(); ++c)
      {
        std::array<double, n_corners> masses{};
        if (!moved[c].is_void_after)
          masses = masses_of_corners<dim>(moved[c].after, points.mass.data() + c * n_sub_cells);
        std::copy(masses.begin(), masses.end(),
                  corner_mass.begin() + std::ptrdiff_t(c * n_corners));
      }
      const NodalVector after = nodal_mass();
      project_nodal_field(overlap, 0, before, field, &after);
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
    void move_within_bounds(const Place &place)
    {
      NodalVector next, before;
      next.reinit(partition);
      before.reinit(partition);
      put(place, next);
      before.copy_from(field);
      before.update_ghosts();
      const std::vector<RemapCell<dim>> moved = cells(position, next);
      const CellOverlap<dim> overlap(moved, {&field}, MPI_COMM_WORLD);
      project_nodal_field(overlap, 0, nodal_mass(), field);
      remap_points(overlap, partition, points);
      const std::vector<double> gained = gained_masses(overlap);
      for (std::size_t i = 0; i < gained.size(); ++i)
        corner_mass[i] += gained[i];
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
      NodalVector result;
      result.reinit(partition, 1);
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
      NodalVector mass;
      mass.reinit(partition, 1);
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

    Point<dim> place_of(const unsigned int node) const
    {
      Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = position.node(node)[d];
      return result;
    }

    /** The centres of the sub-cells. */
    std::vector<Point<dim>> point_places() const
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

    double largest(const std::function<double()> &of_rank) const
    {
      return Utilities::MPI::max(of_rank(), MPI_COMM_WORLD);
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

    /** Random places, others in each @p round: inner nodes are moved by up to @p amount of the
     * spacing, nodes of faces along these; all at the same x alike with @p is_strip. */
    Place disorder(const double amount, const unsigned int round, const bool is_strip = false) const
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
    void put(const Place &place, NodalVector &result) const
    {
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
      {
        Point<dim> x;
        for (unsigned int d = 0; d < dim; ++d)
          x[d] = lattice.node(i)[d];
        const Point<dim> to = place(x);
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

  template <int dim>
  void expect_no_bit_of_an_identity(const bool by_interpolation)
  {
    RemapBody<dim> body(block<dim>());
    const auto place = body.disorder(0.25, 1);
    body.start(place, uniform<dim>);
    body.set_field(rough<dim>);
    body.set_points(rough<dim>);
    const PointValues before = body.points;
    NodalVector field;
    field.reinit(body.partition, node_stride, ReflectionParity::even);
    field.copy_from(body.field);
    if (by_interpolation)
      body.interpolate(place);
    else
      body.move(place);
    EXPECT_EQ(before.values, body.points.values);
    EXPECT_EQ(before.mass, body.points.mass);
    for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
      for (unsigned int slot = 0; slot < node_stride; ++slot)
        EXPECT_EQ(field.node(i)[slot], body.field.node(i)[slot]);
  }

  TEST(Remap, changes_no_bit_where_nothing_moves)
  {
    for (const bool by_interpolation : {false, true})
    {
      expect_no_bit_of_an_identity<2>(by_interpolation);
      expect_no_bit_of_an_identity<3>(by_interpolation);
    }
  }

  template <int dim>
  void expect_linear_nodal_fields(const bool by_interpolation)
  {
    RemapBody<dim> body(block<dim>());
    body.start(body.disorder(0.2, 1), uniform<dim>);
    body.set_field(linear<dim>);
    for (unsigned int round = 2; round < 5; ++round)
      if (by_interpolation)
        body.interpolate(body.disorder(0.2, round));
      else
        body.move(body.disorder(0.2, round));
    double error = 0;
    for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
      for (unsigned int slot = 0; slot < node_stride; ++slot)
        error =
            std::max(error, std::abs(body.field.node(i)[slot] - linear(body.place_of(i), slot)));
    EXPECT_LE(body.largest([&] { return error; }), 1e-12);
  }

  TEST(Remap, reproduces_linear_nodal_fields)
  {
    for (const bool by_interpolation : {false, true})
    {
      expect_linear_nodal_fields<2>(by_interpolation);
      expect_linear_nodal_fields<3>(by_interpolation);
    }
  }

  template <int dim>
  void expect_linear_points_by_interpolation()
  {
    RemapBody<dim> body(block<dim>());
    body.start(body.disorder(0.2, 1), uniform<dim>);
    const auto shares = corner_shares_of_points<dim>(SmoothedIntegrationRule::smoothed);
    const auto places = [&]()
    {
      std::vector<Point<dim>> result;
      for (const auto &nodes : body.nodes_of_cells())
        for (const auto &of_point : shares)
        {
          Point<dim> x;
          for (unsigned int k = 0; k < nodes.size(); ++k)
            x += of_point[k] * body.place_of(nodes[k]);
          result.push_back(x);
        }
      return result;
    };
    const auto before = places();
    for (std::size_t i = 0; i < before.size(); ++i)
      for (unsigned int f = 0; f < 8; ++f)
        body.points.values[i * 8 + f] = linear(before[i], f);
    body.points.stress.reset(); // its bound is not that of linear fields
    body.interpolate(body.disorder(0.2, 2));
    double error = 0;
    const auto after = places();
    const double top = block<dim>()[0];
    for (std::size_t i = 0; i < after.size(); ++i)
    {
      bool is_inside = true; // of the hull of the points
      for (unsigned int d = 0; d < dim; ++d)
        is_inside = is_inside && after[i][d] > 1. && after[i][d] < top - 1.;
      for (unsigned int f = 0; f < 8 && is_inside; ++f)
        error = std::max(error, std::abs(body.points.values[i * 8 + f] - linear(after[i], f)));
    }
    // What the bound of the multiplier costs at the outermost points decays inwards.
    EXPECT_LE(body.largest([&] { return error; }), 1e-5);
  }

  TEST(Remap, by_interpolation_reproduces_linear_fields_of_points)
  {
    expect_linear_points_by_interpolation<2>();
    expect_linear_points_by_interpolation<3>();
  }

  template <int dim>
  void expect_sums_and_bounds()
  {
    RemapBody<dim> body(block<dim>());
    body.start(body.disorder(0.25, 1), [](const Point<dim> &x) { return 1. + 0.3 * x[0]; });
    body.set_field(rough<dim>);
    body.set_points(rough<dim>);
    const std::vector<double> before = body.sums();
    std::vector<double> highest, lowest;
    for (unsigned int f = 0; f < 8; ++f)
    {
      highest.push_back(body.largest_of_points(f));
      lowest.push_back(body.largest_of_points(f, -1.));
    }
    for (unsigned int round = 2; round < 5; ++round)
      body.move(body.disorder(0.25, round));
    const std::vector<double> after = body.sums();
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_NEAR(before[k], after[k], 1e-13 * before[0]) << "sum " << k << " in " << dim;
    for (unsigned int f = 0; f < 8; ++f)
    {
      EXPECT_LE(body.largest_of_points(f), highest[f] + 1e-14);
      EXPECT_LE(body.largest_of_points(f, -1.), lowest[f] + 1e-14);
    }
    EXPECT_LE(body.largest_of_points(6, -1.), 0.); // not negative
  }

  TEST(Remap, keeps_mass_momentum_and_sums_of_points_and_all_bounds)
  {
    expect_sums_and_bounds<2>();
    expect_sums_and_bounds<3>();
  }

  template <int dim>
  void expect_bounds_of_a_step()
  {
    const double middle = 0.5 * block<dim>()[0];
    const auto step = [middle](const Point<dim> &x, const unsigned int slot)
    { return slot == 3 ? x[0] : (x[0] < middle ? 1. : 0.); };
    RemapBody<dim> limited(block<dim>()), plain(block<dim>());
    for (RemapBody<dim> *const body : {&limited, &plain})
    {
      body->start(body->disorder(0.2, 1), [](const Point<dim> &) { return 1.5; });
      body->set_field(step);
      body->set_points(rough<dim>);
    }
    const std::vector<double> before = limited.sums();
    for (unsigned int round = 2; round < 7; ++round)
    {
      limited.move_within_bounds(limited.disorder(0.2, round));
      plain.move(plain.disorder(0.2, round));
      EXPECT_LE(limited.largest_of_field(), 1. + 1e-12);
      EXPECT_GT(plain.largest_of_field(), 1.01);
    }
    const std::vector<double> after = limited.sums();
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_NEAR(before[k], after[k], 1e-13 * before[0]) << "sum " << k << " in " << dim;
    double error = 0, lowest = 0;
    for (unsigned int i = 0; i < limited.partition->n_owned(); ++i)
    {
      error = std::max(error, std::abs(limited.field.node(i)[3] - limited.place_of(i)[0]));
      lowest = std::min(lowest, limited.field.node(i)[0]);
    }
    EXPECT_LE(limited.largest([&] { return error; }), 1e-12);
    EXPECT_LE(limited.largest([&] { return -lowest; }), 1e-12);
  }

  TEST(Remap, keeps_nodal_fields_within_bounds_that_a_projection_leaves)
  {
    expect_bounds_of_a_step<2>();
    expect_bounds_of_a_step<3>();
  }

  /** The disorder, and a surface that is raised and lowered by up to a tenth of the spacing. */
  template <int dim>
  typename RemapBody<dim>::Place waves(const RemapBody<dim> &body, const unsigned int round)
  {
    const auto inside = body.disorder(0.2, round);
    const double top = block<dim>()[0];
    return [=](const Point<dim> &x)
    {
      Point<dim> result = inside(x);
      const double wave = 0.1 * std::sin(1.7 * x[0] + round) * std::cos(0.9 * x[dim - 1] + round);
      result[1] += x[1] > top - 0.5 ? wave : 0.;
      return result;
    };
  }

  template <int dim>
  void expect_sums_where_the_surface_moves()
  {
    RemapBody<dim> body(block<dim>());
    body.start(waves(body, 1), [](const Point<dim> &x) { return 1. + 0.3 * x[0]; });
    body.set_field([](const Point<dim> &x, const unsigned int slot)
                   { return slot == 3 ? 2.5 : rough(x, slot); });
    body.set_points(rough<dim>);
    const std::vector<double> before = body.sums();
    std::vector<double> highest;
    for (unsigned int f = 0; f < 8; ++f)
      highest.push_back(body.largest_of_points(f));
    for (unsigned int round = 2; round < 7; ++round)
      body.move_surface(waves(body, round));
    const std::vector<double> after = body.sums();
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_NEAR(before[k], after[k], 1e-13 * before[0]) << "sum " << k << " in " << dim;
    for (unsigned int f = 0; f < 8; ++f)
      EXPECT_LE(body.largest_of_points(f), highest[f] + 1e-14);
    double error = 0;
    for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
      error = std::max(error, std::abs(body.field.node(i)[3] - 2.5));
    EXPECT_LE(body.largest([&] { return error; }), 1e-12);
  }

  TEST(Remap, keeps_sums_constant_fields_and_bounds_where_the_surface_moves)
  {
    expect_sums_where_the_surface_moves<2>();
    expect_sums_where_the_surface_moves<3>();
  }

  /** A cavity in the top of a block, four fifths deep. */
  template <int dim>
  typename RemapBody<dim>::Place cavity()
  {
    const double top = block<dim>()[0];
    return [=](const Point<dim> &x)
    {
      double depth = 0.8;
      for (unsigned int d = 0; d < dim; ++d)
        if (d != 1)
          depth *= std::pow(std::sin(numbers::PI * x[d] / top), 4);
      Point<dim> result = x;
      result[1] *= 1. - depth;
      return result;
    };
  }

  template <int dim>
  void expect_cells_below_a_cavity()
  {
    RemapBody<dim> body(block<dim>());
    body.start(cavity<dim>(), uniform<dim>);
    const NodalVector inside = body.inner_nodes();
    const double at_start = body.smallest_volume();
    double first = 0, last = 0;
    for (unsigned int step = 0; step < 30; ++step)
    {
      const NodalVector way = winslow_step<dim>(body.nodes_of_cells(), body.lattice_corners(),
                                                inside, body.lattice, body.position);
      double largest = 0;
      for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
        {
          EXPECT_TRUE(*inside.node(i) > 0. || way.node(i)[d] == 0.);
          body.position.node(i)[d] += way.node(i)[d];
          largest = std::max(largest, std::abs(way.node(i)[d]));
        }
      body.position.update_ghosts();
      last = Utilities::MPI::max(largest, MPI_COMM_WORLD);
      first = step == 0 ? last : first;
      EXPECT_GT(body.smallest_volume(), 0.) << "step " << step << " in " << dim;
    }
    EXPECT_LE(last, 1e-3 * first);
    EXPECT_GT(at_start, 0.);
    // Displacements that are harmonic fold them.
    place_inner_nodes<dim>(body.nodes_of_cells(), body.lattice_corners(), inside, body.lattice,
                           body.position);
    EXPECT_LT(body.smallest_volume(), 0.);
  }

  TEST(InnerPlaces, do_not_fold_below_a_cavity)
  {
    expect_cells_below_a_cavity<2>();
    expect_cells_below_a_cavity<3>();
  }

  double mises(const double *s)
  {
    return std::sqrt(
        0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)) +
        3. * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
  }

  template <int dim>
  void expect_stress_within_the_yield_surface(const bool by_interpolation)
  {
    RemapBody<dim> body(block<dim>());
    body.start(body.disorder(0.25, 1), uniform<dim>);
    body.set_points(rough<dim>);
    const auto largest = [&]()
    {
      double result = 0;
      for (std::size_t i = 0; i < body.points.mass.size(); ++i)
        result = std::max(result, mises(body.points.values.data() + i * 8));
      return Utilities::MPI::max(result, MPI_COMM_WORLD);
    };
    for (std::size_t i = 0; i < body.points.mass.size(); ++i)
    {
      double *const stress = body.points.values.data() + i * 8;
      const double factor = 1. / mises(stress);
      for (unsigned int c = 0; c < 6; ++c)
        stress[c] *= factor;
    }
    for (unsigned int round = 2; round < 5; ++round)
      if (by_interpolation)
        body.interpolate(body.disorder(0.25, round));
      else
        body.move(body.disorder(0.25, round));
    EXPECT_LE(largest(), 1. + 1e-12);
    EXPECT_GT(largest(), 0.5);
    EXPECT_LE(body.largest_of_points(6, -1.), 0.); // not negative
  }

  TEST(Remap, leaves_stress_within_a_yield_surface_that_all_points_are_on)
  {
    for (const bool by_interpolation : {false, true})
    {
      expect_stress_within_the_yield_surface<2>(by_interpolation);
      expect_stress_within_the_yield_surface<3>(by_interpolation);
    }
  }

  constexpr unsigned int n_of_strip = 100;

  double bump(const double x)
  {
    constexpr double width = 3.;
    return std::exp(-0.5 * std::pow((x - 0.5 * n_of_strip) / width, 2));
  }

  TEST(Remap, keeps_a_peak_over_400_remaps)
  {
    RemapBody<2> body({n_of_strip, 1});
    body.start(body.disorder(0., 0, true), uniform<2>);
    body.set_field([](const Point<2> &x, unsigned int) { return bump(x[0]); });
    body.set_points([](const Point<2> &x, unsigned int) { return bump(x[0]); });
    for (unsigned int round = 1; round <= 400; ++round)
      body.move(body.disorder(0.25, round, true));
    body.move(body.disorder(0., 0, true));
    EXPECT_GE(body.largest_of_field(), 0.95);
    EXPECT_GE(body.largest_of_points(7), 0.75);
    EXPECT_LE(body.largest_of_field(), 1.01);
  }

  TEST(Remap, by_interpolation_loses_most_of_it)
  {
    RemapBody<2> body({n_of_strip, 1});
    body.start(body.disorder(0., 0, true), uniform<2>);
    body.set_field([](const Point<2> &x, unsigned int) { return bump(x[0]); });
    body.set_cells([](const Point<2> &x, unsigned int) { return bump(x[0]); }, body.middles());
    constexpr SmoothedIntegrationRule rule = SmoothedIntegrationRule::one_point;
    for (unsigned int round = 1; round <= 400; ++round)
      body.interpolate(body.disorder(0.25, round, true), rule);
    body.interpolate(body.disorder(0., 0, true), rule);
    RecordProperty("nodes", std::to_string(body.largest_of_field()));
    RecordProperty("points", std::to_string(body.largest_of_points(7)));
    EXPECT_LE(body.largest_of_field(), 0.5);
    EXPECT_GE(body.largest_of_field(), 0.3);
    EXPECT_LE(body.largest_of_points(7), 0.55);
    EXPECT_GE(body.largest_of_points(7), 0.35);
  }

  TEST(CloudInterpolation, of_a_step_has_lobes_that_its_limit_cuts)
  {
    Cloud<2> cloud, targets;
    std::vector<double> values;
    const unsigned int rank = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
    for (unsigned int i = 0; i < 12 && rank == 0; ++i)
      for (unsigned int j = 0; j < 12; ++j)
      {
        cloud.places.emplace_back(i + 0.2 * std::sin(3. * i + j), j + 0.2 * std::cos(i + 2. * j));
        cloud.bodies.push_back(0.);
        Tensor<2, 2> metric;
        metric[0][0] = metric[1][1] = 1. / 1.5;
        cloud.metrics.push_back(metric);
        values.push_back(i < 6 ? 0. : 1.);
        targets.places.emplace_back(i - 0.5, j + 0.3);
        targets.bodies.push_back(0.);
      }
    const CloudInterpolation<2> interpolation(cloud, targets, MPI_COMM_WORLD);
    std::vector<double> found = interpolation.interpolate(values, 1);
    if (rank == 0)
    {
      EXPECT_LT(*std::min_element(found.begin(), found.end()), -1e-3);
      EXPECT_GT(*std::max_element(found.begin(), found.end()), 1.001);
    }
    interpolation.limit(values, 1, {}, found);
    for (const double value : found)
    {
      EXPECT_GE(value, 0.);
      EXPECT_LE(value, 1.);
    }
  }

  TEST(Remap, keeps_a_peak_of_one_value_a_cell_over_400_remaps)
  {
    RemapBody<2> body({n_of_strip, 1});
    body.start(body.disorder(0., 0, true), uniform<2>);
    body.set_cells([](const Point<2> &x, unsigned int) { return bump(x[0]); }, body.middles());
    for (unsigned int round = 1; round <= 400; ++round)
      body.move_cells(body.disorder(0.25, round, true));
    body.move_cells(body.disorder(0., 0, true));
    RecordProperty("cells", std::to_string(body.largest_of_points(7)));
    EXPECT_GE(body.largest_of_points(7), 0.75);
    EXPECT_LE(body.largest_of_points(7), 1.);
  }

  template <int dim>
  void expect_sums_and_bounds_of_cells()
  {
    RemapBody<dim> body(block<dim>());
    body.start(body.disorder(0.2, 1), uniform<dim>);
    body.set_cells(rough<dim>, body.middles());
    const auto sums = [&]()
    {
      std::vector<double> result(9, 0.);
      for (std::size_t c = 0; c < body.points.mass.size(); ++c)
      {
        result[8] += body.points.mass[c];
        for (unsigned int f = 0; f < 8; ++f)
          result[f] += body.points.mass[c] * body.points.values[c * 8 + f];
      }
      return ordered_sum(result, MPI_COMM_WORLD);
    };
    const std::vector<double> before = sums();
    const double highest = body.largest_of_points(6), lowest = -body.largest_of_points(6, -1.);
    for (unsigned int round = 2; round < 5; ++round)
      body.move_cells(body.disorder(0.2, round));
    const std::vector<double> after = sums();
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_NEAR(before[k], after[k], 1e-13 * before[8]) << "sum " << k << " in " << dim;
    EXPECT_LE(body.largest_of_points(6), highest + 1e-14);
    EXPECT_GE(-body.largest_of_points(6, -1.), lowest - 1e-14);
  }

  TEST(Remap, keeps_sums_and_bounds_of_one_value_a_cell)
  {
    expect_sums_and_bounds_of_cells<2>();
    expect_sums_and_bounds_of_cells<3>();
  }

  TEST(CloudFunctions, exist_at_every_place_and_depend_continuously_on_it)
  {
    CloudFunctions<2> functions;
    std::vector<Point<2>> points;
    std::vector<Tensor<2, 2>> metrics;
    for (unsigned int i = 0; i < 4; ++i)
      for (unsigned int j = 0; j < 4; ++j)
      {
        points.emplace_back(i + 0.1 * std::sin(3. * i + j), j + 0.1 * std::cos(i + 2. * j));
        Tensor<2, 2> metric;
        metric[0][0] = metric[1][1] = 1. / 1.3;
        metrics.push_back(metric);
      }
    std::vector<double> values;
    const auto found = [&](const Point<2> &x)
    {
      EXPECT_TRUE(functions.evaluate(x, points, metrics, values));
      Point<2> place;
      double sum = 0;
      for (std::size_t j = 0; j < points.size(); ++j)
      {
        EXPECT_GE(values[j], 0.);
        sum += values[j];
        place += values[j] * points[j];
      }
      EXPECT_NEAR(sum, 1., 1e-14);
      return place;
    };
    EXPECT_LE(found(Point<2>(1.4, 1.7)).distance(Point<2>(1.4, 1.7)), 1e-13);
    // A point on the hull; a place outside of a face; and one nearby.
    EXPECT_LE(found(points[0]).distance(points[0]), 1e-12);
    const Point<2> outside(1.3, -0.8), near(1.3 + 1e-9, -0.8);
    const Point<2> place = found(outside);
    EXPECT_LE(found(near).distance(place), 1e-7);
    EXPECT_LE(place[1], 0.25);
    EXPECT_FALSE(functions.evaluate(Point<2>(9., 9.), points, metrics, values));
  }

  struct Errors
  {
    double nodes, points, cells, interpolated;
  };

  /** The same of one value a cell. */
  double error_of_wave_in_cells(const unsigned int n, const bool by_interpolation)
  {
    RemapBody<2> body({n, 2});
    const auto wave = [n](const Point<2> &x, unsigned int)
    { return std::cos(4. * M_PI * x[0] / n); };
    body.start(body.disorder(0.2, 1), uniform<2>);
    const auto places = [&]()
    { return by_interpolation ? body.middles() : body.centres_of_mass(); };
    body.set_cells(wave, places());
    for (unsigned int round = 2; round < 6; ++round)
      if (by_interpolation)
        body.interpolate(body.disorder(0.2, round), SmoothedIntegrationRule::one_point);
      else
        body.move_cells(body.disorder(0.2, round));
    std::array<double, 2> sums{};
    const auto now = places();
    for (std::size_t i = 0; i < now.size(); ++i)
    {
      sums[0] += std::pow(body.points.values[i * 8 + 7] - wave(now[i], 0), 2);
      sums[1] += 1.;
    }
    sums = ordered_sum(sums, MPI_COMM_WORLD);
    return std::sqrt(sums[0] / sums[1]);
  }

  /** Of a wave in n cells, after four remaps, in the mean square. It has no slope at the ends:
   * there the limit of points has values on one side alone, and takes the slope away. */
  Errors errors_of_wave(const unsigned int n)
  {
    RemapBody<2> body({n, 2});
    const auto wave = [n](const Point<2> &x, unsigned int)
    { return std::cos(4. * M_PI * x[0] / n); };
    body.start(body.disorder(0.2, 1), uniform<2>);
    body.set_field(wave);
    body.set_points(wave);
    for (unsigned int round = 2; round < 6; ++round)
      body.move(body.disorder(0.2, round));
    std::array<double, 3> sums{};
    for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
      sums[0] += std::pow(body.field.node(i)[0] - wave(body.place_of(i), 0), 2);
    const auto places = body.point_places();
    for (std::size_t i = 0; i < places.size(); ++i)
    {
      sums[1] += std::pow(body.points.values[i * 8 + 7] - wave(places[i], 0), 2);
      sums[2] += 1.;
    }
    sums = ordered_sum(sums, MPI_COMM_WORLD);
    return {std::sqrt(sums[0] / sums[2]), std::sqrt(sums[1] / sums[2]),
            error_of_wave_in_cells(n, false), error_of_wave_in_cells(n, true)};
  }

  /** Two walls have passed each other in the middle, where cells were void, and all is one body
   * then but for its last cells, which are emptied; sums before and after, and bounds. */
  template <int dim>
  void expect_joined_walls(const std::vector<unsigned int> &n)
  {
    const double length = n[0];
    RemapBody<dim> body(n);
    // Full cells are as far as 3 from the ends in the lattice, and reach over the middle now.
    const auto was_void = [&](const Point<dim> &x) { return x[0] > 3. && x[0] < length - 3.; };
    const auto is_void = [&](const Point<dim> &x) { return x[0] > length - 1.; };
    const auto disorder = body.disorder(0.1, 1);
    const auto walls = [&](const Point<dim> &x)
    {
      Point<dim> result = disorder(x);
      const double reach = (0.5 * length + 0.1) / 3.;
      if (x[0] < 3.5)
        result[0] *= reach;
      else if (x[0] > length - 3.5)
        result[0] = length - (length - result[0]) * reach;
      return result;
    };
    body.start(walls, [](const Point<dim> &x) { return 1. + 0.1 * x[0]; });
    body.empty(was_void);
    body.set_field([&](const Point<dim> &x, unsigned int slot)
                   { return x[0] < 0.5 * length ? 1. + slot : -2.; });
    body.set_points([](const Point<dim> &x, unsigned int f) { return std::sin(x[0] + f); });
    const std::vector<double> before = body.sums();
    body.fill(body.disorder(0.2, 2), was_void, is_void);
    const std::vector<double> after = body.sums();
    for (unsigned int k = 0; k < before.size(); ++k)
      EXPECT_NEAR(after[k], before[k], 1e-12 * std::abs(before[0])) << k;
    const auto middle = body.middles_of_lattice();
    for (std::size_t c = 0; c < middle.size(); ++c)
      for (unsigned int q = 0; q < SubCells<dim>::n_sub_cells; ++q)
      {
        const std::size_t i = c * SubCells<dim>::n_sub_cells + q;
        EXPECT_EQ(body.points.mass[i] > 0., !is_void(middle[c])) << middle[c];
        for (unsigned int f = 0; f < 8 && !is_void(middle[c]); ++f)
          EXPECT_LE(std::abs(body.points.values[i * 8 + f]), 1. + 1e-12);
      }
    // Nodes of emptied cells alone keep nothing.
    for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
      if (body.lattice.node(i)[0] > length - 0.5)
        EXPECT_EQ(body.field.node(i)[0], 0.);
  }

  TEST(Remap, of_walls_that_meet_keeps_sums_in_filled_cells)
  {
    expect_joined_walls<2>({8, 5});
    expect_joined_walls<3>({8, 3, 3});
  }

  TEST(Remap, is_of_second_order)
  {
    // Over five octaves, since places are random.
    const Errors coarse = errors_of_wave(20), fine = errors_of_wave(640);
    EXPECT_GE(std::log2(coarse.nodes / fine.nodes) / 5., 1.95);
    EXPECT_GE(std::log2(coarse.points / fine.points) / 5., 1.8);
    EXPECT_GE(std::log2(coarse.cells / fine.cells) / 5., 1.8);
    EXPECT_GE(std::log2(coarse.interpolated / fine.interpolated) / 5., 1.8);
  }
} // namespace
