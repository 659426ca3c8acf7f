// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include "model_scene.h"
#include "output_test_directory.h"
#include "plate_on_wall.h"

#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/outward_areas.h>
#include <tombolo/physics/mechanics/rigid_contacts.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  /** With friction, capacities, and a motion. */
  class SlidingPlate : public PlateOnWall
  {
  public:
    SlidingPlate(const std::string &entries, const bool has_heat,
                 const std::string &wall_position = "0")
        : PlateOnWall(
              (entries.find("Friction") != std::string::npos ? "" : "set Friction = 0.3\n") +
                  entries,
              has_heat, wall_position)
    {
      add_capacities();
      for (NodalVector *const vector : {&heat, &waiting})
        vector->reinit(state.partition(), Quantity::scalar);
      given_now.set_partition(state.partition());
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
      state.position.update_ghosts();
      std::vector<unsigned int> touched;
      loads.set_zero();
      const NodalHeat nodal_heat{&temperature, &enthalpy,  &waiting,
                                 nullptr,      &given_now, &given_now};
      contact->add_forces(state, clock, loads, touched, nodal_heat);
      given_now.collect(waiting);
      contact->exchange_heat(nodal_heat);
      given_now.collect(waiting);
      contact->complete_step(clock);
    }

    /** Adds the pending heat to that before. */
    void supply_heat()
    {
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        *heat.node(i) += std::exchange(*waiting.node(i), 0.);
    }

    /** Heats the nodes by the pending heat, as a thermal step does. */
    void apply_heat()
    {
      heat.set_zero();
      supply_heat();
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      {
        const double now = enthalpy.enthalpy(i, *temperature.node(i)) + *heat.node(i);
        *temperature.node(i) = enthalpy.temperature(i, now);
      }
    }

    double sum_of_enthalpy() const
    {
      double sum = 0;
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        sum += enthalpy.enthalpy(i, *temperature.node(i));
      return ordered_sum(sum, MPI_COMM_WORLD);
    }

    double sum_of(const NodalVector &vector) const
    {
      double sum = 0;
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        sum += *vector.node(i);
      return ordered_sum(sum, MPI_COMM_WORLD);
    }

    double given() const
    {
      return sum_of(heat);
    }

    double pending() const
    {
      return sum_of(waiting);
    }

    double friction() const
    {
      return contact->balance(MPI_COMM_WORLD).friction;
    }

    NodalVector heat, waiting, temperature;
    HeatAction given_now{"heat", "heat"};
    NodalEnthalpy enthalpy;

  private:
    /** Capacities of 2 per mass below 40 degrees and of 4 above 50, at 10 degrees: √(k ρ c) is 6
     * and √72. */
    void add_capacities()
    {
      properties_section.read_text(
          "subsection Heat\nset Specific heat capacity = 40: 2, 50: 4\nset "
          "Conductivity = 9\nset Initial temperature = 10\nend\n",
          "heat.prm");
      properties_section.handler().enter_subsection("Heat");
      declare<ThermalProperties>(properties_section.handler());
      properties_section.handler().leave_subsection();
      properties_section.assign();
      properties = std::make_unique<ThermalProperties>(properties_section.section("Heat"));
      temperature.reinit(state.partition());
      enthalpy.reinit(state.partition()->n_owned());
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      {
        enthalpy.add(i, *state.mass.node(i), *properties, 2.);
        *temperature.node(i) = 10.;
      }
      enthalpy.complete();
    }

    Parameters properties_section{MPI_COMM_WORLD};
    std::unique_ptr<ThermalProperties> properties;
  };

  /** Position along x of a node of the lower side that started at x. */
  double moved_x(const double x, const double t)
  {
    return x + 0.4 * std::sin(1.3 * t + x);
  }
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
      plate.supply_heat();
      EXPECT_EQ(plate.pending(), 0.);
    }
    EXPECT_EQ(plate.pending() > 0., fraction > 0.);
    EXPECT_GT(plate.friction(), 0.1);
    for (unsigned int i = 0; i < plate.state.partition()->n_owned(); ++i)
      EXPECT_EQ(*plate.heat.node(i) != 0.,
                fraction > 0. && plate.state.initial_position.node(i)[1] < 0.1);
  }
}

