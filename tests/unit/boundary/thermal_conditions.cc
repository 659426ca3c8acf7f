// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/base/ordered_sum.h>
#include <tombolo/boundary/mechanical_conditions.h>
#include <tombolo/boundary/thermal_conditions.h>

#include <mesh_testing.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  struct NamedCondition
  {
    std::string name, lines;
  };

  /** A mesh of the source `box` with thermal conditions, and nodal vectors on it. */
  template <int dim>
  class Body
  {
  public:
    Body(const std::string &box, const std::vector<NamedCondition> &list,
         const std::string &heat = "", const unsigned int degree = 1)
        : model("box", box), parameters(MPI_COMM_WORLD)
    {
      std::string text = "subsection Heat\n" + heat + "\nend\n";
      for (const NamedCondition &condition : list)
        text += "subsection Condition: " + condition.name + "\n" + condition.lines + "\nend\n";
      parameters.read_text(text, "body.prm");
      dealii::ParameterHandler &handler = parameters.handler();
      handler.enter_subsection("Heat");
      handler.declare_entry("Absolute zero", "", dealii::Patterns::Anything());
      handler.leave_subsection();
      for (const NamedCondition &condition : list)
      {
        handler.enter_subsection("Condition: " + condition.name);
        MechanicalCondition<dim>::declare_parameters(handler);
        ThermalCondition<dim>::declare_parameters(handler);
        handler.leave_subsection();
      }
      parameters.assign();
      for (const NamedCondition &condition : list)
        sections.push_back(parameters.section("Condition: " + condition.name));
      const Section heat_section = parameters.section("Heat");
      for (const Section &section : sections)
      {
        EXPECT_TRUE(is_thermal(section));
        ThermalCondition<dim>::read(section, heat_section);
      }
      mesh = model.create_mesh();
      nodes = std::make_unique<Nodes<dim>>(*mesh, degree);
      conditions = std::make_unique<ThermalConditions<dim>>(sections, heat_section, *mesh, *nodes);
      parameters.refuse_unused();

      dealii::IndexSet ghosts = nodes->relevant();
      ghosts.add_indices(conditions->required_nodes());
      partition =
          std::make_shared<const NodePartition>(nodes->owned(), ghosts, nodes->communicator());
      conditions->set_partition(*partition);
      position = initial_positions(*nodes, partition);
      conditions->update_areas(position);
    }

    NodalVector vector(const Quantity quantity = Quantity::vector) const
    {
      return NodalVector(partition, quantity);
    }

    /** A temperature from a function of the initial position, ghosts too. */
    NodalVector field(const std::function<double(const double *)> &function) const
    {
      NodalVector result = vector();
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        result.node(i)[0] = function(position.node(i));
      result.update_ghosts();
      return result;
    }

    NodalVector uniform(const double value) const
    {
      return field([&](const double *) { return value; });
    }

    /** Collected at owners. */
    NodalVector surface_heat(const NodalVector &temperature, const double time = 0)
    {
      NodalVector result = vector();
      condition_heat.assign(conditions->n_conditions(), 0.);
      conditions->add_surface_heat(position, temperature, time, result, condition_heat);
      condition_heat = ordered_sum(condition_heat, MPI_COMM_WORLD);
      result.add_to_owners();
      return result;
    }

    NodalVector film_action(const NodalVector &temperature, const NodalVector &field)
    {
      NodalVector result = vector();
      conditions->add_film_action(position, temperature, 0., field, result);
      result.add_to_owners();
      return result;
    }

    double sum(const NodalVector &vector) const
    {
      double result = 0;
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        result += vector.node(i)[0];
      return ordered_sum(result, MPI_COMM_WORLD);
    }

    MeshScene<dim> model;
    Parameters parameters;
    std::vector<Section> sections;
    std::unique_ptr<Mesh<dim>> mesh;
    std::unique_ptr<Nodes<dim>> nodes;
    std::unique_ptr<ThermalConditions<dim>> conditions;
    std::shared_ptr<const NodePartition> partition;
    NodalVector position;
    std::vector<double> condition_heat; ///< of the last surface_heat(), over all ranks
  };

  const std::string block = "set Upper corner = 4, 2, 3\nset Cells = 4, 3, 5\n";
  const std::string plate = "set Upper corner = 4, 2\nset Cells = 6, 5\n";
  const std::string flux = "set Type = heat flux\nset Function = 7\n";
  const std::string convection =
      "set Type = convection\nset Film coefficient = 3\nset Ambient temperature = 20\n";
  const std::string radiation = "set Type = radiation\nset Emissivity = 0.8\nset Ambient "
                                "temperature = 20\nset Stefan-Boltzmann constant = 5.67e-8\n";
  const std::string celsius = "set Absolute zero = -273.15";

  template <int dim>
  void expect_total_of_uniform_flux(const std::string &box, const unsigned int degree,
                                    const double area)
  {
    Body<dim> body(box, {{"f", flux + "set Boundary = x max"}}, "", degree);
    const NodalVector heat = body.surface_heat(body.uniform(0));
    EXPECT_NEAR(body.sum(heat), 7 * area, 1e-13 * 7 * area) << box << degree;
    EXPECT_NEAR(body.condition_heat[0], 7 * area, 1e-13 * 7 * area);
    EXPECT_TRUE(body.conditions->failure().empty());

    // Heat is at nodes of the surface and at no others.
    const auto at_surface = body.conditions->surface_nodes(body.partition);
    for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
      EXPECT_EQ(heat.node(i)[0] > 0, std::binary_search(at_surface.begin(), at_surface.end(), i));
  }

  /** A pseudo-random number of a point, between 0 and 1. */
  double noise(const double *x, const double seed)
  {
    const double wave = 1e3 * std::sin(12.9898 * x[0] + 78.233 * x[1] + 37.719 * x[2] + seed);
    return wave - std::floor(wave);
  }

  std::string refusal(const std::vector<NamedCondition> &list, const std::string &heat = "",
                      const std::string &box = block)
  {
    return input_error([&]() { Body<3> body(box, list, heat); });
  }
} // namespace

