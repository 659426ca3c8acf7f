// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include <gtest/gtest.h>

#include "model_scene.h"
#include "nodal_fields.h"
#include <tombolo/physics/failure/conversion.h>

#include <mesh_testing.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <functional>
#include <sstream>
#include <string>

/** Cells that become particles: what they keep, on disordered cells. */
namespace tombolo
{
  namespace
  {
    struct ConversionCase
    {
      std::string formulation = "hexahedron";
      std::string kernel = "total Lagrangian";
      std::string smoothing = "affine";
      std::string options; ///< of the elements
      bool has_heat = false;
      bool has_other_particles = false; ///< a part of particles from the start, at x > 3
      bool has_strain = true;
      unsigned int n_layers = 0;
      std::string contact; ///< the name of a wall 0.1 below the body; empty: none
      double target_step = 0.;
    };

    std::string text_of(const ConversionCase &words)
    {
      std::ostringstream text;
      text << "set Dimension = 3\nset Materials = m\nset Parts = a, b"
           << (words.has_other_particles ? ", c" : "")
           << "\nsubsection Mesh\nset Type = box\nsubsection box\nset Upper corner = 4, 4, 4\nset "
              "Cells = 4, 4, 4\nset Disorder = 0.15\nset Surface nodes = slide\nend\nend\n"
           << "subsection Part: a\nset Cells = "
           << (words.has_other_particles ? "x < 3" : "otherwise")
           << "\nset Formulation = " << words.formulation << "\nset Material = m\nsubsection "
           << words.formulation << (words.has_strain ? "\nset Conversion strain = 0.3" : "")
           << "\nset Conversion layers = " << words.n_layers << "\n"
           << words.options << "\nend\nend\n";
      const std::string particles =
          "\nset Formulation = momentum consistent particle\nset Material "
          "= m\nsubsection momentum consistent particle\nset Smoothing "
          "= " +
          words.smoothing + "\n";
      text << "subsection Part: b\nset Cells = from a" << particles
           << "set Configuration = " << words.kernel << "\n"
           << (words.kernel == "updated Lagrangian" ? "set Rebuild interval = 10\n" : "")
           << "end\nend\n";
      if (words.has_other_particles)
        text << "subsection Part: c\nset Cells = otherwise" << particles << "end\nend\n";
      text << "subsection Material: m\nset Model = j2 plasticity\nsubsection j2 plasticity\nset "
              "Density = 2\nset Young's modulus = 100\nset Poisson's ratio = 0.3\nset "
              "Taylor-Quinney coefficient = "
           << (words.has_heat ? "0.9" : "0")
           << "\nset Flow stress = linear hardening\nsubsection linear hardening\nset Yield stress "
              "= 1\nend\nend\n";
      const std::string contact =
          words.contact.empty()
              ? ""
              : "end\nset Contacts = " + words.contact + "\nsubsection Contact: " + words.contact +
                    "\nset Surface = plane\nsubsection plane\nset Point = 0, 0, -0.1\nset Normal = "
                    "0, 0, 1\nend\n";
      if (words.has_heat)
        text << "subsection Heat\nset Specific heat capacity = 3\nset Conductivity = 0.3\nset "
                "Initial temperature = 5\nend\n";
      text << contact << "end\n";
      if (words.target_step > 0.)
        text << "subsection Scaling\nset Target time step = " << words.target_step << "\nend\n";
      return text.str();
    }

    /** A scene between two steps. */
    class ConvertingBody : public testing::ModelScene<3>
    {
    public:
      explicit ConvertingBody(const ConversionCase &words) : ModelScene(text_of(words))
      {
        model->state.unsmoothed_velocity.fill(
            [&](const unsigned int i, double *const v)
            {
              const double *const x = model->state.initial_position.node(i);
              v[0] = 1. + 0.3 * x[1];
              v[1] = 0.2 * x[0] - 0.1 * x[2];
              v[2] = std::sin(x[0]);
            });
      }

