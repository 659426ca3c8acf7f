// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/model.h>

#include <tombolo/mesh/image_conditions.h>
#include <tombolo/model/hanging_nodes.h>
#include <tombolo/model/initial_condition.h>
#include <tombolo/model/model_input.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <utility>

namespace tombolo
{
  namespace
  {
    /** Sets the equal parts, and those of another material, of a part whose section is one of
     * @p part_sections. */
    template <int dim>
    void find_equal_parts(const std::vector<Section> &part_sections, PartSetup<dim> &setup)
    {
      const Section &section = part_sections[setup.index];
      const std::string formulation = section.get("Formulation");
      for (unsigned int p = 0; p < part_sections.size(); ++p)
        if (const Section &other = part_sections[p];
            p != setup.index && other.get("Formulation") == formulation &&
            section.subsection(formulation).is_equal_to(other.subsection(formulation)))
          (other.get("Material") == section.get("Material") ? setup.equal_parts
                                                            : setup.parts_of_other_material)
              .push_back(p);
    }
  } // namespace

  template <int dim>
  Model<dim>::Model(const Parameters &parameters, MPI_Comm communicator,
                    const MeshChange &change_mesh)
      : communicator(communicator), mesh(communicator), parts(create_parts<dim>(parameters))
  {
    const std::vector<Section> part_sections = named_sections(parameters, "Parts", "Part");
    degree = common_degree(parts, part_sections);
    create_mesh(parameters, part_sections, change_mesh);

    std::vector<Section> mechanical_sections, thermal_sections;
    for (const Section &section : named_sections(parameters, "Conditions", "Condition"))
      if (!makes_images(section))
        (is_thermal(section) ? thermal_sections : mechanical_sections).push_back(section);
    nodes->set_images(find_images(parameters, mesh, *nodes));
    conditions = std::make_unique<MechanicalConditions<dim>>(mechanical_sections, mesh, *nodes);

    const Physics<dim> physics(parts, part_sections);
    has_mechanics = physics.has_mechanics;
    const bool trace = parameters.section("Coupling").get("Bridge") == "trace";
    inertia_is_mass =
        std::all_of(parts.begin(), parts.end(),
                    [](const Part<dim> &part) { return part.material->relative_inertia() == 1.; });
    const SmoothingSettings smoothing = initialize_parts(part_sections, physics.has_heat, trace);
    if (has_mechanics)
    {
      bridge = std::make_unique<Bridge>(smoothing, trace);
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
    set_initial_conditions(parameters, *this);
    for (const ProcessKind<dim> *const kind : ProcessKinds<dim>::instance().all())
      for (auto &process : kind->create(parameters, *this))
        processes.push_back(std::move(process));
    for (ParticleFormulation<dim> *const particles : particle_parts())
      if (has_mechanics)
        particles->set_before_change(
            [this]
            {
              // Once a step, before the first part changes: S is then that of all rows before.
              if (!std::exchange(change_has_begun, true))
                begin_change();
              signals.rows_change();
            });
    notify_processes();
  }

  template <int dim>
  void Model<dim>::create_mesh(const Parameters &parameters,
                               const std::vector<Section> &part_sections,
                               const MeshChange &change_mesh)
  {
    read_mesh(parameters.section("Mesh"), mesh, communicator);
    if (change_mesh)
      change_mesh(mesh);
    part_cells = std::make_unique<PartCells<dim>>(part_sections, mesh);
    part_cells->check(mesh.triangulation);
    refuse_unfit_gradings(mesh, *part_cells, parts, part_sections);
    std::vector<std::function<StepCost(double)>> costs;
    for (const Part<dim> &part : parts)
      costs.push_back([&part](const double box_ratio)
                      { return part.formulation->step_cost(*part.material, box_ratio); });
    balance(mesh, *part_cells, costs);
    nodes = std::make_unique<Nodes<dim>>(mesh, degree);
    nodes->set_dependent_nodes(find_hanging_nodes(*nodes, *part_cells, parts));
  }

  template <int dim>
  SmoothingSettings Model<dim>::initialize_parts(const std::vector<Section> &part_sections,
                                                 const bool has_heat, const bool trace)
  {
    SmoothingSettings smoothing;
    const Part<dim> *first_smoothed = nullptr;
    if (!particle_parts().empty())
      bodies = std::make_unique<Bodies<dim>>(*nodes);
    const bool cells_can_leave = std::any_of(
        parts.begin(), parts.end(),
        [](const Part<dim> &part) { return part.source || part.formulation->can_lose_cells(); });
    for (unsigned int p = 0; p < parts.size(); ++p)
    {
      Part<dim> &part = parts[p];
      PartSetup<dim> setup;
      setup.name = part.name;
      setup.index = p;
      setup.nodes = nodes.get();
      setup.part_cells = part_cells.get();
      setup.bodies = bodies.get();
      setup.material = part.material;
      setup.communicator = communicator;
      setup.heat = has_heat ? part.heat : nullptr;
      setup.has_mechanics = has_mechanics;
      setup.source = part.source;
      setup.trace_bridge = trace;
      setup.cells_can_leave = cells_can_leave;
      find_equal_parts(part_sections, setup);
      setup.prescribed_nodes = conditions->prescribed_nodes();
      part.formulation->initialize(setup);
      if (part.particles == nullptr)
        continue;
      const SmoothingSettings part_smoothing = part.particles->smoothing();
      if (first_smoothed == nullptr)
        smoothing = part_smoothing;
      else if (part_smoothing.is_active && !(smoothing == part_smoothing))
        part_sections[p].fail(
            "Formulation", "the particles of all parts of a scene are smoothed alike (`Smoothing`, "
                           "`Smallest smoothed mass`), since one operator smooths them all, or "
                           "not at all (`none`), but those of part \"" +
                               first_smoothed->name + "\" differ");
      if (first_smoothed == nullptr && part_smoothing.is_active)
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
  void Model<dim>::set_partition()
  {
    IndexSet required = nodes->relevant();
    std::vector<ImageNode> images;
    for (const Part<dim> &part : parts)
    {
      required.add_indices(part.formulation->required_nodes());
      const std::vector<ImageNode> part_images = part.formulation->required_image_nodes();
      images.insert(images.end(), part_images.begin(), part_images.end());
    }
    required.add_indices(conditions->required_nodes());
    if (heat)
      required.add_indices(heat->required_nodes());
    const auto next = partition_of(*nodes, required, images);
    if (partition != nullptr)
      next->continue_counting(*partition);
    partition = next;
    for (const Part<dim> &part : parts)
      part.formulation->set_partition(*partition);
    conditions->set_partition(*partition);
  }

  template <int dim>
  void Model<dim>::renew_masses()
  {
    if (heat)
      heat->set_partition(partition);
    renew_inertia();
  }

  template <int dim>
  void Model<dim>::renew_inertia()
  {
    set_element_mass();
    if (has_mechanics)
      set_inertia();
    notify_processes();
    match_rows();
  }

  template <int dim>
  void Model<dim>::parts_were_read()
  {
    for (const auto &process : processes)
      process->structure.complete();
    set_partition();
    state.move_to(partition);
    for (const Part<dim> &part : parts)
      part.formulation->complete_reading(state.position); // read afterwards
    renew_masses();
  }

  template <int dim>
  void Model<dim>::notify_processes()
  {
    for (const auto &process : processes)
    {
      process->actions.set_partition(partition);
      process->model_changed(*this);
    }
  }

  template <int dim>
  void Model<dim>::match_rows()
  {
    if (!has_mechanics || !heat)
      return;
    const auto has_changed = [&] // evaluates both
    { return std::max(bridge->extract_change_of_rows(), heat->bridge.extract_change_of_rows()); };
    while (has_changed())
    {
      bridge->update_nodal_mass();
      heat->update_shape_functions();
    }
  }

  template <int dim>
  void Model<dim>::set_element_mass()
  {
    element_mass.reinit(partition, Quantity::scalar);
    NodalVector part_mass;
    for (const Part<dim> &part : parts)
    {
      if (part.particles != nullptr)
        continue;
      if (inertia_is_mass)
      {
        part.formulation->add_mass(element_mass);
        continue;
      }
      part_mass.reinit(partition, Quantity::scalar);
      part.formulation->add_mass(part_mass);
      if (!part.inertia.empty())
        part.formulation->add_extra_mass(part.inertia, part_mass);
      for (unsigned int i = 0; i < partition->n_local(); ++i)
        *element_mass.node(i) += part.material->relative_inertia() * *part_mass.node(i);
    }
    element_mass.collect();
    if (inertia_is_mass)
      return;
    mass_of_bodies.reinit(partition, Quantity::scalar);
    for (const Part<dim> &part : parts)
      part.formulation->add_mass(mass_of_bodies);
    mass_of_bodies.collect();
  }

  template <int dim>
  void Model<dim>::set_inertia()
  {
    std::vector<Stencils *> stencils;
    std::vector<double> weights;
    std::vector<std::vector<double>> row_weights;
    for (const Part<dim> &part : parts)
      if (part.particles != nullptr)
      {
        stencils.push_back(&part.particles->stencils());
        weights.push_back(part.material->relative_inertia());
        row_weights.push_back(part.inertia);
      }
    bridge->reinit(partition, {stencils, element_mass, conditions->constrained_components(),
                               weights, row_weights});
    state.mass.copy_from(bridge->mass_split().loaded_mass());
  }

  template <int dim>
  void Model<dim>::begin_change()
  {
    bridge->smooth_velocity(state);
    signals.change();
    for (const auto &process : processes)
      process->actions.begin_change(state.velocity);
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
    change_has_begun = false;
    for (const Part<dim> &part : parts)
      found = std::max(found, part.formulation->update_neighbourhoods(state.position));
    ModelChange change;
    if (found == NeighbourhoodChange::none)
      return change;
    change.stencils = true;
    ++revisions.stencils;
    signals.rows_changed();
    if (found == NeighbourhoodChange::values)
    {
      // In the order of renew_masses(), which a resumed run does instead: each can change rows.
      // Without smoothing masses do not depend on rows.
      if (heat && heat->bridge.operators() != Bridge::Operators::identity)
        heat->update_shape_functions();
      if (bridge->operators() != Bridge::Operators::identity)
        bridge->update_nodal_mass();
      match_rows();
      return change;
    }
    renew_partition();
    return change;
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
  std::vector<std::uint64_t> Model<dim>::persistent_ids_of_points(const unsigned int part) const
  {
    std::vector<std::uint64_t> ids;
    if (parts[part].particles == nullptr)
      for (const auto &cell : cells_of_part(*nodes, *part_cells, part))
        ids.push_back(persistent_id(cell->id(), dim));
    else
      for (const unsigned int node : parts[part].formulation->particle_nodes())
        ids.push_back(nodes->persistent_ids()[node]);
    return ids;
  }

  template <int dim>
  bool Model<dim>::has_heat_sources() const
  {
    const auto has_sources = [](const auto &process) { return process->actions.has_heat(); };
    return heat != nullptr && (heat->has_plastic_heat() ||
                               std::any_of(processes.begin(), processes.end(), has_sources));
  }

  template class Model<2>;
  template class Model<3>;
} // namespace tombolo