TEST(ContactHeat, of_friction_is_split_by_effusivities_at_the_present_temperatures)
{
  for (const auto &[temperature, body_effusivity, tool_effusivity] :
       {std::make_tuple(10., 6., 2.), std::make_tuple(60., std::sqrt(72.), 4.)})
  {
    SlidingPlate plate("set Heat fraction = by effusivity\nset Tool effusivity = 20: 2, 50: 4\n",
                       true);
    for (unsigned int i = 0; i < plate.state.partition()->n_owned(); ++i)
      *plate.temperature.node(i) = temperature;
    for (unsigned int step = 1; step <= 20; ++step)
      plate.advance();
    // The heat that came since has an effect, too; it is small.
    const double fraction = body_effusivity / (body_effusivity + tool_effusivity);
    const ContactBalance balance = plate.contact->balance(MPI_COMM_WORLD);
    EXPECT_GT(balance.friction, 0.01);
    EXPECT_NEAR(plate.pending() / balance.friction, fraction, 1e-3);
    EXPECT_NEAR(balance.friction_of_bodies, plate.pending(), 1e-13 * balance.friction);
    EXPECT_NEAR(balance.heat_of_bodies + balance.heat_of_tool, balance.friction,
                1e-13 * balance.friction);
  }
  // The tool's is that at its own temperature, where it has one.
  SlidingPlate plate("set Heat fraction = by effusivity\nset Tool effusivity = 20: 2, 50: 4\nset "
                     "Tool temperature = 80\nset Heat capacity = 1e6\n",
                     true);
  for (unsigned int step = 1; step <= 20; ++step)
    plate.advance();
  const ContactBalance balance = plate.contact->balance(MPI_COMM_WORLD);
  EXPECT_NEAR(plate.pending() / balance.friction, 0.6, 1e-3);
  EXPECT_NEAR(balance.heat_of_bodies + balance.heat_of_tool, balance.friction,
              1e-8 * balance.friction);
}

TEST(ContactEntries, limit_of_shear_holds_on_the_area_of_the_node)
{
  constexpr double limit = 2e-3;
  SlidingPlate plate("set Shear limit = 2e-3\nset Friction = 5\n", false);
  unsigned int n_at_limit = 0;
  for (unsigned int step = 1; step <= 60; ++step)
  {
    plate.advance();
    const double t = plate.clock.time;
    for (unsigned int i = 0; i < plate.state.partition()->n_owned(); ++i)
    {
      const double x = plate.state.initial_position.node(i)[0];
      const double area =
          0.5 * (moved_x(std::min(x + 1. / 3., 2.), t) - moved_x(std::max(x - 1. / 3., 0.), t));
      const double traction = std::abs(plate.loads.node(i)[0]) / area;
      EXPECT_LE(traction, limit * (1. + 1e-12));
      n_at_limit += traction > limit * (1. - 1e-12) ? 1 : 0;
    }
    if (step == 20)
    {
      EXPECT_GT(plate.contact->balance(MPI_COMM_WORLD).area, 0.1);
    }
  }
  EXPECT_GT(dealii::Utilities::MPI::sum(n_at_limit, MPI_COMM_WORLD), 20u);
  // Above all of Coulomb's forces it changes nothing.
  SlidingPlate high("set Shear limit = 1e30\n", false), none("", false);
  unsigned int n_sliding = 0;
  for (unsigned int step = 1; step <= 30; ++step)
  {
    high.advance();
    none.advance();
    for (unsigned int i = 0; i < none.state.partition()->n_owned(); ++i)
    {
      EXPECT_EQ(high.loads.node(i)[0], none.loads.node(i)[0]);
      // That of Coulomb includes the damper, which pushes during the first steps.
      const double friction_limit = 0.3 * none.loads.node(i)[1];
      EXPECT_LE(std::abs(none.loads.node(i)[0]), friction_limit * (1. + 1e-12));
      n_sliding += step < 12 && friction_limit > 0. &&
                           std::abs(none.loads.node(i)[0]) > friction_limit * (1. - 1e-12)
                       ? 1
                       : 0;
    }
  }
  EXPECT_GT(dealii::Utilities::MPI::sum(n_sliding, MPI_COMM_WORLD), 5u);
}

