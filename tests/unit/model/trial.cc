// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "frozen_body.h"
#include "text_testing.h"

#include <tombolo/model/trial.h>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      std::string plastic_block_of(const std::string &formulation, const std::string &options)
      {
        Block block;
        block.formulation = formulation;
        block.options = options;
        block.cells = {3, 2, 2};
        return changed(parameters_of(block), "set Model = elastic\nsubsection elastic\n",
                       "set Model = j2 plasticity\nsubsection j2 plasticity\nset Flow stress "
                       "= linear hardening\nsubsection linear hardening\nset Yield stress = "
                       "0.002\nset Hardening modulus = 0.02\nend\n");
      }

      /** The forces of a body that is sheared by @p shear within a step. */
      std::vector<double> forces(Model<3> &model, const double shear)
      {
        NodalVector velocity(model.state.partition()), force(model.state.partition());
        for (unsigned int i = 0; i < model.state.partition()->n_local(); ++i)
        {
          const double *const x = model.state.initial_position.node(i);
          velocity.node(i)[0] = shear * (x[1] + 0.3 * x[1] * x[2]);
          for (unsigned int d = 0; d < 3; ++d)
            model.state.position.node(i)[d] = x[d] + velocity.node(i)[d];
        }
        for (Part<3> &part : model.parts)
        {
          if (part.particles != nullptr)
            part.particles->stencils().inverse_deformation_is_current = false;
          part.formulation->add_internal_force({&model.state.position, &velocity, 1.}, force);
        }
        return {force.data(), force.data() + 4 * force.partition()->n_local()};
      }

      std::vector<double> state_of(const Model<3> &model)
      {
        std::vector<double> result;
        for (const Part<3> &part : model.parts)
        {
          const MaterialPoints &points = part.formulation->points();
          for (unsigned int f = 0; f < points.fields().size(); ++f)
            for (unsigned int c = 0; c < points.fields()[f].n_components; ++c)
              result.insert(result.end(), points.component(f, c),
                            points.component(f, c) + points.size());
        }
        return result;
      }

      const std::vector<std::pair<std::string, std::string>> kinds = {
          {"hexahedron", ""},
          {"fully integrated hexahedron", ""},
          {"particles", "set Dilation = 1.8"}};

      TEST(Trial, an_evaluation_can_be_repeated_and_leaves_nothing_behind)
      {
        for (const auto &[formulation, options] : kinds)
        {
          SCOPED_TRACE(formulation);
          FrozenBody<3> body(plastic_block_of(formulation, options));
          forces(*body.model, 0.01); // flows
          const std::vector<double> start = state_of(*body.model);
          std::vector<double> first;
          {
            Trial<3> trial(*body.model);
            first = forces(*body.model, 0.02);
            EXPECT_NE(state_of(*body.model), start);
            trial.restart();
            EXPECT_EQ(state_of(*body.model), start);
            forces(*body.model, -0.03);
            trial.restart();
            EXPECT_EQ(forces(*body.model, 0.02), first);
          }
          EXPECT_EQ(state_of(*body.model), start);
          EXPECT_EQ(forces(*body.model, 0.02), first);
        }
      }

      TEST(Trial, a_commitment_is_what_a_direct_evaluation_makes)
      {
        for (const auto &[formulation, options] : kinds)
        {
          SCOPED_TRACE(formulation);
          FrozenBody<3> tried(plastic_block_of(formulation, options)),
              direct(plastic_block_of(formulation, options));
          {
            Trial<3> trial(*tried.model);
            forces(*tried.model, -0.02);
            trial.restart();
            forces(*tried.model, 0.02);
            trial.commit();
          }
          forces(*direct.model, 0.02);
          EXPECT_EQ(state_of(*tried.model), state_of(*direct.model));
          EXPECT_EQ(forces(*tried.model, 0.03), forces(*direct.model, 0.03));
        }
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
