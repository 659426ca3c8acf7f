// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material_testing.h"
#include "text_testing.h"
#include "tool_surfaces.h"

#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/surfaces/rigid_profile.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      using ProfilePoint = RigidProfile::Point;

      double distance(const ProfilePoint &a, const ProfilePoint &b)
      {
        return std::hypot(a.r - b.r, a.z - b.z);
      }

      class RandomPoints
      {
      public:
        ProfilePoint operator()(const double largest_r, const double low, const double high)
        {
          return {largest_r * uniform(generator), low + (high - low) * uniform(generator)};
        }

      private:
        std::mt19937 generator{7};
        std::uniform_real_distribution<double> uniform{0., 1.};
      };

      TEST(RigidProfile, square_with_the_edge_radius_of_a_disc_is_a_sphere)
      {
        const RigidProfile sphere({{0., -2.}, {2., -2.}, {2., 2.}, {0., 2.}}, 2.);
        RandomPoints random;
        for (unsigned int i = 0; i < 1000; ++i)
        {
          const ProfilePoint point = random(4., -4., 4.);
          const double size = std::hypot(point.r, point.z);
          const auto nearest = sphere.nearest(point);
          ASSERT_NEAR(nearest.gap, size - 2., 1e-14);
          ASSERT_NEAR(nearest.normal.r, point.r / size, 1e-13);
          ASSERT_NEAR(nearest.normal.z, point.z / size, 1e-13);
        }
      }

      TEST(RigidProfile, gap_is_a_distance_with_the_normal_as_its_gradient)
      {
        for (const double edge_radius : {0., 0.3})
        {
          const RigidProfile profile(stepped, edge_radius);
          RandomPoints random;
          for (unsigned int i = 0; i < 2000; ++i)
          {
            const ProfilePoint a = random(5., -1., 5.), b = random(5., -1., 5.);
            const auto nearest_a = profile.nearest(a), nearest_b = profile.nearest(b);
            ASSERT_LE(std::abs(nearest_a.gap - nearest_b.gap), distance(a, b) + 1e-14);
            ASSERT_NEAR(std::hypot(nearest_a.normal.r, nearest_a.normal.z), 1., 1e-13);
            ASSERT_LE(profile.distance_from_box(a), std::max(0., nearest_a.gap) + 1e-14);
            // The point that the gap and the normal lead to is on the surface.
            const ProfilePoint foot = {a.r - nearest_a.gap * nearest_a.normal.r,
                                       a.z - nearest_a.gap * nearest_a.normal.z};
            ASSERT_NEAR(profile.nearest(foot).gap, 0., 1e-13) << a.r << ", " << a.z;
          }
        }
      }

      TEST(RigidProfile, inside_and_outside_are_told_apart_at_edges_of_both_kinds)
      {
        const RigidProfile profile(stepped, 0.);
        for (const ProfilePoint point :
             {ProfilePoint{0.9, 0.1}, {0.99, 1.99}, {1.01, 2.01}, {2.99, 2.01}})
          EXPECT_LT(profile.nearest(point).gap, 0.) << point.r << ", " << point.z;
        for (const ProfilePoint point :
             {ProfilePoint{1.01, -0.01}, {1.01, 1.99}, {3.01, 1.99}, {2.99, 1.99}})
          EXPECT_GT(profile.nearest(point).gap, 0.) << point.r << ", " << point.z;
        EXPECT_EQ(profile.nearest({1., 2.}).gap, 0.);
        EXPECT_NEAR(profile.nearest({1., 2.}).normal.r, std::sqrt(0.5), 1e-14);
        EXPECT_NEAR(profile.nearest({1., 2.}).normal.z, -std::sqrt(0.5), 1e-14);
      }

      /** The force of a unit spring on a node that moves all around the tool, some way below the
       * surface. */
      double largest_jump_of_force(const RigidProfile &profile, const double depth,
                                   const unsigned int n)
      {
        // A way around the sharp corners, moved inwards and over the edges in small steps.
        const std::vector<ProfilePoint> way = {{0., depth},
                                               {1. - depth, depth},
                                               {1. - depth, 2. + depth},
                                               {3. - depth, 2. + depth},
                                               {3. - depth, 4. - depth},
                                               {0., 4. - depth}};
        double jump = 0;
        ProfilePoint last = {0., 0.};
        bool is_first = true;
        for (std::size_t side = 0; side + 1 < way.size(); ++side)
          for (unsigned int i = 0; i < n; ++i)
          {
            const double s = double(i) / n;
            const auto nearest = profile.nearest({(1. - s) * way[side].r + s * way[side + 1].r,
                                                  (1. - s) * way[side].z + s * way[side + 1].z});
            const double size = std::max(-nearest.gap, 0.);
            const ProfilePoint force = {size * nearest.normal.r, size * nearest.normal.z};
            if (!is_first)
              jump = std::max(jump, distance(force, last));
            is_first = false;
            last = force;
          }
        return jump;
      }

      TEST(RigidProfile, force_of_a_node_that_passes_every_edge_is_continuous)
      {
        const RigidProfile rounded(stepped, 0.3), sharp(stepped, 0.);
        for (const double depth : {0.01, 0.1, 0.2})
        {
          const double coarse = largest_jump_of_force(rounded, depth, 1000);
          EXPECT_LT(coarse, 0.02);
          EXPECT_LT(largest_jump_of_force(rounded, depth, 10000), 0.11 * coarse);
          EXPECT_GT(largest_jump_of_force(sharp, depth, 10000), depth);
        }
      }

      TEST(RigidProfile, outlines_that_are_none_are_refused)
      {
        const std::vector<std::vector<ProfilePoint>> bad = {
            {{0., 0.}, {1., 1.}},
            {{0., 0.}, {0., 4.}, {3., 4.}, {3., 0.}},
            {{0., 4.}, {3., 4.}, {3., 0.}, {0., 0.}},
            {{0., 0.}, {1., 0.}, {1., 0.}, {0., 1.}},
            {{0., 0.}, {3., 0.}, {1., 3.}, {1., -1.}, {0., 4.}},
            {{0., 0.}, {std::nan(""), 1.}, {0., 2.}}};
        for (const auto &corners : bad)
          EXPECT_THROW(RigidProfile(corners, 0.), std::invalid_argument);
        EXPECT_THROW(RigidProfile(stepped, 1.01), std::invalid_argument);
        EXPECT_THROW(RigidProfile(stepped, -1.), std::invalid_argument);
        EXPECT_NO_THROW(RigidProfile(stepped, 0.99));
      }

      TEST(RigidProfile, outline_lies_on_the_profile_and_has_its_corners)
      {
        for (const double radius : {0., 0.3})
        {
          const RigidProfile profile(stepped, radius);
          const std::vector<ProfilePoint> outline = profile.outline(0.2);
          EXPECT_EQ(outline.front().r, 0.);
          EXPECT_EQ(outline.back().r, 0.);
          if (radius == 0.)
          {
            EXPECT_EQ(outline.size(), stepped.size());
          }
          else
          {
            EXPECT_GT(outline.size(), 3 * stepped.size());
          }
          for (const ProfilePoint &point : outline)
            EXPECT_NEAR(profile.nearest(point).gap, 0., 1e-14) << point.r << " " << point.z;
        }
      }

      TEST(RigidProfile, outline_of_a_rounded_tip_ends_on_the_axis)
      {
        const RigidProfile profile({{0., 0.}, {1., 1.}, {0., 2.}}, 0.2);
        const std::vector<ProfilePoint> outline = profile.outline(0.2);
        EXPECT_EQ(outline.front().r, 0.);
        EXPECT_NEAR(outline.front().z, 0.2 * (std::sqrt(2.) - 1.), 1e-14);
        EXPECT_EQ(outline.back().r, 0.);
        for (const ProfilePoint &point : outline)
          EXPECT_NEAR(profile.nearest(point).gap, 0., 1e-14) << point.r << " " << point.z;
      }

      TEST(Drill, touches_where_its_cones_and_its_cylinder_are)
      {
        const auto drill = make_plugin<ContactSurface<3>>(
            "drill", "set Diameter = 5.3\nset Cone angle = 36\nset Centre height = 0.95\n"
                     "set Length = 14\nset Origin = 1, 2, 3\nset Axis = 0, 0, 2\n"
                     "set Displacement = 0; 0; -t\nset Angle = 5*t\n");
        const double slope = std::tan(dealii::numbers::PI / 10.);
        const auto at = [](const double r, const double z, const double time) {
          return dealii::Tensor<1, 3>({1. + 0.6 * r, 2. - 0.8 * r, 3. + z - time});
        };
        for (const double time : {0., 2.})
        {
          const auto gap = gaps<3>(*drill,
                                   {at(0., 0., time), at(0.5, 0.5, time),
                                    at(0.95 + slope, 1.95, time), at(2.65, 8., time),
                                    at(3.65, 8., time), at(2.65, 20., time), at(0., -1., time)},
                                   time);
          for (unsigned int k = 0; k < 4; ++k)
            EXPECT_NEAR(gap[k], 0., 1e-14) << k;
          EXPECT_NEAR(gap[4], 1., 1e-14);
          EXPECT_NEAR(gap[5], 6., 1e-14);
          EXPECT_NEAR(gap[6], 1., 1e-14);
          const auto normal = drill->normal(at(0.95 + slope, 1.95, time), time);
          const double across = std::cos(dealii::numbers::PI / 10.);
          EXPECT_NEAR(normal[0], 0.6 * across, 1e-14);
          EXPECT_NEAR(normal[1], -0.8 * across, 1e-14);
          EXPECT_NEAR(normal[2], -std::sin(dealii::numbers::PI / 10.), 1e-14);
        }
        // A quarter turn about the axis, and down.
        const double quarter = dealii::numbers::PI / 10.;
        const auto motion = drill->motion(at(1., 2., quarter), 0., quarter);
        EXPECT_NEAR(motion[0], std::sqrt(2.) * 0.8, 1e-14);
        EXPECT_NEAR(motion[1], std::sqrt(2.) * 0.6, 1e-14);
        EXPECT_NEAR(motion[2], -quarter, 1e-14);
        EXPECT_NEAR((drill->reference_point(2.) - dealii::Tensor<1, 3>({1., 2., 1.})).norm(), 0.,
                    1e-14);
      }

      TEST(Tools, in_two_dimensions_turn_with_their_axis)
      {
        const auto wedge = make_plugin<ContactSurface<2>>(
            "profile", "set Corners = 0, 0; 1, 1; 1, 3; 0, 3\nset Origin = 0, 0\nset Angle = t\n");
        const double half_turn = dealii::numbers::PI;
        const auto gap =
            gaps<2>(*wedge,
                    {dealii::Tensor<1, 2>({-0.5, 0.5}), dealii::Tensor<1, 2>({0.5, 0.5}),
                     dealii::Tensor<1, 2>({0., -1.})},
                    0.);
        EXPECT_NEAR(gap[0], 0., 1e-14);
        EXPECT_NEAR(gap[1], 0., 1e-14);
        EXPECT_NEAR(gap[2], 1., 1e-14);
        const auto turned =
            gaps<2>(*wedge, {dealii::Tensor<1, 2>({0., 1.}), dealii::Tensor<1, 2>({-0.5, -0.5})},
                    half_turn);
        EXPECT_NEAR(turned[0], 1., 1e-14);
        EXPECT_NEAR(turned[1], 0., 1e-14);
        const auto normal = wedge->normal(dealii::Tensor<1, 2>({0., 2.}), half_turn);
        EXPECT_NEAR(normal[1], 1., 1e-14);
      }

      std::string message_of(const std::string &name, const std::string &entries)
      {
        return input_error([&] { make_plugin<ContactSurface<3>>(name, entries); });
      }

      TEST(Tools, that_cannot_be_made_are_refused_with_their_place)
      {
        const std::string drill = "set Diameter = 5\nset Origin = 0, 0, 0\n";
        const auto says = [](const std::string &message, const std::string &text)
        { return message.find(text) != std::string::npos; };
        EXPECT_PRED2(says, message_of("drill", drill + "set Cone angle = 180\nset Length = 9\n"),
                     "Cone angle");
        EXPECT_PRED2(says, message_of("drill", drill + "set Cone angle = 36\nset Length = 2\n"),
                     "the cone ends 7.69");
        EXPECT_PRED2(says,
                     message_of("drill", drill + "set Cone angle = 36\nset Length = 9\n"
                                                 "set Edge radius = 3\n"),
                     "does not fit between the corners");
        EXPECT_PRED2(
            says,
            message_of("pin and shoulder",
                       "set Pin diameter = 6\nset Pin length = 3\nset Shoulder diameter = 5"
                       "\nset Shoulder length = 3\nset Origin = 0, 0, 0\n"),
            "above the diameter of the pin");
        EXPECT_PRED2(says, message_of("sphere", "set Radius = 0\nset Origin = 0, 0, 0\n"),
                     "Radius");
        EXPECT_PRED2(says, message_of("sphere", "set Radius = 1\nset Origin = 0, 0\n"), "Origin");
        EXPECT_PRED2(
            says,
            message_of("sphere", "set Radius = 1\nset Origin = 0, 0, 0\nset Axis = 0, 0, 0\n"),
            "Axis");
        EXPECT_PRED2(
            says, message_of("sphere", "set Radius = 1\nset Origin = 0, 0, 0\nset Angle = 2*q\n"),
            "Angle");
        EXPECT_PRED2(says,
                     message_of("profile", "set Corners = 0, 0; 1; 0, 2\nset Origin = 0, 0, 0\n"),
                     "not a pair of numbers");
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