TEST(ContactEntries, a_ball_touches_where_a_point_would_touch_a_wall_that_is_nearer)
{
  SlidingPlate ball("set Radius = 0.25\n", false, "-0.25"), point("", false);
  double pressure = 0;
  for (unsigned int step = 1; step <= 40; ++step)
  {
    ball.advance();
    point.advance();
    for (unsigned int i = 0; i < point.state.partition()->n_owned(); ++i)
    {
      for (unsigned int d = 0; d < 2; ++d)
        EXPECT_NEAR(ball.loads.node(i)[d], point.loads.node(i)[d], 1e-12);
      pressure += point.loads.node(i)[1];
    }
  }
  EXPECT_GT(ordered_sum(pressure, MPI_COMM_WORLD), 1.);
  EXPECT_TRUE(contains(input_error([] { SlidingPlate plate("set Radius = 0.25\n", false); }),
                       "starts inside"));
}

TEST(ContactEntries, that_cannot_be_are_refused)
{
  const auto refusal = [](const std::string &entries)
  { return input_error([&] { SlidingPlate plate(entries, true); }); };
  const char *const cases[][2] = {
      {"set Shear limit = 0\n", "\"Contact: wall/Shear limit\" = \"0\""},
      {"set Radius = -1\n", "\"Contact: wall/Radius\" = \"-1\""},
      {"set Heat fraction = half\n", "\"Contact: wall/Heat fraction\" = \"half\": allowed is a "
                                     "number from 0 to 1, or \"by effusivity\"."},
      {"set Heat fraction = by effusivity\n", "the entry \"Tool effusivity\" is missing"},
      {"set Heat fraction = by effusivity\nset Tool effusivity = 0\n",
       "allowed are numbers above 0"},
      {"set Tool effusivity = 3\n", "has no effect"}};
  for (const auto &[entries, message] : cases)
    EXPECT_TRUE(contains(refusal(entries), message)) << entries;
}

