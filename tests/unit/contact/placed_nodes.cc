// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include "plate_on_wall.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace tombolo;
  using namespace tombolo::testing;

  /** Without friction, and placed by a function. */
  class PlacedPlate : public PlateOnWall
  {
  public:
    PlacedPlate() : PlateOnWall("set Damping = 0\n") {}
    /** Nodes go down by @p first at the left end and @p last at the right one. */
    void put(const double first, const double last)
    {
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      {
        const double *const x = state.initial_position.node(i);
        state.position.node(i)[1] = x[1] - (first + (last - first) * x[0] / 2.);
      }
      state.position.update_ghosts();
    }

    void add_forces()
    {
      std::vector<unsigned int> touched;
      loads.set_zero();
      contact->add_forces(state, clock, loads, touched);
      contact->complete_step(clock);
    }

    double stored() const
    {
      return contact->balance(MPI_COMM_WORLD).elastic;
    }
  };

  TEST(PlacedNodes, leave_springs_as_deep_as_the_next_forces_find_them)
  {
    // As deep everywhere, deeper at one end, out of the wall at the other one.
    for (const auto &[first, last] :
         {std::make_pair(0.02, 0.03), std::make_pair(0.01, 0.07), std::make_pair(-0.02, 0.05)})
    {
      PlacedPlate plate;
      plate.clock.advance();
      plate.put(0.02, 0.03);
      plate.add_forces();
      const double before = plate.stored();
      EXPECT_GT(before, 0.);
      NodalVector from = plate.state.position.copy();
      from.update_ghosts();
      plate.put(first, last);
      plate.contact->place_nodes(plate.state, from, plate.clock);
      const double placed = plate.stored();
      plate.clock.advance();
      plate.add_forces();
      EXPECT_NEAR(placed / plate.stored(), 1., 1e-12);
      EXPECT_EQ(std::abs(placed / before - 1.) < 1e-12, first == 0.02);
    }
  }
} // namespace
