#include <tombolo/simulation/scene.h>

#include <tombolo/base/throw_together.h>
#include <tombolo/boundary/symmetry_planes.h>
#include <tombolo/mesh/mesh_source.h>
#include <tombolo/mesh/partition_weights.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The selected plug-in of a kind, made from the subsection of its name. */
    template <typename Interface>
    std::unique_ptr<Interface> create_selected(const Section &section, const std::string &entry)
    {
      const std::string name = section.get(entry);
      return Registry<Interface>::instance().create(name, section.subsection(name));
    }

    std::vector<Section> named_sections(const Parameters &parameters, const std::string &list,
                                        const std::string &prefix)
    {
      std::vector<Section> sections;
      for (const std::string &name : parameters.raw_list(list))
        sections.push_back(parameters.section(prefix + ": " + name));
      return sections;
    }

    template <int dim>
    Point<dim> point_of(const double *node)
    {
      Point<dim> point;
      for (unsigned int d = 0; d < dim; ++d)
        point[d] = node[d];
      return point;
    }

    /** Whether the cells of a part are not named by the mesh, so that they can be read without one.
     */
    bool is_predicate_of_cells(const std::string &cells)
    {
      const std::string first_word = cells.substr(0, cells.find_first_of(" \t"));
      return first_word != "all" && first_word != "otherwise" && first_word != "material" &&
             first_word != "group";
    }

    LatticeFilterSettings filter_settings(const Parameters &parameters)
    {
      const Section section = parameters.section("Lattice filter");
      LatticeFilterSettings settings;
      settings.power = section.get_unsigned("Power");
      settings.strength = section.get_double("Strength");
      settings.interval = section.get_unsigned("Interval");
      return settings;
    }

    /** What a section "Initial condition: NAME" says. */
    template <int dim>
    struct InitialCondition
    {
      explicit InitialCondition(const Section &section)
      {
        if (!section.get("Where").empty())
          where.emplace(section, "Where");
        if (section.is_set("Velocity"))
          velocity.emplace(section, "Velocity", dim);
        if (section.is_set("Stress"))
          stress.emplace(section, "Stress", 6);
        if (!velocity && !stress)
          section.fail("", "an initial condition needs `Velocity` or `Stress`.");
      }

      std::optional<Predicate<dim>> where;
      std::optional<Expression<dim>> velocity;
      std::optional<Expression<dim>> stress;
    };

    std::map<std::string, std::shared_ptr<const Material>>
    create_materials(const Parameters &parameters)
    {
      std::map<std::string, std::shared_ptr<const Material>> materials;
      for (const std::string &name : parameters.raw_list("Materials"))
        materials[name] =
            create_selected<Material>(parameters.section("Material: " + name), "Model");
      return materials;
    }

    template <int dim>
    std::vector<Part<dim>> create_parts(const Parameters &parameters)
    {
      const auto materials = create_materials(parameters);
      std::vector<Part<dim>> parts;
      for (const Section &section : named_sections(parameters, "Parts", "Part"))
      {
        Part<dim> part;
        part.name = section.name();
        const std::string material = section.get("Material");
        const auto found = materials.find(material);
        if (found == materials.end())
        {
          std::vector<std::string> names;
          std::string list;
          for (const auto &entry : materials)
          {
            names.push_back(entry.first);
            list += (list.empty() ? "" : ", ") + entry.first;
          }
          const std::string nearest = nearest_name(material, names);
          section.fail("Material",
                       "there is no material of this name." +
                           (nearest.empty() ? "" : " Did you mean \"" + nearest + "\"?") +
                           " The entry \"Materials\" lists: " + list + ".");
        }
        part.material = found->second;
        part.formulation = create_selected<Formulation<dim>>(section, "Formulation");
        part.particles = dynamic_cast<ParticleFormulation<dim> *>(part.formulation.get());
        parts.push_back(std::move(part));
      }
      return parts;
    }
  } // namespace

  template <int dim>
  void Scene<dim>::declare_parameters(Parameters &parameters)
  {
    ParameterHandler &handler = parameters.handler();
    handler.declare_entry("Title", "", Patterns::Anything(), "A title for logs and pictures.");
    handler.declare_entry("Dimension", "3", Patterns::Integer(2, 3),
                          "Number of space dimensions; 2 is plane strain per unit thickness.");
    Parameters::declare_mandatory(handler, "Parts", Patterns::Anything(),
                                  "Names of the parts, each with a section `Part: NAME`.");
    Parameters::declare_mandatory(handler, "Materials", Patterns::Anything(),
                                  "Names of the materials, each with a section `Material: NAME`.");
    handler.declare_entry("Conditions", "", Patterns::Anything(),
                          "Names of the conditions, each with a section `Condition: NAME`.");
    handler.declare_entry("Contacts", "", Patterns::Anything(),
                          "Names of contacts with rigid surfaces, each with a section `Contact: "
                          "NAME`.");
    handler.declare_entry(
        "Initial conditions", "", Patterns::Anything(),
        "Names of initial conditions, each with a section `Initial condition: NAME`.");
    handler.declare_entry(
        "Plugin libraries", "", Patterns::Anything(),
        "Shared objects with further plug-ins, loaded before all else is read. Paths "
        "are relative to the parameter file, or to the working directory.");

    handler.enter_subsection("Mesh");
    Parameters::declare_mandatory(
        handler, "Type", Patterns::Selection(Registry<MeshSource<dim>>::instance().selection()),
        "Where the mesh comes from.");
    Registry<MeshSource<dim>>::instance().declare_all(handler);
    handler.leave_subsection();

    for (const std::string &name : parameters.raw_list("Parts"))
    {
      handler.enter_subsection("Part: " + name);
      Parameters::declare_mandatory(
          handler, "Cells", Patterns::Anything(),
          "The cells of the part: a predicate of the cell's centre such as "
          "`x < 5`, `material N`, `group NAME`, `all`, or `otherwise` (those "
          "that no other part takes).");
      Parameters::declare_mandatory(
          handler, "Formulation",
          Patterns::Selection(Registry<Formulation<dim>>::instance().selection()),
          "Element type or particle method.");
      Parameters::declare_mandatory(handler, "Material", Patterns::Anything(),
                                    "The name of one of the materials.");
      Registry<Formulation<dim>>::instance().declare_all(handler);
      handler.leave_subsection();
    }

    for (const std::string &name : parameters.raw_list("Materials"))
    {
      handler.enter_subsection("Material: " + name);
      Parameters::declare_mandatory(handler, "Model",
                                    Patterns::Selection(Registry<Material>::instance().selection()),
                                    "The material model.");
      Registry<Material>::instance().declare_all(handler);
      handler.leave_subsection();
    }

    for (const std::string &name : parameters.raw_list("Conditions"))
    {
      handler.enter_subsection("Condition: " + name);
      MechanicalConditions<dim>::declare_parameters(handler);
      handler.leave_subsection();
    }

    for (const std::string &name : parameters.raw_list("Contacts"))
    {
      handler.enter_subsection("Contact: " + name);
      PenaltyContact<dim>::declare_parameters(handler);
      handler.leave_subsection();
    }

    for (const std::string &name : parameters.raw_list("Initial conditions"))
    {
      handler.enter_subsection("Initial condition: " + name);
      handler.declare_entry("Where", "", Patterns::Anything(),
                            "A predicate of the initial position; everywhere if empty.");
      handler.declare_entry("Velocity", "", Patterns::Anything(),
                            "Components separated by `;`, functions of x, y, z. Units: L/T.");
      handler.declare_entry(
          "Stress", "", Patterns::Anything(),
          "Six components xx; yy; zz; yz; xz; xy of the Cauchy stress, functions of "
          "x, y, z. Units: M/(L T^2).");
      handler.leave_subsection();
    }

    handler.enter_subsection("Coupling");
    handler.declare_entry(
        "Bridge", "paper", Patterns::Selection("paper|trace"),
        "How finite elements and particles share nodes: `paper` (Appendix 2 of Pan et "
        "al. 2019), or `trace`, where the elements see the particles' field.");
    handler.leave_subsection();

    handler.enter_subsection("Lattice filter");
    handler.declare_entry(
        "Power", "0", Patterns::Integer(0, 16),
        "p of v <- v - delta (I - Phi S)^p v, which removes the waves that alternate "
        "between neighbouring particles; 0 is no filter. 4 suits waves, 6 or more impact.");
    handler.declare_entry("Strength", "0.5", Patterns::Double(0., 10.),
                          "beta of delta = beta c dt n / h.");
    handler.declare_entry("Interval", "3", Patterns::Integer(1, 1000),
                          "The filter is applied every so many steps.");
    handler.leave_subsection();
  }

  template <int dim>
  void Scene<dim>::validate(const Parameters &parameters)
  {
    parameters.section("").get("Parts");
    parameters.section("").get("Materials");
    if (create_parts<dim>(parameters).empty())
      parameters.fail("Parts", "a scene needs at least one part.");
    create_selected<MeshSource<dim>>(parameters.section("Mesh"), "Type");
    for (const Section &section : named_sections(parameters, "Parts", "Part"))
      if (is_predicate_of_cells(section.get("Cells")))
        Predicate<dim> predicate(section, "Cells");
    for (const Section &section : named_sections(parameters, "Conditions", "Condition"))
      if (is_symmetry(section))
        validate_symmetry<dim>(section);
      else
        MechanicalConditions<dim>::validate(section);
    for (const Section &section : named_sections(parameters, "Contacts", "Contact"))
      PenaltyContact<dim>::validate(section, false);
    for (const Section &section :
         named_sections(parameters, "Initial conditions", "Initial condition"))
      InitialCondition<dim> condition(section);
    parameters.section("Coupling").get("Bridge");
    filter_settings(parameters);
  }

  template <int dim>
  Scene<dim>::~Scene() = default;

  template <int dim>
  Scene<dim>::Scene(const Parameters &parameters, MPI_Comm communicator)
      : communicator(communicator), mesh(communicator), parts(create_parts<dim>(parameters))
  {
    const std::vector<Section> part_sections = named_sections(parameters, "Parts", "Part");

    degree = 1;
    for (unsigned int p = 0; p < parts.size(); ++p)
    {
      const unsigned int wanted = parts[p].formulation->degree();
      if (wanted == 0 || wanted == degree)
        continue;
      for (unsigned int q = 0; q < p; ++q)
        if (parts[q].formulation->degree() != 0)
          part_sections[p].fail("Formulation", "the part has nodes of degree " +
                                                   std::to_string(wanted) + ", but part \"" +
                                                   parts[q].name + "\" has degree " +
                                                   std::to_string(degree) +
                                                   "; the parts of a scene share their nodes.");
      degree = wanted;
    }

    create_selected<MeshSource<dim>>(parameters.section("Mesh"), "Type")->create(mesh);
    part_cells = std::make_unique<PartCells<dim>>(part_sections, mesh);
    part_cells->check(mesh.triangulation);
    std::vector<double> work;
    for (const Part<dim> &part : parts)
      work.push_back(part.particles != nullptr ? 2. : 1.);
    balance(mesh, *part_cells, work);
    nodes = std::make_unique<Nodes<dim>>(mesh, degree);

    const Section coupling = parameters.section("Coupling");
    const bool trace = coupling.get("Bridge") == "trace";

    std::vector<Section> mechanical_sections, symmetry_sections;
    for (const Section &section : named_sections(parameters, "Conditions", "Condition"))
      (is_symmetry(section) ? symmetry_sections : mechanical_sections).push_back(section);
    symmetry = find_symmetry(symmetry_sections, mesh, *nodes);
    conditions = std::make_unique<MechanicalConditions<dim>>(mechanical_sections, mesh, *nodes);

    SmoothingSettings smoothing;
    const Part<dim> *first_particles = nullptr;
    for (unsigned int p = 0; p < parts.size(); ++p)
    {
      Part<dim> &part = parts[p];
      PartSetup<dim> setup;
      setup.name = part.name;
      setup.index = p;
      setup.nodes = nodes.get();
      setup.part_cells = part_cells.get();
      setup.material = part.material;
      setup.communicator = communicator;
      setup.symmetry = symmetry;
      part.formulation->initialize(setup);
      if (part.particles == nullptr)
        continue;
      if (first_particles == nullptr)
        smoothing = part.particles->smoothing();
      else if (!(smoothing == part.particles->smoothing()))
        part_sections[p].fail("Formulation",
                              "the particles of all parts of a scene are smoothed alike, "
                              "but those of part \"" +
                                  first_particles->name + "\" differ");
      if (first_particles == nullptr)
        first_particles = &part;
    }
    bridge = std::make_unique<Bridge>(dim, smoothing, trace);

    set_partition();
    state.reinit(partition);
    std::vector<types::global_dof_index> cell_nodes;
    std::vector<Point<dim>> cell_points;
    for (const auto &cell : nodes->dof_handler().active_cell_iterators())
    {
      if (cell->is_artificial())
        continue;
      nodes->cell_nodes(cell, cell_nodes);
      nodes->cell_points(cell, cell_points);
      for (unsigned int k = 0; k < cell_nodes.size(); ++k)
        if (nodes->owned().is_element(cell_nodes[k]))
          for (unsigned int d = 0; d < dim; ++d)
            state.initial_position.node(partition->local_index(cell_nodes[k]))[d] =
                cell_points[k][d];
    }
    state.initial_position.update_ghosts();
    state.position.copy_from(state.initial_position);
    set_masses();

    filter = filter_settings(parameters);
    double rate = 0;
    for (const Part<dim> &part : parts)
      if (part.particles != nullptr)
        rate = std::max(rate, part.material->longitudinal_wave_speed() /
                                  part.particles->smallest_spacing());
    filter.rate = Utilities::MPI::max(rate, communicator);

    set_initial_conditions(parameters);
    create_contacts(parameters);
    set_contact_buffers();
  }

  template <int dim>
  void Scene<dim>::set_contact_buffers()
  {
    if (contacts.empty())
      return;
    contact_loads.reinit(partition);
    contact_force.reinit(partition);
  }

  template <int dim>
  void Scene<dim>::create_contacts(const Parameters &parameters)
  {
    std::vector<bool> is_particle(partition->n_owned(), false);
    for (const Part<dim> &part : parts)
      if (part.particles != nullptr)
        for (const unsigned int node : part.particles->shape_functions().particle_node)
          is_particle[node] = true;
    for (const Section &section : named_sections(parameters, "Contacts", "Contact"))
      contacts.push_back(
          std::make_unique<PenaltyContact<dim>>(section, mesh, *nodes, state, is_particle, false));
  }

  template <int dim>
  void Scene<dim>::compute_contact_force(const Clock &clock)
  {
    nodes_in_contact.clear();
    for (const auto &contact : contacts)
      contact->add_forces(state, clock, contact_loads, nodes_in_contact);
    std::sort(nodes_in_contact.begin(), nodes_in_contact.end());
    nodes_in_contact.erase(std::unique(nodes_in_contact.begin(), nodes_in_contact.end()),
                           nodes_in_contact.end());
    contact_force.set_zero();
    bridge->add_force_of_loads(nodes_in_contact, contact_loads, contact_force);
    contact_force.add_to_owners();
    for (const unsigned int node : nodes_in_contact)
      std::fill_n(contact_loads.node(node), n_slots, 0.);
  }

  template <int dim>
  ContactBalance Scene<dim>::contact_balance() const
  {
    ContactBalance sum;
    for (const auto &contact : contacts)
    {
      const ContactBalance balance = contact->balance(communicator);
      for (unsigned int d = 0; d < 3; ++d)
      {
        sum.force[d] += balance.force[d];
        sum.impulse[d] += balance.impulse[d];
      }
      sum.elastic += balance.elastic;
      sum.friction += balance.friction;
      sum.damping += balance.damping;
      sum.work += balance.work;
      sum.n_nodes += balance.n_nodes;
      sum.penetration = std::max(sum.penetration, balance.penetration);
    }
    return sum;
  }

  template <int dim>
  std::vector<ShapeFunctions *> Scene<dim>::shape_functions() const
  {
    std::vector<ShapeFunctions *> result;
    for (const Part<dim> &part : parts)
      if (part.particles != nullptr)
        result.push_back(&part.particles->shape_functions());
    return result;
  }

  template <int dim>
  void Scene<dim>::set_partition()
  {
    IndexSet required = nodes->relevant();
    std::vector<ImageNode> images;
    for (const Part<dim> &part : parts)
    {
      required.add_indices(part.formulation->required_nodes());
      const std::vector<ImageNode> of_part = part.formulation->required_images();
      images.insert(images.end(), of_part.begin(), of_part.end());
    }
    required.add_indices(conditions->required_nodes());
    required.compress();
    partition = std::make_shared<const NodePartition>(nodes->owned(), required, communicator,
                                                      symmetry, images);
    for (const Part<dim> &part : parts)
      part.formulation->set_partition(*partition);
    conditions->set_partition(*partition);
  }

  template <int dim>
  void Scene<dim>::set_masses()
  {
    element_mass.reinit(partition, 1);
    for (const Part<dim> &part : parts)
      if (part.particles == nullptr)
        part.formulation->add_mass(element_mass);
    element_mass.add_to_owners();
    bridge->reinit(partition, shape_functions(), element_mass,
                   conditions->constrained_components());
    state.mass.copy_from(bridge->mass());
    if (conditions->has_loads())
    {
      bridge->set_loaded_nodes(conditions->loaded_nodes(state));
      loads.reinit(partition);
      load_force.reinit(partition);
    }
    set_contact_buffers();
  }

  template <int dim>
  bool Scene<dim>::update_neighbourhoods()
  {
    NeighbourhoodChange change = NeighbourhoodChange::none;
    for (const Part<dim> &part : parts)
      change = std::max(change, part.formulation->update_neighbourhoods(state.position));
    if (change == NeighbourhoodChange::none)
      return false;
    if (change == NeighbourhoodChange::values)
    {
      bridge->update_nodal_mass();
      return true;
    }
    set_partition();
    state.move_to(partition);
    set_masses();
    return true;
  }

  template <int dim>
  void Scene<dim>::set_initial_conditions(const Parameters &parameters)
  {
    for (const Section &section :
         named_sections(parameters, "Initial conditions", "Initial condition"))
    {
      const InitialCondition<dim> condition(section);
      unsigned long n_selected = 0;
      const auto set = [&]()
      {
        if (condition.velocity)
          for (unsigned int i = 0; i < partition->n_owned(); ++i)
          {
            const Point<dim> point = point_of<dim>(state.initial_position.node(i));
            if (condition.where && !(*condition.where)(point))
              continue;
            ++n_selected;
            for (unsigned int d = 0; d < dim; ++d)
              state.unsmoothed_velocity.node(i)[d] = condition.velocity->value(point, 0., d);
          }
        if (condition.stress)
          for (Part<dim> &part : parts)
          {
            const auto &points = part.formulation->initial_point_positions();
            for (unsigned int i = 0; i < points.size(); ++i)
            {
              if (condition.where && !(*condition.where)(points[i]))
                continue;
              ++n_selected;
              for (unsigned int c = 0; c < 6; ++c)
                part.formulation->points().component(MaterialPoints::stress, c)[i] =
                    condition.stress->value(points[i], 0., c);
            }
          }
      };
      // An expression can be without a value where only one rank looks.
      std::string failure;
      try
      {
        set();
      }
      catch (const std::runtime_error &error)
      {
        failure = error.what();
      }
      throw_together<InputError>(failure, communicator);
      if (Utilities::MPI::sum(n_selected, communicator) == 0)
        section.fail("Where", "the initial condition selects nothing; it would do nothing.");
    }
    conditions->prescribe_initial_velocity(state, 0.);
    throw_together<InputError>(conditions->failure(), communicator);
    state.unsmoothed_velocity.update_ghosts();
  }

  template <int dim>
  typename Scene<dim>::Counts Scene<dim>::counts() const
  {
    Counts counts;
    std::vector<std::uint8_t> is_particle(partition->n_owned(), 0);
    for (const Part<dim> &part : parts)
    {
      counts.cells += part.formulation->n_cells();
      if (part.particles != nullptr)
        for (const unsigned int node : part.particles->shape_functions().particle_node)
          is_particle[node] = 1;
    }
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
    {
      const bool is_element_node = *element_mass.node(i) > 0.;
      counts.particles += is_particle[i];
      counts.element_nodes += is_element_node ? 1 : 0;
      counts.shared_nodes += (is_element_node && is_particle[i] != 0) ? 1 : 0;
    }
    counts.nodes = partition->n_global();
    for (unsigned long *count :
         {&counts.cells, &counts.particles, &counts.element_nodes, &counts.shared_nodes})
      *count = Utilities::MPI::sum(*count, communicator);
    return counts;
  }

  template <int dim>
  bool Scene<dim>::has_particles() const
  {
    return bridge->has_particles();
  }

  template class Scene<2>;
  template class Scene<3>;
} // namespace tombolo
