// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/contact/surface_contact.h>

#include <mesh_testing.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

namespace
{
  using namespace tombolo;
  using namespace tombolo::testing;

  /** A plate on a wall without friction, whose nodes are placed by a function. */
  class PlacedPlate
  {
  public:
    PlacedPlate()
        : scene("box", "set Upper corner = 2, 1\nset Cells = 6, 3"), parameters(MPI_COMM_WORLD)
    {
      parameters.read_text("subsection Contact: wall\nset Surface = plane\nset Damping = 0\n"
                           "subsection plane\nset Point = 0, 0\nset Normal = 0, 1\nend\nend\n",
                           "plate.prm");
      parameters.handler().enter_subsection("Contact: wall");
      ContactScene<2>::declare(parameters.handler());
      parameters.handler().leave_subsection();
      parameters.assign();
      mesh = scene.create_mesh();
      nodes = std::make_unique<Nodes<2>>(*mesh, 1);
      start_at(*nodes, state);
      ContactScene<2> contact_scene{parameters.section("Contact: wall"),
                                    *mesh,
                                    *nodes,
                                    state,
                                    std::vector<bool>(state.partition()->n_owned(), false),
                                    false,
                                    std::vector<double>(state.partition()->n_owned(), 1.),
                                    {}};
      contact = make_penalty_contact(contact_scene);
      loads.reinit(state.partition());
      clock.next_step = clock.stable_step = 0.1;
    }

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

    MeshScene<2> scene;
    Parameters parameters;
    std::unique_ptr<Mesh<2>> mesh;
    std::unique_ptr<Nodes<2>> nodes;
    NodalState state;
    std::unique_ptr<SurfaceContact<2>> contact;
    NodalVector loads;
    Clock clock;
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
      NodalVector from(plate.state.partition());
      from.copy_from(plate.state.position);
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
