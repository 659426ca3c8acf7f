// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/remesh/nodal_projection.h>
#include <tombolo/remesh/point_remap.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    template <int dim>
    constexpr unsigned int n_of_cell = SubCells<dim>::n_sub_cells;

    /** The centres of the sub-cells of before. */
    template <int dim>
    std::array<Point<dim>, n_of_cell<dim>> centres(const typename SubCells<dim>::Corners &corners)
    {
      const SimplexPoints<dim> &points = SimplexPoints<dim>::instance();
      const SimplexLanes<dim> lanes(corners);
      double volumes[SimplexLanes<dim>::n_padded];
      lanes.find_volumes(volumes);
      std::array<Point<dim>, n_of_cell<dim>> result;
      std::array<double, n_of_cell<dim>> total{};
      for (unsigned int s = 0; s < SimplexPoints<dim>::n_simplices; ++s)
      {
        total[points.sub_cell[s]] += volumes[s];
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int k = 0; k <= dim; ++k)
            result[points.sub_cell[s]][d] +=
                volumes[s] / (dim + 1) * lanes.coordinates[d][points.vertices[s][k]];
      }
      for (unsigned int q = 0; q < n_of_cell<dim>; ++q)
        result[q] /= total[q];
      return result;
    }

    /** The centre of mass of a cell of before, whose sub-cells have these centres. */
    template <int dim>
    Point<dim> centre_of_mass(const RemapCell<dim> &cell,
                              const std::array<Point<dim>, n_of_cell<dim>> &sub_cell_centres)
    {
      Point<dim> result;
      double total = 0;
      for (unsigned int q = 0; q < n_of_cell<dim>; ++q)
      {
        result += cell.mass[q] * sub_cell_centres[q];
        total += cell.mass[q];
      }
      return result / total;
    }

    /** The gradient of every component in every cell by least squares over the sub-cells of all
     * cells that share a node with it: moments of what surrounds a node are added over ranks. */
    template <int dim>
    class Gradients
    {
    public:
      /** With @p is_cellwise all sub-cells of a cell are at the centre of its mass. */
      Gradients(const std::vector<RemapCell<dim>> &cells,
                const std::shared_ptr<const NodePartition> &partition, const PointValues &points,
                const bool is_cellwise = false)
          : cells(cells), is_cellwise(is_cellwise), moments(3 + points.n_components)
      {
        for (NodalVector &vector : moments)
          vector.reinit(partition, Quantity::scalars);
        for (std::size_t c = 0; c < cells.size(); ++c)
          if (!cells[c].is_void_before)
            add_cell(c, points);
        for (NodalVector &vector : moments)
          vector.sum_over_ranks();
      }

      /** By component. */
      std::vector<Tensor<1, dim>> cell_gradients(const std::size_t c) const
      {
        const Point<dim> centre = SubCells<dim>::centre(cells[c].before);
        double weight = 0;
        Tensor<1, dim> first;
        SymmetricTensor<2, dim> second;
        std::vector<double> sum(moments.size() - 3, 0.);
        std::vector<Tensor<1, dim>> product(sum.size());
        for (unsigned int k = 0; k < cells[c].nodes.size(); ++k)
        {
          const unsigned int node = cells[c].nodes[k];
          const Tensor<1, dim> offset = cells[c].before[k] - centre;
          const double node_mass = moments[0].node(node)[0];
          Tensor<1, dim> arm;
          for (unsigned int d = 0; d < dim; ++d)
            arm[d] = moments[0].node(node)[1 + d];
          weight += node_mass;
          first += arm + node_mass * offset;
          for (unsigned int a = 0; a < dim; ++a)
            for (unsigned int b = a; b < dim; ++b)
              second[a][b] += moments[a == b ? 1 : 2].node(node)[a == b ? a : a + b - 1] +
                              offset[a] * arm[b] + arm[a] * offset[b] +
                              node_mass * offset[a] * offset[b];
          for (std::size_t f = 0; f < sum.size(); ++f)
          {
            const double *const values = moments[3 + f].node(node);
            sum[f] += values[0];
            for (unsigned int d = 0; d < dim; ++d)
              product[f][d] += values[1 + d] + values[0] * offset[d];
          }
        }
        Tensor<2, dim> matrix;
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            matrix[a][b] = second[a][b] - first[a] * first[b] / weight;
        // Where cells lie in one layer, the gradient across it is not defined.
        constexpr double shift = 1e-12;
        const double least = is_cellwise ? shift * trace(matrix) : 0.;
        for (unsigned int d = 0; d < dim && is_cellwise; ++d)
          matrix[d][d] += least;
        const Tensor<2, dim> inverse = invert(matrix);
        for (std::size_t f = 0; f < sum.size(); ++f)
          product[f] = inverse * (product[f] - sum[f] / weight * first);
        return product;
      }

    private:
      void add_cell(const std::size_t c, const PointValues &points)
      {
        auto sub_cell_centres = centres<dim>(cells[c].before);
        if (is_cellwise)
          sub_cell_centres.fill(centre_of_mass(cells[c], sub_cell_centres));
        for (unsigned int k = 0; k < cells[c].nodes.size(); ++k)
        {
          const unsigned int node = cells[c].nodes[k];
          for (unsigned int q = 0; q < n_of_cell<dim>; ++q)
          {
            const std::size_t i = c * n_of_cell<dim> + q;
            const double weight = points.mass[i];
            const Tensor<1, dim> arm = sub_cell_centres[q] - cells[c].before[k];
            const auto add = [&](NodalVector &vector, const double value)
            {
              vector.node(node)[0] += weight * value;
              for (unsigned int d = 0; d < dim; ++d)
                vector.node(node)[1 + d] += weight * value * arm[d];
            };
            add(moments[0], 1.);
            for (unsigned int a = 0; a < dim; ++a)
              for (unsigned int b = a; b < dim; ++b)
                moments[a == b ? 1 : 2].node(node)[a == b ? a : a + b - 1] +=
                    weight * arm[a] * arm[b];
            for (unsigned int f = 0; f < points.n_components; ++f)
              add(moments[3 + f], points.values[i * points.n_components + f]);
          }
        }
      }

      const std::vector<RemapCell<dim>> &cells;
      bool is_cellwise;
      // Σ m and Σ m r; Σ m r r on and off the diagonal; Σ m s and Σ m r s of each component
      std::vector<NodalVector> moments;
    };

    /** The largest of one number of the sub-cells around each node. Collective. */
    template <int dim, typename Value>
    NodeMaxima largest_around_nodes(const std::vector<RemapCell<dim>> &cells,
                                    const std::shared_ptr<const NodePartition> &partition,
                                    const Value &value)
    {
      NodeMaxima result(partition);
      for (std::size_t c = 0; c < cells.size(); ++c)
        for (unsigned int q = 0; q < n_of_cell<dim> && !cells[c].is_void_before; ++q)
          for (const unsigned int node : cells[c].nodes)
            result.raise(node, value(c * n_of_cell<dim> + q));
      result.share();
      return result;
    }

    /** The bounds of all components, and of the second invariant of the stress, around a cell. */
    template <int dim>
    class Bounds
    {
    public:
      Bounds(const std::vector<RemapCell<dim>> &cells,
             const std::shared_ptr<const NodePartition> &partition, const PointValues &points)
      {
        for (unsigned int f = 0; f < points.n_components; ++f)
        {
          const auto value = [&](const std::size_t i)
          { return points.values[i * points.n_components + f]; };
          largest.push_back(largest_around_nodes(cells, partition, value));
          largest_negative.push_back(largest_around_nodes(
              cells, partition, [&](const std::size_t i) { return -value(i); }));
        }
        if (points.stress)
          invariant = largest_around_nodes(cells, partition,
                                           [&](const std::size_t i)
                                           {
                                             return StressInvariants::second(
                                                 points.values.data() + i * points.n_components +
                                                 *points.stress);
                                           });
      }

      /** Scales the gradients of a sub-cell so that its vertices, at these offsets from the centre,
       * stay within the bounds. */
      void limit(const RemapCell<dim> &cell, const double *values,
                 const std::vector<Tensor<1, dim>> &offsets,
                 const std::optional<unsigned int> &stress,
                 std::vector<Tensor<1, dim>> &gradients) const
      {
        std::vector<double> factors(gradients.size(), 1.);
        for (std::size_t f = 0; f < gradients.size(); ++f)
        {
          const double up = std::max(0., largest[f].largest_of(cell.nodes) - values[f]);
          const double down = std::max(0., largest_negative[f].largest_of(cell.nodes) + values[f]);
          for (const Tensor<1, dim> &offset : offsets)
          {
            const double change = gradients[f] * offset;
            const double allowed = change > 0. ? up : down;
            if (std::abs(change) > allowed)
              factors[f] = std::min(factors[f], allowed / std::abs(change));
          }
        }
        if (stress)
          limit_stress(cell, values + *stress, offsets, gradients.data() + *stress,
                       factors.data() + *stress);
        for (std::size_t f = 0; f < gradients.size(); ++f)
          gradients[f] *= factors[f];
      }

    private:
      void limit_stress(const RemapCell<dim> &cell, const double *stress,
                        const std::vector<Tensor<1, dim>> &offsets, const Tensor<1, dim> *gradients,
                        double *factors) const
      {
        double factor = *std::min_element(factors, factors + StressInvariants::n_components);
        const double room =
            std::max(0., invariant->largest_of(cell.nodes) - StressInvariants::second(stress));
        for (const Tensor<1, dim> &offset : offsets)
        {
          double change[StressInvariants::n_components];
          for (unsigned int c = 0; c < StressInvariants::n_components; ++c)
            change[c] = gradients[c] * offset;
          const double square = StressInvariants::second(change);
          const double slope =
              StressInvariants::mixed(change, stress); // of half the invariant's rate
          if (square + 2. * slope > room && square > 0.)
            factor = std::min(factor, (std::sqrt(slope * slope + square * room) - slope) / square);
        }
        std::fill_n(factors, StressInvariants::n_components, std::max(0., factor));
      }

      std::vector<NodeMaxima> largest, largest_negative;
      std::optional<NodeMaxima> invariant;
    };

    template <int dim>
    void check_coverage(const CellOverlap<dim> &overlap)
    {
      constexpr double least_share = 1e-6;
      double uncovered = 0;
      for (unsigned int c = 0; c < overlap.cells.size(); ++c)
      {
        if (!overlap.is_source(c))
          continue;
        const auto volumes = CellSimplices<dim>::volumes(overlap.cells[c].before);
        for (unsigned int q = 0; q < n_of_cell<dim>; ++q)
        {
          const std::size_t i = c * n_of_cell<dim> + q;
          const bool is_distributed = !overlap.is_uncovered.empty() && overlap.is_uncovered[i];
          if (!is_distributed && !(overlap.covered[i].volume > least_share * std::abs(volumes[q])))
            uncovered = 1;
        }
      }
      if (Utilities::MPI::max(uncovered, overlap.communicator) > 0.)
        throw RunError("A refill finds no cell to put the mass of a sub-cell into.");
    }

    /** Throws where a cell of after has no mass. Collective. */
    template <int dim>
    void check_masses(const CellOverlap<dim> &overlap, const PointValues &points)
    {
      std::string empty;
      for (std::size_t c = 0; c < overlap.cells.size() && empty.empty(); ++c)
      {
        double mass = 0;
        for (std::size_t i = c * n_of_cell<dim>; i < (c + 1) * n_of_cell<dim>; ++i)
          mass += points.mass[i];
        if (overlap.cells[c].is_void_after || mass > 0.)
          continue;
        empty = as_text("A refill finds no mass for the cell around (",
                        SubCells<dim>::centre(overlap.cells[c].after), ").");
      }
      throw_on_all_ranks<RunError>(empty, overlap.communicator);
    }

    /** The same density in all sub-cells of a cell: those with too much pass mass to those with too
     * little. */
    template <int dim>
    void equalize(const typename SubCells<dim>::Corners &corners, const std::size_t c,
                  PointValues &points)
    {
      constexpr double negligible = 1e-13;
      const auto volumes = CellSimplices<dim>::volumes(corners);
      double mass = 0, volume = 0, pool = 0;
      for (unsigned int q = 0; q < n_of_cell<dim>; ++q)
      {
        mass += points.mass[c * n_of_cell<dim> + q];
        volume += volumes[q];
      }
      const unsigned int n = points.n_components;
      std::vector<double> content(n, 0.);
      for (unsigned int q = 0; q < n_of_cell<dim>; ++q)
      {
        const std::size_t i = c * n_of_cell<dim> + q;
        const double surplus = points.mass[i] - mass * volumes[q] / volume;
        if (!(surplus > 0.))
          continue;
        pool += surplus;
        for (unsigned int f = 0; f < n; ++f)
          content[f] += surplus * points.values[i * n + f];
      }
      if (!(pool > negligible * mass))
        return;
      for (unsigned int q = 0; q < n_of_cell<dim>; ++q)
      {
        const std::size_t i = c * n_of_cell<dim> + q;
        const double target = mass * volumes[q] / volume, missing = target - points.mass[i];
        if (missing > 0.)
          for (unsigned int f = 0; f < n; ++f)
            points.values[i * n + f] =
                (points.mass[i] * points.values[i * n + f] + missing / pool * content[f]) / target;
        points.mass[i] = target;
      }
    }

    /** Data of the sub-cells of before for other ranks: density, centre, values and limited
     * gradients. */
    template <int dim>
    std::vector<double> describe_sub_cells(const CellOverlap<dim> &overlap,
                                           const std::shared_ptr<const NodePartition> &partition,
                                           const PointValues &points)
    {
      const Gradients<dim> gradients(overlap.cells, partition, points);
      const Bounds<dim> bounds(overlap.cells, partition, points);
      std::vector<double> result;
      result.reserve(points.mass.size() * (1 + dim) * (1 + points.n_components));
      for (unsigned int c = 0; c < overlap.cells.size(); ++c)
      {
        const RemapCell<dim> &cell = overlap.cells[c];
        const SimplexLanes<dim> lanes(cell.before);
        const bool is_source = overlap.is_source(c);
        const std::vector<Tensor<1, dim>> cell_gradients =
            is_source ? gradients.cell_gradients(c)
                      : std::vector<Tensor<1, dim>>(points.n_components);
        for (unsigned int q = 0; q < n_of_cell<dim>; ++q)
        {
          const std::size_t i = c * n_of_cell<dim> + q;
          const auto &covered = overlap.covered[i];
          const bool has_moved =
              is_source && (overlap.is_uncovered.empty() || !overlap.is_uncovered[i]);
          const double volume = has_moved ? covered.volume : 1.;
          const Tensor<1, dim> centre = covered.moment / volume;
          const double *const values = points.values.data() + i * points.n_components;
          std::vector<Tensor<1, dim>> offsets, limited = cell_gradients;
          const unsigned int sub_cell_points = SimplexPoints<dim>::instance().points_of_sub_cell[q];
          for (unsigned int p = 0; p < SimplexPoints<dim>::n_points; ++p)
            if (has_moved && ((sub_cell_points >> p) & 1u) != 0)
              offsets.push_back(lanes.point(p) - centre);
          if (has_moved)
            bounds.limit(cell, values, offsets, points.stress, limited);
          else
            std::fill(limited.begin(), limited.end(), Tensor<1, dim>());
          result.push_back(points.mass[i] / volume);
          result.insert(result.end(), &centre[0], &centre[0] + dim);
          for (unsigned int f = 0; f < points.n_components; ++f)
          {
            result.push_back(values[f]);
            result.insert(result.end(), &limited[f][0], &limited[f][0] + dim);
          }
        }
      }
      return result;
    }
  } // namespace

  template <int dim>
  void remap_points(const CellOverlap<dim> &overlap,
                    const std::shared_ptr<const NodePartition> &partition, PointValues &points)
  {
    if (!overlap.has_motion)
      return;
    check_coverage(overlap);
    const unsigned int n = points.n_components;
    if (!overlap.is_uncovered.empty())
      overlap.distribute_to_neighbours(partition, n, points.mass, points.values);
    const unsigned int size = (1 + dim) * (1 + n);
    const std::vector<double> received =
        overlap.forward(describe_sub_cells(overlap, partition, points), size * n_of_cell<dim>);
    for (std::size_t c = 0; c < overlap.cells.size(); ++c)
      if (overlap.cells[c].has_moved())
      {
        std::fill_n(points.mass.begin() + std::ptrdiff_t(c * n_of_cell<dim>), n_of_cell<dim>, 0.);
        std::fill_n(points.values.begin() + std::ptrdiff_t(c * n_of_cell<dim> * n),
                    n_of_cell<dim> * n, 0.);
      }
    for (const auto &share : overlap.shares)
    {
      const double *const from = received.data() + std::size_t(share.from) * size;
      const double mass = from[0] * share.volume;
      points.mass[share.to] += mass;
      Tensor<1, dim> offset = share.moment / share.volume;
      for (unsigned int d = 0; d < dim; ++d)
        offset[d] -= from[1 + d];
      for (unsigned int f = 0; f < n; ++f)
      {
        const double *const values = from + (1 + dim) * (1 + f);
        double value = values[0];
        for (unsigned int d = 0; d < dim; ++d)
          value += values[1 + d] * offset[d];
        points.values[std::size_t(share.to) * n + f] += mass * value;
      }
    }
    check_masses(overlap, points);
    for (unsigned int c = 0; c < overlap.cells.size(); ++c)
    {
      if (overlap.cells[c].is_void_after)
        continue;
      if (overlap.is_target(c))
        for (std::size_t i = c * n_of_cell<dim>; i < (c + 1) * n_of_cell<dim>; ++i)
          for (unsigned int f = 0; f < n && points.mass[i] > 0.; ++f)
            points.values[i * n + f] /= points.mass[i];
      equalize<dim>(overlap.cells[c].after, c, points);
    }
  }

  template <int dim>
  PointValues values_of_sub_cells(const std::vector<RemapCell<dim>> &cells,
                                  const std::shared_ptr<const NodePartition> &partition,
                                  const PointValues &cell_values)
  {
    const unsigned int n = cell_values.n_components;
    PointValues result;
    result.n_components = n;
    result.stress = cell_values.stress;
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (unsigned int q = 0; q < n_of_cell<dim>; ++q)
      {
        result.mass.push_back(cells[c].mass[q]);
        const auto values = cell_values.values.begin() + std::ptrdiff_t(c * n);
        result.values.insert(result.values.end(), values, values + n);
      }
    const Gradients<dim> gradients(cells, partition, result, true);
    const Bounds<dim> bounds(cells, partition, result);
    for (std::size_t c = 0; c < cells.size(); ++c)
    {
      const auto sub_cell_centres = centres<dim>(cells[c].before);
      const Point<dim> centre = centre_of_mass(cells[c], sub_cell_centres);
      std::vector<Tensor<1, dim>> offsets, slopes = gradients.cell_gradients(c);
      for (const Point<dim> &sub_cell_centre : sub_cell_centres)
        offsets.push_back(sub_cell_centre - centre);
      bounds.limit(cells[c], cell_values.values.data() + c * n, offsets, result.stress, slopes);
      for (unsigned int q = 0; q < n_of_cell<dim>; ++q)
        for (unsigned int f = 0; f < n; ++f)
          result.values[(c * n_of_cell<dim> + q) * n + f] += slopes[f] * offsets[q];
    }
    return result;
  }

  template <int dim>
  void set_means_of_cells(const std::vector<RemapCell<dim>> &cells,
                          const PointValues &sub_cell_values, PointValues &cell_values)
  {
    const unsigned int n = cell_values.n_components;
    for (std::size_t c = 0; c < cells.size(); ++c)
    {
      if (!cells[c].has_moved())
        continue;
      double mass = 0;
      std::vector<double> sum(n, 0.);
      for (std::size_t i = c * n_of_cell<dim>; i < (c + 1) * n_of_cell<dim>; ++i)
      {
        mass += sub_cell_values.mass[i];
        for (unsigned int f = 0; f < n; ++f)
          sum[f] += sub_cell_values.mass[i] * sub_cell_values.values[i * n + f];
      }
      cell_values.mass[c] = mass;
      for (unsigned int f = 0; f < n; ++f)
        cell_values.values[c * n + f] = sum[f] / mass;
    }
  }

  template PointValues values_of_sub_cells(const std::vector<RemapCell<2>> &,
                                           const std::shared_ptr<const NodePartition> &,
                                           const PointValues &);
  template PointValues values_of_sub_cells(const std::vector<RemapCell<3>> &,
                                           const std::shared_ptr<const NodePartition> &,
                                           const PointValues &);
  template void set_means_of_cells(const std::vector<RemapCell<2>> &, const PointValues &,
                                   PointValues &);
  template void set_means_of_cells(const std::vector<RemapCell<3>> &, const PointValues &,
                                   PointValues &);
  template void remap_points(const CellOverlap<2> &, const std::shared_ptr<const NodePartition> &,
                             PointValues &);
  template void remap_points(const CellOverlap<3> &, const std::shared_ptr<const NodePartition> &,
                             PointValues &);
} // namespace tombolo
