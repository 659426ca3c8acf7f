// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/base/input/parameters.h>
#include <tombolo/formulations/particles/part_boundary.h>
#include <tombolo/model/model.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <string>

using namespace tombolo;

namespace
{
  struct Choice
  {
    std::string gradient = "consistent";
    std::string disorder = "0.25";
    std::string smoothing = "affine";
    std::string bridge = "";    ///< of a body that is half elements; empty: all particles
    std::string planes = "";    ///< axes with a plane of symmetry at the lower end: "x", "xy"
    std::string clamp = "";     ///< a predicate
    std::string rotation = "0"; ///< in the plane of x and y [degrees]
    std::string surface = "slide";
    std::string cells = "5, 6, 4";
  };

  template <int dim>
  class Cloud
  {
  public:
    explicit Cloud(const Choice &choice) : parameters(MPI_COMM_WORLD)
    {
      std::ostringstream text;
      std::string names, sections;
      for (const char axis : choice.planes)
      {
        names += (names.empty() ? "" : ", ") + std::string("plane ") + axis;
        sections += std::string("subsection Condition: plane ") + axis +
                    "\nset Type = symmetry\nset Where = " + axis + " < 1e-9\nend\n";
      }
      if (!choice.clamp.empty())
      {
        names += (names.empty() ? "" : ", ") + std::string("clamp");
        sections += "subsection Condition: clamp\nset Type = clamp\nset Where = " + choice.clamp +
                    "\nend\n";
      }
      const bool is_coupled = !choice.bridge.empty();
      text << "set Dimension = " << dim
           << "\nset Materials = m\nset Parts = " << (is_coupled ? "a, b" : "b")
           << "\nset Conditions = " << names << "\n"
           << sections << "subsection Mesh\nset Type = box\nsubsection box\nset Upper corner = "
           << (dim == 2 ? "1, 1.5" : "1, 1.5, 0.8")
           << "\nset Cells = " << (dim == 2 ? "6, 9" : choice.cells)
           << "\nset Disorder = " << choice.disorder << "\nset Surface nodes = " << choice.surface
           << "\nset Rotation = " << choice.rotation << "\nend\nend\n";
      if (is_coupled)
        text << "subsection Part: a\nset Cells = y < 0.75\nset Formulation = fully integrated "
                "hexahedron\nset Material = m\nend\n";
      text << "subsection Part: b\nset Cells = " << (is_coupled ? "otherwise" : "all")
           << "\nset Formulation = momentum consistent particle\nset Material = m\n"
              "subsection momentum consistent particle\nset Smoothing = "
           << choice.smoothing << "\nset Gradient = " << choice.gradient
           << (choice.gradient == "consistent" ? "\nset Gradient tolerance = 1e-10"
                                               : "\nset Shape functions = moving least squares")
           << "\nend\nend\nsubsection Material: m\nset Model = elastic\nsubsection elastic\n"
              "set Density = 2\nset Young's modulus = 3\nset Poisson's ratio = 0.3\nend\nend\n";
      if (is_coupled)
        text << "subsection Coupling\nset Bridge = " << choice.bridge << "\nend\n";
      parameters.read_text(text.str(), "test.prm");
      Model<dim>::declare_parameters(parameters);
      parameters.assign();
      model = std::make_unique<Model<dim>>(parameters, MPI_COMM_WORLD);
    }

    ParticleFormulation<dim> &particles()
    {
      return *model->parts.back().particles;
    }

    PatchTest patch_test()
    {
      return particles().patch_test(model->state.initial_position);
    }

