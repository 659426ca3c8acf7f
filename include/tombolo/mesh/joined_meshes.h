// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/cell_quality.h>
#include <tombolo/mesh/mesh_source.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /** The corners of @p cell moved towards its centre by this @p share of their distance to it. */
  template <int dim>
  CellVertices<dim> shrunk_corners(const CellVertices<dim> &cell, double share);

  /** Whether the convex hulls of two cells have points in common: those of which no normal of a
   * face, and in space no normal of two edges, is a direction in which one lies behind the other.
   * Faces that are not plane have the normal of their diagonals. */
  template <int dim>
  bool have_points_in_common(const CellVertices<dim> &a, const CellVertices<dim> &b);

  /** Where a mesh is put: turned about a point, in three dimensions about an axis through it, and
   * then shifted. */
  template <int dim>
  class MeshPlacement
  {
  public:
    /** Throws InputError. */
    explicit MeshPlacement(const Entries &e);

    dealii::Point<dim> operator()(const dealii::Point<dim> &place) const;

  private:
    bool is_turned = false;
    dealii::Tensor<2, dim> rotation;
    dealii::Point<dim> centre;
    dealii::Tensor<1, dim> shift;
  };

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

  /** The source that the entry `Type` of a section chooses: declares it and the entries of all
   * sources, or reads. */
  template <int dim>
  std::unique_ptr<MeshSource<dim>> chosen_mesh_source(const Entries &e);

  /** Declares what chooses the cells of a scene: section Mesh, or several meshes. */
  template <int dim>
  void declare_mesh_sources(Parameters &parameters);

  /** The source of the mesh of the whole scene. Throws InputError. */
  template <int dim>
  std::unique_ptr<MeshSource<dim>> mesh_source(const Parameters &parameters);
} // namespace tombolo