      /** Sets a component of a field of the elements to a function of the middles of cells. */
      void set(const std::string &field, const unsigned int component,
               const std::function<double(const dealii::Point<3> &)> &value)
      {
        Formulation<3> &part = *model->parts[0].formulation;
        double *const values = part.points().component(part.points().find_field(field), component);
        const unsigned int n_points = part.n_points_per_cell();
        for (unsigned int cell = 0; cell < part.n_cells(); ++cell)
        {
          dealii::Point<3> middle;
          for (unsigned int q = 0; q < n_points; ++q)
            middle += part.initial_point_positions()[part.point_of_cell(cell, q)] / n_points;
          for (unsigned int q = 0; q < n_points; ++q)
            values[part.point_of_cell(cell, q)] = value(middle);
        }
      }

      /** Cells whose middle is here have flowed. */
      void strain(const std::function<bool(const dealii::Point<3> &)> &is_strained)
      {
        set("effective plastic strain", 0,
            [&](const dealii::Point<3> &x) { return is_strained(x) ? 0.4 : 0.1; });
      }

      tombolo::Conversion<3> &conversion()
      {
        return *model->find_process<tombolo::Conversion<3>>();
      }

      double lost_energy()
      {
        tombolo::EnergyAccounts accounts;
        conversion().observed.energies(accounts);
        return accounts["conversion loss"];
      }

      bool convert(double *const lost = nullptr)
      {
        tombolo::Conversion<3> &process = conversion();
        const double before = lost_energy();
        const bool has_converted = process.find_converting_cells(*model, Clock());
        if (has_converted)
          process.convert(*model);
        if (lost != nullptr)
          *lost = dealii::Utilities::MPI::sum(lost_energy() - before, MPI_COMM_WORLD);
        return has_converted;
      }

      double sum(const std::function<double(unsigned int)> &node_value) const
      {
        double result = 0;
        for (unsigned int i = 0; i < model->state.partition()->n_owned(); ++i)
          result += node_value(i);
        return dealii::Utilities::MPI::sum(result, MPI_COMM_WORLD);
      }

      double mass() const
      {
        return sum([&](const unsigned int i) { return *model->state.mass.node(i); });
      }

      double momentum(const unsigned int d) const
      {
        return sum(
            [&](const unsigned int i)
            { return *model->state.mass.node(i) * model->state.unsmoothed_velocity.node(i)[d]; });
      }

      /** Over all parts and ranks. */
      double energy(const std::string &which) const
      {
        double result = 0;
        for (const Part<3> &part : model->parts)
          result += part.formulation->energies()[which];
        return dealii::Utilities::MPI::sum(result, MPI_COMM_WORLD);
      }
    };

    bool is_in_corner(const dealii::Point<3> &x)
    {
      return x[0] < 2. && x[1] < 2. && x[2] < 2.;
    }
    bool is_beside_corner(const dealii::Point<3> &x)
    {
      return x[0] < 3. && x[1] < 3. && x[2] < 3.;
    }

    bool is_anywhere(const dealii::Point<3> &)
    {
      return true;
    }

    class Conversion : public ::testing::TestWithParam<ConversionCase>
    {};