TEST(ThermalConditions, the_total_of_a_uniform_flux_is_exact)
{
  for (const unsigned int degree : {1u, 2u, 3u})
  {
    expect_total_of_uniform_flux<3>(block, degree, 6.);
    expect_total_of_uniform_flux<3>(block + "set Disorder = 0.2\nset Surface nodes = slide\nset "
                                            "Rotation = 25\nset Rotation axis = 1, 2, 3\n",
                                    degree, 6.);
    expect_total_of_uniform_flux<2>(plate + "set Disorder = 0.2\nset Rotation = 25\n", degree, 2.);
  }
}

TEST(ThermalConditions, areas_follow_the_current_positions)
{
  Body<3> body(block, {{"f", flux + "set Boundary = x max"}});
  NodalVector stretched = body.vector();
  stretched.copy_from(body.position);
  for (unsigned int i = 0; i < body.partition->n_local(); ++i)
    stretched.node(i)[2] *= 1.5;
  body.conditions->update_areas(stretched);
  EXPECT_NEAR(body.sum(body.surface_heat(body.uniform(0))), 7 * 9., 1e-12);
}

TEST(ThermalConditions, a_flux_is_a_function_of_initial_place_and_time)
{
  Body<3> body(block, {{"f", "set Type = heat flux\nset Function = (1 + y) * t\nset Boundary = x "
                             "max\n"}});
  // The integral of 1 + y over the face, which linear shapes integrate exactly.
  EXPECT_NEAR(body.sum(body.surface_heat(body.uniform(0), 2.)), 2. * (2. + 2.) * 3., 1e-12);
  EXPECT_EQ(body.sum(body.surface_heat(body.uniform(0), 0.)), 0.);
}

TEST(ThermalConditions, films_have_the_heat_of_their_laws)
{
  Body<3> body(block,
               {{"c", convection + "set Boundary = x max"},
                {"r", radiation + "set Boundary = x max, y min"}},
               celsius);
  EXPECT_TRUE(body.conditions->has_films());
  EXPECT_TRUE(body.conditions->has_surface_heat());
  EXPECT_FALSE(body.conditions->has_sources());
  const double convected = 3. * (20. - 120.) * 6.;
  const double radiated = 0.8 * 5.67e-8 * (std::pow(293.15, 4) - std::pow(393.15, 4)) * (6. + 12.);
  // The same by decimal arithmetic, 4.536e-8 (293.15^4 - 393.15^4) on 6 + 12.
  EXPECT_NEAR(radiated, -748.7021301033960 * 18., 1e-8);
  const NodalVector heat = body.surface_heat(body.uniform(120.));
  EXPECT_NEAR(body.condition_heat[0], convected, 1e-12 * std::abs(convected));
  EXPECT_NEAR(body.condition_heat[1], radiated, 1e-12 * std::abs(radiated));
  EXPECT_NEAR(body.sum(heat), convected + radiated, 1e-12 * std::abs(convected + radiated));
  const NodalVector nothing = body.surface_heat(body.uniform(20.));
  EXPECT_EQ(nothing.dot(nothing), 0.);
}

