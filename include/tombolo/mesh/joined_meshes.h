// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/mesh_placement.h>
#include <tombolo/mesh/mesh_source.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Several meshes beside each other, `set Meshes = a, b`, each with a section `Mesh: NAME` that
   * says its source and its place. They share no nodes, wherever these lie, and may touch but not
   * overlap. Boundaries and groups of cells are called "a.NAME", and "NAME" where only one mesh has
   * it; all cells of a mesh are the group "mesh a". Ids of faces and of cells that an earlier mesh
   * has are counted on. All cells are refined as often as those of each source are at least; cells
   * of a source that refines more often are coarse cells here.
   */
  template <int dim>
  class JoinedMeshes : public MeshSource<dim>
  {
  public:
    /** Declares the entry `Meshes` and the sections of its names. */
    static void declare_parameters(Parameters &parameters);

    /** The meshes that the entry `Meshes` names, nullptr where it is empty. Throws InputError. */
    static std::unique_ptr<JoinedMeshes> read(const Parameters &parameters);

    /** Throws InputError, also where two meshes overlap. */
    void create(Mesh<dim> &mesh) const override;

    /** Those of the sources that number their nodes; the smallest integer at nodes of others.
     * Throws the InputError that two meshes have a number in common. */
    std::vector<long long> node_numbers() const override;

  private:
    /** One of the meshes. */
    struct Member
    {
      explicit Member(const Section &section);

      std::string name;
      Section section;
      std::unique_ptr<MeshSource<dim>> source;
      MeshPlacement<dim> placement;
    };

    struct Pieces;

    explicit JoinedMeshes(const Section &root) : root(root) {}

    /** The cells and names of all meshes. Collective. */
    Pieces read_pieces(MPI_Comm communicator) const;

    /** Refuses meshes of which two cells have more than a fringe in common. Collective. */
    void refuse_overlap(const Mesh<dim> &mesh, const Pieces &pieces) const;

    Section root;
    std::vector<Member> members;
  };
} // namespace tombolo
