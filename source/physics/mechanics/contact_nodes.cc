// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/contact_nodes.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/formulations/smoothed/smoothed_cells.h>
#include <tombolo/model/mass_of_part.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tombolo
{
  namespace
  {
    /** Tells the void cells of parts whose refills fill and empty cells; empty where there are no
     * such parts. Refers to the model. */
    template <int dim>
    typename OutwardAreas<dim>::IsVoid void_cells_of(const Model<dim> &model)
    {
      std::vector<const VoidCells<dim> *> of_parts;
      bool any = false;
      for (const Part<dim> &part : model.parts)
      {
        const auto *const cells = dynamic_cast<const SmoothedCells<dim> *>(part.formulation.get());
        const bool fills = cells != nullptr && cells->refill().fills_cells;
        of_parts.push_back(fills ? &cells->void_cells() : nullptr);
        any = any || fills;
      }
      if (!any)
        return {};
      return [of_parts, &model](const typename Nodes<dim>::Cell &cell)
      {
        const VoidCells<dim> *const voids = of_parts[model.part_cells->part_of(cell)];
        return voids != nullptr && voids->is_void(cell);
      };
    }
  } // namespace

  template <int dim>
  std::vector<double> ContactNodes<dim>::volume_of_nodes() const
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

  template <int dim>
  std::vector<bool> ContactNodes<dim>::nodes_that_can_be_exposed() const
  {
    const auto &partition = model.state.partition();
    std::vector<bool> can_be_exposed(partition->n_owned(), false);
    for (const Part<dim> &part : model.parts)
      for (const unsigned int node : part.formulation->particle_nodes())
        can_be_exposed[node] = true;
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

  template <int dim>
  void ContactNodes<dim>::take_faces_of_full_cells(
      const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts) const
  {
    const auto is_void = void_cells_of(model);
    for (const auto &contact : contacts)
      if (is_void && contact->faces() != nullptr)
        contact->faces()->take_faces(*model.nodes, is_void);
  }

  template <int dim>
  void ContactNodes<dim>::refuse_faces_of_void_cells(const Section &section,
                                                     const ContactSettings &settings) const
  {
    if (settings.is_of_faces && void_cells_of(model))
      section.fail("Method", "refills of a part fill and empty cells (`Refill void cells`), whose "
                             "faces this contact does not follow; allowed is penalty.");
  }

  template <int dim>
  std::set<types::global_dof_index>
  ContactNodes<dim>::bodies_of_contacts(const std::vector<const SurfaceContact<dim> *> &contacts,
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

  template <int dim>
  void ContactNodes<dim>::find_isolated_nodes(
      const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts) const
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

  template <int dim>
  std::optional<double> ContactNodes<dim>::count_fast_particles(
      const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts) const
  {
    constexpr double of_cutting_speed = 2.;
    double speed = std::numeric_limits<double>::max();
    for (const auto &contact : contacts)
      if (contact->cutting_speed() > 0.)
        speed = std::min(speed, contact->cutting_speed());
    if (speed == std::numeric_limits<double>::max())
      return {};
    std::set<unsigned int> fast;
    for (const Part<dim> &part : model.parts)
      for (const unsigned int node : part.formulation->particle_nodes())
        if (vector_of<dim>(model.state.velocity.node(node)).norm_square() >
            std::pow(of_cutting_speed * speed, 2))
          fast.insert(node);
    return ordered_sum(static_cast<double>(fast.size()), model.communicator);
  }

  template <int dim>
  void ContactNodes<dim>::refuse_blunt_smoothing(const Section &section) const
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

  template class ContactNodes<2>;
  template class ContactNodes<3>;
} // namespace tombolo
