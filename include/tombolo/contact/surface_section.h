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

    /** The boundaries that the section of a contact names; none for the whole surface. Throws
     * InputError. */
    std::set<dealii::types::boundary_id> boundaries() const;

    /** The owned nodes (local numbers, ascending) that a contact can touch: those on faces of
     * @p boundaries or, where the section names none, of the whole surface of the mesh and all that
     * can be exposed. Throws InputError where there is none on any rank. Collective. */
    std::vector<unsigned int>
    candidates(const std::set<dealii::types::boundary_id> &boundaries) const;

    /** Throws the InputError of a @p surface with a mass that would leave a plane of symmetry. */
    void refuse_motion_out_of_mirrors(ContactSurface<dim> &surface) const;
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

  /** Throws an InputError where these owned nodes are deeper in something than round-off, each by
   * its entry of @p depths [L]: what @p message says of the depth of the deepest node of all ranks
   * and of the node, "the node with the number 3 at (1, 2)". Collective. */
  template <int dim>
  void refuse_depth(
      const Nodes<dim> &nodes, const NodalState &state, const std::vector<unsigned int> &candidates,
      const std::vector<double> &depths,
      const std::function<std::string(const std::string &depth, const std::string &node)> &message);
} // namespace tombolo
