// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/model.h>

#include <tombolo/base/throw_on_all_ranks.h>
#include <tombolo/mesh/mesh_source.h>
#include <tombolo/mesh/partition_weights.h>
#include <tombolo/mesh/symmetry_planes.h>
#include <tombolo/model/model_input.h>

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
    template <int dim>
    Point<dim> point_of(const double *node)
    {
      Point<dim> point;
      for (unsigned int d = 0; d < dim; ++d)
        point[d] = node[d];
      return point;
    }

    /** Refuses vertices so far away that volumes would overflow. Collective. */
    template <int dim>
    void check_extent(const Mesh<dim> &mesh, const Section &section, MPI_Comm communicator)
    {
      constexpr double largest = 1e90;
      bool is_within = true;
      for (const Point<dim> &vertex : mesh.triangulation.get_vertices())
        for (unsigned int d = 0; d < dim; ++d)
          is_within = is_within && std::abs(vertex[d]) <= largest;
      if (Utilities::MPI::min(is_within ? 1 : 0, communicator) == 0)
        section.fail("Type", "the mesh has vertices that are not finite, or with coordinates above "
                             "1e90, beyond which volumes are not numbers any more.");
    }

  } // namespace

  template <int dim>
  Model<dim>::~Model() = default;

  template <int dim>
  Model<dim>::Model(const Parameters &parameters, MPI_Comm communicator)
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
    check_extent(mesh, parameters.section("Mesh"), communicator);
    part_cells = std::make_unique<PartCells<dim>>(part_sections, mesh);
    part_cells->check(mesh.triangulation);
    std::vector<std::function<double(double)>> work;
    for (const Part<dim> &part : parts)
      work.push_back([&part](const double box_ratio)
                     { return part.formulation->cost_per_cell(*part.material, box_ratio); });
    balance(mesh, *part_cells, work);
    nodes = std::make_unique<Nodes<dim>>(mesh, degree);

    const bool trace = parameters.section("Coupling").get("Bridge") == "trace";

    std::vector<Section> mechanical_sections, thermal_sections, symmetry_sections;
    for (const Section &section : named_sections(parameters, "Conditions", "Condition"))
      (is_symmetry(section)                          ? symmetry_sections
       : ThermalConditions<dim>::is_thermal(section) ? thermal_sections
                                                     : mechanical_sections)
          .push_back(section);
    symmetry = find_symmetry(symmetry_sections, mesh, *nodes);
    conditions = std::make_unique<MechanicalConditions<dim>>(mechanical_sections, mesh, *nodes);

    const Physics<dim> physics(parts, part_sections);
    has_mechanics = physics.has_mechanics;
    const ScalingSettings scaling_settings(parameters.section("Scaling"));
    if (scaling_settings.is_active())
      scaling = std::make_unique<MassScaling<dim>>(parameters.section("Scaling"), scaling_settings,
                                                   parts, communicator);
    const SmoothingSettings smoothing = initialize_parts(part_sections, physics.has_heat, trace);
    if (has_mechanics)
      bridge = std::make_unique<Bridge>(dim, smoothing, trace);
    if (physics.has_heat)
      heat = std::make_unique<ThermalModel<dim>>(thermal_sections, parameters.section("Heat"), mesh,
                                                 *nodes, parts, state.initial_position, smoothing,
                                                 trace);

    set_partition();
    state.reinit(partition, has_mechanics);
    set_initial_positions();
    if (scaling)
      scaling->start(state.position);
    set_masses();

    if (has_mechanics)
    {
      filter = filter_settings(parameters);
      set_filter_rate();
    }
    if (heat)
      heat->set_initial_temperature();

    set_initial_conditions(parameters);
    create_contacts(parameters);
    set_contact_buffers();
    if (loses_bonds())
      momentum_redistribution = std::make_unique<MomentumRedistribution<dim>>(*this);
  }

  template <int dim>
  void Model<dim>::set_filter_rate()
  {
    double rate = 0;
    for (const Part<dim> &part : parts)
      if (part.particles != nullptr)
        rate = std::max(rate, part.material->longitudinal_wave_speed() /
                                  part.particles->smallest_spacing());
    filter.rate = Utilities::MPI::max(rate, communicator);
  }

  template <int dim>
  SmoothingSettings Model<dim>::initialize_parts(const std::vector<Section> &part_sections,
                                                 const bool has_heat, const bool trace)
  {
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
      setup.heat = has_heat ? part.heat : nullptr;
      setup.has_mechanics = has_mechanics;
      setup.source = part.source;
      setup.trace_bridge = trace;
      setup.scales_inertia = scaling != nullptr && scaling->settings().is_selective();
      setup.prescribed_nodes = conditions->prescribed_nodes();
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
    return smoothing;
  }

  template <int dim>
  void Model<dim>::set_initial_positions()
  {
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
  }

  template <int dim>
  std::vector<Stencils *> Model<dim>::stencils() const
  {
    std::vector<Stencils *> result;
    for (const Part<dim> &part : parts)
      if (part.particles != nullptr)
        result.push_back(&part.particles->stencils());
    return result;
  }

  template <int dim>
  void Model<dim>::set_partition()
  {
    IndexSet required = nodes->relevant();
    std::vector<MirrorNode> images;
    for (const Part<dim> &part : parts)
    {
      required.add_indices(part.formulation->required_nodes());
      const std::vector<MirrorNode> of_part = part.formulation->required_images();
      images.insert(images.end(), of_part.begin(), of_part.end());
    }
    required.add_indices(conditions->required_nodes());
    if (heat)
      required.add_indices(heat->required_nodes());
    required.compress();
    const auto next =
        std::make_shared<NodePartition>(nodes->owned(), required, communicator, symmetry, images);
    if (partition != nullptr)
      next->continue_counting(*partition);
    partition = next;
    for (const Part<dim> &part : parts)
      part.formulation->set_partition(*partition);
    conditions->set_partition(*partition);
    for (const auto &contact : contacts)
      contact->set_partition(partition);
  }

  template <int dim>
  void Model<dim>::set_masses()
  {
    set_element_mass();
    if (heat)
      heat->set_partition(partition);
    if (has_mechanics)
      set_inertia();
    settle_rows();
  }

  template <int dim>
  void Model<dim>::settle_rows()
  {
    if (!has_mechanics || !heat)
      return;
    const auto has_changed = [&]()
    {
      const bool for_motion = bridge->take_change_of_rows();
      return heat->bridge.take_change_of_rows() || for_motion;
    };
    while (has_changed())
    {
      bridge->update_nodal_mass();
      heat->update_shape_functions();
    }
  }

  template <int dim>
  void Model<dim>::set_element_mass()
  {
    element_mass.reinit(partition, 1);
    for (const Part<dim> &part : parts)
      if (part.particles == nullptr)
        part.formulation->add_mass(element_mass);
    if (!scaling)
    {
      element_mass.add_to_owners();
      return;
    }
    scaling->complete_element_mass(element_mass);
    true_mass.reinit(partition, 1);
    for (const Part<dim> &part : parts)
      part.formulation->add_mass(true_mass);
    true_mass.add_to_owners();
  }

  template <int dim>
  void Model<dim>::set_inertia()
  {
    if (scaling)
      bridge->reinit(partition, stencils(), element_mass, conditions->constrained_components(),
                     scaling->particle_factors(), scaling->row_factors());
    else
      bridge->reinit(partition, stencils(), element_mass, conditions->constrained_components());
    state.mass.copy_from(bridge->mass());
    if (erodes())
      find_massless_nodes();
    if (conditions->has_loads())
    {
      bridge->set_loaded_nodes(conditions->loaded_nodes(state));
      loads.reinit(partition);
      load_force.reinit(partition);
    }
    set_contact_buffers();
  }

  template <int dim>
  bool Model<dim>::raise_masses(const unsigned long step)
  {
    if (!scaling || !scaling->is_due(step) || !scaling->raise(state.position))
      return false;
    set_element_mass();
    set_inertia();
    settle_rows();
    return true;
  }

  template <int dim>
  bool Model<dim>::update_neighbourhoods()
  {
    NeighbourhoodChange change = NeighbourhoodChange::none;
    bool needs_ghosts = false;
    for (const Part<dim> &part : parts)
    {
      const NeighbourhoodChange of_part = part.formulation->update_neighbourhoods(state.position);
      needs_ghosts = needs_ghosts || of_part == NeighbourhoodChange::ghosts;
      change = std::max(change, of_part);
    }
    if (needs_ghosts && change == NeighbourhoodChange::values)
      change = NeighbourhoodChange::neighbours;
    if (change == NeighbourhoodChange::none)
      return false;
    if (change == NeighbourhoodChange::ghosts)
    {
      renew_partition();
      return false;
    }
    if (momentum_redistribution)
      momentum_redistribution->complete();
    // Broken bonds make larger gradients at the same lengths.
    if (heat && loses_bonds())
      heat->limit_is_outdated = true;
    if (change == NeighbourhoodChange::values)
    {
      // In the order of set_masses(), which a resumed run does instead: each can change rows.
      if (heat)
        heat->update_shape_functions();
      bridge->update_nodal_mass();
      settle_rows();
      return true;
    }
    renew_partition();
    return true;
  }

  template <int dim>
  void Model<dim>::renew_partition()
  {
    set_partition();
    state.move_to(partition);
    set_masses();
  }

  template <int dim>
  void Model<dim>::set_initial_conditions(const Parameters &parameters)
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
        if (condition.temperature)
          for (unsigned int i = 0; i < partition->n_owned(); ++i)
          {
            const Point<dim> point = point_of<dim>(state.initial_position.node(i));
            if (condition.where && !(*condition.where)(point))
              continue;
            ++n_selected;
            const double temperature = condition.temperature->value(point, 0., 0);
            *heat->state.unsmoothed_temperature.node(i) = temperature;
            *heat->state.enthalpy.node(i) = heat->nodal_enthalpy.enthalpy(i, temperature);
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
      throw_on_all_ranks<InputError>(failure, communicator);
      if (Utilities::MPI::sum(n_selected, communicator) == 0)
        section.fail("Where", "the initial condition selects nothing; it would do nothing.");
    }
    if (!has_mechanics)
      return;
    conditions->prescribe_initial_velocity(state, 0.);
    throw_on_all_ranks<InputError>(conditions->failure(), communicator);
    state.unsmoothed_velocity.update_ghosts();
  }

  template <int dim>
  typename Model<dim>::Counts Model<dim>::counts() const
  {
    Counts counts;
    std::vector<std::uint8_t> is_particle(partition->n_owned(), 0);
    for (const Part<dim> &part : parts)
    {
      counts.cells += part.formulation->n_cells();
      if (part.particles != nullptr)
        for (const unsigned int node : part.particles->stencils().particle_node)
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
  bool Model<dim>::loses_bonds() const
  {
    return std::any_of(parts.begin(), parts.end(),
                       [](const Part<dim> &part) {
                         return part.particles != nullptr &&
                                !part.particles->bond_counts().criterion.empty();
                       });
  }

  template <int dim>
  bool Model<dim>::has_self_contact() const
  {
    return std::any_of(parts.begin(), parts.end(),
                       [](const Part<dim> &part) {
                         return part.particles != nullptr &&
                                part.particles->fragment_counts().has_contact;
                       });
  }

  template <int dim>
  bool Model<dim>::has_particles() const
  {
    return std::any_of(parts.begin(), parts.end(),
                       [](const Part<dim> &part) { return part.particles != nullptr; });
  }

  template <int dim>
  bool Model<dim>::has_contact_heat() const
  {
    return heat != nullptr && !contacts.empty();
  }

  template <int dim>
  bool Model<dim>::has_heat_sources() const
  {
    return heat != nullptr && (heat->has_plastic_heat() || has_contact_heat());
  }

  template class Model<2>;
  template class Model<3>;
} // namespace tombolo
