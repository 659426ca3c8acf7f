// ranks: 1 2 3
#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/penalty_contact.h>
#include <tombolo/state/state_archive.h>

#include <mesh_testing.h>

#include "unit/output_test_directory.h"

#include <deal.II/base/mpi.h>

#include <cmath>
#include <filesystem>
#include <memory>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  /** A plate on a wall with friction, whose nodes are moved by hand. */
  class SlidingPlate
  {
  public:
    SlidingPlate(const std::string &entries, const bool has_heat)
        : scene("box", "set Upper corner = 2, 1\nset Cells = 6, 3"), parameters(MPI_COMM_WORLD)
    {
      parameters.read_text("subsection Contact: wall\nset Surface = plane\nset Friction = 0.3\n" +
                               entries +
                               "subsection plane\nset Point = 0, 0\nset Normal = 0, 1\nend\nend\n",
                           "plate.prm");
      parameters.handler().enter_subsection("Contact: wall");
      PenaltyContact<2>::declare_parameters(parameters.handler());
      parameters.handler().leave_subsection();
      parameters.assign();
      const Section section = parameters.section("Contact: wall");
      PenaltyContact<2>::validate(section, has_heat);

      mesh = scene.create_mesh();
      nodes = std::make_unique<Nodes<2>>(*mesh, 1);
      state.reinit(std::make_shared<const NodePartition>(nodes->owned(), nodes->relevant(),
                                                         nodes->communicator()));
      std::vector<dealii::types::global_dof_index> cell_nodes;
      std::vector<dealii::Point<2>> points;
      for (const auto &cell : nodes->dof_handler().active_cell_iterators())
        if (!cell->is_artificial())
        {
          nodes->cell_nodes(cell, cell_nodes);
          nodes->cell_points(cell, points);
          for (unsigned int k = 0; k < points.size(); ++k)
            if (nodes->owned().is_element(cell_nodes[k]))
            {
              const unsigned int i = state.partition()->local_index(cell_nodes[k]);
              for (unsigned int d = 0; d < 2; ++d)
                state.initial_position.node(i)[d] = points[k][d];
              *state.mass.node(i) = 1. + points[k][0];
            }
        }
      state.initial_position.update_ghosts();
      state.position.copy_from(state.initial_position);
      contact = std::make_unique<PenaltyContact<2>>(
          section, *mesh, *nodes, state, std::vector<bool>(state.partition()->n_owned(), false),
          has_heat);
      parameters.refuse_unused();
      loads.reinit(state.partition());
      heat.reinit(state.partition(), 1);
      clock.next_step = clock.stable_step = 0.1;
    }

    /** Moves to and fro along the wall, into it and, at the left end, out of it again. */
    void advance()
    {
      clock.advance();
      const double t = clock.time;
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      {
        const double *const x = state.initial_position.node(i);
        state.position.node(i)[0] = x[0] + 0.4 * std::sin(1.3 * t + x[0]);
        state.position.node(i)[1] = x[1] - 0.05 * std::sin(t) * (0.5 + x[0]);
      }
      std::vector<unsigned int> touched;
      contact->add_forces(state, clock, loads, touched);
    }

    double given() const
    {
      double sum = 0;
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        sum += *heat.node(i);
      return ordered_sum(sum, MPI_COMM_WORLD);
    }

    double pending() const
    {
      return ordered_sum(contact->heat_to_give(), MPI_COMM_WORLD);
    }

    double friction() const
    {
      return contact->balance(MPI_COMM_WORLD).friction;
    }

    MeshScene<2> scene;
    Parameters parameters;
    std::unique_ptr<Mesh<2>> mesh;
    std::unique_ptr<Nodes<2>> nodes;
    NodalState state;
    std::unique_ptr<PenaltyContact<2>> contact;
    NodalVector loads, heat;
    Clock clock;
  };
} // namespace

