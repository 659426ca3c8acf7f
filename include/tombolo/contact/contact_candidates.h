// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_surface.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_state.h>

#include <set>
#include <vector>

namespace tombolo
{
  /** Declares `Boundary` and `Where`, which select the nodes of a contact. */
  void declare_contact_candidates(const Entries &e);

  /** Refuses what can be seen to be wrong with them without a mesh. */
  template <int dim>
  void validate_contact_candidates(const Section &section);

  /** The boundaries that the section of a contact names; none for the whole surface. Throws
   * InputError. */
  template <int dim>
  std::set<dealii::types::boundary_id> contact_boundaries(const Section &section,
                                                          const Mesh<dim> &mesh);

  /** The owned nodes (local numbers, ascending) that a contact can touch: those on faces of
   * @p boundaries or, where the section names none, of the whole surface of the mesh and all that
   * @p can_be_exposed (an entry per owned node). Throws InputError where there is none on any rank.
   * Collective. */
  template <int dim>
  std::vector<unsigned int> find_contact_candidates(
      const Section &section, const std::set<dealii::types::boundary_id> &boundaries,
      const Nodes<dim> &nodes, const NodalState &state, const std::vector<bool> &can_be_exposed);

  /** Throws InputError where a candidate is behind the surface at the start: its @p gap, of which
   * there is one per candidate, is negative [L]. Names the deepest node of all ranks. Collective.
   */
  template <int dim>
  void refuse_penetration(const Section &section, const Nodes<dim> &nodes, const NodalState &state,
                          const std::vector<unsigned int> &candidates,
                          const std::vector<double> &gap);

  /** Moves candidates of which @p slides is positive and whose gap @p from (positions) was negative
   * along the normal of the surface until it is as it was; where @p slides is less than one, only
   * if the surface of the body and this one differ in slope by little. Moves others with a negative
   * gap out of the surface. Marks those with a gap that is or was negative in @p is_bound. */
  template <int dim>
  void push_out(const ContactSurface<dim> &surface, const std::vector<unsigned int> &candidates,
                const std::vector<double> &was, const std::vector<double> &gap, double time,
                const NodalVector &slides, const NodalVector &from, NodalVector &position,
                NodalVector &is_bound);

  /** Throws the InputError of a @p surface with a mass that would move out of a plane of symmetry.
   */
  template <int dim>
  void refuse_motion_out_of_mirrors(const Section &section, const Images &images,
                                    ContactSurface<dim> &surface);
} // namespace tombolo
