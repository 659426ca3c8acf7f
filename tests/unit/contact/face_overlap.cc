// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/contact/face_overlap.h>
#include <tombolo/contact/pairing.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

using namespace tombolo;
using dealii::Tensor;

namespace
{
  template <int dim>
  struct OverlapPoint
  {
    double weight;
    std::array<double, (1u << (dim - 1))> slave_values, master_values;
  };

  template <int dim>
  std::vector<OverlapPoint<dim>> common_points(const FaceCorners<dim> &slave,
                                               const FaceCorners<dim> &master)
  {
    FaceOverlap<dim> overlap(slave);
    overlap.find(master);
    std::vector<OverlapPoint<dim>> points(overlap.n_points());
    for (unsigned int q = 0; q < points.size(); ++q)
    {
      points[q].weight = overlap.weights()[q];
      for (unsigned int k = 0; k < overlap.n_corners; ++k)
      {
        points[q].slave_values[k] = overlap.of_slave(k)[q];
        points[q].master_values[k] = overlap.of_master(k)[q];
      }
    }
    return points;
  }

  /** A plane surface of faces at y (in three dimensions z) = @p height, turned by 30 degrees. */
  template <int dim>
  struct Surface
  {
    static constexpr unsigned int n_corners = 1u << (dim - 1);
    std::vector<Tensor<1, dim>> nodes;
    std::vector<std::array<unsigned int, n_corners>> faces;

    Surface(const unsigned int n, const double ratio, const double height)
    {
      std::vector<double> line{0.};
      for (unsigned int i = 0; i < n; ++i)
        line.push_back(line.back() + std::pow(ratio, double(i) / (n - 1)));
      for (double &x : line)
        x /= line.back();
      const double c = std::cos(M_PI / 6.), s = std::sin(M_PI / 6.);
      const unsigned int n_rows = dim == 2 ? 1 : n + 1;
      for (unsigned int j = 0; j < n_rows; ++j)
        for (unsigned int i = 0; i <= n; ++i)
        {
          Tensor<1, dim> x;
          x[0] = c * line[i] - s * height;
          x[dim - 1] = s * line[i] + c * height;
          if (dim == 3)
            x[1] = line[j];
          nodes.push_back(x);
        }
      for (unsigned int j = 0; j < (dim == 2 ? 1 : n); ++j)
        for (unsigned int i = 0; i < n; ++i)
        {
          std::array<unsigned int, n_corners> face;
          for (unsigned int k = 0; k < n_corners; ++k)
            face[k] = (j + k / 2) * (n + 1) + i + k % 2;
          faces.push_back(face);
        }
    }

    FaceCorners<dim> corners(const std::size_t face) const
    {
      FaceCorners<dim> result;
      for (unsigned int k = 0; k < n_corners; ++k)
        result[k] = nodes[faces[face][k]];
      return result;
    }

    /** ∫ N dA. */
    std::vector<double> areas() const
    {
      std::vector<double> result(nodes.size(), 0.);
      for (std::size_t f = 0; f < faces.size(); ++f)
        for (const unsigned int node : faces[f])
          result[node] += area_vector<dim>(corners(f)).norm() / n_corners;
      return result;
    }
  };