TEST(ContactHeat, the_body_gets_its_share_of_all_that_sliding_heats)
{
  for (const auto &[entries, fraction] : std::vector<std::pair<std::string, double>>{
           {"", 0.5}, {"set Heat fraction = 0.3\n", 0.3}, {"set Heat fraction = 0\n", 0.}})
  {
    SlidingPlate plate(entries, true);
    for (unsigned int step = 1; step <= 150; ++step)
    {
      plate.advance();
      if (step % 7 != 0 && step != 150)
        continue;
      EXPECT_NEAR(plate.given() + plate.pending(), fraction * plate.friction(),
                  1e-13 * plate.friction());
      if (step == 150)
        break;
      plate.contact->add_heat(plate.heat);
      EXPECT_EQ(plate.pending(), 0.);
    }
    EXPECT_EQ(plate.pending() > 0., fraction > 0.);
    EXPECT_GT(plate.friction(), 0.1);
    for (unsigned int i = 0; i < plate.state.partition()->n_owned(); ++i)
      EXPECT_EQ(*plate.heat.node(i) != 0.,
                fraction > 0. && plate.state.initial_position.node(i)[1] < 0.1);
  }
}

TEST(ContactHeat, does_nothing_in_a_scene_without_heat)
{
  SlidingPlate plate("", false), with_heat("", true);
  for (unsigned int step = 1; step <= 50; ++step)
  {
    plate.advance();
    with_heat.advance();
  }
  plate.contact->add_heat(plate.heat);
  EXPECT_GT(with_heat.pending(), 0.);
  EXPECT_EQ(plate.pending(), 0.);
  EXPECT_EQ(plate.given(), 0.);
  EXPECT_EQ(plate.friction(), with_heat.friction());
}

TEST(ContactHeat, that_was_not_given_yet_is_in_a_checkpoint)
{
  const TestDirectory directory("contact_heat");
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    std::filesystem::create_directories(directory.path);
  MPI_Barrier(MPI_COMM_WORLD);
  const std::string file = directory.path + "/heat.h5";
  SlidingPlate plate("", true);
  const auto serialize = [&](SlidingPlate &some, const StateArchive::Mode mode)
  {
    StateArchive archive(file, mode, MPI_COMM_WORLD);
    archive.set_nodes(some.nodes->persistent_ids());
    some.contact->serialize(archive);
    if (mode == StateArchive::Mode::write)
      archive.close();
  };
  for (unsigned int step = 1; step <= 50; ++step)
  {
    plate.advance();
    if (step == 20)
      plate.contact->add_heat(plate.heat);
  }
  serialize(plate, StateArchive::Mode::write);
  SlidingPlate resumed("", true);
  serialize(resumed, StateArchive::Mode::read);
  EXPECT_GT(plate.pending(), 0.);
  EXPECT_EQ(resumed.pending(), plate.pending());
  plate.heat.set_zero();
  plate.contact->add_heat(plate.heat);
  resumed.contact->add_heat(resumed.heat);
  for (unsigned int i = 0; i < plate.state.partition()->n_owned(); ++i)
    EXPECT_EQ(*resumed.heat.node(i), *plate.heat.node(i));
}

TEST(ContactHeat, a_fraction_that_cannot_be_or_is_not_needed_is_refused)
{
  const auto refusal = [](const std::string &fraction, const bool has_heat)
  {
    return input_error([&]()
                       { SlidingPlate plate("set Heat fraction = " + fraction + "\n", has_heat); });
  };
  for (const std::string fraction : {"1.1", "-0.1"})
    EXPECT_TRUE(contains(refusal(fraction, true), "entry \"Contact: wall/Heat fraction\" = \"" +
                                                      fraction +
                                                      "\": allowed is a number from 0 to 1."));
  EXPECT_TRUE(
      contains(refusal("0.5", false), "\"Contact: wall/Heat fraction\" = \"0.5\" has no effect"));
  EXPECT_EQ(refusal("1", true), "");
}
