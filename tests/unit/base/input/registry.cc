// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/registry.h>

#include <algorithm>

namespace tombolo
{
  class Shape
  {
  public:
    virtual ~Shape() = default;
    virtual double area() const = 0;
  };

  template <>
  struct PluginKind<Shape>
  {
    static constexpr const char *name = "shape of the registry test";
  };

  class Square : public Shape
  {
  public:
    explicit Square(const Section &section) : side(section.get_double("Side")) {}
    static void declare_parameters(dealii::ParameterHandler &handler)
    {
      handler.declare_entry("Side", "3", dealii::Patterns::Double(0.), "Length of a side.");
    }
    double area() const override
    {
      return side * side;
    }

  private:
    double side;
  };

  class Dot : public Shape
  {
  public:
    explicit Dot(const Section &) {}
    static void declare_parameters(dealii::ParameterHandler &) {}
    double area() const override
    {
      return 0;
    }
  };

  TOMBOLO_REGISTER(Shape, Square, "square", "four equal sides")
  TOMBOLO_REGISTER(Shape, Dot, "dot", "no extent")

  template <int dim>
  class Solid
  {
  public:
    virtual ~Solid() = default;
  };

  template <int dim>
  struct PluginKind<Solid<dim>>
  {
    static constexpr const char *name = "solid of the registry test";
  };

  template <int dim>
  class Ball : public Solid<dim>
  {
  public:
    explicit Ball(const Section &) {}
    static void declare_parameters(dealii::ParameterHandler &) {}
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Solid, Ball, "ball", "round")

  namespace
  {
    TEST(Registry, plugin_is_made_by_name_from_its_own_section)
    {
      const auto &registry = Registry<Shape>::instance();
      EXPECT_EQ(registry.names(), (std::vector<std::string>{"dot", "square"}));
      EXPECT_EQ(registry.selection(), "dot|square");
      EXPECT_TRUE(registry.has("square"));
      EXPECT_FALSE(registry.has("circle"));

      Parameters parameters(MPI_COMM_WORLD);
      parameters.read_text("subsection square\nset Side = 4\nend\n", "case.prm");
      registry.declare_all(parameters.handler());
      parameters.assign();
      EXPECT_EQ(registry.create("square", parameters.section("square"))->area(), 16.);
      EXPECT_EQ(registry.create("dot", parameters.section("dot"))->area(), 0.);
    }

    TEST(Registry, list_names_each_plugin_once_for_all_dimensions)
    {
      const auto plugins = list_plugins();
      const auto count = [&](const std::string &name)
      {
        return std::count_if(plugins.begin(), plugins.end(),
                             [&](const PluginDescription &plugin) { return plugin.name == name; });
      };
      EXPECT_EQ(count("ball"), 1);
      EXPECT_EQ(count("square"), 1);
      EXPECT_TRUE(Registry<Solid<2>>::instance().has("ball"));
      EXPECT_TRUE(Registry<Solid<3>>::instance().has("ball"));
      const auto square = std::find_if(plugins.begin(), plugins.end(),
                                       [](const auto &plugin) { return plugin.name == "square"; });
      EXPECT_EQ(square->kind, "shape of the registry test");
      EXPECT_EQ(square->description, "four equal sides");
      EXPECT_TRUE(std::is_sorted(plugins.begin(), plugins.end(),
                                 [](const auto &a, const auto &b) { return a.kind < b.kind; }));
    }

    TEST(Registry, plugins_of_the_library_are_registered)
    {
      const auto plugins = list_plugins();
      EXPECT_TRUE(std::any_of(plugins.begin(), plugins.end(),
                              [](const auto &plugin) { return plugin.name == "elastic"; }));
    }

    TEST(Registry, second_plugin_of_a_name_is_reported_and_the_first_stays)
    {
      EXPECT_EQ(internal::release_registration_problems(), "");
      const internal::Registration<Shape, Dot> again("square", "another");
      EXPECT_EQ(internal::release_registration_problems(),
                "Two plug-ins of kind shape of the registry test are called \"square\".");
      EXPECT_EQ(internal::release_registration_problems(), "");
    }

    TEST(NearestName, is_the_one_with_the_fewest_changes)
    {
      const std::vector<std::string> names = {"Density", "Young's modulus", "Poisson's ratio"};
      EXPECT_EQ(nearest_name("Densty", names), "Density");
      EXPECT_EQ(nearest_name("density", names), "Density");
      EXPECT_EQ(nearest_name("Dnesity", names), "Density");
      EXPECT_EQ(nearest_name("implicit", {"explicit", "quasi-static"}), "");
      EXPECT_EQ(nearest_name("YOUNGS_MODULUS", names), "Young's modulus");
      EXPECT_EQ(nearest_name("Poisson ratio", names), "Poisson's ratio");
    }

    TEST(NearestName, is_empty_where_nothing_is_near)
    {
      EXPECT_EQ(nearest_name("Viscosity", {"Density", "End time"}), "");
      EXPECT_EQ(nearest_name("x", {"y"}), "");
      EXPECT_EQ(nearest_name("", {"y"}), "");
      EXPECT_EQ(nearest_name("abc", {}), "");
    }
  } // namespace
} // namespace tombolo
