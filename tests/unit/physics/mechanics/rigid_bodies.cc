// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
// Rigid parts of a model: their inertia, and the balances of their motion.
#include "frozen_body.h"

#include <tombolo/formulations/elements/rigid_cells.h>
#include <tombolo/physics/mechanics/rigid_bodies.h>

#include <deal.II/base/numbers.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      /** A rigid part of all cells of a mesh, with density 2. */
      std::string rigid_scene(const int dim, const std::string &mesh, const std::string &motion,
                              const std::string &more = "")
      {
        return "set Dimension = " + std::to_string(dim) + "\nset Parts = r\nset Materials = m\n" +
               more + "subsection Mesh\n" + mesh +
               "end\nsubsection Part: r\nset Cells = all\nset Formulation = rigid\n"
               "set Material = m\nsubsection rigid\n" +
               motion +
               "end\nend\nsubsection Material: m\nset Model = heat conductor\n"
               "subsection heat conductor\nset Density = 2\nend\nend\n"
               "subsection Time step\nset Fixed = 0.01\nend\n";
      }

      std::string box(const std::string &corner, const std::string &cells)
      {
        return "set Type = box\nsubsection box\nset Upper corner = " + corner +
               "\nset Cells = " + cells + "\nset Disorder = 0.2\nend\n";
      }

      struct RigidScene : BookedBody
      {
        using BookedBody::BookedBody;

        EnergyBalance next(const double time_step)
        {
          return BookedBody::next(time_step, time_step);
        }

        const RigidBody<3> &body() const
        {
          return model->find_process<RigidBodies<3>>()->all().front();
        }
      };

      const std::string free_motion = "set Displacement = free; free; free\nset Rotation = free\n";

      TEST(RigidBodies, a_box_has_the_inertia_of_its_closed_form_on_any_cells)
      {
        for (const std::string cells : {"1, 1, 1", "3, 2, 4"})
          for (const std::string degree : {"1", "2"})
          {
            SCOPED_TRACE(cells + " cells of degree " + degree);
            const RigidScene scene(rigid_scene(3, box("1, 2, 3", cells),
                                               free_motion + "set Degree = " + degree + "\n"));
            const RigidInertia &inertia = scene.body().inertia();
            EXPECT_NEAR(inertia.mass, 12., 1e-12);
            for (unsigned int a = 0; a < 3; ++a)
            {
              EXPECT_NEAR(inertia.centre[a], 0.5 * (a + 1.), 1e-13);
              for (unsigned int b = 0; b < 3; ++b)
                EXPECT_NEAR(inertia.second[a][b], a == b ? (a + 1.) * (a + 1.) : 0., 1e-12);
            }
            // Corners are farther out than their cells. Lobatto's rule is exact in a box; in cells
            // that are disordered the volume element needs the degree beyond it.
            const bool is_one_cell = cells[0] == '1';
            const double expected = degree == "2" ? 1. : is_one_cell ? 3. : 1.3;
            EXPECT_NEAR(trace(inertia.nodal_second) / trace(inertia.second), expected,
                        is_one_cell     ? 1e-12
                        : degree == "2" ? 1e-6
                                        : 0.2);
          }
      }

      TEST(RigidBodies, a_cylinder_has_the_inertia_of_its_regular_polygon)
      {
        const RigidScene scene(rigid_scene(
            3,
            "set Type = cylinder\nsubsection cylinder\nset Radius = 1\n"
            "set Length = 2\nset Core cells = 4\nset Rings = 2\nset Cells along axis = 2\n"
            "set Axis = x\nend\n",
            free_motion));
        const RigidInertia &inertia = scene.body().inertia();
        const double n_sides = 16., side = 2. * std::sin(dealii::numbers::PI / n_sides);
        const double area = 0.5 * n_sides * std::sin(2. * dealii::numbers::PI / n_sides);
        const double mass = 2. * area * 2., about_axis = mass * (6. - side * side) / 12.;
        EXPECT_NEAR(inertia.mass, mass, 1e-12);
        EXPECT_NEAR(inertia.centre[0], 1., 1e-13);
        const dealii::Tensor<2, 3> tensor = inertia_of(inertia.second);
        for (unsigned int a = 0; a < 3; ++a)
          for (unsigned int b = 0; b < 3; ++b)
            EXPECT_NEAR(tensor[a][b],
                        a != b   ? 0.
                        : a == 0 ? about_axis
                                 : 0.5 * about_axis + mass * 4. / 12.,
                        1e-12);
        // Of the circle: ½ m R² with the mass of the circle.
        EXPECT_NEAR(about_axis, 2. * dealii::numbers::PI, 0.06 * 2. * dealii::numbers::PI);
      }

      TEST(RigidBodies, a_free_body_that_falls_and_tumbles_keeps_all_balances)
      {
        RigidScene scene(rigid_scene(
            3, box("1, 2, 3", "2, 2, 2"),
            free_motion + "set Initial spin = 0.02, 1, 0.01\nset Initial velocity = 0.1, 0.2, 0\n",
            "set Conditions = weight\nsubsection Condition: weight\nset Type = gravity\n"
            "set Function = 0; 0; -1\nend\n"));
        double largest = 0, momentum = 0, angular = 0;
        double fallen = 1.5, velocity = 0.;
        for (unsigned int n = 0; n < 400; ++n)
        {
          const double step = n % 3 == 0 ? 0.02 : 0.01;
          velocity -= 0.5 * (scene.clock.previous_step + step);
          fallen += step * velocity;
          const EnergyBalance balance = scene.next(step);
          largest = std::max(largest, std::abs(balance.error));
          momentum = std::max(momentum, balance.momentum_drift);
          angular = std::max(angular, balance.angular_momentum_drift);
        }
        EXPECT_LT(largest, 1e-4);
        EXPECT_LT(momentum, 1e-12);
        EXPECT_LT(angular, 1e-12);
        const RigidBodyBalance now = scene.body().balance();
        EXPECT_NEAR(now.position[0], 0.5 + 0.1 * scene.clock.time, 1e-12);
        EXPECT_NEAR(now.position[2], fallen, 1e-12);
        // Nodes are where the body is.
        for (unsigned int i = 0; i < scene.model->state.partition()->n_owned(); ++i)
          for (unsigned int j = 0; j < i; ++j)
          {
            double before = 0, after = 0;
            for (unsigned int d = 0; d < 3; ++d)
            {
              const NodalVector &x = scene.model->state.position,
                                &start = scene.model->state.initial_position;
              before += std::pow(start.node(i)[d] - start.node(j)[d], 2);
              after += std::pow(x.node(i)[d] - x.node(j)[d], 2);
            }
            EXPECT_NEAR(after, before, 1e-12);
          }
      }

      TEST(RigidBodies, an_initial_condition_moves_the_body_by_its_momenta)
      {
        // A rigid motion about the origin is met to the last digit.
        const RigidScene scene(
            rigid_scene(3, box("1, 2, 3", "2, 1, 2"), free_motion,
                        "set Initial conditions = i\nsubsection Initial condition: i\n"
                        "set Velocity = 0.3*z - 0.2*y + 1; 0.2*x - 0.1*z; 0.1*y - 0.3*x\nend\n"));
        const RigidBodyBalance now = scene.body().balance();
        EXPECT_NEAR(now.spin[0], 0.1, 1e-13);
        EXPECT_NEAR(now.spin[1], 0.3, 1e-13);
        EXPECT_NEAR(now.spin[2], 0.2, 1e-13);
        EXPECT_NEAR(now.velocity[0], 0.3 * 1.5 - 0.2 * 1. + 1., 1e-13);
        for (unsigned int i = 0; i < scene.model->state.partition()->n_owned(); ++i)
        {
          const double *const x = scene.model->state.initial_position.node(i);
          EXPECT_NEAR(scene.model->state.unsmoothed_velocity.node(i)[1], 0.2 * x[0] - 0.1 * x[2],
                      1e-13);
        }
      }

      TEST(RigidBodies, nodes_shared_with_elements_move_with_the_body_and_balances_hold)
      {
        RigidScene scene(
            "set Dimension = 3\nset Parts = r, e\nset Materials = m, n\nset Initial conditions = "
            "i\nsubsection Initial condition: i\nset Velocity = 0.01*y; 0.02*x; 0.01*sin(x)\nend\n"
            "subsection Mesh\n" +
            box("4, 1, 1", "8, 2, 2") +
            "end\nsubsection Part: r\nset Cells = x < 2\nset Formulation = rigid\n"
            "set Material = m\nsubsection rigid\n" +
            free_motion +
            "end\nend\nsubsection Part: e\nset Cells = otherwise\nset Formulation = fully "
            "integrated hexahedron\nset Material = n\nend\n"
            "subsection Material: m\nset Model = heat conductor\nsubsection heat conductor\n"
            "set Density = 2\nend\nend\nsubsection Material: n\nset Model = elastic\n"
            "subsection elastic\nset Density = 1\nset Young's modulus = 1\n"
            "set Poisson's ratio = 0.3\nend\nend\n");
        // The cells of density 2, and half a layer of elements of length 1/2.
        EXPECT_NEAR(scene.body().inertia().mass, 2. * 2. + 0.25, 0.05);
        double momentum = 0, angular = 0, energy = 0;
        for (unsigned int n = 0; n < 200; ++n)
        {
          const EnergyBalance balance = scene.next(0.1);
          momentum = std::max(momentum, balance.momentum_drift);
          angular = std::max(angular, balance.angular_momentum_drift);
          energy = std::max(energy, std::abs(balance.error));
        }
        EXPECT_LT(momentum, 1e-12);
        EXPECT_LT(angular, 1e-12);
        EXPECT_LT(energy, 0.01);
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
