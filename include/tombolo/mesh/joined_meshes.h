// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/cell_quality.h>
#include <tombolo/mesh/mesh_source.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>
#include <deal.II/physics/transformations.h>

#include <algorithm>
#include <array>
#include <cmath>
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
    explicit MeshPlacement(const Entries &e)
    {
      const std::string origin = dim == 2 ? "0, 0" : "0, 0, 0";
      const double degrees = e.number(
          "Rotation", "0", any_number(), "",
          dim == 2 ? "The angle by which the mesh is turned about `Rotation point`, before "
                     "it is shifted. Units: degrees"
                   : "The angle by which the mesh is turned about `Rotation axis`, before "
                     "it is shifted. Units: degrees");
      dealii::Tensor<1, 3> axis({0., 0., 1.});
      if (dim == 3)
      {
        const std::vector<double> direction =
            e.numbers("Rotation axis", "0, 0, 1", dim, "",
                      "The direction of the axis of the rotation; its length is of no importance.");
        std::copy_n(direction.begin(), dim, axis.begin_raw());
        e.refuse(!std::isfinite(axis.norm()) || axis.norm() == 0., "Rotation axis",
                 "The direction must be finite and not zero.");
      }
      const std::vector<double> point =
          e.numbers("Rotation point", origin, dim, "L",
                    dim == 2 ? "The point that the rotation leaves where it is."
                             : "A point that the axis of the rotation passes through.");
      const std::vector<double> displacement =
          e.numbers("Shift", origin, dim, "L", "By what the mesh is displaced, all of it.");
      if (e.declares())
        return;
      std::copy_n(point.begin(), dim, centre.begin_raw());
      std::copy_n(displacement.begin(), dim, shift.begin_raw());
      is_turned = degrees != 0.;
      const dealii::Tensor<2, 3> matrix =
          dealii::Physics::Transformations::Rotations::rotation_matrix_3d(
              axis / axis.norm(), degrees * dealii::numbers::PI / 180.);
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
        {
          // Quarters of a turn are exact.
          const double nearest = std::round(matrix[i][j]);
          rotation[i][j] = std::abs(matrix[i][j] - nearest) < 1e-15 ? nearest : matrix[i][j];
        }
    }

    dealii::Point<dim> operator()(const dealii::Point<dim> &place) const
    {
      return (is_turned ? centre + rotation * (place - centre) : place) + shift;
    }

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
