// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include "model_scene.h"

#include <tombolo/formulations/particles/patch_test.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

using namespace tombolo;

namespace
{
  struct Choice
  {
    std::string functions;
    std::string smoothing;
    std::string planes = ""; ///< axes with a plane of symmetry at the lower end: "x", "xy"
    std::string clamp = "";  ///< a predicate
  };

  /** A disordered block of particles. */
  template <int dim>
  class Cloud : public tombolo::testing::ModelScene<dim>
  {
  public:
    explicit Cloud(const Choice &choice) : tombolo::testing::ModelScene<dim>(text_of(choice)) {}

    static std::string text_of(const Choice &choice)
    {
      std::string names = choice.clamp.empty() ? "" : "clamp", sections;
      if (!choice.clamp.empty())
        sections = "subsection Condition: clamp\nset Type = clamp\nset Where = " + choice.clamp +
                   "\nend\n";
      for (const char axis : choice.planes)
      {
        names += (names.empty() ? "" : ", ") + std::string("plane ") + axis;
        sections += std::string("subsection Condition: plane ") + axis +
                    "\nset Type = symmetry\nset Where = " + axis + " < 1e-9\nend\n";
      }
      std::ostringstream text;
      text << "set Dimension = " << dim
           << "\nset Materials = m\nset Parts = b\nset Conditions = " << names << "\n"
           << sections << "subsection Mesh\nset Type = box\nsubsection box\nset Upper corner = "
           << (dim == 2 ? "1, 1.5\nset Cells = 6, 9" : "1, 1.5, 0.8\nset Cells = 5, 6, 4")
           << "\nset Disorder = 0.25\nset Surface nodes = slide\nend\nend\n"
              "subsection Part: b\nset Cells = all\nset Formulation = momentum consistent "
              "particle\nset Material = m\nsubsection momentum consistent particle\n"
              "set Smoothing = "
           << choice.smoothing << "\nset Shape functions = " << choice.functions
           << "\nend\nend\nsubsection Material: m\nset Model = elastic\nsubsection elastic\n"
              "set Density = 2\nset Young's modulus = 3\nset Poisson's ratio = 0.3\nend\nend\n";
      return text.str();
    }

    double defect() const
    {
      return model->parts.front().particles->patch_test(model->state.initial_position).defect;
    }

    /** The norm of the forces of a uniform pressure less those of its tractions, over the latter.
     */
    double defect_of_pressure()
    {
      Formulation<dim> &formulation = *model->parts.front().formulation;
      for (unsigned int c = 0; c < 6; ++c)
        std::fill_n(formulation.points().component(MaterialPoints::stress, c),
                    formulation.points().padded_size(), c < 3 ? 1. : 0.);
      const auto &partition = model->state.partition();
      NodalVector force(partition), rest(partition), loads(partition), traction(partition);
      formulation.add_internal_force({&model->state.initial_position, &rest, 0., nullptr}, force);
      force.add_to_owners();

      PartSetup<dim> body;
      body.nodes = model->nodes.get();
      PartBoundary<dim> boundary;
      boundary.initialize(body);
      boundary.add_areas(model->state.initial_position, loads, loads);
      loads.add_to_owners();
      std::vector<unsigned int> all;
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        all.push_back(i);
      traction.set_zero();
      model->bridge->load_transfer().add_force_of_loads(all, loads, traction);
      traction.add_to_owners();
      traction.add_to_owners();
      double residual_square = 0, traction_square = 0;
      for (const unsigned int i : all)
        for (unsigned int d = 0; d < dim; ++d)
        {
          residual_square += std::pow(force.node(i)[d] + traction.node(i)[d], 2);
          traction_square += std::pow(traction.node(i)[d], 2);
        }
      return std::sqrt(dealii::Utilities::MPI::sum(residual_square, MPI_COMM_WORLD) /
                       dealii::Utilities::MPI::sum(traction_square, MPI_COMM_WORLD));
    }

    using tombolo::testing::ModelScene<dim>::model;
  };

  template <int dim>
  void expect_defect_of_pressure(const Choice &choice)
  {
    Cloud<dim> cloud(choice);
    const double defect = cloud.defect();
    EXPECT_NEAR(defect, cloud.defect_of_pressure(), 1e-12);
    if (choice.functions == "cell averages")
    {
      EXPECT_LT(defect, 1e-12);
    }
    else
    {
      EXPECT_GT(defect, 1e-3);
    }
  }
} // namespace

TEST(PatchTest, tells_what_forces_a_uniform_pressure_makes_that_its_tractions_do_not_bear)
{
  const std::string least_squares = "moving least squares", averages = "cell averages";
  for (const Choice &choice :
       {Choice{least_squares, "affine"}, Choice{least_squares, "none"},
        Choice{least_squares, "fe matched"}, Choice{least_squares, "paper", "x"},
        Choice{least_squares, "none", "xz"}, Choice{averages, "affine"},
        Choice{averages, "affine", "xyz"}, Choice{averages, "none", "xz"}})
    expect_defect_of_pressure<3>(choice);
  for (const std::string planes : {"", "x", "xy"})
    for (const std::string &functions : {least_squares, averages})
      expect_defect_of_pressure<2>({functions, "affine", planes});
}

TEST(PatchTest, reckons_with_prescribed_particles_where_tractions_enter)
{
  expect_defect_of_pressure<3>({"moving least squares", "affine", "", "x < 1e-9 || z < 1e-9"});
}
