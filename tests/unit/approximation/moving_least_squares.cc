// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/moving_least_squares.h>
#include <tombolo/approximation/neighbour_search.h>
#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/approximation/support_size.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/memory.h>

#include <gtest/gtest.h>

#include "particle_clouds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace
{
  using namespace tombolo;

  template <int dim>
  Stencils rows_of(const ParticleCloud &cloud, const double skin = 0.)
  {
    Stencils shape;
    shape.particle_node = cloud.nodes;
    NeighbourSearch<dim> search;
    search.find(cloud.nodes, cloud.nodes, cloud.position.data(), cloud.support.data(), skin,
                shape.row_start, shape.neighbour);
    return shape;
  }

  template <int dim>
  Stencils stencils(const ParticleCloud &cloud, const double skin = 0.,
                    const std::string &kernel = "cubic spline")
  {
    Stencils shape = rows_of<dim>(cloud, skin);
    MovingLeastSquares<dim> mls(make_kernel(kernel));
    EXPECT_TRUE(
        mls.compute(cloud.nodes, cloud.position.data(), cloud.support.data(), shape).empty());
    return shape;
  }

  /** Largest errors of Σφ = 1, Σφ (x_J - x_I) = 0, Σ∇φ = 0, Σ(x_J - x_I)⊗∇φ = I in units of the
   * support of the particle. */
  template <int dim>
  double reproduction_error(const ParticleCloud &cloud, const Stencils &shape)
  {
    double worst = 0;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const unsigned int i = shape.particle_node[row];
      double sum = -1, first[dim] = {}, gradient_sum[dim] = {}, gradient[dim][dim] = {};
      const Stencils::Row stencil = shape.row(row);
      for (unsigned int n = 0; n < stencil.size; ++n)
      {
        const double *const neighbour_gradient = stencil.gradient + n * Stencils::n_gradient;
        sum += stencil.value[n];
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double scaled = (cloud.x(stencil.neighbour[n])[d] - cloud.x(i)[d]) / cloud.a(i)[d];
          first[d] += stencil.value[n] * scaled;
          gradient_sum[d] += neighbour_gradient[d] * cloud.a(i)[d];
          for (unsigned int k = 0; k < dim; ++k)
            gradient[d][k] += scaled * neighbour_gradient[k] * cloud.a(i)[k];
        }
      }
      worst = std::max(worst, std::abs(sum));
      for (unsigned int d = 0; d < dim; ++d)
      {
        worst = std::max({worst, std::abs(first[d]), std::abs(gradient_sum[d])});
        for (unsigned int k = 0; k < dim; ++k)
          worst = std::max(worst, std::abs(gradient[d][k] - (d == k ? 1. : 0.)));
      }
    }
    return worst;
  }

  TEST(MovingLeastSquares, reproduces_linear_fields_and_their_gradients_on_lattices_and_in_disorder)
  {
    for (const char *kernel : {"cubic spline", "quintic spline"})
      for (const double disorder : {0., 0.1, 0.2, 0.4})
      {
        const ParticleCloud flat = lattice_cloud<2>(12, 1.8, disorder);
        EXPECT_LT(reproduction_error<2>(flat, stencils<2>(flat, 0., kernel)), 1e-12)
            << kernel << ", disorder " << disorder;
        const ParticleCloud solid = lattice_cloud<3>(9, 1.8, disorder);
        EXPECT_LT(reproduction_error<3>(solid, stencils<3>(solid, 0., kernel)), 1e-12)
            << kernel << ", disorder " << disorder;
      }
  }

  TEST(MovingLeastSquares, reproduces_linear_fields_among_particles_at_random)
  {
    const ParticleCloud flat = random_cloud<2>(500, 0.15, 0.3);
    EXPECT_LT(reproduction_error<2>(flat, stencils<2>(flat)), 1e-12);
    const ParticleCloud solid = random_cloud<3>(700, 0.25, 0.4);
    EXPECT_LT(reproduction_error<3>(solid, stencils<3>(solid)), 1e-12);
  }

  TEST(MovingLeastSquares, reproduces_linear_fields_far_from_the_origin_and_at_any_scale)
  {
    const ParticleCloud far = lattice_cloud<3>(7, 1.8, 0.2, 1e6);
    EXPECT_LT(reproduction_error<3>(far, stencils<3>(far)), 1e-12);
    ParticleCloud small = lattice_cloud<3>(7, 1.8, 0.2);
    for (unsigned int i = 0; i < small.position.size(); ++i)
    {
      small.position[i] *= i % node_stride == 0 ? 1e-9 : 1e-6;
      small.support[i] *= i % node_stride == 0 ? 1e-9 : 1e-6;
    }
    EXPECT_LT(reproduction_error<3>(small, stencils<3>(small)), 1e-12);
  }

  TEST(MovingLeastSquares, has_the_row_of_the_uniform_lattice_and_no_share_off_a_flat_face)
  {
    const unsigned int n = 7;
    const ParticleCloud cloud = lattice_cloud<3>(n, 1.8);
    const Stencils shape = stencils<3>(cloud);
    const auto value = [&](const unsigned int i, const unsigned int j)
    {
      for (std::size_t e = shape.row_start[i]; e < shape.row_start[i + 1]; ++e)
        if (shape.neighbour[e] == j)
          return shape.value[e];
      return 0.;
    };
    const unsigned int center = (3 * n + 3) * n + 3;
    // w(0) = 2/3 and w(1/1.8) = 4/3 (4/9)³ of the cubic spline, normalized.
    const double w0 = 2. / 3., w1 = 4. / 3. * std::pow(4. / 9., 3);
    const double outer = w1 / (w0 + 2. * w1), middle = w0 / (w0 + 2. * w1);
    EXPECT_NEAR(value(center, center), middle * middle * middle, 1e-14);
    EXPECT_NEAR(value(center, center + 1), outer * middle * middle, 1e-14);
    EXPECT_NEAR(value(center, center + n * n + n + 1), outer * outer * outer, 1e-14);
    EXPECT_EQ(shape.row_start[center + 1] - shape.row_start[center], 27u);

    const unsigned int on_face = 3 * n + 3; // the middle of z = 0
    double off_face = 0;
    for (std::size_t e = shape.row_start[on_face]; e < shape.row_start[on_face + 1]; ++e)
      if (shape.neighbour[e] >= n * n)
        off_face = std::max(off_face, std::abs(shape.value[e]));
    EXPECT_LT(off_face, 1e-14);
  }

  template <int dim>
  void expect_gradient_of_values(const ParticleCloud &cloud, const std::string &kernel)
  {
    // A probe that is in no row, not even its own, moves through the cloud.
    const double step = 1e-5;
    const unsigned int particle = cloud.size() / 2 + 1;
    ParticleCloud extended = cloud;
    const unsigned int probe = cloud.size();
    extended.add(cloud.x(particle), cloud.a(particle), dim);
    Stencils shape;
    shape.particle_node = {probe};
    shape.row_start = {0, cloud.size()};
    shape.neighbour = cloud.nodes;
    MovingLeastSquares<dim> mls(make_kernel(kernel));
    const auto compute = [&](const unsigned int axis, const double shift)
    {
      std::vector<double> position = extended.position;
      position[std::size_t(probe) * node_stride + axis] += 0.21 + shift;
      EXPECT_TRUE(
          mls.compute(extended.nodes, position.data(), extended.support.data(), shape).empty());
    };
    for (unsigned int axis = 0; axis < dim; ++axis)
    {
      compute(axis, 0.);
      std::vector<double> gradient(cloud.size());
      for (unsigned int j = 0; j < cloud.size(); ++j)
        gradient[j] = shape.gradient[std::size_t(j) * Stencils::n_gradient + axis];
      compute(axis, step);
      const std::vector<double> right(shape.value.begin(), shape.value.end());
      compute(axis, -step);
      double largest = 0;
      for (unsigned int j = 0; j < cloud.size(); ++j)
      {
        EXPECT_NEAR(gradient[j], (right[j] - shape.value[j]) / (2. * step), 1e-8);
        largest = std::max(largest, std::abs(gradient[j]));
      }
      EXPECT_GT(largest, 0.05);
    }
  }

  TEST(MovingLeastSquares, has_the_gradient_of_its_values)
  {
    for (const char *kernel : {"cubic spline", "quintic spline"})
    {
      expect_gradient_of_values<2>(lattice_cloud<2>(8, 1.8, 0.3), kernel);
      expect_gradient_of_values<3>(lattice_cloud<3>(6, 1.8, 0.3), kernel);
      expect_gradient_of_values<3>(lattice_cloud<3>(2, 1.8, 0.1), kernel);
    }
  }

  TEST(MovingLeastSquares, leaves_candidates_outside_their_support_at_zero)
  {
    const ParticleCloud cloud = lattice_cloud<3>(8, 1.8, 0.2);
    const Stencils exact = stencils<3>(cloud);
    const Stencils with_skin = stencils<3>(cloud, 0.4);
    ASSERT_GT(with_skin.neighbour.size(), exact.neighbour.size());
    for (unsigned int row = 0; row < exact.n_particles(); ++row)
    {
      std::size_t e = exact.row_start[row];
      for (std::size_t s = with_skin.row_start[row]; s < with_skin.row_start[row + 1]; ++s)
        if (e < exact.row_start[row + 1] && with_skin.neighbour[s] == exact.neighbour[e])
        {
          EXPECT_NEAR(with_skin.value[s], exact.value[e], 1e-13);
          for (unsigned int d = 0; d < Stencils::n_gradient; ++d)
            EXPECT_NEAR(with_skin.gradient[s * Stencils::n_gradient + d],
                        exact.gradient[e * Stencils::n_gradient + d], 1e-12);
          ++e;
        }
        else
        {
          EXPECT_EQ(with_skin.value[s], 0.);
          for (unsigned int d = 0; d < Stencils::n_gradient; ++d)
            EXPECT_EQ(with_skin.gradient[s * Stencils::n_gradient + d], 0.);
        }
      EXPECT_EQ(e, exact.row_start[row + 1]);
    }
  }

  TEST(MovingLeastSquares, has_no_gradient_across_two_dimensions)
  {
    const ParticleCloud flat = lattice_cloud<2>(5, 1.8, 0.2);
    const Stencils shape = stencils<2>(flat);
    ASSERT_EQ(shape.gradient.size(), shape.neighbour.size() * Stencils::n_gradient + 1);
    for (std::size_t e = 0; e < shape.neighbour.size(); ++e)
      EXPECT_EQ(shape.gradient[e * Stencils::n_gradient + 2], 0.);
  }

  /** The largest difference of φ, and of ∇φ over the largest of all, of the same neighbours. */
  std::pair<double, double> difference(const Stencils &one, const Stencils &other)
  {
    double value_difference = 0, gradient_difference = 0, largest = 0;
    for (unsigned int i = 0; i < one.n_particles(); ++i)
    {
      const Stencils::Row a = one.row(i), b = other.row(i);
      EXPECT_EQ(a.size, b.size);
      for (unsigned int k = 0; k < std::min(a.size, b.size); ++k)
      {
        EXPECT_EQ(a.neighbour[k], b.neighbour[k]);
        value_difference = std::max(value_difference, std::abs(a.value[k] - b.value[k]));
        for (unsigned int d = 3 * k; d < 3 * k + 3; ++d)
        {
          gradient_difference =
              std::max(gradient_difference, std::abs(a.gradient[d] - b.gradient[d]));
          largest = std::max(largest, std::abs(b.gradient[d]));
        }
      }
    }
    return {value_difference, gradient_difference / largest};
  }

  TEST(MovingLeastSquares, keeps_equal_rows_once_where_asked_to)
  {
    const unsigned int n = 12;
    for (const double disorder : {0., 0.2})
    {
      // The neighbours of the lattice are in the order of their offsets.
      const ParticleCloud cloud = lattice_cloud<3>(n, 1.8, disorder);
      const Stencils each = stencils<3>(cloud);
      Stencils shared = rows_of<3>(cloud);
      MovingLeastSquares<3> mls(make_kernel("cubic spline"));
      EXPECT_TRUE(
          mls.compute(cloud.nodes, cloud.position.data(), cloud.support.data(), shared, true)
              .empty());
      const auto [value_difference, gradient_difference] = difference(shared, each);
      EXPECT_LE(value_difference, 1e-12);
      EXPECT_LE(gradient_difference, 1e-12);
      EXPECT_LT(reproduction_error<3>(cloud, shared), 1e-11);
      EXPECT_EQ(shared.gradient.size(), 3 * shared.value.size() + 1);
      if (disorder == 0.)
        // Inside, faces, edges and corners.
        EXPECT_LE(shared.value.size(), 5u * 5u * 5u * 27u);
      else
        EXPECT_EQ(shared.value.size(), shared.neighbour.size());
    }
  }

  TEST(MovingLeastSquares,
       reproduces_linear_fields_after_affine_deformation_with_stretched_supports)
  {
    // Ten to one along a direction off the axes, near volume preserving.
    const double c = std::cos(0.6), s = std::sin(0.6);
    const double rotation[3][3] = {{c, -s, 0}, {s * 0.8, c * 0.8, -0.6}, {s * 0.6, c * 0.6, 0.8}};
    const double stretches[3] = {10., 0.3, 0.35};
    double F[9];
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        F[3 * i + j] = rotation[i][j] * stretches[j];
    ParticleCloud cloud = lattice_cloud<3>(6, 1.8, 0.1);
    const Stencils before = rows_of<3>(cloud);
    for (unsigned int i = 0; i < cloud.size(); ++i)
    {
      const std::vector<double> X(cloud.x(i), cloud.x(i) + 3), a(cloud.a(i), cloud.a(i) + 3);
      for (unsigned int k = 0; k < 3; ++k)
        cloud.position[i * node_stride + k] =
            F[3 * k] * X[0] + F[3 * k + 1] * X[1] + F[3 * k + 2] * X[2];
      SupportSize::stretch<3>(F, a.data(), &cloud.support[i * node_stride]);
    }
    const Stencils after = stencils<3>(cloud);
    EXPECT_LT(reproduction_error<3>(cloud, after), 1e-12);
    for (unsigned int row = 0; row < before.n_particles(); ++row)
      for (std::size_t e = before.row_start[row]; e < before.row_start[row + 1]; ++e)
      {
        const auto begin = after.neighbour.begin() + std::ptrdiff_t(after.row_start[row]);
        const auto end = after.neighbour.begin() + std::ptrdiff_t(after.row_start[row + 1]);
        double farthest = 0; // in initial half widths; lattice neighbours are nearer than 1/1.5
        for (unsigned int d = 0; d < 3; ++d)
        {
          const auto index = [&](const unsigned int node) {
            return d == 0 ? node % 6 : d == 1 ? node / 6 % 6 : node / 36;
          };
          farthest = std::max(farthest, std::abs(double(index(before.particle_node[row])) -
                                                 double(index(before.neighbour[e]))));
        }
        EXPECT_TRUE(farthest > 1 || std::binary_search(begin, end, before.neighbour[e]))
            << "row " << row << " lost neighbour " << before.neighbour[e];
      }
  }

  TEST(SupportSize, is_the_largest_coordinate_difference_within_the_cells_around)
  {
    // Two cells side by side, the second one twice as wide and sheared.
    ParticleCloud cloud;
    const double zero[2] = {0., 0.};
    const double points[6][2] = {{0, 0}, {1, 0}, {3, 0.5}, {0, 1}, {1, 1}, {3, 1.5}};
    for (const auto &point : points)
      cloud.add(point, zero, 2);
    SupportSize::accumulate<2>({0, 1, 3, 4, 1, 2, 4, 5}, 4, cloud.position.data(),
                               cloud.support.data());
    const double expected[6][2] = {{1, 1}, {2, 1.5}, {2, 1}, {1, 1}, {2, 1}, {2, 1.5}};
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int d = 0; d < 2; ++d)
        EXPECT_DOUBLE_EQ(cloud.a(i)[d], expected[i][d]) << "node " << i << ", axis " << d;
  }

  TEST(SupportSize, does_not_grow_under_rotation_and_stretches_with_the_material)
  {
    const double c = std::sqrt(0.5), a[2] = {1.8, 1.8};
    double stretched[2];
    const double rotation[4] = {c, -c, c, c};
    SupportSize::stretch<2>(rotation, a, stretched);
    EXPECT_NEAR(stretched[0], 1.8, 1e-15);
    EXPECT_NEAR(stretched[1], 1.8, 1e-15);
    const double stretch[4] = {10., 0., 0., 0.1};
    SupportSize::stretch<2>(stretch, a, stretched);
    EXPECT_NEAR(stretched[0], 18., 1e-14);
    EXPECT_NEAR(stretched[1], 0.18, 1e-15);
    const double quarter_turn[4] = {0., -1., 1., 0.}, unequal[2] = {1., 3.};
    SupportSize::stretch<2>(quarter_turn, unequal, stretched);
    EXPECT_NEAR(stretched[0], 3., 1e-15);
    EXPECT_NEAR(stretched[1], 1., 1e-15);
  }

  /** Defects of a cloud whose every particle is a neighbour of every other. */
  template <int dim>
  std::vector<BasisDefect> defects_of(const ParticleCloud &cloud, Stencils &shape,
                                      MovingLeastSquares<dim> &mls)
  {
    shape = rows_of<dim>(cloud);
    return mls.compute(cloud.nodes, cloud.position.data(), cloud.support.data(), shape);
  }

  TEST(MovingLeastSquares, gives_collinear_coplanar_and_lonely_particles_the_functions_of_shepard)
  {
    const double a[3] = {2.5, 2.5, 2.5};
    ParticleCloud line, plane, lonely, tilted;
    for (unsigned int i = 0; i < 5; ++i)
    {
      const double on_line[3] = {double(i), 0.5 * i, 0.25 * i};
      line.add(on_line, a, 3);
      for (unsigned int j = 0; j < 5; ++j)
      {
        const double in_plane[3] = {double(i), double(j), 0.};
        plane.add(in_plane, a, 3);
        const double in_tilted[3] = {double(i), double(j), 0.3 * i - 0.7 * j};
        tilted.add(in_tilted, a, 3);
      }
    }
    for (unsigned int i = 0; i < 3; ++i)
    {
      const double x[3] = {10. * i, 0., 0.};
      lonely.add(x, a, 3);
    }
    MovingLeastSquares<3> mls(make_kernel("cubic spline"));
    Stencils shape;
    for (const auto &cloud : {line, plane, lonely, tilted})
    {
      const auto defects = defects_of<3>(cloud, shape, mls);
      ASSERT_EQ(defects.size(), cloud.size());
      for (unsigned int i = 0; i < cloud.size(); ++i)
      {
        EXPECT_EQ(defects[i].row, i);
        EXPECT_GT(defects[i].condition, mls.largest_condition);
        EXPECT_LE(defects[i].n_neighbours, shape.row_start[i + 1] - shape.row_start[i]);
      }
      for (unsigned int i = 0; i < cloud.size(); ++i)
      {
        double sum = 0.;
        for (std::size_t entry = shape.row_start[i]; entry < shape.row_start[i + 1]; ++entry)
        {
          EXPECT_GE(shape.value[entry], 0.);
          sum += shape.value[entry];
        }
        EXPECT_NEAR(sum, 1., 1e-14);
      }
      for (const double gradient : shape.gradient)
        EXPECT_EQ(gradient, 0.);
    }
    EXPECT_EQ(defects_of<3>(lonely, shape, mls)[0].n_neighbours, 1u);
    // In two dimensions the plane determines the basis.
    MovingLeastSquares<2> flat(make_kernel("cubic spline"));
    EXPECT_TRUE(defects_of<2>(plane, shape, flat).empty());
    EXPECT_EQ(defects_of<2>(line, shape, flat).size(), line.size());
  }

  TEST(MovingLeastSquares, reports_only_the_defective_particle_among_good_ones)
  {
    ParticleCloud cloud = lattice_cloud<3>(5, 1.8, 0.2);
    const double x[3] = {30., 30., 30.}, a[3] = {1.8, 1.8, 1.8};
    cloud.add(x, a, 3);
    MovingLeastSquares<3> mls(make_kernel("cubic spline"));
    Stencils shape;
    const auto defects = defects_of<3>(cloud, shape, mls);
    ASSERT_EQ(defects.size(), 1u);
    EXPECT_EQ(defects[0].row, 125u);
    EXPECT_EQ(defects[0].n_neighbours, 1u);

    // As a rigid row its deformation is the identity, wherever it moves; without, it is refused.
    for (double &coordinate : cloud.position)
      coordinate *= 1.25;
    EXPECT_THROW(NodalSmoothing::update_inverse_deformation<3>(cloud.position.data(), shape),
                 RunError);
    shape.rank_deficient_rows = {125};
    NodalSmoothing::update_inverse_deformation<3>(cloud.position.data(), shape);
    for (unsigned int row = 0; row < 126; ++row)
      for (unsigned int j = 0; j < 3; ++j)
        for (unsigned int i = 0; i < 3; ++i)
          EXPECT_NEAR(shape.inverse_deformation[3 * node_stride * row + node_stride * i + j],
                      i != j       ? 0.
                      : row == 125 ? 1.
                                   : 0.8,
                      1e-12);
  }

  TEST(MovingLeastSquares, names_the_dilation_that_would_do)
  {
    // At dilation 0.9 no support has a neighbour; above one, each has those of the lattice.
    const ParticleCloud cloud = lattice_cloud<3>(5, 0.9);
    MovingLeastSquares<3> mls(make_kernel("cubic spline"));
    Stencils shape;
    EXPECT_EQ(defects_of<3>(cloud, shape, mls).size(), cloud.size());
    for (const unsigned int particle : {0u, 62u})
    {
      const double factor = mls.sufficient_support_factor(
          particle, cloud.nodes, cloud.position.data(), cloud.support.data());
      EXPECT_GT(0.9 * factor, 1.);
      EXPECT_LT(0.9 * factor, 1.4);
      EXPECT_TRUE(defects_of<3>(lattice_cloud<3>(5, 0.9 * factor), shape, mls).empty());
    }
    ParticleCloud line;
    const double a[3] = {1.8, 1.8, 1.8};
    for (unsigned int i = 0; i < 5; ++i)
    {
      const double x[3] = {double(i), 0., 0.};
      line.add(x, a, 3);
    }
    EXPECT_EQ(
        mls.sufficient_support_factor(2, line.nodes, line.position.data(), line.support.data()),
        0.);
  }

  TEST(MovingLeastSquares, computes_again_without_allocating)
  {
    const ParticleCloud cloud = lattice_cloud<3>(9, 1.8, 0.2);
    Stencils shape = rows_of<3>(cloud);
    MovingLeastSquares<3> mls(make_kernel("cubic spline"));
    mls.compute(cloud.nodes, cloud.position.data(), cloud.support.data(), shape);
    const std::vector<double> value(shape.value.begin(), shape.value.end());
    const std::size_t memory = allocated_bytes();
    mls.compute(cloud.nodes, cloud.position.data(), cloud.support.data(), shape);
    EXPECT_EQ(memory, allocated_bytes());
    EXPECT_TRUE(std::equal(value.begin(), value.end(), shape.value.begin()));
  }

  /** @p cloud with its axes in another order: axis d of the result is axis order[d]. */
  ParticleCloud permuted(const ParticleCloud &cloud, const std::vector<unsigned int> &order)
  {
    ParticleCloud result = cloud;
    for (unsigned int node = 0; node < cloud.size(); ++node)
      for (unsigned int d = 0; d < order.size(); ++d)
      {
        result.position[node * node_stride + d] = cloud.x(node)[order[d]];
        result.support[node * node_stride + d] = cloud.a(node)[order[d]];
      }
    return result;
  }

  template <int dim>
  std::vector<unsigned int> rows_without_basis(const ParticleCloud &cloud)
  {
    MovingLeastSquares<dim> mls(make_kernel("cubic spline"));
    Stencils shape;
    std::vector<unsigned int> rows;
    for (const BasisDefect &defect : defects_of<dim>(cloud, shape, mls))
      rows.push_back(defect.row);
    return rows;
  }

  TEST(MovingLeastSquares, lacks_a_basis_whatever_the_order_of_the_axes)
  {
    // Nearly in a line that is nearly the y axis: the pivots of the moments are 1, 1e-5 and 1e-5
    // with x before y, and 1, 1 and 1e-10 with y before x.
    ParticleCloud line;
    const double a[3] = {1.8, 1.8, 1.8};
    for (const auto &[x, y] : {std::array<double, 2>{{0., 0.}}, {{4.01e-3, 1.}}, {{-3.99e-3, -1.}}})
    {
      const double position[3] = {x, y, 0.};
      line.add(position, a, 2);
    }
    EXPECT_EQ(rows_without_basis<2>(line).size(), 3u);
    EXPECT_EQ(rows_without_basis<2>(permuted(line, {1, 0})).size(), 3u);

    // Five particles at random, flatter and flatter.
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> uniform(-1., 1.);
    unsigned int n_defects = 0;
    constexpr unsigned int n_clouds = 100;
    for (unsigned int k = 0; k < n_clouds; ++k)
    {
      ParticleCloud cloud;
      const double flatness = std::pow(10., -6. * k / n_clouds);
      const double slope[2] = {0.1 * uniform(generator), 0.01 * uniform(generator)};
      for (unsigned int i = 0; i < 5; ++i)
      {
        double x[3] = {flatness * uniform(generator), uniform(generator), uniform(generator)};
        x[0] += slope[0] * x[1] + slope[1] * x[2];
        cloud.add(x, a, 3);
      }
      const std::vector<unsigned int> rows = rows_without_basis<3>(cloud);
      n_defects += static_cast<unsigned int>(rows.size());
      for (const std::vector<unsigned int> &order :
           {std::vector<unsigned int>{0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}})
        EXPECT_EQ(rows_without_basis<3>(permuted(cloud, order)), rows);
    }
    EXPECT_GT(n_defects, n_clouds);
    EXPECT_LT(n_defects, 4 * n_clouds);
  }
} // namespace
