// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include <tombolo/contact/surfaces/facet_tree.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      using dealii::Tensor;

      /** A polygon of n sides in a circle. */
      FacetList<2> polygon(const unsigned int n)
      {
        FacetList<2> result;
        for (unsigned int k = 0; k < n; ++k)
        {
          const double angle = 2. * dealii::numbers::PI * k / n;
          result.vertices.push_back(Tensor<1, 2>({std::cos(angle), std::sin(angle)}));
          result.facets.push_back({{k, (k + 1) % n}});
        }
        return result;
      }

      /** The surface of a cube of n cells an edge, cut into triangles. */
      FacetList<3> cube(const unsigned int n)
      {
        FacetList<3> result;
        for (unsigned int axis = 0; axis < 3; ++axis)
          for (const double end : {0., 1.})
          {
            const auto first = static_cast<unsigned int>(result.vertices.size());
            for (unsigned int i = 0; i <= n; ++i)
              for (unsigned int j = 0; j <= n; ++j)
              {
                Tensor<1, 3> vertex;
                vertex[axis] = end;
                vertex[(axis + 1) % 3] = double(i) / n;
                vertex[(axis + 2) % 3] = double(j) / n;
                result.vertices.push_back(vertex);
              }
            for (unsigned int i = 0; i < n; ++i)
              for (unsigned int j = 0; j < n; ++j)
              {
                const unsigned int a = first + i * (n + 1) + j, b = a + n + 1;
                result.facets.push_back({{a, b, b + 1}});
                result.facets.push_back({{a, b + 1, a + 1}});
              }
          }
        return result;
      }

      /** Turned, sheared and bent. */
      template <int dim>
      std::vector<Tensor<1, dim>> bent(const std::vector<Tensor<1, dim>> &vertices)
      {
        std::vector<Tensor<1, dim>> result = vertices;
        for (Tensor<1, dim> &x : result)
        {
          const double first = x[0], second = x[1];
          x[0] = 0.6 * first - 0.8 * second + 0.2 * second * second;
          x[1] = 0.8 * first + 0.6 * second + 3.;
        }
        return result;
      }

      template <int dim>
      void compare_moved_with_new(const FacetList<dim> &list)
      {
        ClosedSurface<dim> moved(list);
        FacetTree<dim> tree(moved);
        moved.move_vertices(bent(moved.vertices));
        tree.refit(moved);
        FacetList<dim> given;
        given.vertices = moved.vertices;
        given.facets = moved.facets;
        const ClosedSurface<dim> made(given);
        ASSERT_EQ(made.facets.size(), moved.facets.size());
        for (std::size_t f = 0; f < made.facets.size(); ++f)
          EXPECT_LT((made.facet_normals[f] - moved.facet_normals[f]).norm(), 1e-13);
        EXPECT_LT((made.low - moved.low).norm() + (made.high - moved.high).norm(), 1e-13);
        const FacetTree<dim> new_tree(made);
        std::mt19937 generator(3);
        std::uniform_real_distribution<double> uniform(-1.5, 1.5);
        for (unsigned int k = 0; k < 300; ++k)
        {
          Tensor<1, dim> point;
          for (unsigned int d = 0; d < dim; ++d)
            point[d] = uniform(generator) + (d == 1 ? 3. : 0.);
          EXPECT_NEAR(tree.nearest(point).distance_square, new_tree.nearest(point).distance_square,
                      1e-13);
        }
      }

      TEST(facet_tree, finds_the_same_places_of_a_surface_that_has_moved_as_a_new_one)
      {
        compare_moved_with_new(polygon(50));
        compare_moved_with_new(cube(4));
      }

      TEST(facet_tree, finds_the_nearest_of_the_facets_that_face_a_direction)
      {
        const ClosedSurface<3> surface(cube(4));
        const FacetTree<3> tree(surface);
        // Next to the side x = 1, a little below the top z = 1.
        const Tensor<1, 3> point({0.99, 0.4, 0.9});
        EXPECT_NEAR(tree.nearest(point).distance_square, 1e-4, 1e-12);
        const Tensor<1, 3> down({0., 0., -2.});
        const auto top = tree.nearest_facing(point, down, -0.2);
        ASSERT_TRUE(top);
        EXPECT_NEAR(top->distance_square, 0.01, 1e-12);
        EXPECT_NEAR(surface.facet_normals[tree.facet_of(*top)][2], 1., 1e-12);
        EXPECT_FALSE(tree.nearest_facing(point, down, -2.1));
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
