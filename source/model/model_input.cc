// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/model_input.h>

#include <tombolo/base/format.h>
#include <tombolo/base/input/name_hints.h>
#include <tombolo/boundary/mechanical_conditions.h>
#include <tombolo/boundary/thermal_conditions.h>
#include <tombolo/mesh/image_conditions.h>
#include <tombolo/mesh/mesh_source.h>
#include <tombolo/mesh/refinement.h>
#include <tombolo/model/initial_condition.h>
#include <tombolo/model/model.h>
#include <tombolo/model/moving_parts.h>
#include <tombolo/state/material_points.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace tombolo
{
  namespace
  {
    /** Whether the cells of a part are not named by the mesh, so that they can be read without one.
     */
    bool is_predicate_of_cells(const std::string &cells)
    {
      const std::string first_word = cells.substr(0, cells.find_first_of(" \t"));
      return first_word != "all" && first_word != "otherwise" && first_word != "material" &&
             first_word != "group" && first_word != "mesh" && first_word != "from";
    }

    /** The entries outside of sections. */
    void declare_names(const Entries &e)
    {
      e.text("Title", "", "", "A title for logs and pictures.");
      e.integer("Dimension", "3", between(2, 3),
                "Number of space dimensions; 2 is plane strain per unit thickness.");
      e.text("Parts", mandatory, "", "Names of the parts, each with a section `Part: NAME`.");
      e.text("Materials", mandatory, "",
             "Names of the materials, each with a section `Material: NAME`.");
      e.text("Conditions", "", "",
             "Names of the conditions, each with a section `Condition: NAME`.");
      e.text("Initial conditions", "", "",
             "Names of initial conditions, each with a section `Initial condition: NAME`.");
      e.text("Plugin libraries", "", "",
             "Shared objects with further plug-ins, loaded before all else is read. Paths are "
             "relative to the parameter file, to the working directory, or to the directory of the "
             "program's own library.");
    }

    template <int dim>
    void declare_part(const Entries &e)
    {
      e.text(
          "Cells", mandatory, "",
          "The cells of the part: a predicate of the cell's centre such as `x < 5`, `material "
          "N`, `group NAME`, `mesh NAME`, `all`, or `otherwise` (those that no other part takes); "
          "or `from NAME`: those cells of the part NAME that become particles while the run goes "
          "on.");
      e.choice("Formulation", mandatory, Registry<Formulation<dim>>::instance().selection(),
               "Element type or particle method.");
      e.text("Material", mandatory, "", "The name of one of the materials.");
      e.plugins<Formulation<dim>>();
    }

    void declare_material(const Entries &e)
    {
      e.choice("Model", mandatory, Registry<Material>::instance().selection(),
               "The material model.");
      e.plugins<Material>();
      declare<ThermalProperties>(e.subsection("Heat"));
    }

    /** Refuses vertices so far away that volumes would overflow. Collective. */
    template <int dim>
    void check_extent(const Mesh<dim> &mesh, const Section &section, MPI_Comm communicator)
    {
      constexpr double largest = 1e90, smallest = 1e-90;
      bool is_within = true;
      const std::string entry = section.is_set("Type") ? "Type" : "";
      double extent = 0;
      for (const Point<dim> &vertex : mesh.triangulation.get_vertices())
        for (unsigned int d = 0; d < dim; ++d)
        {
          is_within = is_within && std::abs(vertex[d]) <= largest;
          extent = std::max(extent, std::abs(vertex[d]));
        }
      if (Utilities::MPI::min(is_within ? 1 : 0, communicator) == 0)
        section.fail(entry, "the mesh has vertices that are not finite, or with coordinates above "
                            "1e90, beyond which volumes are not numbers any more.");
      if (Utilities::MPI::max(extent, communicator) < smallest)
        section.fail(entry, "all coordinates of the mesh are below 1e-90, where volumes are not "
                            "numbers any more; choose a smaller unit of length.");
    }
  } // namespace

  std::vector<Section> named_sections(const Parameters &parameters, const std::string &list,
                                      const std::string &prefix)
  {
    std::vector<Section> sections;
    for (const std::string &name : section_names(parameters, list))
      sections.push_back(parameters.section(prefix + ": " + name));
    return sections;
  }

  using Materials = std::map<std::string, std::shared_ptr<Material>>;

  namespace
  {
    /** Refuses a material, such as a plug-in, that nothing can compute with. Throws InputError. */
    void check_material(const Section &section, const Material &material)
    {
      const auto require =
          [&](const bool is_allowed, const std::string &is, const std::string &allowed)
      {
        if (!is_allowed)
          section.fail("Model", "the material has " + is + "; allowed is " + allowed + ".");
      };
      const auto require_number =
          [&](const double value, const std::string &name, const double smallest)
      {
        require(value >= smallest && std::isfinite(value),
                "a " + name + " of " + format_number(value), "a finite number above zero");
      };
      constexpr double above_zero = std::numeric_limits<double>::min();
      require_number(material.density(), "density", above_zero);
      if (material.has_mechanics())
      {
        require_number(material.bulk_modulus(), "bulk modulus", above_zero);
        require_number(material.shear_modulus(), "shear modulus", 0.);
      }
      MaterialPoints points;
      points.reinit(0, material.internal_variables());
      std::set<std::string> names;
      for (const FieldDescription &field : points.fields())
      {
        const unsigned int n = field.n_components;
        require(!field.name.empty() && names.insert(field.name).second,
                "a variable " + in_quotes(field.name), "a name that no other field has");
        require(field.location == FieldLocation::material_point &&
                    (n == 6 || (!field.turns && (n == 1 || n == 3 || n == 9))),
                "a variable " + in_quotes(field.name) + " of " + std::to_string(n) + " components",
                "one of 1, 3, 6 or 9 at material points, and of 6 if it turns");
      }
    }
  } // namespace

  Materials create_materials(const Parameters &parameters)
  {
    Materials materials;
    for (const std::string &name : section_names(parameters, "Materials"))
      parameters.attempt(
          [&]
          {
            const Section section = parameters.section("Material: " + name);
            auto material = create_selected<Material>(section, "Model");
            check_material(section, *material);
            materials[name] = std::move(material);
          });
    return materials;
  }

  namespace
  {
    /** The material of a part. Throws InputError. */
    std::shared_ptr<Material> material_of(const Section &section, const Materials &materials)
    {
      const std::string material = section.get("Material");
      const auto found = materials.find(material);
      if (found != materials.end())
        return found->second;
      const std::vector<std::string> names = section_names(section.all(), "Materials");
      if (std::find(names.begin(), names.end(), material) != names.end())
        throw KnownMistake("The material " + in_quotes(material) + " could not be made.");
      std::vector<std::string> sorted = names;
      std::sort(sorted.begin(), sorted.end());
      section.fail("Material", "there is no material of this name." +
                                   did_you_mean(material, names) +
                                   " The entry \"Materials\" lists: " + joined(sorted, ", ") + ".");
    }

    /** Reads the section of a part. Throws InputError. */
    template <int dim>
    void read_part(const Section &section, const Materials &materials, Part<dim> &part)
    {
      const Parameters &parameters = section.all();
      part.name = section.name();
      parameters.attempt(
          [&]
          {
            part.material = material_of(section, materials);
            part.heat =
                ThermalProperties::read(parameters.section("Material: " + section.get("Material")));
          });
      parameters.attempt(
          [&]
          {
            part.formulation = create_selected<Formulation<dim>>(section, "Formulation");
            part.particles = part.formulation->as_particles();
          });
      section.get("Cells");
    }
  } // namespace

  template <int dim>
  std::vector<Part<dim>> create_parts(const Parameters &parameters)
  {
    const Materials materials = create_materials(parameters);
    std::vector<Part<dim>> parts;
    bool are_complete = true;
    for (const Section &section : named_sections(parameters, "Parts", "Part"))
    {
      Part<dim> part;
      if (!parameters.attempt([&] { read_part(section, materials, part); }))
      {
        are_complete = false; // which a part without a formulation marks
        part.formulation.reset();
        part.particles = nullptr;
      }
      if (part.material != nullptr)
        parts.push_back(std::move(part));
    }
    if (are_complete)
      for (const ProcessKind<dim> *const kind : ProcessKinds<dim>::instance().all())
        parameters.attempt([&] { kind->prepare(parameters, parts); });
    return parts;
  }

  template <int dim>
  Physics<dim>::Physics(const std::vector<Part<dim>> &parts,
                        const std::vector<Section> &part_sections)
  {
    for (const Part<dim> &part : parts)
    {
      has_mechanics = has_mechanics || has_motion(part);
      has_heat = has_heat || part.heat != nullptr;
    }
    for (std::size_t p = 0; p < parts.size(); ++p)
    {
      if (has_heat && parts[p].heat == nullptr)
        part_sections[p].fail("Material", "the material has no section \"Heat\", but that of "
                                          "another part has; in a scene with heat all parts have "
                                          "it.");
      if (has_mechanics && !has_motion(parts[p]))
        part_sections[p].fail("Material",
                              "the material has no stresses, but that of another part "
                              "has; in a scene with mechanics all parts have them. A part that "
                              "only conducts heat is one with `Formulation = rigid`.");
    }
    if (!has_mechanics && !has_heat && !parts.empty())
      part_sections.front().fail("Material", "the material has neither stresses nor a section "
                                             "\"Heat\": nothing would happen.");
  }

  template <int dim>
  unsigned int common_degree(const std::vector<Part<dim>> &parts,
                             const std::vector<Section> &part_sections)
  {
    unsigned int result = 1;
    for (unsigned int p = 0; p < parts.size(); ++p)
    {
      const unsigned int part_degree = parts[p].formulation->degree();
      if (part_degree == 0 || part_degree == result)
        continue;
      for (unsigned int q = 0; q < p; ++q)
        if (parts[q].formulation->degree() != 0)
          part_sections[p].fail("Formulation", "the part has nodes of degree " +
                                                   std::to_string(part_degree) + ", but part \"" +
                                                   parts[q].name + "\" has degree " +
                                                   std::to_string(result) +
                                                   "; the parts of a scene share their nodes.");
      result = part_degree;
    }
    return result;
  }

  bool divides_cells_in_run(const Parameters &parameters)
  {
    return parameters.section("Mesh/Adaptive refinement").get("Criterion") != "none";
  }

  template <int dim>
  void read_mesh(const Section &section, Mesh<dim> &mesh, const MPI_Comm communicator)
  {
    mesh_source<dim>(section.all())->create(mesh);
    check_extent(mesh, section, communicator);
    MeshRefinement<dim>(section).refine(mesh);
  }

  template <int dim>
  void declare_model(Parameters &parameters)
  {
    const Entries e(parameters.handler());
    declare_names(e);
    declare_mesh_sources<dim>(parameters);
    declare<MeshRefinement<dim>>(e.subsection("Mesh"));
    for (const std::string &name : section_names(parameters, "Parts"))
      declare_part<dim>(e.subsection("Part: " + name));
    for (const std::string &name : section_names(parameters, "Materials"))
      declare_material(e.subsection("Material: " + name));
    for (const std::string &name : section_names(parameters, "Conditions"))
    {
      MechanicalCondition<dim>::declare_parameters(e.subsection("Condition: " + name));
      ThermalCondition<dim>::declare_parameters(e.subsection("Condition: " + name));
    }
    for (const std::string &name : section_names(parameters, "Initial conditions"))
      declare<InitialCondition<dim>>(e.subsection("Initial condition: " + name));
    e.subsection("Coupling")
        .choice("Bridge", "paper", "paper|trace",
                "How finite elements and particles share nodes: `paper` (Appendix 2 of Pan et al. "
                "2019), or `trace`, where the elements see the particles' field.");
    ThermalModel<dim>::declare_parameters(e.subsection("Heat"));
    for (const ProcessKind<dim> *const kind : ProcessKinds<dim>::instance().all())
      kind->declare_parameters(parameters);
  }

  namespace
  {
    /** Checks what can be checked of a condition without a mesh. Returns whether it is
     * one of radiation. */
    template <int dim>
    bool validate_condition(const Section &section, const Physics<dim> &physics)
    {
      if (makes_images(section))
        validate_images<dim>(section);
      else if (is_thermal(section))
      {
        if (!physics.has_heat)
          section.fail("Type", "the scene has no heat: a thermal condition needs materials with a "
                               "section \"Heat\".");
        ThermalCondition<dim>::read(section, section.all().section("Heat"));
        return section.get("Type") == "radiation";
      }
      else
      {
        if (!physics.has_mechanics)
          section.fail("Type", "the scene has no mechanics, since its materials have no stresses; "
                               "nothing moves.");
        MechanicalCondition<dim>::read(section);
      }
      return false;
    }

    /** Refuses initial temperatures below absolute zero. */
    void check_initial_temperatures(const Parameters &parameters)
    {
      const Section heat = parameters.section("Heat");
      for (const Section &section : named_sections(parameters, "Parts", "Part"))
      {
        const Section material =
            parameters.section("Material: " + section.get("Material") + "/Heat");
        if (material.get_double("Initial temperature") < heat.get_double("Absolute zero"))
          material.fail("Initial temperature",
                        "allowed is a temperature not below absolute zero, which is " +
                            heat.get("Absolute zero") + " by " +
                            in_quotes(heat.path() + "/Absolute zero") + ".");
      }
    }
  } // namespace

  template <int dim>
  Physics<dim> validate_model(const Parameters &parameters)
  {
    const std::vector<Section> part_sections = named_sections(parameters, "Parts", "Part");
    parameters.attempt(
        [&]
        {
          parameters.section("").get("Parts");
          if (part_sections.empty())
            parameters.fail("Parts", "a scene needs at least one part.");
        });
    parameters.attempt([&] { parameters.section("").get("Materials"); });
    const std::vector<Part<dim>> parts = create_parts<dim>(parameters);
    // What a part that is not known has, cannot be missing.
    Physics<dim> physics;
    const bool are_complete =
        !parts.empty() && parts.size() == part_sections.size() &&
        std::all_of(parts.begin(), parts.end(),
                    [](const Part<dim> &part) { return part.formulation != nullptr; });
    if (are_complete)
      parameters.attempt([&] { physics = Physics<dim>(parts, part_sections); });
    parameters.attempt([&] { mesh_source<dim>(parameters); });
    parameters.attempt([&] { MeshRefinement<dim> refinement(parameters.section("Mesh")); });
    for (const Section &section : part_sections)
      parameters.attempt(
          [&]
          {
            if (is_predicate_of_cells(section.get("Cells")))
              Predicate<dim> predicate(section, "Cells");
          });
    bool has_radiation = false;
    for (const Section &section : named_sections(parameters, "Conditions", "Condition"))
      parameters.attempt(
          [&] { has_radiation = validate_condition<dim>(section, physics) || has_radiation; });
    // By name and number processes would find others than the parts that the file has.
    const std::vector<Part<dim>> none;
    const auto &known_parts = parts.size() == part_sections.size() ? parts : none;
    for (const ProcessKind<dim> *const kind : ProcessKinds<dim>::instance().all())
      parameters.attempt([&] { kind->validate(parameters, known_parts); });
    validate_initial_conditions(parameters, physics);
    if (has_radiation && are_complete)
      parameters.attempt([&] { check_initial_temperatures(parameters); });
    parameters.section("Coupling").get("Bridge");
    return physics;
  }

  template std::vector<Part<2>> create_parts<2>(const Parameters &);
  template std::vector<Part<3>> create_parts<3>(const Parameters &);
  template struct Physics<2>;
  template struct Physics<3>;
  template unsigned int common_degree(const std::vector<Part<2>> &, const std::vector<Section> &);
  template unsigned int common_degree(const std::vector<Part<3>> &, const std::vector<Section> &);
  template void read_mesh(const Section &, Mesh<2> &, MPI_Comm);
  template void read_mesh(const Section &, Mesh<3> &, MPI_Comm);
  template void declare_model<2>(Parameters &);
  template void declare_model<3>(Parameters &);
  template Physics<2> validate_model<2>(const Parameters &);
  template Physics<3> validate_model<3>(const Parameters &);
} // namespace tombolo