TEST(ThermalConditions, the_film_action_is_symmetric_and_the_derivative_of_the_heat)
{
  Body<3> body(block + "set Disorder = 0.2\nset Surface nodes = slide\n",
               {{"c", "set Type = convection\nset Film coefficient = 2 + x + y^2\nset Ambient "
                      "temperature = 20 - z\nset Where = x > 3.9 || y < 0.1"},
                {"r", radiation + "set Boundary = x max, z min"},
                {"f", flux + "set Boundary = x max"}},
               celsius);
  const NodalVector temperature = body.field([](const double *x) { return 900. * noise(x, 0.); });
  const NodalVector a = body.field([](const double *x) { return noise(x, 1.) - 0.5; });
  const NodalVector b = body.field([](const double *x) { return noise(x, 2.) - 0.3; });
  const NodalVector film_a = body.film_action(temperature, a);
  const NodalVector film_b = body.film_action(temperature, b);
  const double scale = std::sqrt(film_a.dot(film_a) * b.dot(b));
  EXPECT_GT(scale, 1.);
  EXPECT_NEAR(b.dot(film_a), a.dot(film_b), 1e-14 * scale);
  EXPECT_GT(a.dot(film_a), 0.);

  const double difference = 1e-3;
  const auto shifted = [&](const double sign)
  {
    NodalVector result = body.vector();
    for (unsigned int i = 0; i < body.partition->n_local(); ++i)
      result.node(i)[0] = temperature.node(i)[0] + sign * difference * a.node(i)[0];
    return body.surface_heat(result);
  };
  const NodalVector after = shifted(1.), before = shifted(-1.);
  double largest = 0, largest_error = 0;
  for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
  {
    const double slope = (before.node(i)[0] - after.node(i)[0]) / (2. * difference);
    largest = std::max(largest, std::abs(film_a.node(i)[0]));
    largest_error = std::max(largest_error, std::abs(slope - film_a.node(i)[0]));
  }
  largest = dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
  EXPECT_LT(dealii::Utilities::MPI::max(largest_error, MPI_COMM_WORLD), 1e-8 * largest);
}

TEST(ThermalConditions, below_absolute_zero_radiation_has_no_negative_film)
{
  Body<3> body(block, {{"r", radiation + "set Boundary = x max"}}, celsius);
  const NodalVector one = body.uniform(1.);
  EXPECT_GT(body.sum(body.film_action(body.uniform(-200.), one)), 0.);
  EXPECT_EQ(body.sum(body.film_action(body.uniform(-300.), one)), 0.);
}

TEST(ThermalConditions, sources_give_their_density_times_the_volume)
{
  Body<3> body(block,
               {{"all", "set Type = heat source\nset Function = 5 * t\n"},
                {"half", "set Type = heat source\nset Function = x\nset Where = x < 1.5\n"}});
  EXPECT_TRUE(body.conditions->has_sources());
  EXPECT_FALSE(body.conditions->has_surface_heat());
  EXPECT_EQ(body.conditions->surface_nodes(body.partition).size(), 0u);
  NodalVector volume = body.vector(Quantity::scalar);
  for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
    *volume.node(i) = 0.25 + noise(body.position.node(i), 3.);
  double at_one = 0;
  for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
    at_one += std::abs(body.position.node(i)[0] - 1.) < 1e-9 ? *volume.node(i) : 0.;
  at_one = ordered_sum(at_one, MPI_COMM_WORLD);
  NodalVector heat = body.vector(Quantity::scalar);
  std::vector<double> condition_heat(2, 0.);
  body.conditions->add_sources(body.position, volume, 2., heat, condition_heat);
  condition_heat = ordered_sum(condition_heat, MPI_COMM_WORLD);
  const double total = 10. * body.sum(volume);
  EXPECT_NEAR(condition_heat[0], total, 1e-13 * total);
  EXPECT_NEAR(condition_heat[1], at_one, 1e-13 * at_one);
  EXPECT_NEAR(body.sum(heat), total + at_one, 1e-13 * total);
}

