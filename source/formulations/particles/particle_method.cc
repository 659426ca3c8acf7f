// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_method.h>

#include <tombolo/approximation/row_deformation.h>
#include <tombolo/formulations/particles/cell_dilatation.h>
#include <tombolo/formulations/particles/zero_energy_control.h>
#include <tombolo/formulations/step_cost.h>
#include <tombolo/mesh/image_conditions.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tombolo
{
  namespace
  {
    // Measured, for each neighbour [ns].
    constexpr double per_neighbour = 4.;       // deformation and force
    constexpr double per_smoothing = 4.;       // velocity and motion with Φ
    constexpr double per_sharpening = 4.;      // Φ again, for γ
    constexpr double per_affine_term = 2.5;    // velocity gradient and moments
    constexpr double own_rows = 1.25;          // where rows are not shared by particles
    constexpr double per_shape_function = 18.; // neighbours and shape functions built anew
  }                                            // namespace

  template <int dim>
  StepCost ParticleMethod<dim>::step_cost(const Material &material, const double box_ratio) const
  {
    // Neighbours on a lattice along the axes, where a support reaches over `dilation` spacings to
    // both sides; supports around a lattice that is turned or skewed hold as many more as the box
    // around a cell is larger.
    const double n_neighbours = box_ratio * std::pow(2. * std::ceil(rows->dilation()) - 1., dim);
    double cost = per_neighbour;
    if (smoothing_settings.is_active)
      cost += per_smoothing + (smoothing_settings.affine        ? per_affine_term
                               : smoothing_settings.gamma != 0. ? per_sharpening
                                                                : 0.);
    if (!kernel.is_total_lagrangian())
      cost *= own_rows;
    if (kernel.is_current())
      cost += per_shape_function;
    return {0., StepCosts::per_node + n_neighbours * cost + material.cost_per_point()};
  }

  template <int dim>
  void ParticleMethod<dim>::declare_shared_parameters(const Entries &e,
                                                      const std::string &default_configuration)
  {
    ParticleRows<dim>::declare_parameters(e);
    declare<KernelConfiguration<dim>>(e, default_configuration);
    declare<BulkViscosity>(e);
    declare<BondCheck<dim>>(e);
    SelfContact<dim>::create(e);
  }

  template <int dim>
  ParticleMethod<dim>::ParticleMethod(const Section &of_part,
                                      std::unique_ptr<ParticleRows<dim>> of_method,
                                      const StrainMeasure measure)
      : section(of_part), rows(std::move(of_method)),
        bonds(of_part, set, kernel, *rows, part_points)
  {
    part_points = PartPoints(BulkViscosity(of_part), measure);
    smoothing_settings.is_active = false;
    self_contact = SelfContact<dim>::create(section);
    kernel = KernelConfiguration<dim>(section);
  }

  template <int dim>
  void ParticleMethod<dim>::collect(const CellSelection<dim> &is_taken,
                                    const NodalVector *const volumes)
  {
    rows->reset(this->collect_particles(setup, rows->dilation(), is_taken, volumes));
    if (!rows->choose_supports(setup, is_taken, set))
      return;
    if (section.get_double("Support stretch limit") > 0.)
      section.fail("Support stretch limit", "smoothed particles keep their supports.");
    kernel.fix_supports(set);
  }

  template <int dim>
  void ParticleMethod<dim>::create_points()
  {
    std::vector<FieldDescription> further = bonds.variables();
    if (self_contact)
      for (const FieldDescription &field : self_contact->variables())
        further.push_back(field);
    if (this->control != nullptr)
      for (const FieldDescription &field : this->control->variables())
        further.push_back(field);
    NodalParticles<dim>::create_points(further);
    if (this->control != nullptr)
      this->control->initialize(this->points());
  }

  template <int dim>
  void ParticleMethod<dim>::check_setup() const
  {
    if (!setup.has_mechanics && bonds.is_on())
      section.fail("Bond failure", "the scene has heat alone, and no stresses that could break "
                                   "a bond");
    if (!setup.has_mechanics && self_contact)
      section.fail("Self-contact", "the scene has heat alone, and nothing that moves");
    if (self_contact && setup.heat == nullptr)
      RubbingLaw::refuse_without_heat(section);
    refuse_images_of_images<dim>(section, rows->support_entry(), *setup.nodes->images(),
                                 set.initial_positions(), set.initial_supports(),
                                 setup.communicator);
  }

  template <int dim>
  void ParticleMethod<dim>::initialize(const PartSetup<dim> &of_part)
  {
    setup = of_part;

    const unsigned int index = setup.source.value_or(setup.index);
    collect([&](const typename Nodes<dim>::Cell &cell)
            { return setup.part_cells->part_of(cell) == index; });
    if (rows->choose_functions(setup, set))
    {
      fibres = find_surface_fibres<dim>(setup);
      kernel.reset(set);
    }
    check_setup();
    part_points.initialize(setup.material, setup.heat, setup.has_mechanics);
    this->dilatation = rows->dilatation_of_cells();
    if (this->dilatation != nullptr)
      this->dilatation->set_material(*setup.material);
    this->control = rows->zero_energy_control();
    if (this->control != nullptr)
      this->control->set_material(*setup.material);
    if (this->control != nullptr && !this->control->is_on())
      this->control = nullptr;
    rows->set_images(setup.nodes->images());
    if (self_contact)
      self_contact->set_images(setup.nodes->images());
    const Images &images = *setup.nodes->images();
    rows->set_bodies(*setup.bodies, PlanesOfBodies(*setup.bodies, images, setup.communicator),
                     !images.empty());
    if (setup.source)
    {
      // Whether the supports would do is known before the first cell becomes particles.
      find_neighbours(set.padded_initial_positions());
      smallest_spacing_at_start = set.smallest_spacing();
      collect([](const typename Nodes<dim>::Cell &) { return false; });
    }
    create_points();
    find_neighbours(set.padded_initial_positions());
    bonds.initialize();
    if (!setup.source)
      smallest_spacing_at_start = set.smallest_spacing();
    if (tell_self_contact() > 1 && !kernel.is_total_lagrangian())
      section.fail("Self-contact", "the part has several bodies, and with a kernel that is renewed "
                                   "those that come near each other grow together; choose `total "
                                   "Lagrangian` as `Configuration`");
  }

  template <int dim>
  unsigned long ParticleMethod<dim>::tell_self_contact()
  {
    if (!self_contact)
      return 0;
    const Material &material = this->material();
    std::vector<double> inertia, copies;
    for (const double mass : rows->stencils().mass)
      inertia.push_back(mass * material.relative_inertia());
    for (unsigned int i = 0; i < inertia.size(); ++i)
      copies.push_back(set.copies_in_whole_body(i));
    self_contact->set_particles(
        {set.nodes(), set.persistent_ids(), set.initial_volumes(), inertia, copies},
        material.longitudinal_wave_speed() / smallest_spacing_at_start, setup.communicator);
    const auto partition = rows->partition(set);
    set_partition(*partition);
    return self_contact->set_start(setup.source.has_value(), rows->stencils(), *partition);
  }

  template <int dim>
  IndexSet ParticleMethod<dim>::required_nodes() const
  {
    IndexSet nodes = rows->required_nodes(set);
    for (const SurfaceFibre &fibre : fibres)
      nodes.add_indices(fibre.node.begin(), fibre.node.end());
    nodes.compress();
    return nodes;
  }

  template <int dim>
  void ParticleMethod<dim>::set_partition(const NodePartition &partition)
  {
    rows->set_partition(partition);
    if (smoothing_settings.affine)
      rows->store_reference(set, kernel, partition.shared_from_this());
  }

  template <int dim>
  void ParticleMethod<dim>::find_neighbours(const std::vector<double> &positions)
  {
    bonds.prepare_search();
    rows->search(set, positions, kernel.supports());
    bonds.finish_search();
    rows->compute_at_search();
  }

  template <int dim>
  NeighbourhoodChange ParticleMethod<dim>::update_neighbourhoods(const NodalVector &position)
  {
    const NeighbourhoodChange of_rows = update_rows(position);
    if (self_contact)
      self_contact->set_rows(of_rows != NeighbourhoodChange::none, bonds.any());
    return of_rows;
  }

  template <int dim>
  NeighbourhoodChange ParticleMethod<dim>::update_rows(const NodalVector &position)
  {
    rows->finish_start();
    const bool has_broken = bonds.update(position);
    if (!kernel.is_renewal_due(position, set, rows->stencils()))
      return has_broken ? NeighbourhoodChange::values : NeighbourhoodChange::none;
    bonds.prepare_change();
    kernel.renew(position, set, rows->stencils());
    tell_volumes();
    kernel.set_positions(position, rows->stencils());
    if (rows->neighbourhoods().candidates_hold(kernel.positions(), kernel.supports(),
                                               setup.communicator))
    {
      rows->compute_at(position, kernel.supports());
      if (smoothing_settings.affine)
        rows->store_reference(set, kernel, position.partition());
      rows->note_present();
      bonds.release_debris();
      bonds.isolate_distorted(position);
      return NeighbourhoodChange::values;
    }
    find_neighbours(kernel.positions());
    rows->note_present();
    bonds.release_debris();
    bonds.isolate_distorted_in_reference();
    return NeighbourhoodChange::neighbours;
  }

  template <int dim>
  void ParticleMethod<dim>::tell_volumes()
  {
    if (!rows->depend_on_volumes())
      return;
    rows->set_present_volumes(this->points().size() > 0
                                  ? this->points().component(MaterialPoints::volume, 0)
                                  : set.initial_volumes().data());
  }

  template <int dim>
  void ParticleMethod<dim>::add_particles(const CellSelection<dim> &is_taken,
                                          const NodalVector &position,
                                          const StateTransfer *const state,
                                          const NodalVector *const volumes)
  {
    rows->finish_start();
    const bool renews = !kernel.is_total_lagrangian() && state != nullptr;
    bonds.prepare_search();
    if (renews)
      kernel.renew(position, set, rows->stencils());
    const ParticleSet<dim> old_set = set;
    const std::vector<Tensor<2, dim>> old_deformation = kernel.deformation();
    const MaterialPoints old_points = this->points();

    collect(is_taken, volumes);
    std::vector<unsigned int> old_index, own_nodes;
    std::vector<bool> gains;
    for (const types::global_dof_index node : set.nodes())
    {
      const auto found = std::lower_bound(old_set.nodes().begin(), old_set.nodes().end(), node);
      const bool is_old = found != old_set.nodes().end() && *found == node;
      old_index.push_back(is_old ? static_cast<unsigned int>(found - old_set.nodes().begin())
                                 : numbers::invalid_unsigned_int);
      // Local numbers of owned nodes are their indices among them.
      own_nodes.push_back(static_cast<unsigned int>(set.owned_nodes().index_within_set(node)));
      gains.push_back(state != nullptr && *state->volume.node(own_nodes.back()) > 0.);
    }
    kernel.keep_deformation(old_deformation, old_index);
    create_points();
    if (state != nullptr)
      state->merge(part_points, own_nodes, set.initial_volumes(), old_points,
                   old_set.initial_volumes(), old_index);
    bonds.add_particles(old_index, gains);
    if (renews)
      renew_reference(position, old_index);
    tell_volumes();
    rows->search(set, renews ? kernel.positions() : set.padded_initial_positions(),
                 kernel.supports());
    bonds.finish_search();
    rows->compute_at_search();
    if (!renews)
      bonds.measure_rows(rows->stencils());
    bonds.release_debris();
    tell_self_contact();
  }

  template <int dim>
  void ParticleMethod<dim>::renew_reference(const NodalVector &position,
                                            const std::vector<unsigned int> &old_index)
  {
    // New particles have come from the initial configuration with the rows that they have there.
    Neighbourhoods<dim> at_start;
    at_start.set_images(setup.nodes->images());
    Stencils initial;
    at_start.search(set.nodes(), set.padded_initial_positions(), set.initial_supports(),
                    setup.communicator, initial);
    IndexSet required(set.owned_nodes().size());
    required.add_indices(at_start.global_nodes().begin(), at_start.global_nodes().end());
    const auto partition = set.partition(required, at_start.images());
    rows->separate_bodies(partition, at_start, initial);
    bonds.remove_unbonded(partition, at_start, initial);
    rows->fill(at_start, at_start.position_at_search().data(), at_start.support_at_search().data(),
               initial);
    bonds.measure_rows(initial);

    at_start.set_partition(*partition, initial);
    kernel.set_positions(position, initial); // owned nodes have the same numbers in all partitions
    const std::vector<unsigned int> &particles = initial.particle_node;
    const NodalVector present =
        nodal_field(partition, Quantity::position, particles,
                    [&](const std::size_t i, double *const place)
                    { std::copy_n(position.node(particles[i]), node_stride, place); });
    for (unsigned int i = 0; i < initial.n_particles(); ++i)
      if (old_index[i] == numbers::invalid_unsigned_int && !initial.is_undeformed(i))
      {
        const Tensor<2, dim> deformation = row_deformation<dim>(initial, i, present);
        if (determinant(deformation) > 0.)
          kernel.set_deformation(i, deformation);
      }
    kernel.stretch_supports(set);
  }

  template <int dim>
  void ParticleMethod<dim>::list(Records &records)
  {
    kernel.list(records);
    rows->list(records);
    bonds.list(records);
    if (self_contact)
      self_contact->list(records.group("self-contact"));
    records.archived(
        [this](StateArchive &archive)
        {
          bool is_renewed = kernel.is_renewed(setup.communicator);
          archive("is rebuilt", is_renewed);
          if (!is_renewed)
            return;
          // Rows are not stored: the same search and the same renewal at the same positions give
          // them bit by bit, in the same order.
          std::vector<double> position, support;
          rows->serialize_search(archive, position, support);
          kernel.serialize_reference(archive);
          if (archive.is_reading())
            rows->search(set, position, support);
        });
  }

  template <int dim>
  void ParticleMethod<dim>::complete_reading(NodalVector &position)
  {
    // Whoever looked at the model since it was built may have left one of its initial positions.
    rows->stencils().inverse_deformation_is_current = false;
    const bool has_broken = bonds.complete_reading(position.partition());
    if (kernel.is_renewed(setup.communicator) || has_broken)
    {
      tell_volumes();
      rows->compute_in_reference(set, kernel, position);
    }
    if (smoothing_settings.affine)
      rows->store_reference(set, kernel, position.partition());
    rows->complete_reading();
  }

  template <int dim>
  EnergyAccounts ParticleMethod<dim>::energies() const
  {
    EnergyAccounts result = part_points.energies();
    if (this->dilatation != nullptr)
      result.add("elastic energy", EnergyKind::stored, this->dilatation->energy());
    if (this->control != nullptr)
      this->control->account(this->points(), result);
    if (bonds.is_on())
      result.add("failure dissipation", EnergyKind::dissipated, bonds.dissipated_energy());
    if (self_contact)
      self_contact->account(result);
    return result;
  }

  template class ParticleMethod<2>;
  template class ParticleMethod<3>;
} // namespace tombolo
