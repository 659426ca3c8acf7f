// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/model.h>

#include <tombolo/base/throw_on_all_ranks.h>
#include <tombolo/mesh/mesh_source.h>
#include <tombolo/mesh/partition_weights.h>
#include <tombolo/mesh/symmetry_planes.h>
#include <tombolo/model/model_input.h>
#include <tombolo/model/scaling_settings.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
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
    degree = find_degree(part_sections);
    create_mesh(parameters, part_sections);

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
    const bool trace = parameters.section("Coupling").get("Bridge") == "trace";
    const ScalingSettings scaling(parameters.section("Scaling"));
    has_scaled_inertia = scaling.is_active();
    inertia_factor = scaling.inertia_factor();
    const SmoothingSettings smoothing =
        initialize_parts(part_sections, physics.has_heat, trace, scaling.is_selective());
    if (has_mechanics)
    {
      bridge = std::make_unique<Bridge>(dim, smoothing, trace);
      bridge->set_smoothed_parts(smoothed_parts(parts));
    }
    if (physics.has_heat)
      heat = std::make_unique<ThermalModel<dim>>(thermal_sections, parameters.section("Heat"), mesh,
                                                 *nodes, parts, state.initial_position, smoothing,
                                                 trace);
    set_partition();
    state.reinit(partition, has_mechanics, smoothing.is_active && smoothing.affine);
    set_initial_positions();
    renew_masses();
    if (heat)
      heat->set_initial_temperature();
    set_initial_conditions(parameters);
    for (const ProcessKind<dim> *const kind : ProcessKinds<dim>::instance().all())
      for (auto &process : kind->create(parameters, *this))
        processes.push_back(std::move(process));
    notify_processes();
  }

  template <int dim>
  unsigned int Model<dim>::find_degree(const std::vector<Section> &part_sections) const
  {
    unsigned int result = 1;
    for (unsigned int p = 0; p < parts.size(); ++p)
    {
      const unsigned int wanted = parts[p].formulation->degree();
      if (wanted == 0 || wanted == result)
        continue;
      for (unsigned int q = 0; q < p; ++q)
        if (parts[q].formulation->degree() != 0)
          part_sections[p].fail("Formulation", "the part has nodes of degree " +
                                                   std::to_string(wanted) + ", but part \"" +
                                                   parts[q].name + "\" has degree " +
                                                   std::to_string(result) +
                                                   "; the parts of a scene share their nodes.");
      result = wanted;
    }
    return result;
  }

  template <int dim>
  void Model<dim>::create_mesh(const Parameters &parameters,
                               const std::vector<Section> &part_sections)
  {
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
  }

  template <int dim>
  SmoothingSettings Model<dim>::initialize_parts(const std::vector<Section> &part_sections,
                                                 const bool has_heat, const bool trace,
                                                 const bool scales_single_cells)
  {
    SmoothingSettings smoothing;
    const Part<dim> *first_smoothed = nullptr;
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
      setup.scales_inertia = scales_single_cells;
      setup.prescribed_nodes = conditions->prescribed_nodes();
      part.formulation->initialize(setup);
      if (part.particles == nullptr)
        continue;
      const SmoothingSettings of_part = part.particles->smoothing();
      if (first_smoothed == nullptr)
        smoothing = of_part;
      else if (of_part.is_active && !(smoothing == of_part))
        part_sections[p].fail("Formulation",
                              "the particles of all parts of a scene are smoothed alike, since one "
                              "operator smooths them all, or not at all, "
                              "but those of part \"" +
                                  first_smoothed->name + "\" differ");
      if (first_smoothed == nullptr && of_part.is_active)
        first_smoothed = &part;
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
    if (state.unsmoothed_position.partition() != nullptr)
      state.unsmoothed_position.copy_from(state.initial_position);
  }

  template <int dim>
  std::vector<ParticleFormulation<dim> *> Model<dim>::particle_parts() const
  {
    std::vector<ParticleFormulation<dim> *> result;
    for (const Part<dim> &part : parts)
      if (part.particles != nullptr)
        result.push_back(part.particles);
    return result;
  }

  template <int dim>
  std::vector<Stencils *> Model<dim>::stencils_of_parts() const
  {
    std::vector<Stencils *> result;
    for (ParticleFormulation<dim> *const particles : particle_parts())
      result.push_back(&particles->stencils());
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
  }

  template <int dim>
  void Model<dim>::renew_partition()
  {
    set_partition();
    state.move_to(partition);
    renew_masses();
  }

  template <int dim>
  void Model<dim>::renew_masses()
  {
    set_element_mass();
    if (heat)
      heat->set_partition(partition);
    if (has_mechanics)
      set_inertia();
    notify_processes();
    settle_rows();
  }

  template <int dim>
  void Model<dim>::renew_inertia()
  {
    set_element_mass();
    set_inertia();
    notify_processes();
    settle_rows();
  }

  template <int dim>
  void Model<dim>::notify_processes()
  {
    for (const auto &process : processes)
      process->model_changed(*this);
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
      {
        part.formulation->add_mass(element_mass);
        part.formulation->add_extra_mass(element_mass);
      }
    element_mass.add_to_owners();
    if (!is_scaled())
      return;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      *element_mass.node(i) *= inertia_factor;
    true_mass.reinit(partition, 1);
    for (const Part<dim> &part : parts)
      part.formulation->add_mass(true_mass);
    true_mass.add_to_owners();
  }

  template <int dim>
  void Model<dim>::set_inertia()
  {
    const std::vector<Stencils *> stencils = stencils_of_parts();
    bridge->reinit(partition, stencils, element_mass, conditions->constrained_components(),
                   is_scaled() ? std::vector<double>(stencils.size(), inertia_factor)
                               : std::vector<double>(),
                   row_inertia);
    state.mass.copy_from(bridge->mass());
  }

  template <int dim>
  void Model<dim>::begin_change()
  {
    bridge->smooth_velocity(state);
    for (const auto &process : processes)
      process->prepare_change(*this);
  }

  template <int dim>
  void
  Model<dim>::remove_faces(const std::vector<std::vector<types::global_dof_index>> &nodes_of_cells)
  {
    conditions->remove_faces(nodes_of_cells);
    conditions->set_partition(*partition);
    if (heat)
      heat->conditions.remove_faces(nodes_of_cells); // their partition is set with the masses
  }

  template <int dim>
  ModelChange Model<dim>::update_stencils()
  {
    NeighbourhoodChange found = NeighbourhoodChange::none;
    bool needs_ghosts = false;
    for (const Part<dim> &part : parts)
    {
      const NeighbourhoodChange of_part = part.formulation->update_neighbourhoods(state.position);
      needs_ghosts = needs_ghosts || of_part == NeighbourhoodChange::ghosts;
      found = std::max(found, of_part);
    }
    if (needs_ghosts && found == NeighbourhoodChange::values)
      found = NeighbourhoodChange::neighbours;
    ModelChange change;
    if (found == NeighbourhoodChange::none)
      return change;
    if (found == NeighbourhoodChange::ghosts)
    {
      renew_partition();
      return change;
    }
    change.stencils = true;
    ++revisions.stencils;
    if (after_renewal_of_rows)
      after_renewal_of_rows();
    if (found == NeighbourhoodChange::values)
    {
      // In the order of renew_masses(), which a resumed run does instead: each can change rows.
      if (heat)
        heat->update_shape_functions();
      bridge->update_nodal_mass();
      settle_rows();
      return change;
    }
    renew_partition();
    return change;
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
    double interval = std::numeric_limits<double>::max();
    for (const Part<dim> &part : parts)
      interval = std::min(interval, part.formulation->courant_limit(state.position).time_step);
    interval = Utilities::MPI::min(interval, communicator);
    conditions->prescribe_initial_velocity(state, 0., 1e-3 * interval);
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
      for (const unsigned int node : part.formulation->particle_nodes())
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
  bool Model<dim>::has_particles() const
  {
    return !particle_parts().empty();
  }

  template <int dim>
  bool Model<dim>::is_scaled() const
  {
    return has_scaled_inertia;
  }

  template <int dim>
  bool Model<dim>::has_heat_sources() const
  {
    return heat != nullptr && (heat->has_plastic_heat() ||
                               std::any_of(processes.begin(), processes.end(),
                                           [](const auto &process) { return process->heats(); }));
  }

  template class Model<2>;
  template class Model<3>;
} // namespace tombolo