    TEST_P(Conversion, keeps_mass_and_momentum_and_books_energy)
    {
      ConvertingBody body(GetParam());
      for (unsigned int c = 0; c < 6; ++c)
        body.set("stress", c,
                 [&](const dealii::Point<3> &x)
                 { return 0.1 * std::sin(c + x[0] + 2. * x[1] - x[2]); });
      body.set("plastic work", 0, [](const dealii::Point<3> &x) { return 1. + x[0]; });
      body.strain(is_in_corner);
      const auto energy = [&]
      {
        return body.energy("elastic energy") + body.energy("plastic dissipation") +
               body.energy("hourglass energy");
      };
      for (const auto &where :
           {is_in_corner, GetParam().n_layers == 0 ? is_beside_corner : is_anywhere})
      {
        body.strain(where);
        const double mass = body.mass(), before = energy();
        const double momentum[3] = {body.momentum(0), body.momentum(1), body.momentum(2)};
        NodalVector masses = body.model->state.mass.copy();
        double lost = 0;
        EXPECT_TRUE(body.convert(&lost));
        EXPECT_NEAR(body.mass(), mass, 1e-13 * mass);
        for (unsigned int d = 0; d < 3; ++d)
          EXPECT_NEAR(body.momentum(d), momentum[d], 1e-13 * mass);
        EXPECT_LE(testing::largest_difference(body.model->state.mass, masses), 1e-14 * mass);
        EXPECT_NEAR(energy() + lost, before, 1e-12 * before);
        // Means of this stress, and the weights of these cells.
        EXPECT_GT(lost, 0.);
        EXPECT_LT(lost, 0.03 * before);
        EXPECT_FALSE(body.convert());
      }
      EXPECT_EQ(body.conversion().n_converted_cells(), GetParam().n_layers == 0 ? 27u : 64u);
    }

    TEST_P(Conversion, hands_over_what_is_uniform)
    {
      ConvertingBody body(GetParam());
      for (unsigned int c = 0; c < 6; ++c)
        body.set("stress", c, [&](const dealii::Point<3> &) { return 0.1 * (c + 1.); });
      body.set("plastic work", 0, [](const dealii::Point<3> &) { return 0.7; });
      for (const auto &where :
           {is_in_corner, GetParam().n_layers == 0 ? is_beside_corner : is_anywhere})
      {
        body.strain(where);
        body.set("effective plastic strain", 0,
                 [&](const dealii::Point<3> &x) { return where(x) ? 0.4 : 0.; });
        ASSERT_TRUE(body.convert());
      }
      Formulation<3> &particles = *body.model->parts[1].formulation;
      const MaterialPoints &points = particles.points();
      for (unsigned int i = 0; i < points.size(); ++i)
      {
        for (unsigned int c = 0; c < 6; ++c)
          EXPECT_NEAR(points.component(MaterialPoints::stress, c)[i], 0.1 * (c + 1.), 1e-13);
        EXPECT_NEAR(points.component(MaterialPoints::volume_ratio, 0)[i], 1., 1e-13);
        EXPECT_NEAR(points.component(points.find_field("plastic work"), 0)[i], 0.7, 1e-13);
        if (GetParam().n_layers == 0)
        {
          EXPECT_NEAR(points.component(points.find_field("effective plastic strain"), 0)[i], 0.4,
                      1e-13);
        }
      }
      // Particles of the cells, and their mass, whose shape functions sum to one.
      Stencils &shape = body.model->parts[1].particles->stencils();
      double mass = 0;
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
      {
        mass += shape.mass[i];
        const Stencils::Row row = shape.row(i);
        double sum = 0;
        for (unsigned int k = 0; k < row.size; ++k)
          sum += row.value[k];
        EXPECT_NEAR(sum, 1., 1e-12);
      }
      const unsigned int n = body.model->nodes->degree() * (GetParam().n_layers == 0 ? 3 : 4) + 1;
      EXPECT_EQ(dealii::Utilities::MPI::sum(shape.n_particles(), MPI_COMM_WORLD), n * n * n);
      EXPECT_NEAR(dealii::Utilities::MPI::sum(mass, MPI_COMM_WORLD),
                  GetParam().n_layers == 0 ? 2. * 27. : 2. * 64.,
                  GetParam().n_layers == 0 ? 2. : 1e-12);
    }

    std::string name_of(const ::testing::TestParamInfo<ConversionCase> &info)
    {
      const ConversionCase &words = info.param;
      std::string name = words.formulation + " " + words.kernel + " " + words.smoothing +
                         (words.n_layers > 0 ? " layers" : "");
      for (char &letter : name)
        if (letter == ' ')
          letter = '_';
      return name;
    }