  /** How a gap that is the same everywhere presses: forces of nodes over their share of a uniform
   * pressure with the same resultant, minus one, the largest magnitude of both sides. */
  template <int dim>
  class Press
  {
  public:
    Press(const unsigned int n_slave, const double slave_ratio, const unsigned int n_master,
          const double master_ratio)
        : slave(n_slave, slave_ratio, 0.), master(n_master, master_ratio, gap),
          n_slave_nodes(slave.nodes.size()), n_master_nodes(master.nodes.size()),
          slave_matrix(n_slave_nodes * n_slave_nodes, 0.),
          master_matrix(n_slave_nodes * n_master_nodes, 0.), area(n_slave_nodes, 0.)
    {
      for (std::size_t s = 0; s < slave.faces.size(); ++s)
        for (std::size_t m = 0; m < master.faces.size(); ++m)
          for (const auto &point : common_points<dim>(slave.corners(s), master.corners(m)))
            for (unsigned int i = 0; i < slave.n_corners; ++i)
              for (unsigned int j = 0; j < slave.n_corners; ++j)
              {
                const double weight = point.weight * point.slave_values[i];
                const std::size_t row = slave.faces[s][i];
                slave_matrix[row * n_slave_nodes + slave.faces[s][j]] +=
                    weight * point.slave_values[j];
                master_matrix[row * n_master_nodes + master.faces[m][j]] +=
                    weight * point.master_values[j];
                area[row] += weight * point.slave_values[j];
              }
    }

    /** Mean gap of a slave node along the normal, over the true one, minus one. */
    double error_of_gaps() const
    {
      double worst = 0;
      const Tensor<1, dim> normal = area_vector<dim>(slave.corners(0));
      for (std::size_t i = 0; i < n_slave_nodes; ++i)
      {
        Tensor<1, dim> sum;
        for (std::size_t l = 0; l < n_master_nodes; ++l)
          sum += master_matrix[i * n_master_nodes + l] * master.nodes[l];
        for (std::size_t j = 0; j < n_slave_nodes; ++j)
          sum -= slave_matrix[i * n_slave_nodes + j] * slave.nodes[j];
        const double mean = std::abs(sum * normal) / normal.norm() / area[i];
        worst = std::max(worst, std::abs(mean / gap - 1.));
      }
      return worst;
    }

    /** For pressures @p p of slave nodes. */
    double error_of_forces(const std::vector<double> &p) const
    {
      std::vector<double> on_slave(n_slave_nodes, 0.), on_master(n_master_nodes, 0.);
      for (std::size_t i = 0; i < n_slave_nodes; ++i)
      {
        for (std::size_t j = 0; j < n_slave_nodes; ++j)
          on_slave[j] += slave_matrix[i * n_slave_nodes + j] * p[i];
        for (std::size_t l = 0; l < n_master_nodes; ++l)
          on_master[l] += master_matrix[i * n_master_nodes + l] * p[i];
      }
      return std::max(deviation(on_slave, slave.areas()), deviation(on_master, master.areas()));
    }

    static double deviation(const std::vector<double> &force, const std::vector<double> &share)
    {
      const double pressure = std::accumulate(force.begin(), force.end(), 0.) /
                              std::accumulate(share.begin(), share.end(), 0.);
      double worst = 0;
      for (std::size_t i = 0; i < force.size(); ++i)
        worst = std::max(worst, std::abs(force[i] / (pressure * share[i]) - 1.));
      return worst;
    }

    static constexpr double gap = 1e-3;
    Surface<dim> slave, master;
    std::size_t n_slave_nodes, n_master_nodes;
    std::vector<double> slave_matrix, master_matrix, area;
  };

  template <int dim>
  void check_patch(const unsigned int n_slave, const double slave_ratio,
                   const unsigned int n_master, const double master_ratio)
  {
    const Press<dim> press(n_slave, slave_ratio, n_master, master_ratio);
    EXPECT_LE(press.error_of_gaps(), 1e-11);
    // Normalized: the pressure follows the mean gap, which is the same everywhere.
    EXPECT_LE(press.error_of_forces(std::vector<double>(press.n_slave_nodes, 1.)), 1e-11);
    // Negative control, without division by the area: the pressure follows gap times area.
    EXPECT_GE(press.error_of_forces(press.area), 1e-2);
  }
} // namespace

TEST(FaceOverlap, AUniformGapIsAUniformPressureOnBothSidesInTwoDimensions)
{
  check_patch<2>(5, 2.5, 7, 0.4);
  check_patch<2>(7, 0.4, 5, 2.5);
}