TEST(ThermalConditions, prescribe_the_temperature_of_their_nodes)
{
  Body<3> body(block,
               {{"hot", "set Type = temperature\nset Function = 100 + y\nset Boundary = x "
                        "max\n"},
                {"cold", "set Type = temperature\nset Function = -t\nset Where = x < 1e-9"}});
  NodalVector temperature = body.uniform(1.);
  body.conditions->prescribe(body.position, 3., temperature);
  const auto &constrained = body.conditions->constrained_components();
  const auto &list = body.conditions->constrained_nodes();
  ASSERT_EQ(constrained.size(), body.partition->n_owned());
  EXPECT_TRUE(std::is_sorted(list.begin(), list.end()));
  std::size_t n = 0;
  for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
  {
    const double *const x = body.position.node(i);
    const bool is_hot = x[0] > 3.99, is_cold = x[0] < 0.01;
    EXPECT_EQ(constrained[i], is_hot || is_cold ? 255 : 0);
    EXPECT_EQ(temperature.node(i)[0], is_hot ? 100. + x[1] : is_cold ? -3. : 1.);
    if (!is_hot && !is_cold)
      continue;
    ASSERT_LT(n, list.size());
    EXPECT_EQ(list[n], i);
    EXPECT_EQ(body.conditions
                  ->all()[static_cast<std::size_t>(body.conditions->prescribing_condition(n, 0))]
                  .name,
              is_hot ? "hot" : "cold");
    ++n;
  }
  EXPECT_EQ(n, list.size());
  EXPECT_EQ(dealii::Utilities::MPI::sum(n, MPI_COMM_WORLD), 2u * 4u * 6u);
}

TEST(ThermalConditions, without_any_nothing_is_constrained)
{
  Body<3> body(block, {});
  EXPECT_EQ(body.conditions->n_conditions(), 0u);
  EXPECT_TRUE(body.conditions->constrained_components().empty());
  EXPECT_EQ(body.conditions->required_nodes().n_elements(), 0u);
}

TEST(ThermalConditions, a_function_without_a_value_is_kept_as_the_failure)
{
  Body<3> body(block, {{"f", "set Type = heat flux\nset Function = sqrt(1 - t)\nset Boundary = x "
                             "max\n"},
                       {"c", "set Type = convection\nset Film coefficient = 1 - t\nset Ambient "
                             "temperature = 0\nset Boundary = y max\n"}});
  const auto failure = [&]()
  {
    const auto all = texts_of_ranks(MPI_COMM_WORLD, body.conditions->failure());
    return *std::max_element(all.begin(), all.end());
  };
  body.surface_heat(body.uniform(0), 1.);
  EXPECT_EQ(failure(), "");
  const NodalVector one = body.uniform(1.);
  NodalVector result = body.vector();
  body.conditions->add_film_action(body.position, one, 3., one, result);
  EXPECT_TRUE(contains(failure(), "Condition: c/Film coefficient\" = \"1 - t\": allowed is a film "
                                  "coefficient of zero or more, but it is -2 at t = 3"));

  Body<3> other(block, {{"f", "set Type = heat flux\nset Function = sqrt(1 - t)\nset Boundary = x "
                              "max\n"}});
  other.surface_heat(other.uniform(0), 2.);
  const auto all = texts_of_ranks(MPI_COMM_WORLD, other.conditions->failure());
  EXPECT_TRUE(contains(*std::max_element(all.begin(), all.end()), "Condition: f/Function"));
}

TEST(ThermalConditions, that_select_nothing_are_refused)
{
  EXPECT_TRUE(
      contains(refusal({{"a", flux + "set Where = x > 9"}}),
               "body.prm:7: entry \"Condition: a/Where\" = \"x > 9\": the condition selects "
               "no face of the boundary"));
  // Nodes are there, but no face has its centre there.
  EXPECT_TRUE(contains(refusal({{"a", "set Type = adiabatic\nset Where = x < 0.1 && y < 0.1"}}),
                       "selects no face of the boundary"));
  EXPECT_TRUE(
      contains(refusal({{"a", "set Type = temperature\nset Function = 1\nset Where = x > 9"}}),
               "Condition: a/Where\" = \"x > 9\": the condition selects no node"));
  EXPECT_TRUE(
      contains(refusal({{"a", "set Type = heat source\nset Function = 1\nset Where = x > 9"}}),
               "Condition: a/Where\" = \"x > 9\": the condition selects no node"));
  EXPECT_TRUE(contains(refusal({{"a", flux + "set Boundary = x mix"}}), "Did you mean \"x m"));
}