    ConversionCase make(const std::string &formulation, const std::string &kernel,
                        const std::string &smoothing, const unsigned int n_layers)
    {
      ConversionCase words;
      words.formulation = formulation;
      words.kernel = kernel;
      words.smoothing = smoothing;
      words.n_layers = n_layers;
      return words;
    }

    INSTANTIATE_TEST_SUITE_P(
        elements, Conversion,
        ::testing::Values(make("hexahedron", "total Lagrangian", "affine", 0),
                          make("hexahedron", "updated Lagrangian", "paper", 0),
                          make("hexahedron", "current", "affine", 0),
                          make("hexahedron", "total Lagrangian", "fe matched", 1),
                          make("lagrange hexahedron", "total Lagrangian", "affine", 0),
                          make("fully integrated hexahedron", "total Lagrangian", "affine", 0),
                          make("fully integrated hexahedron", "updated Lagrangian", "affine", 0)),
        name_of);

    TEST(Conversion, a_deformed_cell_gives_its_deformation)
    {
      // Particles of a body that has been stretched as a whole have that as their deformation.
      for (const char *kernel : {"total Lagrangian", "updated Lagrangian", "current"})
      {
        ConversionCase words;
        words.kernel = kernel;
        ConvertingBody body(words);
        NodalState &state = body.model->state;
        const double stretch[3][3] = {{1.2, 0.1, 0.}, {0., 0.9, -0.05}, {0.02, 0., 1.1}};
        for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
          for (unsigned int a = 0; a < 3; ++a)
          {
            state.position.node(i)[a] = 0.3;
            for (unsigned int b = 0; b < 3; ++b)
              state.position.node(i)[a] += stretch[a][b] * state.initial_position.node(i)[b];
          }
        state.position.update_ghosts();
        body.strain(is_in_corner);
        ASSERT_TRUE(body.convert());
        // In the total Lagrangian kernel, since the start; in the others, since now.
        Stencils &shape = body.model->parts[1].particles->stencils();
        const bool is_total = std::string(kernel) == "total Lagrangian";
        for (unsigned int i = 0; i < shape.n_particles(); ++i)
        {
          const Stencils::Row row = shape.row(i);
          for (unsigned int a = 0; a < 3; ++a)
            for (unsigned int b = 0; b < 3; ++b)
            {
              double component = 0;
              for (unsigned int k = 0; k < row.size; ++k)
                component += body.model->state.position.node(row.neighbour[k])[a] *
                             row.gradient[Stencils::n_gradient * k + b];
              EXPECT_NEAR(component, is_total ? stretch[a][b] : (a == b ? 1. : 0.), 1e-11);
            }
        }
      }
    }

    TEST(Conversion, keeps_heat_that_nodes_have_not_got)
    {
      for (const bool all_convert : {false, true})
      {
        SCOPED_TRACE(all_convert);
        ConversionCase words;
        words.has_heat = true;
        ConvertingBody body(words);
        body.set("plastic work", 0, [](const dealii::Point<3> &x) { return 1. + x[0]; });
        body.strain([&](const dealii::Point<3> &x) { return all_convert || is_in_corner(x); });
        const auto pending = [&]
        {
          double sum = 0;
          for (const Part<3> &part : body.model->parts)
            sum += part.formulation->pending_plastic_heat();
          return dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
        };
        const auto enthalpy = [&]
        {
          return body.sum([&](const unsigned int i)
                          { return *body.model->heat->state.enthalpy.node(i); });
        };
        const double before = pending(), stored = enthalpy();
        ASSERT_GT(before, 0.);
        ASSERT_TRUE(body.convert());
        EXPECT_NEAR(pending(), before, 1e-13 * before);
        EXPECT_NEAR(enthalpy(), stored, 1e-13 * stored);
      }
    }

