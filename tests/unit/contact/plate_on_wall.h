// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "mesh_testing.h"

#include <tombolo/contact/surface_contact.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    /** A plate of 2 by 1 on a wall of which the lines of the section are @p entries, whose nodes
     * are moved by hand. */
    class PlateOnWall
    {
    public:
      explicit PlateOnWall(const std::string &entries, const bool has_heat = false,
                           const std::string &wall_position = "0")
          : scene("box", "set Upper corner = 2, 1\nset Cells = 6, 3"), parameters(MPI_COMM_WORLD)
      {
        parameters.read_text("subsection Contact: wall\nset Surface = plane\n" + entries +
                                 "subsection plane\nset Point = 0, " + wall_position +
                                 "\nset Normal = 0, 1\nend\nend\n",
                             "plate.prm");
        parameters.handler().enter_subsection("Contact: wall");
        ContactScene<2>::declare(parameters.handler());
        parameters.handler().leave_subsection();
        parameters.assign();
        const Section section = parameters.section("Contact: wall");
        ContactScene<2>::validate(section, has_heat);

        mesh = scene.create_mesh();
        nodes = std::make_unique<Nodes<2>>(*mesh, 1);
        start_at(*nodes, state);
        ContactScene<2> contact_scene{section,
                                      *mesh,
                                      *nodes,
                                      state,
                                      std::vector<bool>(state.partition()->n_owned(), false),
                                      has_heat,
                                      std::vector<double>(state.partition()->n_owned(), 1.),
                                      {}};
        contact = make_penalty_contact(contact_scene);
        parameters.refuse_unused();
        loads.reinit(state.partition());
        clock.next_step = clock.stable_step = 0.1;
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
  } // namespace testing
} // namespace tombolo
