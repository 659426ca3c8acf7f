// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/row_deformation.h>
#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/formulations/particles/cell_dilatation.h>
#include <tombolo/formulations/particles/nodal_particles.h>
#include <tombolo/formulations/particles/particle_rows.h>
#include <tombolo/formulations/particles/self_contact.h>
#include <tombolo/formulations/particles/zero_energy_control.h>
#include <tombolo/formulations/step_cost.h>
#include <tombolo/mesh/image_conditions.h>
#include <tombolo/state/records.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Particles of one part on any rows (ParticleRows): what particle methods share, however φ and ∇φ
   * come about. Stress, strain and force are those of eqs (13), (5), (16) of Pan et al. 2019, with
   * gradients carried from the reference of the kernel to the present by the deformation since
   * then, F_I = Σ_J x_J ⊗ ∇φ_J. A derived class makes the rows and chooses the smoothing, or none.
   */
  template <int dim>
  class ParticleMethod : public NodalParticles<dim>
  {
  public:
    StepCost step_cost(const Material &material, const double box_ratio) const override
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
    void initialize(const PartSetup<dim> &part_setup) override
    {
      setup = part_setup;

      const unsigned int index = setup.source.value_or(setup.index);
      collect([&](const typename Nodes<dim>::Cell &cell)
              { return setup.part_cells->part_of(cell) == index; });
      if (self_contact)
        setup.end_at_own_cells();
      if (rows->choose_functions(setup, set))
      {
        fibres = find_surface_fibres();
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
      if (update_self_contact() > 1 && !kernel.is_total_lagrangian())
        section.fail("Self-contact",
                     "the part has several bodies, and with a kernel that is renewed "
                     "those that come near each other grow together; choose `total "
                     "Lagrangian` as `Configuration`");
    }
    dealii::IndexSet required_nodes() const override
    {
      dealii::IndexSet nodes = rows->required_nodes(set);
      std::vector<dealii::types::global_dof_index> fibre_nodes;
      for (const SurfaceFibre &fibre : fibres)
        fibre_nodes.insert(fibre_nodes.end(), fibre.node.begin(), fibre.node.end());
      nodes.add_indices(fibre_nodes.begin(), fibre_nodes.end());
      nodes.compress();
      return nodes;
    }
    std::vector<ImageNode> required_image_nodes() const override
    {
      return rows->required_image_nodes();
    }
    void set_partition(const NodePartition &partition) override
    {
      rows->set_partition(partition);
      if (smoothing_settings.affine)
        rows->store_reference(set, kernel, partition.shared_from_this());
    }
    EnergyAccounts energies() const override
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
    NeighbourhoodChange update_neighbourhoods(const NodalVector &position) override
    {
      const NeighbourhoodChange row_change = update_rows(position);
      if (self_contact)
        self_contact->set_rows(row_change != NeighbourhoodChange::none, bonds.any());
      return row_change;
    }
    void list(Records &records) override
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
            // Rows are not stored: the same search and the same renewal at the same positions
            // restore them bit by bit, in the same order.
            std::vector<double> position, support;
            rows->serialize_search(archive, position, support);
            kernel.serialize_reference(archive);
            if (archive.is_reading())
              rows->search(set, position, support);
          });
    }
    void complete_reading(NodalVector &position) override
    {
      // A use of the model since it was built may have left one of its initial positions.
      rows->stencils().inverse_deformation_is_current = false;
      const bool has_broken = bonds.complete_reading(position.partition());
      if (kernel.is_renewed(setup.communicator) || has_broken)
      {
        update_volumes();
        rows->compute_in_reference(set, kernel, position);
      }
      if (smoothing_settings.affine)
        rows->store_reference(set, kernel, position.partition());
      rows->complete_reading();
    }

    const Stencils &stencils() const override
    {
      return rows->stencils();
    }
    Stencils &stencils() override
    {
      return rows->stencils();
    }
    SmoothingSettings smoothing() const override
    {
      return smoothing_settings;
    }
    PatchTest patch_test(const NodalVector &position) const override
    {
      return rows->patch_test(setup, set, kernel, smoothing_settings.is_active, position);
    }
    std::string shape_functions() const override
    {
      return rows->functions();
    }
    const std::vector<SurfaceFibre> &surface_fibres() const override
    {
      return fibres;
    }
    Bonds<dim> *breaking_bonds() override
    {
      return bonds.is_on() ? &bonds : nullptr;
    }

    SelfContact<dim> *fragment_contact() override
    {
      return self_contact.get();
    }

    void add_particles(const CellSelection<dim> &is_taken, const NodalVector &position,
                       const StateTransfer *const state, const NodalVector *const volumes) override
    {
      rows->finish_start();
      const bool renews = !kernel.is_total_lagrangian() && state != nullptr;
      bonds.prepare_search();
      if (renews)
        kernel.renew(position, set, rows->stencils());
      const ParticleSet<dim> old_set = set;
      const std::vector<dealii::Tensor<2, dim>> old_deformation = kernel.deformation();
      const MaterialPoints old_points = this->points();

      collect(is_taken, volumes);
      std::vector<unsigned int> old_index, own_nodes;
      std::vector<bool> gains;
      for (const dealii::types::global_dof_index node : set.nodes())
      {
        const std::size_t index = old_set.index_of(node);
        old_index.push_back(index < old_set.size() ? static_cast<unsigned int>(index)
                                                   : dealii::numbers::invalid_unsigned_int);
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
      update_volumes();
      rows->search(set, renews ? kernel.positions() : set.padded_initial_positions(),
                   kernel.supports());
      bonds.finish_search();
      rows->compute_at_search();
      if (!renews)
        bonds.measure_rows(rows->stencils());
      bonds.release_debris();
      update_self_contact();
    }
    bool can_add_particles() const override
    {
      return true;
    }
    bool reaches_other_bodies() const override
    {
      return rows->reaches_other_bodies();
    }
    void set_before_change(const std::function<void()> &before_change) override
    {
      bonds.set_before_change(before_change);
    }

  protected:
    /** @p method_rows have no particles yet. A derived class sets part_points. Throws InputError.
     */
    ParticleMethod(const Entries &e, std::unique_ptr<ParticleRows<dim>> method_rows,
                   const std::string &default_configuration)
        : section(e.section()), rows(std::move(method_rows)),
          bonds(e, set, kernel, *rows, part_points)
    {
      smoothing_settings.is_active = false;
      kernel = KernelConfiguration<dim>(e, default_configuration);
      self_contact = SelfContact<dim>::create(e);
    }

    using NodalParticles<dim>::set;
    using NodalParticles<dim>::kernel;
    using NodalParticles<dim>::part_points;

    Section section;
    SmoothingSettings smoothing_settings;
    std::unique_ptr<ParticleRows<dim>> rows;

  private:
    // Measured, for each neighbour.
    static constexpr double per_neighbour = 4.;       // deformation and force
    static constexpr double per_smoothing = 4.;       // velocity and motion with Φ
    static constexpr double per_sharpening = 7.;      // Φ again, for γ
    static constexpr double per_affine_term = 2.5;    // velocity gradient and moments
    static constexpr double own_rows = 1.25;          // where rows are not shared by particles
    static constexpr double per_shape_function = 18.; // neighbours and shape functions built anew

    void collect(const CellSelection<dim> &is_taken, const NodalVector *const volumes = nullptr)
    {
      rows->reset(this->collect_particles(setup, rows->dilation(), is_taken, volumes));
      if (!rows->choose_supports(setup, is_taken, set))
        return;
      if (section.get_double("Support stretch limit") > 0.)
        section.fail("Support stretch limit", "smoothed particles keep their supports.");
      kernel.fix_supports(set);
    }
    void create_points()
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
    /** Of linear cells that this rank owns; none of parts that are one cell thin. */
    std::vector<SurfaceFibre> find_surface_fibres() const
    {
      std::vector<SurfaceFibre> fibres;
      const Nodes<dim> &nodes = *setup.nodes;
      std::vector<dealii::types::global_dof_index> own, inner;
      std::vector<dealii::Point<dim>> points;
      for (const auto &cell : setup.cells())
      {
        nodes.cell_nodes(cell, own);
        nodes.cell_points(cell, points);
        for (const unsigned int face : cell->face_indices())
        {
          const unsigned int opposite = face ^ 1u;
          if (!nodes.is_outer_face(cell, face) || cell->at_boundary(opposite) ||
              !setup.is_of_equals(setup.part_cells->part_beyond(cell, opposite)))
            continue;
          nodes.cell_nodes(typename Nodes<dim>::Cell(&nodes.dof_handler().get_triangulation(),
                                                     cell->neighbor(opposite)->level(),
                                                     cell->neighbor(opposite)->index(),
                                                     &nodes.dof_handler()),
                           inner);
          const unsigned int across = cell->neighbor_of_neighbor(opposite) / 2;
          for (const unsigned int corner : nodes.face_node_indices(face))
          {
            const unsigned int next = corner ^ (1u << (face / 2));
            const auto in_neighbour = static_cast<unsigned int>(
                std::find(inner.begin(), inner.end(), own[next]) - inner.begin());
            fibres.push_back({{{own[corner], own[next], inner[in_neighbour ^ (1u << across)]}},
                              cell->measure() / (1u << dim),
                              points[corner].distance(points[next])});
          }
        }
      }
      return fibres;
    }
    /** Throws the InputError of what the part must not have. Collective. */
    void check_setup() const
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
    /** Makes @p position the reference; new particles have F by initial rows. Collective. */
    void renew_reference(const NodalVector &position, const std::vector<unsigned int> &old_index)
    {
      // New particles have come from the initial configuration with the rows that they have there.
      Neighbourhoods<dim> at_start;
      at_start.set_images(setup.nodes->images());
      Stencils initial;
      at_start.search(set.nodes(), set.padded_initial_positions(), set.initial_supports(),
                      setup.communicator, initial);
      dealii::IndexSet required(set.owned_nodes().size());
      required.add_indices(at_start.global_nodes().begin(), at_start.global_nodes().end());
      const auto partition = set.partition(required, at_start.images());
      rows->separate_bodies(partition, at_start, initial);
      bonds.remove_unbonded(partition, at_start, initial);
      rows->fill(at_start, at_start.position_at_search().data(),
                 at_start.support_at_search().data(), initial);
      bonds.measure_rows(initial);

      at_start.set_partition(*partition, initial);
      // Owned nodes have the same numbers in all partitions.
      kernel.set_positions(position, initial);
      const std::vector<unsigned int> &particles = initial.particle_node;
      const NodalVector present =
          nodal_field(partition, Quantity::position, particles,
                      [&](const std::size_t i, double *const x)
                      { std::copy_n(position.node(particles[i]), node_stride, x); });
      for (unsigned int i = 0; i < initial.n_particles(); ++i)
        if (old_index[i] == dealii::numbers::invalid_unsigned_int && !initial.is_undeformed(i))
        {
          const dealii::Tensor<2, dim> deformation = row_deformation<dim>(initial, i, present);
          if (determinant(deformation) > 0.)
            kernel.set_deformation(i, deformation);
        }
      kernel.stretch_supports(set);
    }
    /** Sets the particles of self-contact. Returns how many fragments it has. Collective. */
    unsigned long update_self_contact()
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
    /** Finds neighbours anew, here and on other ranks, at these positions (node_stride a particle)
     * and the supports of the reference, and computes the rows. Collective. */
    void find_neighbours(const std::vector<double> &positions)
    {
      bonds.prepare_search();
      rows->search(set, positions, kernel.supports());
      bonds.finish_search();
      rows->compute_at_search();
    }
    /** update_neighbourhoods() of the rows alone. Collective. */
    NeighbourhoodChange update_rows(const NodalVector &position)
    {
      rows->finish_start();
      const bool has_broken = bonds.update(position);
      if (!kernel.is_renewal_due(position, set, rows->stencils()))
        return has_broken ? NeighbourhoodChange::values : NeighbourhoodChange::none;
      bonds.prepare_change();
      kernel.renew(position, set, rows->stencils());
      update_volumes();
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
    void update_volumes()
    {
      if (!rows->depend_on_volumes())
        return;
      rows->set_present_volumes(this->points().size() > 0
                                    ? this->points().component(MaterialPoints::volume, 0)
                                    : set.initial_volumes().data());
    }

    PartSetup<dim> setup;
    Bonds<dim> bonds;
    std::vector<SurfaceFibre> fibres;
    std::unique_ptr<SelfContact<dim>> self_contact; // null: fragments are not in contact
    double smallest_spacing_at_start = 0;           // of all that can be particles of the part [L]
  };
} // namespace tombolo
