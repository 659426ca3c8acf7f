// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "frozen_body.h"

#include <tombolo/base/output_directory.h>
#include <tombolo/model/follow_divisions.h>

#include <gtest/gtest.h>

#include "output_test_directory.h"

namespace
{
  using namespace tombolo;
  using namespace tombolo::testing;

  /** A body in motion, and a process on it whose energy is a number times Σ x of the nodes. */
  struct Owner
  {
    explicit Owner(const double stiffness) : body(parameters_of(block()))
    {
      NodalState &state = body.model->state;
      state.unsmoothed_velocity.fill([](unsigned int, double *const v) { v[0] = 3.; });
      records.sums("energy", share);
      follow_divisions<2>(records, "energy on mesh", share, *body.model,
                          [stiffness, this](const NodalVector &position, const double ago)
                          {
                            EXPECT_EQ(ago, 0.25);
                            return stiffness * sum(position);
                          });
    }

    static Block block()
    {
      Block result;
      result.cells = {3, 2};
      return result;
    }

    static double sum(const NodalVector &position)
    {
      double result = 0;
      for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
        result += position.node(i)[0];
      return result;
    }

    /** Over all ranks. */
    double total() const
    {
      return ordered_sum(share, MPI_COMM_WORLD);
    }

    void serialize(const std::string &file, const StateArchive::Mode mode, const bool divides)
    {
      StateArchive archive(file, mode, MPI_COMM_WORLD);
      Clock clock;
      clock.previous_step = 0.5;
      if (divides)
        archive.divide(clock);
      records.serialize(archive);
      archive.close();
    }

    FrozenBody<2> body;
    double share = 7.;
    Records records;
  };

  TEST(FollowDivisions, energy_changes_by_what_the_new_mesh_stores_more_in_the_middle_of_the_motion)
  {
    const TestDirectory test("follow_divisions");
    const OutputDirectory directory(test.path, MPI_COMM_WORLD);
    for (const bool divides : {true, false})
    {
      Owner before(2.), after(5.);
      const NodalVector &position = after.body.model->state.position;
      const double n = after.body.model->state.partition()->n_global();
      const double middle = ordered_sum(Owner::sum(position), MPI_COMM_WORLD) - n * 0.25 * 3.;
      const std::string file = directory.file(divides ? "divided" : "whole");
      before.serialize(file, StateArchive::Mode::write, divides);
      after.share = 0.;
      after.serialize(file, StateArchive::Mode::read, divides);
      EXPECT_NEAR(after.total(), before.total() + (divides ? 3. * middle : 0.), 1e-12 * middle);
    }
  }
} // namespace
