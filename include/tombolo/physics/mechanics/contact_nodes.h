// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surface_contact.h>
#include <tombolo/model/model.h>

#include <memory>
#include <optional>
#include <set>
#include <vector>

namespace tombolo
{
  /** What contacts with surfaces ask of the nodes and cells of a model, which must outlive this. */
  template <int dim>
  class ContactNodes
  {
  public:
    explicit ContactNodes(const Model<dim> &model) : model(model) {}

    /** Throws the InputError of a contact that puts nodes onto a surface, where particles are
     * smoothed so that this creates energy. */
    void refuse_blunt_smoothing(const Section &section) const;

    /** The initial volume of owned nodes [L^dim]. Collective. */
    std::vector<double> volume_of_nodes() const;

    /** Owned nodes that can be touched inside of the body: particles, which lose bonds, and nodes
     * of cells that can be deactivated. */
    std::vector<bool> nodes_that_can_be_exposed() const;

    /** Lets contacts have the faces of the cells that are full now, where refills fill and empty
     * cells; their partition must be set then. */
    void take_faces_of_full_cells(
        const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts) const;

    /** Throws the InputError of a contact by faces, where refills fill and empty cells. */
    void refuse_faces_of_void_cells(const Section &section, const ContactSettings &settings) const;

    /** The bodies that touch the surfaces of parts, and those of these parts, on this rank, as
     * Bodies::body_of() has them. */
    std::set<dealii::types::global_dof_index>
    bodies_of_contacts(const std::vector<const SurfaceContact<dim> *> &contacts,
                       const Bodies<dim> &bodies) const;

    /** Tells contacts which nodes are debris now, where any of them conducts. Collective. */
    void
    find_isolated_nodes(const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts) const;

    /** Particles now faster than twice the least cutting speed of the contacts, on all ranks;
     * nothing where no contact has one. Collective. */
    std::optional<double>
    count_fast_particles(const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts) const;

  private:
    const Model<dim> &model;
  };
} // namespace tombolo
