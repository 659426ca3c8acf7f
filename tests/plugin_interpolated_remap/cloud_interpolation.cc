// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cloud_interpolation.h"

#include <tombolo/base/exceptions.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/remesh/cell_overlap.h>
#include <tombolo/remesh/point_remap.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/mpi.h>
#include <deal.II/numerics/rtree.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The factor on supports where none reaches a point; points are sent to all ranks that
     * the widened ones reach. */
    constexpr double largest_widening = 2.;

    /** Position, metric and body of a point in a message. */
    template <int dim>
    constexpr unsigned int size_of_point = dim + dim *dim + 1;

    template <int dim>
    BoundingBox<dim> support_of(const Cloud<dim> &cloud, const std::size_t i)
    {
      const Tensor<2, dim> axes = largest_widening * invert(cloud.metrics[i]);
      Point<dim> lower = cloud.positions[i], upper = cloud.positions[i];
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int k = 0; k < dim; ++k)
        {
          lower[d] -= std::abs(axes[d][k]);
          upper[d] += std::abs(axes[d][k]);
        }
      return BoundingBox<dim>({lower, upper});
    }

    template <int dim>
    std::vector<BoundingBox<dim>> supports_of(const Cloud<dim> &cloud)
    {
      std::vector<BoundingBox<dim>> result;
      for (std::size_t i = 0; i < cloud.positions.size(); ++i)
        result.push_back(support_of(cloud, i));
      return result;
    }

    /** Vectors of @p n components a point, whose sums are by component. */
    class Components
    {
    public:
      Components(const unsigned int n, const MPI_Comm communicator)
          : n(n), communicator(communicator)
      {}

      /** Collective. */
      std::vector<double> dot(const std::vector<double> &a, const std::vector<double> &b) const
      {
        std::vector<double> result(n, 0.);
        for (std::size_t i = 0; i < a.size(); ++i)
          result[i % n] += a[i] * b[i];
        return ordered_sum(result, communicator);
      }

      /** Collective. */
      std::vector<double> largest(const std::vector<double> &numbers) const
      {
        std::vector<double> result(n, 0.), rank_maxima(n);
        for (std::size_t i = 0; i < numbers.size(); ++i)
          result[i % n] = std::max(result[i % n], std::abs(numbers[i]));
        Utilities::MPI::max(result, communicator, rank_maxima);
        return rank_maxima;
      }

      /** Zero where there is nothing left. */
      std::vector<double> ratio(const std::vector<double> &a, const std::vector<double> &b) const
      {
        std::vector<double> result(n, 0.);
        for (unsigned int f = 0; f < n; ++f)
          if (b[f] != 0.)
            result[f] = a[f] / b[f];
        return result;
      }

      void add(const std::vector<double> &factors, const std::vector<double> &from,
               std::vector<double> &to, const double sign = 1.) const
      {
        for (std::size_t i = 0; i < to.size(); ++i)
          to[i] += sign * factors[i % n] * from[i];
      }

    private:
      unsigned int n;
      MPI_Comm communicator;
    };

    template <int dim>
    void append(const Cloud<dim> &from, Cloud<dim> &to)
    {
      to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
      to.bodies.insert(to.bodies.end(), from.bodies.begin(), from.bodies.end());
      to.metrics.insert(to.metrics.end(), from.metrics.begin(), from.metrics.end());
    }
  } // namespace

  /** Computes rows. */
  template <int dim>
  class CloudInterpolation<dim>::Builder
  {
  public:
    explicit Builder(const Cloud<dim> &points)
        : points(points), boxes(supports_of(points)), tree(pack_rtree_of_indices(boxes))
    {}

    /** Returns whether there is a point near. */
    bool add_row(const Point<dim> &x, const double body, Rows &rows)
    {
      bool is_found = false;
      for (const double widening : {1., largest_widening})
      {
        find_neighbours(x, body, widening);
        positions.clear();
        metrics.clear();
        for (const std::size_t i : hits)
        {
          positions.push_back(points.positions[i]);
          metrics.push_back(points.metrics[i] / widening);
        }
        is_found = functions.evaluate(x, positions, metrics, values);
        if (is_found)
          break;
      }
      for (std::size_t k = 0; is_found && k < hits.size(); ++k)
        if (values[k] > 0.)
        {
          rows.neighbour.push_back(static_cast<unsigned int>(hits[k]));
          rows.value.push_back(values[k]);
        }
      rows.start.push_back(rows.neighbour.size());
      return is_found;
    }

  private:
    /** In the order of their positions, which is the same on any number of ranks. */
    void find_neighbours(const Point<dim> &x, const double body, const double widening)
    {
      const auto reaches = [&](const std::size_t i)
      {
        bool result = points.bodies[i] == body;
        const Tensor<1, dim> scaled = points.metrics[i] * (points.positions[i] - x);
        for (unsigned int d = 0; d < dim && result; ++d)
          result = std::abs(scaled[d]) < widening;
        return result;
      };
      hits.clear();
      tree.query(boost::geometry::index::intersects(x), std::back_inserter(hits));
      hits.erase(std::remove_if(hits.begin(), hits.end(),
                                [&](const std::size_t i) { return !reaches(i); }),
                 hits.end());
      std::sort(hits.begin(), hits.end(),
                [&](const std::size_t i, const std::size_t j)
                {
                  const auto &a = points.positions[i], &b = points.positions[j];
                  for (unsigned int d = 0; d < dim; ++d)
                    if (a[d] != b[d])
                      return a[d] < b[d];
                  return i < j;
                });
    }

    const Cloud<dim> &points;
    std::vector<BoundingBox<dim>> boxes;
    decltype(pack_rtree_of_indices(boxes)) tree;
    CloudFunctions<dim> functions;
    std::vector<std::size_t> hits;
    std::vector<Point<dim>> positions;
    std::vector<Tensor<2, dim>> metrics;
    std::vector<double> values;
  };

  template <int dim>
  CloudInterpolation<dim>::CloudInterpolation(const Cloud<dim> &cloud, const Cloud<dim> &targets,
                                              const MPI_Comm communicator)
      : n_points(cloud.positions.size()), communicator(communicator)
  {
    Cloud<dim> all = cloud;
    append(exchange(cloud, targets), all);
    Builder builder(all);
    std::string failure;
    for (std::size_t i = 0; i < n_points; ++i)
      builder.add_row(cloud.positions[i], cloud.bodies[i], point_rows);
    for (std::size_t i = 0; i < targets.positions.size(); ++i)
      if (!builder.add_row(targets.positions[i], targets.bodies[i], target_rows) && failure.empty())
      {
        std::ostringstream text;
        text << "A refill by interpolation finds no point near (" << targets.positions[i] << ").";
        failure = text.str();
      }
    throw_on_all_ranks<RunError>(failure, communicator);
  }

  template <int dim>
  Cloud<dim> CloudInterpolation<dim>::exchange(const Cloud<dim> &cloud, const Cloud<dim> &targets)
  {
    std::vector<Point<dim>> positions = cloud.positions;
    positions.insert(positions.end(), targets.positions.begin(), targets.positions.end());
    std::vector<double> own_box;
    if (!positions.empty())
    {
      const auto corners = BoundingBox<dim>(positions).get_boundary_points();
      own_box.insert(own_box.end(), &corners.first[0], &corners.first[0] + dim);
      own_box.insert(own_box.end(), &corners.second[0], &corners.second[0] + dim);
    }
    const auto boxes = items_by_rank(own_box, communicator);
    std::map<unsigned int, std::vector<double>> messages;
    for (std::size_t i = 0; i < n_points; ++i)
    {
      const auto support = support_of(cloud, i).get_boundary_points();
      for (unsigned int rank = 0; rank < boxes.size(); ++rank)
      {
        const std::vector<double> &box = boxes[rank];
        bool reaches = rank != Utilities::MPI::this_mpi_process(communicator) && !box.empty();
        for (unsigned int d = 0; d < dim && reaches; ++d)
          reaches = support.first[d] <= box[dim + d] && box[d] <= support.second[d];
        if (!reaches)
          continue;
        sent[rank].push_back(static_cast<unsigned int>(i));
        std::vector<double> &message = messages[rank];
        message.insert(message.end(), &cloud.positions[i][0], &cloud.positions[i][0] + dim);
        message.push_back(cloud.bodies[i]);
        for (unsigned int d = 0; d < dim; ++d)
          message.insert(message.end(), &cloud.metrics[i][d][0], &cloud.metrics[i][d][0] + dim);
      }
    }
    Cloud<dim> result;
    for (const auto &message : exchange_by_rank(messages, communicator))
      for (std::size_t first = 0; first < message.second.size(); first += size_of_point<dim>)
      {
        const double *const data = message.second.data() + first;
        result.positions.emplace_back();
        result.metrics.emplace_back();
        for (unsigned int d = 0; d < dim; ++d)
        {
          result.positions.back()[d] = data[d];
          for (unsigned int k = 0; k < dim; ++k)
            result.metrics.back()[d][k] = data[dim + 1 + d * dim + k];
        }
        result.bodies.push_back(data[dim]);
      }
    return result;
  }

  template <int dim>
  std::vector<double> CloudInterpolation<dim>::with_others(const std::vector<double> &values,
                                                           const unsigned int n) const
  {
    std::map<unsigned int, std::vector<double>> messages;
    for (const auto &points : sent)
      for (const unsigned int i : points.second)
        messages[points.first].insert(messages[points.first].end(),
                                      values.begin() + std::ptrdiff_t(i) * n,
                                      values.begin() + std::ptrdiff_t(i + 1) * n);
    std::vector<double> result = values;
    for (const auto &message : exchange_by_rank(messages, communicator))
      result.insert(result.end(), message.second.begin(), message.second.end());
    return result;
  }

  template <int dim>
  std::vector<double> CloudInterpolation<dim>::apply(const Rows &rows,
                                                     const std::vector<double> &own_coefficients,
                                                     const unsigned int n) const
  {
    const std::vector<double> all_values = with_others(own_coefficients, n);
    std::vector<double> result((rows.start.size() - 1) * n, 0.);
    for (std::size_t i = 0; i + 1 < rows.start.size(); ++i)
      for (std::size_t k = rows.start[i]; k < rows.start[i + 1]; ++k)
        for (unsigned int f = 0; f < n; ++f)
          result[i * n + f] += rows.value[k] * all_values[std::size_t(rows.neighbour[k]) * n + f];
    return result;
  }

  template <int dim>
  std::vector<double> CloudInterpolation<dim>::residual_of(const std::vector<double> &coefficients,
                                                           const std::vector<double> &values,
                                                           const unsigned int n) const
  {
    std::vector<double> result = apply(point_rows, coefficients, n);
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = values[i] - result[i];
    return result;
  }

  template <int dim>
  std::vector<double> CloudInterpolation<dim>::coefficients_of(const std::vector<double> &values,
                                                               const unsigned int n) const
  {
    constexpr double tolerance = 1e-13;
    constexpr unsigned int most_cycles = 30, most_iterations = 50;
    // Each function is largest at its own point.
    std::vector<double> result = values, residual = residual_of(result, values, n);
    const Components sums(n, communicator);
    const std::vector<double> scale = sums.largest(values);
    const auto is_solved = [&](const std::vector<double> &of, const double share)
    {
      const std::vector<double> error = sums.largest(of);
      bool is_small = true;
      for (unsigned int f = 0; f < n; ++f)
        is_small = is_small && error[f] <= share * tolerance * scale[f];
      return is_small;
    };
    // Cycles of stabilized biconjugate gradients, each from the true residual.
    for (unsigned int cycle = 0; cycle < most_cycles; ++cycle)
    {
      if (is_solved(residual, 1.))
        return result;
      const std::vector<double> shadow = residual;
      std::vector<double> direction = residual, square = sums.dot(shadow, residual);
      for (unsigned int iteration = 0; iteration < most_iterations; ++iteration)
      {
        const std::vector<double> product = apply(point_rows, direction, n);
        const std::vector<double> step = sums.ratio(square, sums.dot(shadow, product));
        sums.add(step, direction, result);
        sums.add(step, product, residual, -1.);
        const std::vector<double> residual_product = apply(point_rows, residual, n);
        const std::vector<double> damping = sums.ratio(
            sums.dot(residual_product, residual), sums.dot(residual_product, residual_product));
        sums.add(damping, residual, result);
        sums.add(damping, residual_product, residual, -1.);
        if (is_solved(residual, 0.3))
          break;
        const std::vector<double> next = sums.dot(shadow, residual);
        std::vector<double> factor = sums.ratio(next, square);
        for (unsigned int f = 0; f < n; ++f)
          factor[f] *= damping[f] != 0. ? step[f] / damping[f] : 0.;
        square = next;
        sums.add(damping, product, direction, -1.);
        for (std::size_t i = 0; i < direction.size(); ++i)
          direction[i] = residual[i] + factor[i % n] * direction[i];
      }
      residual = residual_of(result, values, n);
    }
    throw RunError("The functions of a refill by interpolation cannot be inverted: the points lie "
                   "too irregularly.");
  }

  template <int dim>
  std::vector<double> CloudInterpolation<dim>::interpolate(const std::vector<double> &values,
                                                           const unsigned int n) const
  {
    return apply(target_rows, coefficients_of(values, n), n);
  }

  template <int dim>
  void CloudInterpolation<dim>::limit(const std::vector<double> &values, const unsigned int n,
                                      const std::optional<unsigned int> &stress,
                                      std::vector<double> &at_targets) const
  {
    const std::vector<double> all_values = with_others(values, n);
    for (std::size_t i = 0; i + 1 < target_rows.start.size(); ++i)
    {
      double *const target = at_targets.data() + i * n;
      double largest_invariant = 0;
      std::vector<double> lower(n, 1e300), upper(n, -1e300);
      for (std::size_t k = target_rows.start[i]; k < target_rows.start[i + 1]; ++k)
      {
        const double *const point = all_values.data() + std::size_t(target_rows.neighbour[k]) * n;
        for (unsigned int f = 0; f < n; ++f)
        {
          lower[f] = std::min(lower[f], point[f]);
          upper[f] = std::max(upper[f], point[f]);
        }
        if (stress)
          largest_invariant =
              std::max(largest_invariant, StressInvariants::second(point + *stress));
      }
      for (unsigned int f = 0; f < n; ++f)
        target[f] = std::min(std::max(target[f], lower[f]), upper[f]);
      if (!stress)
        continue;
      double *const s = target + *stress;
      const double invariant = StressInvariants::second(s);
      if (!(invariant > largest_invariant))
        continue;
      const double mean = (s[0] + s[1] + s[2]) / 3.,
                   factor = std::sqrt(largest_invariant / invariant);
      for (unsigned int c = 0; c < StressInvariants::n_components; ++c)
        s[c] = c < 3 ? mean + factor * (s[c] - mean) : factor * s[c];
    }
  }

  template class CloudInterpolation<2>;
  template class CloudInterpolation<3>;
} // namespace tombolo
