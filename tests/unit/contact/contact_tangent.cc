// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include "frozen_body.h"
#include "mesh_file_testing.h"

#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/model/tangent.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <utility>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      using dealii::Tensor;
      using Dof = std::pair<dealii::types::global_dof_index, unsigned int>; ///< node, component
      using Move = std::function<Tensor<1, 3>(const Tensor<1, 3> &)>;

      /** Where the upper block begins: by so little above the lower one that both touch. */
      constexpr double joint = 1. + 1e-11;

      /** The groups lower, 2 x 2 x 1 cells of the size 1, and upper, 3 x 3 x 1 cells of the size
       * 0.6 x 0.5 x 1, from x = @p start on. */
      std::string two_blocks(const double start)
      {
        std::ostringstream nodes, cells;
        nodes.precision(17);
        unsigned int n_nodes = 0, n_cells = 0;
        for (const unsigned int block : {0u, 1u})
        {
          const unsigned int n = 2 + block, first = n_nodes + 1;
          for (unsigned int k = 0; k < 2; ++k)
            for (unsigned int j = 0; j <= n; ++j)
              for (unsigned int i = 0; i <= n; ++i)
                nodes << ++n_nodes << " " << (block == 0 ? i : start + 0.6 * i) << " "
                      << (block == 0 ? 1. : 0.1 + 0.5 * j) * (block == 0 ? j : 1.) << " "
                      << (block == 0 ? k : joint + k) << "\n";
          const unsigned int row = n + 1, layer = row * row;
          for (unsigned int j = 0; j < n; ++j)
            for (unsigned int i = 0; i < n; ++i)
            {
              const unsigned int corner = first + j * row + i;
              cells << ++n_cells << " 5 2 " << block + 1 << " " << block + 1;
              for (const unsigned int z : {0u, layer})
                for (const unsigned int step : {0u, 1u, row + 1, row})
                  cells << " " << corner + z + step;
              cells << "\n";
            }
        }
        return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"lower\"\n3 2 "
               "\"upper\"\n$EndPhysicalNames\n$Nodes\n" +
               std::to_string(n_nodes) + "\n" + nodes.str() + "$EndNodes\n$Elements\n" +
               std::to_string(n_cells) + "\n" + cells.str() + "$EndElements\n";
      }

      std::string scene(const std::string &mesh, const std::string &contact)
      {
        std::string text = "set Dimension = 3\nset Materials = m\nset Parts = lower, upper\n" +
                           contact +
                           "subsection Mesh\nset Type = file\nsubsection file\nset File = " + mesh +
                           "\nend\nend\nsubsection Material: m\nset Model = elastic\nsubsection "
                           "elastic\nset Density = 1\nset Young's modulus = 1\nset Poisson's ratio "
                           "= 0.3\nend\nend\n";
        for (const std::string part : {"lower", "upper"})
          text += "subsection Part: " + part + "\nset Cells = group " + part +
                  "\nset Material = m\nset Formulation = fully integrated hexahedron\nend\n";
        return text;
      }

      const std::string plane = "set Conditions = middle\nsubsection Condition: middle\nset Type = "
                                "symmetry\nset Where = x < 1e-9\nend\n";

      std::string body_contact(const std::string &entries)
      {
        return "set Body contacts = joint\nsubsection Body contact: joint\nset Slave parts = "
               "upper\nset Master parts = lower\nset Damping = 0\n" +
               entries + "end\n";
      }

      std::string on_sphere(const std::string &entries)
      {
        return "set Contacts = ground\nsubsection Contact: ground\nset Surface = sphere\nset "
               "Method = surface\nset Damping = 0\n" +
               entries + "subsection sphere\nset Origin = 0, 0, -100\nset Radius = 100\nend\nend\n";
      }

      const std::string on_plane =
          "set Contacts = ground\nsubsection Contact: ground\nset Surface = "
          "plane\nset Method = surface\nset Damping = 0\nset Friction = "
          "0.4\nsubsection plane\nset Point = 0, 0, 0\nset Normal = 0, "
          "0, 1\nend\nend\n";

      /** The tangent of the contacts of a scene after one step of a motion from the start. */
      class Tangent
      {
      public:
        Tangent(const std::string &text, Move move)
            : body(text), model(*body.model), move(std::move(move))
        {
          constexpr double stiffer = 100., touch_distance = 1e-9;
          clock.stable_step = round_down(courant_limit(model).time_step) / std::sqrt(stiffer);
          force.reinit(model.state.partition());
          model.signals.trials(clock, touch_distance);
          for (const auto &process : model.processes)
            process->records.keep();
          evaluate({}, 0., 0.);
          clock.step = 1;
          clock.time = clock.previous_step = clock.next_step = 1.;
          model.signals.trials(clock, touch_distance);
          for (const auto &process : model.processes)
            process->records.keep();
        }

        /** Its difference to a difference quotient of the forces, over it. */
        double error(const double step = 1e-8)
        {
          evaluate({}, 0., 1.);
          std::map<std::pair<Dof, Dof>, double> matrix;
          std::set<Dof> dofs;
          NodalVector bound(model.state.partition());
          std::vector<ContactStiffness<3>> springs;
          tombolo::Tangent<3> tangent;
          tangent.springs = &springs;
          tangent.bound = &bound;
          for (const auto &process : model.processes)
            process->linearize(model, clock, tangent);
          for (const ContactStiffness<3> &stiffness : springs)
            for (const auto &row : stiffness.entries)
              for (const auto &column : stiffness.entries)
                for (unsigned int a = 0; a < 3; ++a)
                  for (unsigned int b = 0; b < 3; ++b)
                    if (is_free({row.node, a}) && is_free({column.node, b}))
                    {
                      dofs.insert({row.node, a});
                      matrix[{{row.node, a}, {column.node, b}}] +=
                          (stiffness.normal * row.normal[a] + row.weight * stiffness.slip[a]) *
                              column.normal[b] +
                          row.weight * (column.weight * stiffness.along[a][b] +
                                        (stiffness.along * column.shares)[a][b]);
                    }
          double difference = 0, norm = 0;
          for (const Dof &column : dofs)
          {
            evaluate(column, step, 1.);
            const std::vector<double> after = forces(dofs);
            evaluate(column, -step, 1.);
            const std::vector<double> before = forces(dofs);
            std::size_t k = 0;
            for (const Dof &row : dofs)
            {
              const double quotient = (before[k] - after[k]) / (2. * step);
              ++k;
              difference += std::pow(quotient - matrix[{row, column}], 2);
              norm += std::pow(quotient, 2);
            }
          }
          EXPECT_GT(norm, 0.);
          return std::sqrt(difference / norm);
        }

      private:
        bool is_free(const Dof &dof) const
        {
          for (const NodePartition::Reflected &on_plane :
               model.state.partition()->nodes_on_planes())
            if (on_plane.source == dof.first && on_plane.reflection.sign[dof.second] < 0.)
              return false;
          return true;
        }

        void evaluate(const Dof &dof, const double further, const double share)
        {
          for (const auto &process : model.processes)
            process->records.restore();
          NodalVector &position = model.state.position;
          position.fill(
              [&](const unsigned int i, double *const at)
              {
                const auto x = vector_of<3>(model.state.initial_position.node(i));
                const Tensor<1, 3> now = x + share * move(x);
                std::copy_n(&now[0], 3, at);
              });
          position.node(static_cast<unsigned int>(dof.first))[dof.second] += further;
          position.update_ghosts();
          force.set_zero();
          for (const auto &process : model.processes)
            process->act(model, clock, force);
        }

        std::vector<double> forces(const std::set<Dof> &dofs) const
        {
          std::vector<double> result;
          for (const Dof &dof : dofs)
            result.push_back(force.node(static_cast<unsigned int>(dof.first))[dof.second]);
          return result;
        }

        FrozenBody<3> body;
        Model<3> &model;
        Move move;
        Clock clock;
        NodalVector force;
      };

      /** What is above @p height is pressed by about 1e-4 and slides, in directions that change
       * from point to point; nothing crosses x = 0. */
      Move pressed(const double slide, const double height, const double depth = 1e-4)
      {
        return [=](const Tensor<1, 3> &x)
        {
          return x[2] < height ? Tensor<1, 3>()
                               : Tensor<1, 3>({slide * x[0], slide * (0.3 + 0.2 * x[0]),
                                               -depth * (1. + 0.2 * x[0] - 0.1 * x[1])});
        };
      }

      constexpr double between = 1. + 5e-12, everywhere = -1.;

      TEST(ContactTangent, of_bodies_is_the_derivative_of_their_forces)
      {
        // Edges that lie on each other, across which forces have a kink, are on the plane only.
        for (const std::string &planes : {std::string(), plane})
        {
          const TemporaryFile mesh(two_blocks(planes.empty() ? 0.1 : 0.), ".msh");
          for (const auto &[entries, slide] :
               {std::make_pair("", 1e-2), std::make_pair("set Friction = 0.4\n", 1e-6),
                std::make_pair("set Friction = 0.4\n", 1e-2),
                std::make_pair("set Friction = 0.4\nset Shear limit = 1e-3\n", 1e-2),
                std::make_pair("set Type = tied\n", 1e-6)})
          {
            SCOPED_TRACE(planes + entries + std::to_string(slide));
            EXPECT_LE(
                Tangent(scene(mesh.path, planes + body_contact(entries)), pressed(slide, between))
                    .error(),
                2e-3);
          }
        }
      }

      TEST(ContactTangent, of_faces_is_the_derivative_of_their_forces)
      {
        const TemporaryFile mesh(two_blocks(0.), ".msh");
        for (const std::string &planes : {std::string(), plane})
          for (const auto &[entries, slide] :
               {std::make_pair("", 1e-2), std::make_pair("set Friction = 0.4\n", 1e-6),
                std::make_pair("set Friction = 0.4\n", 1e-2)})
          {
            SCOPED_TRACE(planes + entries + std::to_string(slide));
            EXPECT_LE(Tangent(scene(mesh.path, planes + on_sphere(entries)),
                              pressed(slide, everywhere, 2e-3))
                          .error(),
                      2e-3);
          }
      }

      TEST(ContactTangent, of_faces_holds_where_points_touch_that_are_not_pressed)
      {
        const TemporaryFile mesh(two_blocks(0.), ".msh");
        const Move move = [](const Tensor<1, 3> &x) {
          return Tensor<1, 3>({0., 0., x[0] > 1.5 ? -1e-4 : 5e-10});
        };
        EXPECT_LE(Tangent(scene(mesh.path, on_plane), move).error(1e-10), 2e-3);
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
