// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include "frozen_body.h"
#include "patch_errors.h"
#include "text_testing.h"

#include <tombolo/contact/outward_areas.h>
#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/formulations/smoothed/smoothed_gradients.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

namespace
{
  using namespace tombolo;
  using namespace tombolo::testing;

  /** A block of n cells of size 1 along each axis, smaller by the entries of @p refinement. */
  std::string graded_block(const std::vector<unsigned int> &cells, const std::string &refinement,
                           const std::string &options, const std::string &mesh_options)
  {
    Block block;
    block.formulation = "smoothed cells";
    block.cells = cells;
    block.options = options;
    block.mesh_options = mesh_options;
    return changed(parameters_of(block), "set Type = box\n",
                   "set Type = box\n" + refinement + "\n");
  }

  const std::string uneven = "set Disorder = 0.2\nset Surface nodes = slide";
  const std::string corner_and_middle =
      "set Refine where = x < 2 && y < 3; x > 1 && x < 4 && y > 3; (x - 3)^2 + (y - 2)^2 < 1\n"
      "set Refinement levels = 1; 2; 1";

  /** Rows of a part of the model, in its partition. */
  template <int dim>
  struct Rows
  {
    explicit Rows(const FrozenBody<dim> &body, const bool can_move = false)
        : rows(body.parameters.section("Part: a").subsection("smoothed cells"))
    {
      const Model<dim> &model = *body.model;
      setup.name = "a";
      setup.nodes = model.nodes.get();
      setup.part_cells = model.part_cells.get();
      setup.material = model.parts[0].material;
      setup.communicator = MPI_COMM_WORLD;
      if (can_move)
        rows.prepare_positions();
      rows.initialize(setup);
      if (!can_move)
        rows.set_partition(*model.state.partition());
    }

    PartSetup<dim> setup;
    SmoothedGradients<dim> rows;
  };

  /** The largest of Σ G and of Σ x ⊗ G - 1. */
  template <int dim>
  struct RowSums
  {
    /** Adds V G of a row to @p forces. */
    void add(const Stencils::Row &row, const double volume, const NodalVector &position,
             NodalVector &forces)
    {
      dealii::Tensor<1, dim> sum;
      dealii::Tensor<2, dim> moment;
      for (unsigned int k = 0; k < row.size; ++k)
        for (unsigned int a = 0; a < dim; ++a)
        {
          const double g = row.gradient[k * Stencils::n_gradient + a];
          sum[a] += g;
          for (unsigned int b = 0; b < dim; ++b)
            moment[b][a] += position.node(row.neighbour[k])[b] * g;
          forces.node(row.neighbour[k])[a] += volume * g;
        }
      for (unsigned int a = 0; a < dim; ++a)
        moment[a][a] -= 1.;
      sum_error = std::max(sum_error, sum.norm());
      moment_error = std::max(moment_error, moment.norm());
    }

    double sum_error = 0, moment_error = 0;
  };

