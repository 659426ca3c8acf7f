// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
// The estimate of the stable step against the true limit in random small bodies: all formulations,
// smoothings, shape functions and bridges, disordered, deformed, with renewed kernels. The variable
// TOMBOLO_RANDOM_BODIES of the environment is their number; the seeds are the first ones.
#include "frozen_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <random>
#include <string>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  class RandomBody
  {
  public:
    explicit RandomBody(const unsigned int seed) : engine(seed)
    {
      const bool is_plane = flip();
      for (unsigned int d = 0; d < (is_plane ? 2 : 3); ++d)
        block.cells.push_back(2 + below(is_plane ? 4 : 2));
      block.poisson = std::vector<double>{0., 0.3, 0.45, 0.49}[below(4)];
      const unsigned int kind = below(5);
      block.formulation = kind == 0   ? "hexahedron"
                          : kind == 1 ? "fully integrated hexahedron"
                          : kind == 2 ? "particles"
                                      : "coupled";
      if (flip())
        block.element = "hexahedron";
      if (kind >= 2)
        choose_particles();
      if (flip())
        block.mesh_options = "set Disorder = " + std::to_string(0.25 * uniform()) +
                             "\nset Surface nodes = " + (flip() ? "slide" : "fixed") +
                             "\nset Seed = " + std::to_string(below(1000));
      if (below(4) == 0)
        block.conditions = "set Conditions = c\nsubsection Condition: c\nset Type = clamp\nset "
                           "Where = x < 1e-9\nend\n";
    }

    /** Stretches, shears and bends a body. */
    template <int dim>
    void deform(Model<dim> &model)
    {
      double gradient[3][3];
      for (unsigned int a = 0; a < 3; ++a)
        for (unsigned int b = 0; b < 3; ++b)
          gradient[a][b] = 0.4 * (uniform() - 0.5);
      const double bend = 0.05 * uniform();
      NodalVector &x = model.state.position;
      for (unsigned int i = 0; i < x.partition()->n_local(); ++i)
      {
        const double *const start = model.state.initial_position.node(i);
        for (unsigned int a = 0; a < dim; ++a)
        {
          x.node(i)[a] = start[a];
          for (unsigned int b = 0; b < dim; ++b)
            x.node(i)[a] += gradient[a][b] * start[b];
        }
        x.node(i)[0] += bend * start[1] * start[1];
      }
      model.bridge->positions_have_changed();
      for (unsigned int update = 0; update < 5; ++update) // the deformation is checked now and then
        model.update_stencils();
    }

    bool flip()
    {
      return below(2) == 0;
    }

    Block block{"", "", 0.3, "fully integrated hexahedron", "paper", "", "", {}};

  private:
    void choose_particles()
    {
      const std::string smoothing =
          std::vector<std::string>{"affine", "affine", "none", "paper", "fe matched"}[below(5)];
      block.options = "set Smoothing = " + smoothing;
      const bool has_averages = (smoothing == "affine" || smoothing == "none") && flip();
      if (has_averages)
        return;
      block.options += "\nset Shape functions = moving least squares\nset Dilation = " +
                       std::to_string(1.3 + 0.6 * uniform());
      if (flip())
        block.options +=
            "\nset Configuration = updated Lagrangian\nset Rebuild deformation = 0.001";
      if (flip())
        block.bridge = "trace";
    }

    unsigned int below(const unsigned int n)
    {
      return static_cast<unsigned int>(engine() % n);
    }

    double uniform()
    {
      return static_cast<double>(engine()) / 4294967296.;
    }

    std::mt19937 engine;
  };

  struct Result
  {
    double limit_over_estimate = 0;
    bool is_refused = false; // in words
  };

  template <int dim>
  Result try_body(RandomBody &random, const unsigned int seed)
  {
    SCOPED_TRACE(::testing::PrintToString(random.block) + ", seed " + std::to_string(seed));
    Result result;
    try
    {
      FrozenBody<dim> body(random.block);
      if (random.flip())
      {
        body.estimator->estimate(*body.model); // what follows starts from its mode
        random.deform(*body.model);
        body.reset_reference();
        body.keep_configuration();
      }
      const double estimate = body.estimator->estimate(*body.model).time_step;
      result.limit_over_estimate = body.limit_by_eigenvalues() / estimate;
      EXPECT_GE(result.limit_over_estimate, 1.);
      EXPECT_LE(result.limit_over_estimate, 1.1);
    }
    catch (const dealii::ExceptionBase &error)
    {
      ADD_FAILURE() << error.what();
    }
    catch (const InputError &)
    {
      result.is_refused = true;
    }
    catch (const RunError &)
    {
      result.is_refused = true;
    }
    return result;
  }
} // namespace

TEST(RandomBodies, the_estimate_of_the_stable_step_is_a_bound)
{
  const char *const wanted = std::getenv("TOMBOLO_RANDOM_BODIES");
  const unsigned int n = wanted != nullptr ? static_cast<unsigned int>(std::atoi(wanted)) : 40;
  unsigned int n_refused = 0;
  double smallest = 1e300, largest = 0;
  for (unsigned int seed = 0; seed < n; ++seed)
  {
    RandomBody random(seed);
    const Result result =
        random.block.cells.size() == 2 ? try_body<2>(random, seed) : try_body<3>(random, seed);
    if (result.is_refused)
    {
      ++n_refused;
      continue;
    }
    smallest = std::min(smallest, result.limit_over_estimate);
    largest = std::max(largest, result.limit_over_estimate);
  }
  std::cout << "limit / estimate from " << smallest << " to " << largest << " in " << n - n_refused
            << " bodies; refused in words: " << n_refused << std::endl;
  EXPECT_LT(n_refused, n / 4);
}
