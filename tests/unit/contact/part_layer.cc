// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <mesh_testing.h>

#include <tombolo/contact/part_surface.h>
#include <tombolo/contact/surfaces/facet_tree.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      /** The layer of the cells of a box on one side of a plane across x. */
      template <int dim>
      class LayerOfBox
      {
      public:
        LayerOfBox(const std::string &entries, const double begin,
                   const std::shared_ptr<const Images> &images = Images::none())
            : scene("box", entries), mesh(scene.create_mesh()), nodes(*mesh, 1),
              partition(std::make_shared<const NodePartition>(nodes.owned(), nodes.relevant(),
                                                              nodes.communicator())),
              has_images((nodes.set_images(images), true)),
              layer(nodes, [&](const typename Nodes<dim>::Cell &cell)
                    { return cell->center()[0] > begin; })
        {
          layer.set_partition(*partition);
          position = initial_positions(nodes, partition);
        }

        MeshScene<dim> scene;
        std::unique_ptr<Mesh<dim>> mesh;
        Nodes<dim> nodes;
        std::shared_ptr<const NodePartition> partition;
        bool has_images; // before the layer
        PartLayer<dim> layer;
        NodalVector position;
      };

      TEST(part_layer, its_facets_enclose_the_part_up_to_other_parts)
      {
        const LayerOfBox<2> plane("set Upper corner = 3, 2\nset Cells = 6, 8", 1.);
        const ClosedSurface<2> outline(plane.layer.facets());
        EXPECT_NEAR(outline.volume, 2. * 2., 1e-12);
        EXPECT_NEAR(outline.area, 8., 1e-12);
        // Of 4 by 8 cells those in the middle are no part of the layer, but all their nodes are.
        EXPECT_EQ(plane.layer.cells().size(), 4u * 8u - 2u * 6u);
        EXPECT_EQ(plane.layer.n_nodes(), 5u * 9u - 1u * 5u);

        const LayerOfBox<3> space("set Upper corner = 3, 2, 1\nset Cells = 3, 2, 2", 1.);
        const ClosedSurface<3> skin(space.layer.facets());
        EXPECT_NEAR(skin.volume, 2. * 2. * 1., 1e-12);
        EXPECT_NEAR(skin.area, 2. * (4. + 2. + 2.), 1e-12);
        for (std::size_t f = 0; f < space.layer.facets().facets.size(); ++f)
          EXPECT_NEAR(space.layer.size(f), 0.5, 1e-12);
      }

      TEST(part_layer, every_rank_gathers_the_values_of_owners)
      {
        const LayerOfBox<2> box("set Upper corner = 3, 2\nset Cells = 6, 8", 1.);
        const std::vector<double> gathered =
            box.layer.gather(2, Quantity::position,
                             [&](const unsigned int node, double *const x)
                             {
                               x[0] = box.position.node(node)[0];
                               x[1] = box.position.node(node)[1];
                             });
        ASSERT_EQ(gathered.size(), 2 * box.layer.n_nodes());
        for (std::size_t a = 0; a < box.layer.n_nodes(); ++a)
          for (unsigned int d = 0; d < 2; ++d)
            EXPECT_EQ(gathered[2 * a + d], box.layer.facets().vertices[a][d]);
      }

      TEST(part_layer, images_close_the_surface_and_give_to_their_sources)
      {
        Images images;
        images.all = {{1, 0., {}}, {2, 0., {}}};
        const LayerOfBox<3> box("set Upper corner = 3, 2, 1\nset Cells = 3, 2, 2", 1.,
                                std::make_shared<const Images>(images));
        const FacetList<3> &list = box.layer.facets();
        const ClosedSurface<3> skin(list);
        EXPECT_NEAR(skin.volume, 4. * 2. * 2. * 1., 1e-12);
        EXPECT_NEAR(skin.area, 2. * (2. * 4. + 2. * 2. + 4. * 2.), 1e-12);

        const auto gathered = box.layer.gather(3, Quantity::position,
                                               [&](const unsigned int node, double *const x)
                                               { std::copy_n(box.position.node(node), 3, x); });
        std::vector<double> values(3 * box.layer.n_nodes(), 0.);
        std::size_t n_images = 0;
        double source_sum[3] = {};
        for (std::size_t a = 0; a < box.layer.n_nodes(); ++a)
        {
          const auto &x = list.vertices[a];
          for (unsigned int d = 0; d < 3; ++d)
            EXPECT_EQ(gathered[3 * a + d], x[d]);
          if (!(x[1] < 0.))
            continue;
          ++n_images;
          for (unsigned int d = 0; d < 3; ++d)
            values[3 * a + d] = d + 1.;
        }
        EXPECT_GT(n_images, 0u);
        box.layer.sum(3, Quantity::vector, values);
        for (std::size_t a = 0; a < box.layer.n_nodes(); ++a)
          if (list.vertices[a][1] >= 0. && list.vertices[a][2] >= 0.)
            for (unsigned int d = 0; d < 3; ++d)
              source_sum[d] += values[3 * a + d];
        const auto from_all_ranks =
            static_cast<double>(n_images * dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD));
        EXPECT_NEAR(source_sum[0], from_all_ranks, 1e-12);
        EXPECT_NEAR(source_sum[1], -2. * from_all_ranks, 1e-12);
      }

      TEST(part_layer, sums_over_ranks_are_the_same_on_all)
      {
        const LayerOfBox<2> box("set Upper corner = 3, 2\nset Cells = 6, 8", 1.);
        const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
        const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
        std::vector<double> values(2 * box.layer.n_nodes(), 0.);
        // Each rank has something for the first node, and for one of its own.
        values[0] = 1. + rank;
        values[2 * (rank + 3) + 1] = 10.;
        box.layer.sum(2, Quantity::scalars, values);
        EXPECT_EQ(values[0], 0.5 * n_ranks * (n_ranks + 1.));
        for (std::size_t a = 1; a < box.layer.n_nodes(); ++a)
          EXPECT_EQ(values[2 * a + 1], a >= 3 && a < n_ranks + 3 ? 10. : 0.);
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
