// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material_testing.h"
#include "tool_surfaces.h"

#include <tombolo/contact/surfaces/rigid_mesh.h>
#include <tombolo/contact/surfaces/rigid_profile.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      using dealii::Tensor;
      using ProfilePoint = RigidProfile::Point;

      /** A friction drill of 36 degrees. */
      const std::vector<ProfilePoint> drill = {
          {0., 0.}, {1., 1. / std::tan(dealii::numbers::PI / 10.)}, {1., 5.}, {0., 5.}};

      class Points
      {
      public:
        Tensor<1, 3> operator()(const Tensor<1, 3> &low, const Tensor<1, 3> &high)
        {
          Tensor<1, 3> result;
          for (unsigned int d = 0; d < 3; ++d)
            result[d] = low[d] + (high[d] - low[d]) * uniform(generator);
          return result;
        }

      private:
        std::mt19937 generator{5};
        std::uniform_real_distribution<double> uniform{0., 1.};
      };

      FacetList<3> together(FacetList<3> first, const FacetList<3> &second)
      {
        const auto n = static_cast<unsigned int>(first.vertices.size());
        first.vertices.insert(first.vertices.end(), second.vertices.begin(), second.vertices.end());
        for (FacetList<3>::Facet facet : second.facets)
        {
          for (unsigned int &vertex : facet.vertex)
            vertex += n;
          first.facets.push_back(facet);
        }
        return first;
      }

      RigidMesh<3> mesh_of(const FacetList<3> &list, const double edge_radius)
      {
        return RigidMesh<3>(ClosedSurface<3>(list), edge_radius);
      }

      /** The unit box with its edges rounded. */
      double gap_to_box(const Tensor<1, 3> &point, const double edge_radius, Tensor<1, 3> &normal)
      {
        Tensor<1, 3> outside;
        double inside = 1.;
        for (unsigned int d = 0; d < 3; ++d)
        {
          const double from_middle = point[d] - 0.5, beyond = std::abs(from_middle) - 0.5;
          outside[d] = std::copysign(std::max(beyond + edge_radius, 0.), from_middle);
          inside = std::min(inside, -beyond);
          if (-beyond == inside)
          {
            normal = 0.;
            normal[d] = std::copysign(1., from_middle);
          }
        }
        if (inside > edge_radius)
          return -inside;
        normal = outside / outside.norm();
        return outside.norm() - edge_radius;
      }

      TEST(RigidMesh, of_a_surface_that_passes_through_itself_is_refused)
      {
        const FacetList<3> unit = unit_box();
        const auto shifted = [&](const double x, const double y, const double z)
        {
          FacetList<3> list = unit;
          for (Tensor<1, 3> &vertex : list.vertices)
            vertex += Tensor<1, 3>({x, y, z});
          return list;
        };
        for (const double edge_radius : {0., 0.1})
        {
          EXPECT_THROW(mesh_of(together(unit, shifted(0.6, 0.5, 0.7)), edge_radius),
                       std::invalid_argument);
          // A thin bar through two sides, no edge of which the box's edges meet.
          FacetList<3> bar = shifted(0.4, 0.45, -0.5);
          for (Tensor<1, 3> &vertex : bar.vertices)
          {
            vertex[0] = 0.4 + 0.25 * (vertex[0] - 0.4);
            vertex[1] = 0.45 + 0.25 * (vertex[1] - 0.45);
            vertex[2] = 3. * vertex[2];
          }
          EXPECT_THROW(mesh_of(together(unit, bar), edge_radius), std::invalid_argument);
          EXPECT_NO_THROW(mesh_of(together(unit, shifted(1.01, 0.5, 0.7)), edge_radius));
        }
        try
        {
          mesh_of(together(unit, shifted(0.6, 0.5, 0.7)), 0.);
        }
        catch (const std::invalid_argument &error)
        {
          EXPECT_NE(std::string(error.what()).find("passes through itself at ("), std::string::npos)
              << error.what();
        }
        // A polygon like a loop.
        FacetList<2> loop;
        for (const auto &[x, y] : {std::pair(0., 0.), {4., 0.}, {4., 3.}, {1., -1.}})
          loop.vertices.push_back(Tensor<1, 2>({x, y}));
        for (unsigned int k = 0; k < 4; ++k)
          loop.facets.push_back({{k, (k + 1) % 4}});
        EXPECT_THROW(RigidMesh<2>(ClosedSurface<2>(loop), 0.), std::invalid_argument);
      }

      TEST(RigidMesh, of_a_box_is_a_box)
      {
        for (const double edge_radius : {0., 0.1, 0.4})
        {
          const RigidMesh<3> mesh = mesh_of(unit_box(), edge_radius);
          Points random;
          for (unsigned int i = 0; i < 5000; ++i)
          {
            const Tensor<1, 3> point =
                random(Tensor<1, 3>({-0.5, -0.5, -0.5}), Tensor<1, 3>({1.5, 1.5, 1.5}));
            const auto nearest = mesh.nearest(point);
            Tensor<1, 3> normal;
            const double sharp = gap_to_box(point, 0., normal);
            const double gap = sharp < 0. ? gap_to_box(point, edge_radius, normal) : sharp;
            ASSERT_NEAR(nearest.gap, gap, 1e-9);
            ASSERT_NEAR((nearest.normal - normal).norm(), 0., 1e-7);
            const double gap_or_less = mesh.gap_or_less(point);
            ASSERT_LE(gap_or_less, nearest.gap + 1e-14);
            ASSERT_EQ(gap_or_less > 0., nearest.gap > 0.);
            ASSERT_TRUE(gap_or_less > 0. || gap_or_less == nearest.gap);
          }
        }
      }

      TEST(RigidMesh, within_its_reach_gaps_outside_are_those_to_the_rounded_box)
      {
        constexpr double reach = 0.3;
        for (const double edge_radius : {0., 0.1, 0.4})
        {
          RigidMesh<3> mesh = mesh_of(unit_box(), edge_radius);
          mesh.set_reach(reach);
          Points random;
          unsigned int n_near = 0;
          for (unsigned int i = 0; i < 5000; ++i)
          {
            const Tensor<1, 3> point =
                random(Tensor<1, 3>({-0.5, -0.5, -0.5}), Tensor<1, 3>({1.5, 1.5, 1.5}));
            Tensor<1, 3> normal;
            const double gap = gap_to_box(point, edge_radius, normal);
            const double found = mesh.gap_or_less(point);
            if (gap > reach)
            {
              // The sharp edge may be nearer, but not so near.
              ASSERT_GT(found, reach - edge_radius * (std::sqrt(3.) - 1.) - 1e-9);
              ASSERT_LE(found, gap + 1e-9);
              continue;
            }
            n_near += gap > 0. ? 1 : 0;
            ASSERT_NEAR(found, gap, 1e-9);
            if (std::abs(gap) > 1e-3)
            {
              ASSERT_NEAR((mesh.nearest(point).normal - normal).norm(), 0., 1e-6);
            }
          }
          EXPECT_GT(n_near, 500u);
        }
      }

      TEST(RigidMesh, gap_is_a_distance_with_the_normal_as_its_gradient)
      {
        const RigidMesh<3> mesh = mesh_of(revolved(stepped, 9), 0.);
        Points random;
        const Tensor<1, 3> low({-4., -4., -1.}), high({4., 4., 5.});
        for (unsigned int i = 0; i < 5000; ++i)
        {
          const auto a = random(low, high), b = random(low, high);
          const auto nearest_a = mesh.nearest(a), nearest_b = mesh.nearest(b);
          ASSERT_LE(std::abs(nearest_a.gap - nearest_b.gap), (a - b).norm() + 1e-13);
          ASSERT_NEAR(nearest_a.normal.norm(), 1., 1e-13);
          ASSERT_NEAR(mesh.nearest(a - nearest_a.gap * nearest_a.normal).gap, 0., 1e-12);
          if (nearest_a.gap > 0.1)
          {
            ASSERT_NEAR(mesh.nearest(a - 0.05 * nearest_a.normal).gap, nearest_a.gap - 0.05, 1e-12);
          }
        }
      }

      TEST(RigidMesh, with_many_facets_is_the_body_of_revolution)
      {
        constexpr unsigned int n = 240;
        // The middle of a side of the polygon is this far within the circle.
        const double sagitta = 3. * (1. - std::cos(dealii::numbers::PI / n));
        for (const double edge_radius : {0., 0.3})
        {
          const RigidMesh<3> mesh = mesh_of(revolved(stepped, n), edge_radius);
          const RigidProfile profile(stepped, edge_radius);
          Points random;
          unsigned int n_touching = 0;
          for (unsigned int i = 0; i < 20000; ++i)
          {
            const auto point =
                random(Tensor<1, 3>({-3.2, -3.2, -0.2}), Tensor<1, 3>({3.2, 3.2, 4.2}));
            const double r = std::hypot(point[0], point[1]);
            const auto nearest = mesh.nearest(point);
            const auto exact = profile.nearest({r, point[2]});
            if (std::abs(exact.gap) > 2. * sagitta)
            {
              ASSERT_EQ(nearest.gap < 0., exact.gap < 0.);
            }
            if (!(exact.gap < 0.) || (edge_radius > 0. && exact.gap < -0.95 * edge_radius))
              continue;
            ASSERT_NEAR(nearest.gap, exact.gap, 2. * sagitta) << point;
            if (edge_radius > 0. && r > 0.2)
            {
              const Tensor<1, 3> normal(
                  {exact.normal.r * point[0] / r, exact.normal.r * point[1] / r, exact.normal.z});
              ASSERT_LT((nearest.normal - normal).norm(), 0.07) << point << " " << exact.gap;
              ++n_touching;
            }
          }
          if (edge_radius > 0.)
          {
            EXPECT_GT(n_touching, 1000u);
          }
        }
      }

      /** The largest jump of the force of a unit spring on a node along a way of n steps. */
      double largest_jump(const RigidMesh<3> &mesh, const std::function<Tensor<1, 3>(double)> &way,
                          const unsigned int n)
      {
        double jump = 0;
        Tensor<1, 3> last;
        for (unsigned int i = 0; i <= n; ++i)
        {
          const auto nearest = mesh.nearest(way(double(i) / n));
          const Tensor<1, 3> force = std::max(-nearest.gap, 0.) * nearest.normal;
          if (i > 0)
            jump = std::max(jump, (force - last).norm());
          last = force;
        }
        return jump;
      }

      /** That jumps fall with the steps, as those of a continuous force do, and do not without
       * rounding. */
      void expect_continuity(const FacetList<3> &list, const double edge_radius,
                             const std::function<Tensor<1, 3>(double)> &way, const double depth)
      {
        const RigidMesh<3> rounded = mesh_of(list, edge_radius), sharp = mesh_of(list, 0.);
        const double coarse = largest_jump(rounded, way, 4000);
        EXPECT_LT(coarse, 0.2 * depth);
        EXPECT_LT(largest_jump(rounded, way, 40000), 0.15 * coarse);
        EXPECT_GT(largest_jump(sharp, way, 40000), 0.5 * depth);
      }

      TEST(RigidMesh, force_on_a_node_that_passes_edges_and_corners_is_continuous)
      {
        for (const double depth : {0.02, 0.1, 0.18})
        {
          // Around the box in a plane: over four edges.
          const auto around = [=](const double s)
          {
            const double side = 1. - 2. * depth, t = 4. * s;
            const auto k = static_cast<unsigned int>(std::min(t, 3.999999));
            const double along = side * (t - k);
            const double x[4] = {along, side, side - along, 0.},
                         y[4] = {0., along, side, side - along};
            return Tensor<1, 3>({depth + x[k], depth + y[k], 0.4});
          };
          expect_continuity(unit_box(), 0.2, around, depth);
          // Along a diagonal of one side and another's, under the corner between them.
          const auto over_corner = [=](const double s)
          {
            const double t = std::abs(2. * s - 1.);
            const double away = depth + 0.5 * t;
            return s < 0.5 ? Tensor<1, 3>({away, away, depth}) : Tensor<1, 3>({depth, away, away});
          };
          expect_continuity(unit_box(), 0.2, over_corner, depth);
        }
      }

      TEST(RigidMesh, force_on_a_node_that_goes_around_a_cone_and_along_it_is_continuous)
      {
        const FacetList<3> cone = revolved(drill, 12);
        const double slope = std::tan(dealii::numbers::PI / 10.), radius = 0.15;
        for (const double depth : {0.02, 0.08, 0.13})
        {
          // Over twelve edges.
          const auto around = [=](const double s)
          {
            const double angle = 2. * dealii::numbers::PI * s;
            const double r = 2. * slope - depth;
            return Tensor<1, 3>({r * std::cos(angle), r * std::sin(angle), 2.});
          };
          const RigidMesh<3> mesh = mesh_of(cone, radius);
          const double coarse = largest_jump(mesh, around, 4000);
          EXPECT_LT(coarse, 0.05 * depth);
          EXPECT_LT(largest_jump(mesh, around, 40000), 0.15 * coarse);
          // Under the rounded tip, and over the edge between cone and cylinder and that of the end.
          const double tip = radius / std::sin(dealii::numbers::PI / 10.) - radius;
          const auto past_tip = [=](const double s) {
            return Tensor<1, 3>({0.4 * (s - 0.5), 0.03, tip + depth});
          };
          const double at_tip = largest_jump(mesh, past_tip, 4000);
          EXPECT_LT(at_tip, 0.2 * depth);
          EXPECT_LT(largest_jump(mesh, past_tip, 40000), 0.15 * at_tip);
          const auto up = [=](const double s)
          {
            const double height = 2. + 3. * s * 1.2;
            const double r =
                std::min(height * slope, 1.) * std::cos(dealii::numbers::PI / 12.) - depth;
            const double angle = dealii::numbers::PI / 12. + 0.02;
            return height < 5. - depth
                       ? Tensor<1, 3>({r * std::cos(angle), r * std::sin(angle), height})
                       : Tensor<1, 3>({(r - (height - 5. + depth)) * std::cos(angle),
                                       (r - (height - 5. + depth)) * std::sin(angle), 5. - depth});
          };
          expect_continuity(cone, radius, up, depth);
        }
      }

      TEST(RigidMesh, force_on_a_node_at_concave_edges_is_continuous)
      {
        const FacetList<3> list = revolved(stepped, 10);
        const RigidMesh<3> rounded = mesh_of(list, 0.3), sharp = mesh_of(list, 0.);
        for (const double depth : {0.02, 0.15, 0.25})
        {
          // From the pin into its shoulder, in an odd direction, and around the ring between.
          const auto into_shoulder = [=](const double s)
          {
            const double r = s < 0.5 ? 0.95 - depth : 0.95 - depth + 2.2 * (s - 0.5);
            const double z = s < 0.5 ? 1.5 + (1. + 2. * depth) * s : 2. + depth;
            return Tensor<1, 3>({r * std::cos(0.21), r * std::sin(0.21), z});
          };
          const auto around = [=](const double s)
          {
            const double angle = 2. * dealii::numbers::PI * s;
            const double r = 0.95 - 0.7 * depth;
            return Tensor<1, 3>({r * std::cos(angle), r * std::sin(angle), 2. + 0.7 * depth});
          };
          for (const std::function<Tensor<1, 3>(double)> &way :
               {std::function<Tensor<1, 3>(double)>(into_shoulder),
                std::function<Tensor<1, 3>(double)>(around)})
          {
            const double coarse = largest_jump(rounded, way, 4000);
            EXPECT_LT(coarse, 0.1 * depth + 1e-3);
            EXPECT_LT(largest_jump(rounded, way, 40000), 0.15 * coarse + 1e-9);
          }
        }
      }

      TEST(RigidMesh, tells_inside_from_outside_at_sharp_edges_and_corners)
      {
        // A thin wedge, whose corners join facets of very different angles.
        FacetList<3> wedge = unit_box();
        for (const unsigned int v : {1u, 3u, 5u, 7u})
          wedge.vertices[v][2] = 0.001 * wedge.vertices[v][2];
        const RigidMesh<3> mesh = mesh_of(wedge, 0.);
        Points random;
        for (unsigned int i = 0; i < 20000; ++i)
        {
          const auto point = random(Tensor<1, 3>({0.9, -0.1, -0.1}), Tensor<1, 3>({1.1, 1.1, 0.2}));
          const bool is_inside = point[0] < 1. && point[1] > 0. && point[1] < 1. && point[2] > 0. &&
                                 point[2] < 1. - 0.999 * point[0];
          ASSERT_EQ(mesh.nearest(point).gap < 0., is_inside) << point;
        }
      }

      TEST(RigidMesh, without_room_for_its_edge_radius_is_refused)
      {
        FacetList<3> plate = unit_box();
        for (Tensor<1, 3> &vertex : plate.vertices)
          vertex[2] *= 0.3;
        EXPECT_THROW(mesh_of(plate, 0.151), std::invalid_argument);
        EXPECT_NO_THROW(mesh_of(plate, 0.149));
      }

      TEST(RevolvedTool, has_a_normal_on_its_axis)
      {
        // Deep inside of a needle the nearest side is across, in any direction.
        const auto needle = make_plugin<ContactSurface<3>>(
            "profile", "set Corners = 0, 0; 1, 0; 1, 20; 0, 20\nset Origin = 1, 2, 3\n"
                       "set Axis = 0, 1, 1\n");
        const double along = std::sqrt(0.5);
        const Tensor<1, 3> axis({0., along, along}), origin({1., 2., 3.});
        const auto across = needle->normal(origin + 10. * axis, 0.);
        EXPECT_NEAR(across.norm(), 1., 1e-14);
        EXPECT_NEAR(across * axis, 0., 1e-14);
        EXPECT_NEAR((needle->normal(origin + 0.5 * axis, 0.) + axis).norm(), 0., 1e-14);
        const auto strip = make_plugin<ContactSurface<2>>(
            "profile", "set Corners = 0, 0; 1, 0; 1, 20; 0, 20\nset Origin = 1, 2\n");
        const auto sideways = strip->normal(Tensor<1, 2>({1., 12.}), 0.);
        EXPECT_NEAR(std::abs(sideways[0]), 1., 1e-14);
        EXPECT_NEAR(sideways[1], 0., 1e-14);
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