TEST(ThermalConditions, that_exclude_each_other_on_a_face_are_refused)
{
  const std::string at_end = "set Boundary = x max\n", on_more = "set Where = x > 3.9 || y < 0.1\n";
  const std::string temperature = "set Type = temperature\nset Function = 1\n";
  const std::string adiabatic = "set Type = adiabatic\n";
  for (const std::string &type : {flux, convection, temperature, adiabatic})
    EXPECT_TRUE(contains(refusal({{"a", type + at_end}, {"b", type + on_more}}),
                         "15 faces of the boundary that the condition selects have the condition "
                         "\"a\" of type"))
        << type;
  EXPECT_TRUE(contains(refusal({{"a", flux + at_end}, {"b", flux + on_more}}),
                       "entry \"Condition: b/Type\" = \"heat flux\""));
  EXPECT_TRUE(contains(refusal({{"a", radiation + at_end}, {"b", radiation + at_end}}, celsius),
                       "allowed is one condition of a type on a face."));
  for (const std::string &type : {temperature, adiabatic})
    for (const std::string &other : {flux, convection, radiation})
    {
      EXPECT_TRUE(contains(refusal({{"a", type + at_end}, {"b", other + on_more}}, celsius),
                           "allows no other condition on a face."))
          << type << other;
      EXPECT_TRUE(contains(refusal({{"a", other + on_more}, {"b", type + at_end}}, celsius),
                           "allows no other condition on a face."))
          << type << other;
    }
  EXPECT_TRUE(contains(refusal({{"a", temperature + at_end}, {"b", adiabatic + at_end}}),
                       "entry \"Condition: b/Type\" = \"adiabatic\""));
  // The nodes of an edge, or faces side by side, are no conflict.
  EXPECT_EQ(refusal({{"a", temperature + at_end}, {"b", flux + "set Boundary = y max"}}), "");
  EXPECT_EQ(refusal({{"a", flux + at_end}, {"b", convection + at_end}, {"c", radiation + at_end}},
                    celsius),
            "");
  EXPECT_EQ(refusal({{"a", flux + at_end}, {"b", flux + "set Boundary = x min"}}), "");
}

TEST(ThermalConditions, values_that_cannot_be_are_refused)
{
  const std::string at_boundary = "set Boundary = x max\n";
  const auto film = [&](const std::string &h)
  {
    return refusal({{"a", "set Type = convection\nset Film coefficient = " + h +
                              "\nset Ambient temperature = 0\n" + at_boundary}});
  };
  EXPECT_TRUE(contains(film("-3"), "Condition: a/Film coefficient\" = \"-3\": allowed is a film "
                                   "coefficient of zero or more, but it is -3"));
  EXPECT_TRUE(contains(film("t - 1"), "Condition: a/Film coefficient\" = \"t - 1\": allowed is"));
  EXPECT_TRUE(contains(film("1.5 - y"), "but it is -0.5 at (4 2 "));
  EXPECT_EQ(film("2 - y"), "");

  const auto radiating = [&](const std::string &emissivity, const std::string &ambient,
                             const std::string &constant, const std::string &heat)
  {
    return refusal(
        {{"a", "set Type = radiation\nset Emissivity = " + emissivity +
                   "\nset Ambient temperature = " + ambient +
                   "\nset Stefan-Boltzmann constant = " + constant + "\n" + at_boundary}},
        heat);
  };
  EXPECT_EQ(radiating("1", "0", "1e-8", celsius), "");
  const std::string cases[][5] = {
      {"1.1", "0", "1e-8", celsius,
       "Condition: a/Emissivity\" = \"1.1\": allowed is an emissivity from 0 to 1"},
      {"-0.1 + 0*t", "0", "1e-8", celsius, "Condition: a/Emissivity"},
      {"z/2", "0", "1e-8", celsius, "Condition: a/Emissivity"},
      {"1", "-300", "1e-8", celsius,
       "Condition: a/Ambient temperature\" = \"-300\": allowed is a temperature not below absolute "
       "zero, which is -273.15, but it is -300"},
      {"1", "-300*y", "1e-8", celsius, "Ambient temperature"},
      {"1", "0", "-1e-8", celsius,
       "Condition: a/Stefan-Boltzmann constant\" = \"-1e-8\": allowed is a number larger than "
       "zero"},
      {"1", "0", "1e-8", "",
       "entry \"Condition: a/Type\" = \"radiation\": radiation needs absolute "
       "temperatures: `Absolute zero`"},
      {"1", "0", "1e-8", "set Absolute zero = cold",
       "entry \"Heat/Absolute zero\" = \"cold\": allowed is a number"}};
  for (const auto &[emissivity, ambient, constant, heat, message] : cases)
    EXPECT_TRUE(contains(radiating(emissivity, ambient, constant, heat), message));
}

