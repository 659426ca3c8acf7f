// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/part_surface.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_state.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  /** Of what a contact of nodes with a surface is made. */
  template <int dim>
  struct ContactScene
  {
    Section section;
    const Mesh<dim> &mesh;
    const Nodes<dim> &nodes;
    const NodalState &state;
    /** An entry per owned node: particles, and nodes of cells that erode or become particles. */
    std::vector<bool> can_be_exposed;
    bool has_heat = false; ///< contacts give it to nodes (NodalHeat)
    /** The initial one of each owned node, where areas are needed: for heat, for a limit of shear
     * and where the surface is that of a part. */
    std::vector<double> volume;
    MasterPart<dim> master; ///< whose own nodes are no candidates
  };

  /** Declares the section "Contact: NAME" of a contact with a rigid surface. */
  template <int dim>
  void declare_surface_contact(const Entries &e);

  /** Reads the section and refuses what can be seen to be wrong without a mesh. */
  template <int dim>
  void validate_surface_contact(const Section &section, bool has_heat);

  /** The surface that the section names. Throws InputError. */
  template <int dim>
  std::unique_ptr<ContactSurface<dim>> create_surface(const Section &section);

  /** The boundaries that the section of a contact names; none for the whole surface. Throws
   * InputError. */
  template <int dim>
  std::set<dealii::types::boundary_id> contact_boundaries(const ContactScene<dim> &scene);

  /** The owned nodes (local numbers, ascending) that a contact can touch: those on faces of
   * @p boundaries or, where the section names none, of the whole surface of the mesh and all that
   * can be exposed. Throws InputError where there is none on any rank. Collective. */
  template <int dim>
  std::vector<unsigned int>
  find_contact_candidates(const ContactScene<dim> &scene,
                          const std::set<dealii::types::boundary_id> &boundaries);

  /** Throws an InputError where these owned nodes are deeper in something than round-off, each by
   * its entry of @p depths [L]: what @p message says of the depth of the deepest node of all ranks
   * and of the node, "the node with the number 3 at (1, 2)". Collective. */
  template <int dim>
  void refuse_depth(
      const Nodes<dim> &nodes, const NodalState &state, const std::vector<unsigned int> &candidates,
      const std::vector<double> &depths,
      const std::function<std::string(const std::string &depth, const std::string &node)> &message);

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
  void refuse_motion_out_of_mirrors(const ContactScene<dim> &scene, ContactSurface<dim> &surface);
} // namespace tombolo
