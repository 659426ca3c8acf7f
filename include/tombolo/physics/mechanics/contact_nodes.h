// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/surface_contact.h>
#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/formulations/smoothed/smoothed_cells.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/removed_cells.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  /** The properties of nodes and cells of a model for contacts with surfaces. The model must
   * outlive this. */
  template <int dim>
  class ContactNodes
  {
  public:
    explicit ContactNodes(const Model<dim> &model) : model(model) {}

    /** Throws the InputError of a contact that moves nodes onto a surface, where particles are
     * smoothed so that this creates energy. */
    void refuse_blunt_smoothing(const Section &section) const
    {
      // Measured: 0 makes energy, 0.98 does not.
      constexpr double smallest_sharpening = 0.5;
      const SmoothingSettings &smoothing = model.bridge->smoothing();
      if (model.has_particles() && smoothing.is_active && !smoothing.affine &&
          smoothing.gamma < smallest_sharpening)
        section.fail("Method", "particles smoothed by `paper`, or sharpened by less than 0.5, move "
                               "by other velocities than those that strain, and putting them onto "
                               "a surface creates energy; allowed is penalty, or another "
                               "`Smoothing`.");
    }

    /** The initial volume of owned nodes [L^dim]. Collective. */
    std::vector<double> volume_of_nodes() const
    {
      const auto &partition = model.state.partition();
      std::vector<double> volume(partition->n_owned(), 0.);
      for (const Part<dim> &part : model.parts)
      {
        const NodalVector mass = mass_of_part(model, *part.formulation);
        for (unsigned int i = 0; i < partition->n_owned(); ++i)
          volume[i] += *mass.node(i) / part.material->density();
      }
      return volume;
    }

    /** Owned nodes that can be touched inside of the body: nodes of cells that can be deactivated
     * and, unless faces touch, particles, which lose bonds. */
    std::vector<bool> nodes_that_can_be_exposed(const bool are_faces) const
    {
      const auto &partition = model.state.partition();
      std::vector<bool> can_be_exposed(partition->n_owned(), false);
      for (const Part<dim> &part : model.parts)
        for (const unsigned int node : part.formulation->particle_nodes())
          can_be_exposed[node] = !are_faces;
      std::vector<types::global_dof_index> cell_nodes;
      for (const auto &cell : model.nodes->dof_handler().active_cell_iterators())
        if (!cell->is_artificial() &&
            model.parts[model.part_cells->part_of(cell)].formulation->can_lose_cells())
        {
          model.nodes->cell_nodes(cell, cell_nodes);
          for (const types::global_dof_index node : cell_nodes)
            if (model.nodes->owned().is_element(node))
              can_be_exposed[partition->local_index(node)] = true;
        }
      return can_be_exposed;
    }

    /** Sets the faces of contacts to those of the cells that are left, where these are others than
     * for @p is_gone; their partition must be set then. Collective. */
    void renew_faces(const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts,
                     std::vector<bool> &is_gone) const
    {
      if (!removed_cells_differ(model, is_gone))
        return;
      for (const auto &contact : contacts)
        contact->renew_faces(*model.nodes, [&](const typename Nodes<dim>::Cell &cell)
                             { return is_gone[cell->active_cell_index()]; });
    }

    /** Throws the InputError of a contact by faces, where refills fill and empty cells. */
    void refuse_faces_of_void_cells(const Section &section, const ContactSettings &settings) const
    {
      if (settings.is_of_faces &&
          std::any_of(model.parts.begin(), model.parts.end(),
                      [](const Part<dim> &part)
                      {
                        const auto *const cells = part.template as<SmoothedCells>();
                        return cells != nullptr && cells->refill().fills_cells;
                      }))
        section.fail("Method",
                     "refills of a part fill and empty cells (`Refill void cells`), whose "
                     "faces this contact does not follow; allowed is penalty.");
    }

    /** The bodies that touch the surfaces of parts, and those of these parts, on this rank, by
     * Bodies::body_of(). */
    std::set<types::global_dof_index>
    bodies_of_contacts(const std::vector<const SurfaceContact<dim> *> &contacts,
                       const Bodies<dim> &bodies) const
    {
      std::set<types::global_dof_index> result;
      const NodePartition &partition = *model.state.partition();
      for (const auto &contact : contacts)
      {
        if (!contact->is_with_part())
          continue;
        for (const unsigned int node : contact->candidate_nodes())
          result.insert(bodies.body_of(partition.global_index(node)));
        for (const auto &owned : contact->nodes_of_part().owned())
          result.insert(bodies.body_of(partition.global_index(owned.node)));
      }
      return result;
    }

    /** Notifies contacts of the nodes that are debris now, where any of them conducts. Collective.
     */
    void
    find_isolated_nodes(const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts) const
    {
      const auto particles = model.particle_parts();
      if (std::none_of(contacts.begin(), contacts.end(),
                       [](const auto &contact) { return contact->has_areas(); }) ||
          std::none_of(particles.begin(), particles.end(),
                       [](auto *part)
                       { return part->breaking_bonds() && part->breaking_bonds()->any(); }))
        return;
      std::vector<unsigned int> isolated;
      for (ParticleFormulation<dim> *const part : particles)
        if (const Bonds<dim> *const bonds = part->breaking_bonds())
          for (const unsigned int row : bonds->debris())
            if (const unsigned int node = part->stencils().particle_node[row];
                *model.element_mass.node(node) == 0.)
              isolated.push_back(node);
      for (const auto &contact : contacts)
        if (OutwardAreas<dim> *const faces = contact->faces())
          faces->set_isolated_nodes(isolated);
    }

    /** Particles now faster than twice the least cutting speed of the contacts, on all ranks;
     * nothing where no contact has one. Collective. */
    std::optional<double>
    count_fast_particles(const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts) const
    {
      constexpr double speed_factor = 2.;
      double speed = std::numeric_limits<double>::max();
      for (const auto &contact : contacts)
        if (contact->contact_settings().cutting_speed > 0.)
          speed = std::min(speed, contact->contact_settings().cutting_speed);
      if (speed == std::numeric_limits<double>::max())
        return {};
      std::set<unsigned int> fast;
      for (const Part<dim> &part : model.parts)
        for (const unsigned int node : part.formulation->particle_nodes())
          if (vector_of<dim>(model.state.velocity.node(node)).norm_square() >
              std::pow(speed_factor * speed, 2))
            fast.insert(node);
      return ordered_sum(static_cast<double>(fast.size()), model.communicator);
    }

    /** Warns, once for each contact, where its springs give way by more than the spacing of the
     * nodes that touch, the largest of them. Collective. */
    void add_depth_warnings(const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts,
                            std::vector<bool> &has_warned, std::vector<std::string> &warnings) const
    {
      std::optional<std::vector<double>> volume;
      for (std::size_t k = 0; k < contacts.size(); ++k)
      {
        const SurfaceContact<dim> &contact = *contacts[k];
        // A kinematic contact, which limits no step, has no springs.
        if (has_warned[k] || contact.stable_fraction() == 1.)
          continue;
        const double depth = contact.balance(model.communicator).penetration;
        if (!(depth > 0.))
          continue;
        if (!volume)
          volume = volume_of_nodes();
        double largest = 0;
        for (const unsigned int node : contact.nodes_in_contact())
          largest = std::max(largest, (*volume)[node]);
        const double spacing = std::pow(Utilities::MPI::max(largest, model.communicator), 1. / dim);
        has_warned[k] = depth > spacing;
        if (has_warned[k])
          warnings.push_back(
              as_text(std::setprecision(3), "Contact \"", contact.name(), "\": nodes are ", depth,
                      " deep in its surface, ", depth / spacing,
                      " of the spacing there, since its springs give way. A larger `Stiffness`, or "
                      "`Method = kinematic`, holds them."));
      }
    }

  private:
    const Model<dim> &model;
  };
} // namespace tombolo