TEST(ThermalConditions, missing_entries_are_refused)
{
  const std::string at_boundary = "set Boundary = x max\n";
  const auto without = [&](std::string lines, const std::string &entry)
  {
    const std::size_t begin = lines.find("set " + entry);
    lines.erase(begin, lines.find('\n', begin) + 1 - begin);
    return refusal({{"a", lines + at_boundary}}, celsius);
  };
  EXPECT_TRUE(contains(without(flux, "Function"), "entry \"Function\" is missing"));
  EXPECT_TRUE(contains(without("set Type = temperature\nset Function = 1\n", "Function"),
                       "entry \"Function\" is missing"));
  for (const std::string entry : {"Film coefficient", "Ambient temperature"})
    EXPECT_TRUE(contains(without(convection, entry), "entry \"" + entry + "\" is missing"));
  for (const std::string entry : {"Emissivity", "Ambient temperature", "Stefan-Boltzmann constant"})
    EXPECT_TRUE(contains(without(radiation, entry), "entry \"" + entry + "\" is missing"));
  for (const std::string &type : {flux, convection, std::string("set Type = adiabatic\n")})
    EXPECT_TRUE(contains(refusal({{"a", type}}), "needs `Where`"));
}

TEST(ThermalConditions, entries_of_another_type_are_refused)
{
  const std::string at_boundary = "set Boundary = x max\n";
  const auto with = [&](const std::string &lines, const std::string &entry)
  {
    const std::string heat = lines == radiation ? celsius : "";
    return refusal({{"a", lines + at_boundary + "set " + entry + " = 0.5\n"}}, heat);
  };
  const std::string temperature = "set Type = temperature\nset Function = 1\n";
  for (const std::string &type : {flux, temperature, std::string("set Type = adiabatic\n")})
    for (const std::string entry :
         {"Film coefficient", "Emissivity", "Ambient temperature", "Stefan-Boltzmann constant"})
      EXPECT_TRUE(
          contains(with(type, entry), "\"Condition: a/" + entry + "\" = \"0.5\" has no effect"))
          << type;
  EXPECT_TRUE(contains(with(convection, "Function"), "\"Condition: a/Function\" = \"0.5\""));
  EXPECT_TRUE(contains(with(convection, "Emissivity"), "\"Condition: a/Emissivity\""));
  EXPECT_TRUE(contains(with(radiation, "Function"), "\"Condition: a/Function\" = \"0.5\""));
  EXPECT_TRUE(contains(with(radiation, "Film coefficient"), "\"Condition: a/Film coefficient\""));
  EXPECT_TRUE(contains(with("set Type = adiabatic\n", "Function"),
                       "\"Condition: a/Function\" = \"0.5\": no heat passes an adiabatic surface"));
  EXPECT_TRUE(contains(refusal({{"a", "set Type = heat source\nset Function = 1\n" + at_boundary}}),
                       "\"Condition: a/Boundary\" = \"x max\": a heat source is in the volume"));
}

TEST(ThermalConditions, are_told_from_others_by_their_type)
{
  Parameters parameters(MPI_COMM_WORLD);
  parameters.read_text("subsection Condition: a\nset Type = traction\nend\n"
                       "subsection Condition: b\nset Type = heat source\nend\n",
                       "types.prm");
  for (const std::string name : {"a", "b"})
  {
    parameters.handler().enter_subsection("Condition: " + name);
    MechanicalCondition<2>::declare_parameters(parameters.handler());
    ThermalCondition<2>::declare_parameters(parameters.handler());
    parameters.handler().leave_subsection();
  }
  parameters.assign();
  EXPECT_FALSE(is_thermal(parameters.section("Condition: a")));
  EXPECT_TRUE(is_thermal(parameters.section("Condition: b")));
}