    TEST(Conversion, nodes_of_other_particles_are_shared)
    {
      ConversionCase words;
      words.has_other_particles = true;
      words.n_layers = 1;
      ConvertingBody body(words);
      const double mass = body.mass();
      body.strain(is_beside_corner);
      ASSERT_TRUE(body.convert());
      EXPECT_NEAR(body.mass(), mass, 1e-13 * mass);
      EXPECT_EQ(body.conversion().n_converted_cells(), 48u);
    }

    TEST(Conversion, particles_have_the_inertia_of_the_cells_that_they_are_made_of)
    {
      for (const bool is_smooth : {false, true})
      {
        ConversionCase words;
        words.smoothing = is_smooth ? "affine" : "none";
        words.target_step = 0.16;
        ConvertingBody body(words);
        Model<3> &model = *body.model;
        const NodalVector inertia = model.bridge->mass().copy(), mass = model.body_mass().copy();
        EXPECT_GT(testing::sum_of_nodes(inertia) - testing::sum_of_nodes(mass), 1.);
        for (const auto &where : {is_in_corner, is_beside_corner, is_anywhere})
        {
          body.strain(where);
          ASSERT_TRUE(body.convert());
          EXPECT_LE(testing::largest_difference(model.bridge->mass(), inertia), 1e-12);
          EXPECT_LE(testing::largest_difference(model.body_mass(), mass), 1e-12);
        }
      }
    }

    TEST(Conversion, looks_at_the_distance_from_a_contact)
    {
      // Cells of size 1 from z = 0 to 4, four by four in a layer; a wall below them.
      ConversionCase words;
      words.has_strain = false;
      words.options = "set Conversion gap = 1.5\nset Conversion contact = wall";
      words.contact = "wall";
      ConvertingBody body(words);
      EXPECT_TRUE(body.convert());
      // Nodes about 0.1 and 1.1 from it are near, those at 2.1 are not.
      EXPECT_EQ(body.conversion().n_converted_cells(), 32u);
      EXPECT_FALSE(body.convert());
    }

    TEST(Conversion, by_the_distance_from_no_contact_is_refused)
    {
      const auto refusal = [](const std::string &options)
      {
        return testing::input_error(
            [&]
            {
              ConversionCase words;
              words.has_strain = false;
              words.options = options;
              words.contact = "wall";
              ConvertingBody body(words);
            });
      };
      EXPECT_TRUE(testing::contains(refusal("set Conversion gap = 1.5"), "Conversion contact"));
      const std::string unknown = refusal("set Conversion gap = 1.5\nset Conversion contact = wal");
      EXPECT_TRUE(testing::contains(unknown, "Conversion contact\" = \"wal\""));
      EXPECT_TRUE(testing::contains(unknown, "Did you mean \"wall\"?"));
      EXPECT_TRUE(
          testing::contains(refusal("set Conversion gap = -1\nset Conversion contact = wall"),
                            "Conversion gap\" = \"-1\""));
    }

    TEST(Conversion, looks_at_the_shape_and_the_step)
    {
      for (const char *limit : {"Conversion scaled Jacobian = 0.5", "Conversion time step = 0.06"})
      {
        ConversionCase words;
        words.has_strain = false;
        words.options = std::string("set ") + limit;
        ConvertingBody body(words);
        EXPECT_FALSE(body.convert()) << limit;
        NodalVector &x = body.model->state.position;
        for (unsigned int i = 0; i < x.partition()->n_owned(); ++i)
          if (x.node(i)[2] > 3.5) // the last layer is sheared, and flattened
          {
            x.node(i)[0] += 1.5;
            x.node(i)[2] -= 0.5;
          }
        x.update_ghosts();
        EXPECT_TRUE(body.convert()) << limit;
        EXPECT_EQ(body.conversion().n_converted_cells(), 16u) << limit;
      }
    }
  } // namespace
} // namespace tombolo