TEST(FaceOverlap, AUniformGapIsAUniformPressureOnBothSidesInThreeDimensions)
{
  check_patch<3>(5, 2.5, 7, 0.4);
  check_patch<3>(7, 0.4, 5, 2.5);
}

TEST(FaceOverlap, NodesAgainstFacesFailThePatchTest)
{
  // A spring at each slave node, its force shared out by the shape functions of the master face
  // that it is in: negative control of the mortar.
  const Surface<2> slave(5, 2.5, 0.), master(7, 0.4, 0.);
  const std::vector<double> on_slave = slave.areas();
  std::vector<double> on_master(master.nodes.size(), 0.);
  for (std::size_t i = 0; i < slave.nodes.size(); ++i)
    for (const auto &face : master.faces)
    {
      const Tensor<1, 2> along = master.nodes[face[1]] - master.nodes[face[0]];
      const double coordinate =
          (slave.nodes[i] - master.nodes[face[0]]) * along / along.norm_square();
      if (coordinate < -1e-12 || coordinate > 1. - (i + 1 < slave.nodes.size() ? 1e-12 : -1e-12))
        continue;
      on_master[face[0]] += (1. - coordinate) * on_slave[i];
      on_master[face[1]] += coordinate * on_slave[i];
    }
  EXPECT_NEAR(std::accumulate(on_master.begin(), on_master.end(), 0.), 1., 1e-12);
  EXPECT_GE(Press<2>::deviation(on_master, master.areas()), 1e-2);
}

TEST(FaceOverlap, TheCommonPartOfTurnedSquaresIsAnOctagon)
{
  const double r = 1.2 / std::sqrt(2.);
  const FaceCorners<3> square{{Tensor<1, 3>({-.5, -.5, 0.}), Tensor<1, 3>({.5, -.5, 0.}),
                               Tensor<1, 3>({-.5, .5, 0.}), Tensor<1, 3>({.5, .5, 0.})}};
  const FaceCorners<3> turned{{Tensor<1, 3>({0., -r, .1}), Tensor<1, 3>({-r, 0., .1}),
                               Tensor<1, 3>({r, 0., .1}), Tensor<1, 3>({0., r, .1})}};
  // The corners of the square beyond the lines |x| + |y| = r.
  const double cut = 1. - r;
  double area = 0;
  for (const auto &point : common_points<3>(square, turned))
  {
    area += point.weight;
    EXPECT_NEAR(std::accumulate(point.slave_values.begin(), point.slave_values.end(), 0.), 1.,
                1e-14);
    EXPECT_NEAR(std::accumulate(point.master_values.begin(), point.master_values.end(), 0.), 1.,
                1e-14);
    for (const double value : point.slave_values)
      EXPECT_GE(value, -1e-14);
    for (const double value : point.master_values)
      EXPECT_GE(value, -1e-14);
    // Both sides have the same point of the plane.
    Tensor<1, 3> difference;
    for (unsigned int k = 0; k < 4; ++k)
      difference += point.slave_values[k] * square[k] - point.master_values[k] * turned[k];
    EXPECT_NEAR(difference[0], 0., 1e-14);
    EXPECT_NEAR(difference[1], 0., 1e-14);
  }
  EXPECT_NEAR(area, 1. - 2. * cut * cut, 1e-14);
}