  template <int dim>
  void expect_consistent_rows(const std::string &text)
  {
    const FrozenBody<dim> body(text);
    const Model<dim> &model = *body.model;
    const Rows<dim> part(body);
    const Stencils &stencils = part.rows.stencils();
    const NodalVector &position = model.state.position;
    NodalVector boundary(model.state.partition());
    RowSums<dim> sums;
    const unsigned int n_points = part.rows.n_points_per_cell();
    for (unsigned int cell = 0; cell < model.parts[0].formulation->n_cells(); ++cell)
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const unsigned int number = point_in_lanes(cell, n_points, q);
        const Stencils::Row row = stencils.row(number);
        sums.add(row, part.rows.volumes()[number], position, boundary);
      }
    EXPECT_LE(sums.sum_error, 1e-13);
    EXPECT_LE(sums.moment_error, 1e-11);
    boundary.add_to_owners();
    OutwardAreas<dim> areas(*model.nodes, {});
    areas.set_partition(model.state.partition());
    areas.update(position);
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      for (unsigned int a = 0; a < dim; ++a)
        EXPECT_NEAR(boundary.node(i)[a], areas.has_face(i) ? areas.area(i)[a] : 0., 1e-13)
            << position.node(i)[0] << " " << position.node(i)[1] << " " << position.node(i)[2];
  }

  TEST(GradedCells, have_gradients_that_are_consistent_and_sum_up_to_the_boundary)
  {
    for (const std::string &mesh : {std::string(), uneven})
      for (const std::string options : {"set Dilation = 1.1", "set Dilation = 1.5"})
      {
        expect_consistent_rows<2>(graded_block({6, 5}, corner_and_middle, options, mesh));
        expect_consistent_rows<3>(graded_block({5, 5, 3}, corner_and_middle, options, mesh));
      }
  }

  /** Nodes of a block of @p n cells of size 1 slide on its surface, and move inside of it. Of other
   * bodies only inner nodes move. */
  template <int dim>
  void move_nodes(const std::vector<unsigned int> &n, const OutwardAreas<dim> &areas,
                  const bool is_block, NodalVector &position)
  {
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
    {
      double *const x = position.node(i);
      double displacement[dim];
      if (!is_block && areas.has_face(i))
        continue;
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double phase = 1.7 * x[(d + 1) % dim] + 0.9 * x[dim - 1 - d % 2] + d;
        displacement[d] = 0.06 * x[d] * (n[d] - x[d]) / n[d] * std::sin(2.5 * phase);
      }
      for (unsigned int d = 0; d < dim; ++d)
        x[d] += displacement[d];
    }
    position.update_ghosts();
  }

  template <int dim>
  void expect_rows_that_fit_together(const std::string &text, const std::vector<unsigned int> &n,
                                     const bool is_block)
  {
    const FrozenBody<dim> body(text);
    const Model<dim> &model = *body.model;
    Rows<dim> part(body, true);
    const auto partition = std::make_shared<const NodePartition>(
        model.nodes->owned(), part.rows.required_nodes(), MPI_COMM_WORLD);
    NodalVector position = model.state.position.copy();
    position.move_to(partition);
    OutwardAreas<dim> areas(*model.nodes, {});
    areas.set_partition(partition);
    areas.update(position);
    const auto sum_of_volumes = [&]
    {
      double result = 0;
      for (unsigned int cell = 0; cell < model.parts[0].formulation->n_cells(); ++cell)
        for (unsigned int q = 0; q < part.rows.n_points_per_cell(); ++q)
          result += part.rows.volumes()[point_in_lanes(cell, part.rows.n_points_per_cell(), q)];
      return sum_over_ranks(result);
    };
    const double start_volume = sum_of_volumes();
    move_nodes<dim>(n, areas, is_block, position);
    part.rows.initialize(part.setup, &position);
    part.rows.set_partition(*partition);
    const unsigned int n_points = part.rows.n_points_per_cell();
    const std::vector<SmoothedCell<dim>> cells = smoothed_cells_of(part.setup);
    const auto position_of = [&](const dealii::types::global_dof_index node)
    {
      dealii::Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = position.node(position.partition()->local_index(node))[d];
      return result;
    };
    NodalVector force(partition);
    RowSums<dim> sums;
    double volume_error = 0, farthest = 0;
    for (unsigned int cell = 0; cell < cells.size(); ++cell)
    {
      for (const FaceNodes<dim> &face : cells[cell].face_nodes)
      {
        dealii::Tensor<1, dim> away =
            position_of(face.parts[0].nodes.back()) - dealii::Point<dim>();
        for (const auto &face_part : face.parts)
          away -= (position_of(face_part.nodes[0]) - dealii::Point<dim>()) /
                  static_cast<double>(face.parts.size());
        farthest = std::max(farthest, away.norm());
      }
      const auto facet_volumes = volumes_within<dim>(present_facets<dim>(cells[cell], position_of));
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const unsigned int number = point_in_lanes(cell, n_points, q);
        const Stencils::Row row = part.rows.stencils().row(number);
        const double point_volume = part.rows.volumes()[number];
        volume_error = std::max(volume_error, std::abs(point_volume - facet_volumes[q]));
        sums.add(row, point_volume, position, force);
      }
    }
    EXPECT_GT(dealii::Utilities::MPI::max(farthest, MPI_COMM_WORLD), 0.01);
    EXPECT_LE(sums.sum_error, 1e-13);
    EXPECT_LE(sums.moment_error, 1e-11);
    EXPECT_LE(volume_error, 1e-13);
    EXPECT_NEAR(sum_of_volumes(), start_volume, 1e-13 * start_volume);
    force.add_to_owners();
    areas.update(position);
    double unbalanced = 0;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      for (unsigned int a = 0; a < dim && !areas.has_face(i); ++a)
        unbalanced = std::max(unbalanced, std::abs(force.node(i)[a]));
    EXPECT_LE(unbalanced, 1e-13);
  }

  TEST(GradedCells, fit_together_where_hanging_nodes_are_not_in_the_middle_of_edges)
  {
    expect_rows_that_fit_together<2>(
        graded_block({6, 5}, corner_and_middle, "set Dilation = 1.1", uneven), {6, 5}, true);
    expect_rows_that_fit_together<3>(
        graded_block({5, 5, 3}, corner_and_middle, "set Dilation = 1.1", uneven), {5, 5, 3}, true);
    std::string cylinder = graded_block({5, 5, 3}, "set Refine where = y > 2*x", "", "");
    const std::size_t first = cylinder.find("set Type = box"),
                      last = cylinder.find("end", cylinder.find("subsection box"));
    cylinder.replace(first, last - first,
                     "set Type = cylinder\nset Refine where = y > 2*x\nsubsection cylinder\n"
                     "set Radius = 2\nset Length = 3\nset Core cells = 2\nset Rings = 1\n"
                     "set Cells along axis = 3\n");
    expect_rows_that_fit_together<3>(cylinder, {5, 5, 3}, false);
  }

  template <int dim>
  void expect_graded_patch(const std::string &text, const std::vector<unsigned int> &n)
  {
    const PatchErrors errors = patch_errors<dim>(text, n);
    EXPECT_LE(errors.force, 1e-11);
    EXPECT_LE(errors.stress, 1e-8); // of the step's own size
  }

  TEST(GradedCells, pass_the_patch_test)
  {
    for (const std::string &mesh : {std::string(), uneven})
      for (const std::string options : {"set Dilation = 1.1", "set Dilation = 1.5"})
      {
        expect_graded_patch<2>(graded_block({6, 5}, corner_and_middle, options, mesh), {6, 5});
        expect_graded_patch<3>(graded_block({5, 5, 3}, corner_and_middle, options, mesh),
                               {5, 5, 3});
      }
  }

  /** Elements where @p elements holds, and a corner of them around which cells are smaller. */
  std::string beside_elements(const std::string &elements, const std::string &refinement)
  {
    return changed(changed(graded_block({6, 5, 4}, refinement, "", uneven), "set Parts = a",
                           "set Parts = a, e"),
                   "set Cells = all", "set Cells = otherwise") +
           "subsection Part: e\nset Cells = " + elements +
           "\nset Material = m\nset Formulation = fully integrated hexahedron\nend\n";
  }

  TEST(GradedCells, pass_the_patch_test_beside_elements)
  {
    // The size changes one cell away from the elements, then in the diagonal of their corner, so
    // that elements have nodes in the middle of edges.
    expect_graded_patch<3>(beside_elements("x < 2", "set Refine where = x > 3 && y > 2"),
                           {6, 5, 4});
    expect_graded_patch<3>(beside_elements("x < 3 && y < 2", "set Refine where = x > 3 && y > 2"),
                           {6, 5, 4});
    // Elements that are small, too, where they meet small cells.
    expect_graded_patch<3>(beside_elements("x < 2", "set Refine where = x < 3"), {6, 5, 4});
  }

  /** @p centre_tolerance is relative to the size of the body. */
  template <int dim>
  void expect_mass(const std::string &text, const std::vector<unsigned int> &n,
                   const double centre_tolerance)
  {
    const FrozenBody<dim> body(text);
    const Model<dim> &model = *body.model;
    double mass = 0, smallest = 1e9;
    dealii::Tensor<1, dim> moment;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double node_mass = *model.state.mass.node(i);
      smallest = std::min(smallest, node_mass);
      mass += node_mass;
      for (unsigned int d = 0; d < dim; ++d)
        moment[d] += node_mass * model.state.position.node(i)[d];
    }
    double volume = 1;
    for (const unsigned int axis_cells : n)
      volume *= axis_cells;
    EXPECT_GT(smallest, 0.);
    EXPECT_NEAR(sum_over_ranks(mass), volume, 1e-13 * volume);
    for (unsigned int d = 0; d < dim; ++d)
      EXPECT_NEAR(sum_over_ranks(moment[d]), volume * n[d] / 2., centre_tolerance * volume * n[d]);
  }

  TEST(GradedCells, keep_the_mass_and_its_centre)
  {
    expect_mass<2>(graded_block({6, 5}, corner_and_middle, "", ""), {6, 5}, 1e-13);
    expect_mass<2>(graded_block({6, 5}, corner_and_middle, "", uneven), {6, 5}, 1e-13);
    expect_mass<3>(graded_block({5, 5, 3}, corner_and_middle, "", ""), {5, 5, 3}, 1e-13);
    // A warped face of four triangles has the volume of a bilinear one, but not its centre.
    expect_mass<3>(graded_block({5, 5, 3}, corner_and_middle, "", uneven), {5, 5, 3}, 1e-6);
  }

  TEST(GradedCells, give_hanging_nodes_mass_of_the_coarse_cell)
  {
    // A square of side 1 beside squares of side 1/2: a third of its two triangles at the face.
    const FrozenBody<2> body(graded_block({3, 3}, "set Refine where = x < 1", "", ""));
    const Model<2> &model = *body.model;
    unsigned int n_found = 0;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double *const x = model.state.position.node(i);
      if (std::abs(x[0] - 1.) > 1e-9 || std::abs(x[1] - 0.5) > 1e-9)
        continue;
      ++n_found;
      EXPECT_NEAR(*model.state.mass.node(i), 2. * 0.25 / 4. + 2. * 0.125 / 3., 1e-14);
    }
    EXPECT_EQ(dealii::Utilities::MPI::sum(n_found, MPI_COMM_WORLD), 1u);
  }

  TEST(GradedCells, have_the_rigid_motions_as_their_only_modes_without_energy)
  {
    FrozenBody<2> plane(graded_block({3, 3}, "set Refine where = x < 1 && y < 2", "", ""));
    const std::vector<double> plane_eigenvalues = plane.eigenvalues();
    EXPECT_LT(plane_eigenvalues[2], 1e-8);
    EXPECT_GT(plane_eigenvalues[3], 1e-4);
    FrozenBody<3> solid(graded_block({2, 2, 1}, "set Refine where = x < 1 && y < 1", "", ""));
    const std::vector<double> solid_eigenvalues = solid.eigenvalues();
    EXPECT_LT(solid_eigenvalues[5], 1e-8);
    EXPECT_GT(solid_eigenvalues[6], 1e-4);
  }

  TEST(GradedCells, have_a_step_that_is_estimated_and_no_longer_than_that_of_the_small_cells)
  {
    for (const std::string dilation : {"1.1", "1.5"})
    {
      FrozenBody<2> body(graded_block({4, 3}, "set Refine where = x < 2 && y < 2",
                                      "set Dilation = " + dilation, uneven));
      const double limit = body.limit_by_eigenvalues();
      const double estimate = body.estimator->estimate(*body.model).time_step;
      EXPECT_LE(estimate, 1.0001 * limit);
      EXPECT_GE(estimate, 0.98 * limit);
      FrozenBody<2> fine(
          graded_block({4, 3}, "set Refine where = x < 9", "set Dilation = " + dilation, uneven));
      EXPECT_GE(limit, 0.9 * fine.limit_by_eigenvalues());
    }
  }

  TEST(GradedCells, share_the_work_between_ranks_by_their_number)
  {
    const FrozenBody<3> body(
        graded_block({6, 5, 5}, "set Refine where = x < 2\nset Refinement levels = 2", "", ""));
    const unsigned int here = body.model->parts[0].formulation->n_cells();
    const auto shares = dealii::Utilities::MPI::min_max_avg(here, MPI_COMM_WORLD);
    EXPECT_LE(shares.max, 1.05 * shares.avg);
  }
} // namespace