    /** Largest |Σ_J G_IJ ⊗ (x_J - x_I) - 1| and |Σ_J G_IJ|, times the spacing. */
    double error_of_rows()
    {
      const Stencils &shape = particles().stencils();
      const NodalVector &x = model->state.initial_position;
      double error = 0;
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        double sum[dim] = {}, moment[dim][dim] = {};
        for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1]; ++entry)
          for (unsigned int a = 0; a < dim; ++a)
          {
            const double gradient = shape.gradient[entry * Stencils::n_gradient + a];
            sum[a] += gradient;
            for (unsigned int b = 0; b < dim; ++b)
              moment[a][b] += gradient * (x.node(shape.neighbour[entry])[b] -
                                          x.node(shape.particle_node[row])[b]);
          }
        for (unsigned int a = 0; a < dim; ++a)
        {
          error = std::max(error, std::abs(0.2 * sum[a]));
          for (unsigned int b = 0; b < dim; ++b)
            error = std::max(error, std::abs(moment[a][b] - (a == b ? 1. : 0.)));
        }
      }
      return dealii::Utilities::MPI::max(error, MPI_COMM_WORLD);
    }

    /** Gives all points the same stress (principal axes along the box, so that planes of symmetry
     * bear no shear), and returns the largest force at nodes that @p counts,
     * less that of the traction σn, over the largest force of that traction at a node. */
    template <typename Counts>
    double force_of_constant_stress(const Counts &counts)
    {
      const double stress[3] = {1.3, -0.7, 0.9};
      for (Part<dim> &part : model->parts)
        for (unsigned int c = 0; c < 6; ++c)
          std::fill_n(part.formulation->points().component(MaterialPoints::stress, c),
                      part.formulation->points().padded_size(), c < 3 ? stress[c] : 0.);
      const auto &partition = model->state.partition();
      NodalVector element_force, force;
      element_force.reinit(partition);
      force.reinit(partition);
      NodalVector rest;
      rest.reinit(partition);
      const MechanicalInput input{&model->state.initial_position, &rest, 0., nullptr};
      const bool is_trace = model->bridge->is_trace();
      for (Part<dim> &part : model->parts)
        part.formulation->add_internal_force(
            input, is_trace && part.particles == nullptr ? element_force : force);
      if (is_trace)
        model->bridge->collect_element_force(element_force, force);
      force.add_to_owners();

      // The traction, by faces of the box, which are plane.
      NodalVector loads, traction;
      loads.reinit(partition);
      traction.reinit(partition);
      PartSetup<dim> body;
      body.nodes = model->nodes.get();
      body.symmetry = model->symmetry;
      PartBoundary<dim> boundary;
      boundary.initialize(body);
      boundary.add_areas(model->state.initial_position, loads, loads);
      loads.add_to_owners();
      std::vector<unsigned int> all;
      double scale = 0;
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
      {
        all.push_back(i);
        for (unsigned int d = 0; d < dim; ++d)
        {
          loads.node(i)[d] *= stress[d];
          scale = std::max(scale, std::abs(loads.node(i)[d]));
        }
      }
      model->bridge->load_transfer().set_loaded_nodes(all);
      model->bridge->load_transfer().force_of_loads(loads, traction);
      traction.add_to_owners();
      double error = 0;
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (counts(model->state.initial_position.node(i)))
          for (unsigned int d = 0; d < dim; ++d)
            error = std::max(error, std::abs(force.node(i)[d] + traction.node(i)[d]));
      return dealii::Utilities::MPI::max(error, MPI_COMM_WORLD) /
             dealii::Utilities::MPI::max(scale, MPI_COMM_WORLD);
    }

    double force_of_constant_stress()
    {
      return force_of_constant_stress([](const double *) { return true; });
    }

    Parameters parameters;
    std::unique_ptr<Model<dim>> model;
  };

  Choice with(const std::string &smoothing, const std::string &bridge = "",
              const std::string &planes = "")
  {
    Choice choice;
    choice.smoothing = smoothing;
    choice.bridge = bridge;
    choice.planes = planes;
    return choice;
  }

  class ConsistentGradientsOf : public ::testing::TestWithParam<Choice>
  {};

  INSTANTIATE_TEST_SUITE_P(Clouds, ConsistentGradientsOf,
                           ::testing::Values(with("affine"), with("none"), with("fe matched"),
                                             with("paper", "", "x"), with("affine", "", "xyz"),
                                             with("none", "", "xz"), with("none", "paper"),
                                             with("affine", "trace", "x")),
                           [](const auto &info) { return std::to_string(info.index); });
} // namespace

