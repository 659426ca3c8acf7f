// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/contact/contact_faces.h>
#include <tombolo/contact/mortar_node.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <vector>

namespace tombolo
{
  /** Throws the InputError of bodies that overlap at the start, with the deepest node and its
   * place: @p kept has the overlap of the owned slave nodes. Collective. */
  template <int dim>
  void refuse_overlap(const Section &section, const std::vector<MortarNode<dim>> &kept,
                      const ContactFaces<dim> &slaves, const ContactFaces<dim> &masters,
                      const Nodes<dim> &nodes, const NodalVector &position, MPI_Comm communicator);

  /** Throws the InputError of tied bodies that are apart, with their distance. Collective. */
  template <int dim>
  [[noreturn]] void refuse_distance(const Section &section, const ContactFaces<dim> &slaves,
                                    const ContactFaces<dim> &masters, const NodalVector &position,
                                    MPI_Comm communicator);
} // namespace tombolo