TEST(FaceOverlap, WeightsDoNotDependOnTheNumberingOfCorners)
{
  // Neither face is a parallelogram, and both are warped.
  const FaceCorners<3> slave{{Tensor<1, 3>({0., 0., 0.}), Tensor<1, 3>({1.1, .1, .03}),
                              Tensor<1, 3>({-.1, .9, .02}), Tensor<1, 3>({.8, 1.2, -.05})}};
  const FaceCorners<3> master{{Tensor<1, 3>({.3, -.2, .1}), Tensor<1, 3>({1.3, .4, .07}),
                               Tensor<1, 3>({-.3, .7, .13}), Tensor<1, 3>({.9, 1., .1})}};
  using Weights = std::array<std::array<std::array<double, 4>, 4>, 2>;
  const auto weights_of = [&](const std::array<unsigned int, 4> &slave_numbering,
                              const std::array<unsigned int, 4> &master_numbering)
  {
    FaceCorners<3> numbered_slave, numbered_master;
    for (unsigned int k = 0; k < 4; ++k)
    {
      numbered_slave[k] = slave[slave_numbering[k]];
      numbered_master[k] = master[master_numbering[k]];
    }
    Weights result{};
    for (const auto &point : common_points<3>(numbered_slave, numbered_master))
      for (unsigned int i = 0; i < 4; ++i)
        for (unsigned int j = 0; j < 4; ++j)
        {
          const double weight = point.weight * point.slave_values[i];
          result[0][slave_numbering[i]][slave_numbering[j]] += weight * point.slave_values[j];
          result[1][slave_numbering[i]][master_numbering[j]] += weight * point.master_values[j];
        }
    return result;
  };
  const std::vector<std::array<unsigned int, 4>> numberings{
      {{0, 1, 2, 3}}, {{1, 0, 3, 2}}, {{2, 3, 0, 1}}, {{3, 2, 1, 0}},
      {{0, 2, 1, 3}}, {{2, 0, 3, 1}}, {{1, 3, 0, 2}}, {{3, 1, 2, 0}}};
  const Weights first = weights_of(numberings[0], numberings[0]);
  for (const auto &slave_numbering : numberings)
    for (const auto &master_numbering : numberings)
    {
      const Weights other = weights_of(slave_numbering, master_numbering);
      for (unsigned int side = 0; side < 2; ++side)
        for (unsigned int i = 0; i < 4; ++i)
          for (unsigned int j = 0; j < 4; ++j)
            EXPECT_NEAR(other[side][i][j], first[side][i][j], 1e-14);
    }
}

TEST(FaceOverlap, FacesBesideEachOtherHaveNothingInCommon)
{
  const FaceCorners<2> line{{Tensor<1, 2>({0., 0.}), Tensor<1, 2>({1., 0.})}};
  EXPECT_TRUE(common_points<2>(line, {{Tensor<1, 2>({1., .1}), Tensor<1, 2>({2., .1})}}).empty());
  const auto lines = common_points<2>(line, {{Tensor<1, 2>({.75, .1}), Tensor<1, 2>({2., .1})}});
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_NEAR(lines[0].weight + lines[1].weight, 0.25, 1e-15);
}

TEST(MortarPairing, FacesTouchWhereTheyAreNear)
{
  const Parameters parameters(MPI_COMM_SELF);
  const auto pairing =
      Registry<Pairing<3>>::instance().create("touching", parameters.section("contact"));
  const FaceCorners<3> flat{{Tensor<1, 3>({0., 0., 0.}), Tensor<1, 3>({1., 0., 0.}),
                             Tensor<1, 3>({0., 1., 0.}), Tensor<1, 3>({1., 1., 0.})}};
  FaceCorners<3> inclined = flat;
  for (auto &corner : inclined)
    corner[2] = 2. * corner[0];
  const PairedFace<3> slave{0, 1., flat, area_vector<3>(flat)};
  const std::vector<PairedFace<3>> masters{{0, 1., inclined, -1. * area_vector<3>(inclined)}};
  std::vector<FacePair<3>> pairs;
  pairing->find(slave, masters, pairs);
  ASSERT_EQ(pairs.size(), 1u);
  double area = 0, master_area = 0;
  for (unsigned int i = 0; i < 4; ++i)
    for (unsigned int j = 0; j < 4; ++j)
    {
      area += pairs[0].of_slave[i][j];
      master_area += pairs[0].of_master[i][j];
    }
  // As far as the distance is at most reach(): up to the nearest points of the quadrature.
  EXPECT_NEAR(area, pairing->reach() / 2., 0.2);
  EXPECT_NEAR(master_area, area, 1e-15);
}