TEST_P(ConsistentGradientsOf, let_a_disordered_cloud_pass_the_patch_test)
{
  Cloud<3> cloud(GetParam());
  EXPECT_LT(cloud.error_of_rows(), 1e-12);
  EXPECT_LT(cloud.force_of_constant_stress(), 1e-8);
  const PatchTest found = cloud.patch_test();
  ASSERT_NE(found.consistency, nullptr);
  EXPECT_TRUE(found.consistency->converged);
  EXPECT_GT(found.consistency->defect_before, 1e-3);
  EXPECT_LT(found.defect, 1e-8);

  Choice plain = GetParam();
  plain.gradient = "moving least squares";
  Cloud<3> control(plain);
  EXPECT_GT(control.force_of_constant_stress(), 1e-2);
  EXPECT_EQ(control.patch_test().consistency, nullptr);
  EXPECT_GT(control.patch_test().defect, 1e-3);
}

TEST(ConsistentGradients, reckon_with_prescribed_particles_where_loads_enter)
{
  // Reactions at the clamp are its own; all other nodes are in equilibrium with the traction.
  Choice choice;
  choice.clamp = "x < 1e-9 || z < 1e-9";
  Cloud<3> cloud(choice);
  const auto is_free = [](const double *x) { return x[0] > 1e-9 && x[2] > 1e-9; };
  EXPECT_LT(cloud.force_of_constant_stress(is_free), 1e-8);
}

TEST(ConsistentGradients, leave_the_inside_of_a_large_lattice_as_it_is)
{
  Choice choice;
  choice.disorder = "0";
  choice.cells = "12, 12, 12";
  Choice plain = choice;
  plain.gradient = "moving least squares";
  Cloud<3> cloud(choice), control(plain);
  const Stencils &changed = cloud.particles().stencils();
  const Stencils &original = control.particles().stencils();
  double inside = 0, near_the_surface = 0, scale = 0;
  for (unsigned int row = 0; row < changed.n_particles(); ++row)
  {
    const double *const x = cloud.model->state.initial_position.node(changed.particle_node[row]);
    const double depth = std::min({x[0] * 12., (1. - x[0]) * 12., x[1] * 8., (1.5 - x[1]) * 8.,
                                   x[2] * 15., (0.8 - x[2]) * 15.});
    const Stencils::Row after = changed.row(row), before = original.row(row);
    ASSERT_EQ(after.size, before.size);
    for (unsigned int k = 0; k < after.size; ++k)
    {
      const auto place =
          std::find(before.neighbour, before.neighbour + before.size, after.neighbour[k]) -
          before.neighbour;
      ASSERT_LT(place, before.size);
      for (unsigned int d = 0; d < 3; ++d)
      {
        const double old = before.gradient[std::size_t(place) * Stencils::n_gradient + d];
        const double change = std::abs(after.gradient[k * Stencils::n_gradient + d] - old);
        (depth > 4.5 ? inside : near_the_surface) =
            std::max(depth > 4.5 ? inside : near_the_surface, change);
        scale = std::max(scale, std::abs(old));
      }
    }
  }
  const auto largest = [](const double value)
  { return dealii::Utilities::MPI::max(value, MPI_COMM_WORLD); };
  EXPECT_LT(largest(inside), 1e-3 * largest(scale));
  EXPECT_GT(largest(near_the_surface), 1e-3 * largest(scale));
}

TEST(ConsistentGradients, pass_the_patch_test_in_two_dimensions)
{
  for (const char *planes : {"", "x", "xy"})
  {
    Cloud<2> cloud(with("affine", "", planes));
    EXPECT_LT(cloud.error_of_rows(), 1e-12);
    EXPECT_LT(cloud.force_of_constant_stress(), 1e-8);
  }
}
