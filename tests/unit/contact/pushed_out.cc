// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/nodal_geometry.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      using dealii::Tensor;

      /** A disc of radius 1 around the origin. */
      class UnitDisc : public ContactSurface<2>
      {
      public:
        void evaluate_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes,
                           const double, std::vector<double> &gap) const override
        {
          gap.clear();
          for (const unsigned int node : nodes)
            gap.push_back(vector_of<2>(position.node(node)).norm() - 1.);
        }
        Tensor<1, 2> normal(const Tensor<1, 2> &point, const double) const override
        {
          return point / point.norm();
        }
        Tensor<1, 2> motion(const Tensor<1, 2> &, const double, const double) const override
        {
          return {};
        }
        Tensor<1, 2> reference_point(const double) const override
        {
          return {};
        }
        RigidTranslation<2> &translation() override
        {
          return at_rest;
        }

      private:
        RigidTranslation<2> at_rest;
      };

      Tensor<1, 2> at(const double radius, const double angle)
      {
        return Tensor<1, 2>({radius * std::cos(angle), radius * std::sin(angle)});
      }

      struct Placed
      {
        double gap;
        bool is_bound;
      };

      /** The result for a node that comes @p from a point and is to be placed at @p target. */
      Placed placed(const Tensor<1, 2> &from, const Tensor<1, 2> &target, const double slides = 1.)
      {
        const UnitDisc disc;
        const NodalVector before = positions_as_nodes<2>({from});
        NodalVector position = positions_as_nodes<2>({target}), is_bound, sliding;
        for (NodalVector *const vector : {&is_bound, &sliding})
          vector->reinit(position.partition(), Quantity::scalar);
        *sliding.node(0) = slides;
        std::vector<double> was, gap;
        disc.evaluate_gaps(before, {0}, 0., was);
        disc.evaluate_gaps(position, {0}, 0., gap);
        disc.push_out({0}, was, gap, 0., sliding, before, position, is_bound);
        disc.evaluate_gaps(position, {0}, 0., gap);
        return {gap[0], *is_bound.node(0) > 0.};
      }

      TEST(push_out, what_touched_touches_as_deep)
      {
        constexpr double depth = 1e-3;
        const Tensor<1, 2> from = at(1. - depth, 0.2);
        const Tensor<1, 2> ends[2] = {from, at(1. - depth, 0.4)};
        const Tensor<1, 2> on_chord = 0.5 * (ends[0] + ends[1]); // deeper
        for (const Tensor<1, 2> &target : {on_chord, at(1. + 5e-3, 0.3)})
        {
          const Placed result = placed(from, target);
          EXPECT_NEAR(result.gap, -depth, 1e-14);
          EXPECT_TRUE(result.is_bound);
        }
      }

      TEST(push_out, what_goes_away_steeply_is_left_on_a_part_of_its_way_only)
      {
        const Tensor<1, 2> from = at(1. - 1e-3, 0.2), target = at(1.1, 0.3);
        EXPECT_NEAR(placed(from, target, 0.5).gap, 0.1, 1e-14);
        EXPECT_NEAR(placed(from, at(1. + 5e-3, 0.3), 0.5).gap, -1e-3, 1e-14);
        EXPECT_NEAR(placed(from, target).gap, -1e-3, 1e-14);
      }

      TEST(push_out, what_did_not_touch_does_not)
      {
        Placed result = placed(at(1.01, 0.2), at(0.98, 0.3));
        EXPECT_NEAR(result.gap, 0., 1e-7);
        EXPECT_GT(result.gap, 0.);
        EXPECT_TRUE(result.is_bound);
        result = placed(at(1.01, 0.2), at(1.02, 0.3));
        EXPECT_NEAR(result.gap, 0.02, 1e-14);
        EXPECT_FALSE(result.is_bound);
        EXPECT_NEAR(placed(at(1.01, 0.2), at(0.98, 0.3), 0.).gap, -0.02, 1e-14);
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