TEST(ContactHeat, does_nothing_in_a_scene_without_heat)
{
  SlidingPlate plate("", false), with_heat("", true);
  for (unsigned int step = 1; step <= 50; ++step)
  {
    plate.advance();
    with_heat.advance();
  }
  plate.supply_heat();
  EXPECT_GT(with_heat.pending(), 0.);
  EXPECT_EQ(plate.pending(), 0.);
  EXPECT_EQ(plate.given(), 0.);
  EXPECT_EQ(plate.friction(), with_heat.friction());
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

TEST(ContactHeat, without_friction_presses_alike_and_holds_nothing)
{
  SlidingPlate rough("", true), smooth("set Friction = 0\n", true);
  double pressure = 0;
  for (unsigned int step = 1; step <= 60; ++step)
  {
    rough.advance();
    smooth.advance();
    for (unsigned int i = 0; i < rough.state.partition()->n_owned(); ++i)
    {
      EXPECT_EQ(smooth.loads.node(i)[1], rough.loads.node(i)[1]);
      EXPECT_EQ(smooth.loads.node(i)[0], 0.);
      pressure += smooth.loads.node(i)[1];
    }
  }
  EXPECT_GT(ordered_sum(pressure, MPI_COMM_WORLD), 1.);
  EXPECT_EQ(smooth.friction(), 0.);
  EXPECT_GT(rough.friction(), 0.1);
}

TEST(ContactHeat, friction_follows_the_temperature_of_the_node)
{
  const std::string table = "set Heat fraction = 0\nset Friction = 0: 0.1, 20: 0.5\n";
  SlidingPlate by_table(table, true), weak("set Heat fraction = 0\nset Friction = 0.1\n", true),
      middle("set Heat fraction = 0\nset Friction = 0.3\n", true);
  // The right half is at the first knot, the left one between the two.
  for (unsigned int i = 0; i < by_table.state.partition()->n_owned(); ++i)
    if (by_table.state.initial_position.node(i)[0] > 1.)
      *by_table.temperature.node(i) = -5.;
  double tangential = 0;
  for (unsigned int step = 1; step <= 30; ++step)
  {
    by_table.advance();
    weak.advance();
    middle.advance();
    for (unsigned int i = 0; i < by_table.state.partition()->n_owned(); ++i)
    {
      const bool is_right = by_table.state.initial_position.node(i)[0] > 1.;
      const double expected = (is_right ? weak : middle).loads.node(i)[0];
      EXPECT_NEAR(by_table.loads.node(i)[0], expected, 1e-13);
      tangential += std::abs(expected);
    }
  }
  EXPECT_GT(ordered_sum(tangential, MPI_COMM_WORLD), 0.1);
}

TEST(ContactHeat, friction_sees_heat_that_was_not_given_yet)
{
  const std::string table = "set Heat fraction = 1\nset Friction = 10: 0.3, 10.001: 0\n";
  SlidingPlate plate(table, true);
  for (unsigned int step = 1; step <= 30; ++step)
    plate.advance();
  SlidingPlate constant("set Heat fraction = 1\nset Friction = 0.3\n", true);
  for (unsigned int step = 1; step <= 30; ++step)
    constant.advance();
  EXPECT_GT(plate.friction(), 0.);
  EXPECT_LT(plate.friction(), 0.3 * constant.friction());
}

TEST(ContactConduction, is_exponential_over_the_area_in_contact_whatever_the_steps)
{
  constexpr double conductance = 3.;
  for (const unsigned int interval : {1u, 7u, 1000u})
  {
    SlidingPlate plate("set Conductance = 3\nset Tool temperature = 35\nset Heat fraction = 0\n",
                       true);
    std::vector<double> exposure(plate.state.partition()->n_owned(), 0.);
    for (unsigned int step = 1; step <= 30; ++step)
    {
      plate.advance();
      if (step % interval == 0)
        plate.apply_heat();
      // A node of the lower side has half of it towards each of its neighbours, and nothing of the
      // other sides.
      const double t = plate.clock.time;
      for (unsigned int i = 0; i < exposure.size(); ++i)
      {
        const double x = plate.state.initial_position.node(i)[0];
        if (plate.state.initial_position.node(i)[1] < 0.1)
          exposure[i] +=
              0.5 * conductance * 0.1 *
              (moved_x(std::min(x + 1. / 3., 2.), t) - moved_x(std::max(x - 1. / 3., 0.), t));
      }
    }
    plate.apply_heat();
    for (unsigned int i = 0; i < exposure.size(); ++i)
    {
      const double capacity = 2. * *plate.state.mass.node(i);
      EXPECT_NEAR(*plate.temperature.node(i), 35. - 25. * std::exp(-exposure[i] / capacity), 1e-12);
    }
    EXPECT_NEAR(plate.sum_of_enthalpy(), plate.contact->balance(MPI_COMM_WORLD).conducted, 1e-11);
  }
}

TEST(ContactConduction, takes_the_conductance_of_the_pressure)
{
  // h = p, so that h A is the force.
  SlidingPlate plate("set Conductance = 0: 0, 1e6: 1e6\nset Tool temperature = 35\nset Friction = "
                     "0\n",
                     true);
  std::vector<double> exposure(plate.state.partition()->n_owned(), 0.);
  double sum = 0;
  for (unsigned int step = 1; step <= 30; ++step)
  {
    plate.advance();
    for (unsigned int i = 0; i < exposure.size(); ++i)
      exposure[i] += 0.1 * plate.loads.node(i)[1];
  }
  plate.apply_heat();
  for (unsigned int i = 0; i < exposure.size(); ++i)
  {
    const double capacity = 2. * *plate.state.mass.node(i);
    EXPECT_NEAR(*plate.temperature.node(i), 35. - 25. * std::exp(-exposure[i] / capacity), 1e-11);
    sum += exposure[i];
  }
  EXPECT_GT(ordered_sum(sum, MPI_COMM_WORLD), 1.);
}

TEST(ContactConduction, without_resistance_brings_nodes_to_the_tool_and_not_beyond)
{
  // Across the step of the capacity, which a linear estimate would overshoot or miss.
  for (const double tool : {80., 35., -20.})
  {
    SlidingPlate plate("set Conductance = 1e30\nset Heat fraction = 0\nset Tool temperature = " +
                           std::to_string(tool) + "\n",
                       true);
    for (unsigned int step = 1; step <= 20; ++step)
    {
      plate.advance();
      plate.apply_heat();
      for (unsigned int i = 0; i < plate.state.partition()->n_owned(); ++i)
        EXPECT_NEAR(*plate.temperature.node(i),
                    plate.state.initial_position.node(i)[1] < 0.1 ? tool : 10., 1e-11);
    }
  }
}

TEST(ContactConduction, tool_of_given_capacity_keeps_all_heat_and_stays_between_the_temperatures)
{
  for (const double capacity : {5., 1e-6})
    for (const std::string conductance : {"2", "1e30", "0"})
    {
      const bool is_smooth = conductance != "0" && capacity < 1.;
      SlidingPlate plate(
          "set Conductance = " + conductance +
              "\nset Heat fraction = 0.3\nset Friction = " + (is_smooth ? "0" : "0.3") +
              "\nset Tool temperature = 35\nset Heat "
              "capacity = " +
              std::to_string(capacity) + "\n",
          true);
      ContactBalance balance;
      for (unsigned int step = 1; step <= 60; ++step)
      {
        plate.advance();
        if (step % 3 == 0)
          plate.apply_heat();
        balance = plate.contact->balance(MPI_COMM_WORLD);
        const double tool = capacity * (balance.tool_temperature - 35.);
        EXPECT_NEAR(balance.heat_of_tool, tool, 1e-12);
        const double body = plate.sum_of_enthalpy() + plate.pending();
        EXPECT_NEAR(balance.heat_of_bodies, body, 1e-11);
        EXPECT_NEAR(tool + body, balance.friction, 1e-11);
        if (is_smooth)
        {
          EXPECT_GT(balance.tool_temperature, 10. - 1e-12);
          EXPECT_LT(balance.tool_temperature, 35.);
        }
      }
      EXPECT_EQ(balance.friction > 0.05, !is_smooth);
      EXPECT_EQ(balance.conducted != 0., conductance != "0");
    }
}

TEST(ContactConduction, of_two_tools_at_a_node_leads_past_neither_whatever_their_order)
{
  for (const std::string capacity : {"0", "0.5"})
    for (const std::string conductance : {"3", "1e30"})
    {
      std::vector<double> first_temperatures;
      for (const bool hot_is_first : {true, false})
      {
        const auto tool = [&](const std::string &name, const std::string &temperature)
        {
          return "subsection Contact: " + name +
                 "\nset Surface = plane\nset Conductance = " + conductance +
                 "\nset Heat fraction = 0\nset Tool temperature = " + temperature +
                 "\nset Heat capacity = " + capacity +
                 "\nsubsection plane\nset Point = 0, 0\nset Normal = 0, 1\nend\nend\n";
        };
        const auto scene = make_model<2>(
            "set Dimension = 2\nset Materials = m\nset Parts = a\nset Contacts = " +
            std::string(hot_is_first ? "hot, cold" : "cold, hot") +
            "\nsubsection Mesh\nset Type = box\nsubsection box\nset Upper corner = 3, 1\nset "
            "Cells = 6, 2\nend\nend\nsubsection Part: a\nset Cells = all\nset Formulation = "
            "hexahedron\nset Material = m\nend\nsubsection Material: m\nset Model = elastic\n"
            "subsection elastic\nset Density = 1\nset Young's modulus = 1\nset Poisson's ratio "
            "= 0\nend\nsubsection Heat\nset Specific heat capacity = 20: 2, 60: 5\nset "
            "Conductivity = 0\nset Initial temperature = 25\nend\nend\n" +
            tool("hot", "80") + tool("cold", "10"));
        Model<2> &model = *scene;
        const unsigned int n_owned = model.state.partition()->n_owned();
        for (unsigned int i = 0; i < n_owned; ++i)
        {
          model.state.position.node(i)[1] -= 0.1;
          *model.heat->state.present_temperature.node(i) = 25.;
        }
        model.state.position.update_ghosts();
        Clock clock;
        clock.stable_step = clock.next_step = 0.4;
        auto &contacts = *model.find_process<RigidContacts<2>>();
        for (unsigned int step = 0; step < 12; ++step)
        {
          clock.advance();
          contacts.act(model, clock, model.state.force);
          const NodalVector &heat = model.heat->state.pending;
          double sum = 0;
          for (unsigned int i = 0; i < n_owned; ++i)
          {
            const double enthalpy = model.heat->nodal_enthalpy.enthalpy(
                i, *model.heat->state.present_temperature.node(i));
            const double temperature =
                model.heat->nodal_enthalpy.temperature(i, enthalpy + *heat.node(i));
            EXPECT_GT(temperature, 10.);
            EXPECT_LT(temperature, 80.);
            sum += *heat.node(i);
            if (hot_is_first)
              first_temperatures.push_back(temperature);
            else
            {
              EXPECT_NEAR(temperature, first_temperatures[step * n_owned + i], 1e-10);
            }
          }
          const ContactBalance balance = contacts.balance();
          sum = ordered_sum(sum, MPI_COMM_WORLD);
          EXPECT_NEAR(sum, balance.heat_of_bodies, 1e-11);
          EXPECT_NEAR(balance.heat_of_bodies + balance.heat_of_tool, 0., 1e-11);
          EXPECT_GT(std::abs(contacts.contacts()[0]->balance(MPI_COMM_WORLD).conducted), 0.1);
        }
      }
    }
}

TEST(ContactConduction, temperature_of_the_tool_is_in_a_checkpoint)
{
  const TestDirectory directory("tool_heat");
  const std::string file = directory.create("tool.h5");
  const std::string entries =
      "set Conductance = 2\nset Tool temperature = 35\nset Heat capacity = 5\n";
  SlidingPlate plate(entries, true), resumed(entries, true);
  for (unsigned int step = 1; step <= 20; ++step)
    plate.advance();
  for (SlidingPlate *const some : {&plate, &resumed})
  {
    StateArchive archive(file,
                         some == &plate ? StateArchive::Mode::write : StateArchive::Mode::read,
                         MPI_COMM_WORLD);
    archive.set_nodes(some->nodes->persistent_ids());
    some->contact->records.serialize(archive);
    if (some == &plate)
      archive.close();
  }
  resumed.clock = plate.clock;
  for (unsigned int i = 0; i < plate.waiting.partition()->n_owned(); ++i)
    *resumed.waiting.node(i) = *plate.waiting.node(i); // which the thermal state has
  for (SlidingPlate *const some : {&plate, &resumed})
    some->advance();
  const ContactBalance plate_balance = plate.contact->balance(MPI_COMM_WORLD),
                       resumed_balance = resumed.contact->balance(MPI_COMM_WORLD);
  EXPECT_LT(plate_balance.tool_temperature, 34.);
  EXPECT_EQ(resumed_balance.tool_temperature, plate_balance.tool_temperature);
  EXPECT_EQ(resumed_balance.conducted, plate_balance.conducted);
  EXPECT_EQ(resumed_balance.friction, plate_balance.friction);
}

TEST(ContactConduction, entries_that_cannot_be_are_refused)
{
  const auto refusal = [](const std::string &entries, const bool has_heat = true)
  { return input_error([&]() { SlidingPlate plate(entries, has_heat); }); };
  const std::string tool = "set Tool temperature = 20\n";
  EXPECT_TRUE(contains(refusal(tool + "set Conductance = -1\n"),
                       "Conductance\" = \"-1\": allowed are numbers from zero on."));
  EXPECT_TRUE(
      contains(refusal(tool + "set Conductance = 0: 1, 5\n"), "is no pair `pressure: value`"));
  EXPECT_TRUE(contains(refusal(tool + "set Conductance = 5: 1, 0: 2\n"),
                       "allowed are pressures that increase"));
  EXPECT_TRUE(contains(refusal(tool + "set Heat capacity = -2\n"),
                       "Heat capacity\" = \"-2\": allowed is zero or a positive number."));
  EXPECT_TRUE(contains(refusal("set Conductance = 1\n"), "Tool temperature"));
  EXPECT_TRUE(contains(refusal(tool), "has no effect"));
  EXPECT_TRUE(contains(refusal("set Conductance = 1\n", false), "has no effect"));
  EXPECT_TRUE(
      contains(refusal("set Friction = 0: 0.1, 20: 0.3\n", false), "the scene has no temperature"));
  EXPECT_TRUE(contains(refusal("set Friction = 0: 0.1, 20: -0.3\n"),
                       "allowed are coefficients from 0 to 10."));
  EXPECT_TRUE(contains(refusal("set Friction = much\n"), "\"much\" is not a number"));
}

TEST(OutwardAreas, enclose_the_volume_of_a_distorted_box)
{
  const auto check = [](const auto &nodes, const double volume)
  {
    constexpr int dim = std::decay_t<decltype(nodes.dof_handler())>::dimension;
    const auto partition = std::make_shared<const NodePartition>(nodes.owned(), nodes.relevant(),
                                                                 nodes.communicator());
    const NodalVector position = initial_positions(nodes, partition);
    OutwardAreas<dim> areas(nodes, {});
    areas.set_partition(partition);
    areas.update(position);
    double enclosed = 0, closed = 0;
    unsigned int n_inner = 0;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
    {
      const auto area = areas.area(i);
      for (unsigned int d = 0; d < dim; ++d)
        enclosed += position.node(i)[d] * area[d] / dim;
      closed += area[0];
      n_inner += areas.has_face(i) ? 0 : 1;
      EXPECT_EQ(area.norm() > 0., areas.has_face(i));
    }
    EXPECT_NEAR(ordered_sum(enclosed, MPI_COMM_WORLD), volume, 1e-13);
    EXPECT_NEAR(ordered_sum(closed, MPI_COMM_WORLD), 0., 1e-13);
    EXPECT_GT(ordered_sum(double(n_inner), MPI_COMM_WORLD), 0.);
  };
  for (const unsigned int degree : {1u, 2u})
  {
    const MeshScene<2> plane("box",
                             "set Upper corner = 2, 1\nset Cells = 5, 3\nset Disorder = 0.2");
    const auto mesh_2 = plane.create_mesh();
    check(Nodes<2>(*mesh_2, degree), 2.);
    const MeshScene<3> space(
        "box", "set Upper corner = 2, 1, 0.5\nset Cells = 4, 3, 3\nset Disorder = 0.2");
    const auto mesh_3 = space.create_mesh();
    check(Nodes<3>(*mesh_3, degree), 1.);
  }
}

TEST(OutwardAreas, leave_faces_of_isolated_nodes_out)
{
  const MeshScene<2> scene("box", "set Upper corner = 2, 1\nset Cells = 4, 2");
  const auto mesh = scene.create_mesh();
  const Nodes<2> nodes(*mesh, 1);
  const auto partition =
      std::make_shared<const NodePartition>(nodes.owned(), nodes.relevant(), nodes.communicator());
  const NodalVector position = initial_positions(nodes, partition);
  OutwardAreas<2> areas(nodes, {});
  areas.set_partition(partition);
  const auto at = [&](const unsigned int i, const double x)
  { return std::abs(position.node(i)[0] - x) < 1e-9 && position.node(i)[1] == 0.; };
  for (const bool is_isolated : {true, false})
  {
    std::vector<unsigned int> isolated;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (is_isolated && at(i, 1.))
        isolated.push_back(i);
    areas.set_isolated_nodes(isolated);
    areas.update(position);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (at(i, 0.5) || at(i, 1.5))
      {
        EXPECT_NEAR(areas.area(i)[1], is_isolated ? -0.25 : -0.5, 1e-15);
      }
      else if (at(i, 1.))
      {
        EXPECT_EQ(areas.has_face(i), !is_isolated);
      }
  }
}
