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
  /** Throws the InputError of a contact that puts nodes onto a surface, where particles are
   * smoothed so that this creates energy. */
  template <int dim>
  void refuse_blunt_smoothing(const Section &section, const Model<dim> &model);

  /** The initial volume of owned nodes [L^dim]. Collective. */
  template <int dim>
  std::vector<double> volume_of_nodes(const Model<dim> &model);

  /** Owned nodes that can be touched inside of the body: particles, which lose bonds, and nodes of
   * cells that can be deactivated. */
  template <int dim>
  std::vector<bool> nodes_that_can_be_exposed(const Model<dim> &model);

  /** Lets contacts have the faces of the cells that are full now, where refills fill and empty
   * cells; their partition must be set then. */
  template <int dim>
  void take_faces_of_full_cells(const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts,
                                const Model<dim> &model);

  /** Throws the InputError of a contact by faces, where refills fill and empty cells. */
  template <int dim>
  void refuse_faces_of_void_cells(const Section &section, const ContactSettings &settings,
                                  const Model<dim> &model);

  /** The bodies that touch the surfaces of parts, and those of these parts, on this rank, as
   * Bodies::body_of() has them. */
  template <int dim>
  std::set<dealii::types::global_dof_index>
  bodies_of_contacts(const std::vector<const SurfaceContact<dim> *> &contacts,
                     const Model<dim> &model, const Bodies<dim> &bodies);

  /** Tells contacts which nodes are debris now, where any of them conducts. Collective. */
  template <int dim>
  void find_isolated_nodes(const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts,
                           const Model<dim> &model);

  /** Particles now faster than twice the least cutting speed of the contacts, on all ranks; nothing
   * where no contact has one. Collective. */
  template <int dim>
  std::optional<double>
  count_fast_particles(const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts,
                       const Model<dim> &model);
} // namespace tombolo
