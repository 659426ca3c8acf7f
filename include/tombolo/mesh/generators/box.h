// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/generators/axis_segments.h>
#include <tombolo/mesh/mesh_source.h>

#include <array>
#include <vector>

namespace tombolo
{
  /**
   * A box of hexahedra (quadrilaterals), each axis divided into one or several segments of equal
   * cells. The mesh is refined from the coarsest box whose cells the counts allow: if all counts
   * are multiples of 2^k, k times. Boundaries are called "x min", "x max", "y min", and so on.
   * With disorder, nodes are displaced at random, by numbers that depend on the place in the
   * lattice only, and the mesh is not refined, since only coarse vertices keep their places when
   * cells move between ranks.
   */
  template <int dim>
  class Box : public MeshSource<dim>
  {
  public:
    /** Throws InputError where an entry makes no box. */
    explicit Box(const Entries &e);

    void create(Mesh<dim> &mesh) const override;

  private:
    double number_of_coarse_cells() const;
    void check_counts() const;
    void set_rotation(double degrees, const std::vector<double> &direction);

    /** The coordinates of the coarse vertices along each axis. */
    std::array<std::vector<double>, dim> coarse_coordinates() const;

    /** Displaces the vertices, lexicographic on the lattice of these coordinates. */
    void displace(const std::array<std::vector<double>, dim> &coordinates,
                  std::vector<dealii::Point<dim>> &vertices) const;

    Section section;
    std::array<std::vector<AxisSegment>, dim> segments;
    unsigned int refinements = 0;
    double disorder = 0;
    unsigned int seed = 0;
    bool surface_nodes_slide = false;
    dealii::Tensor<2, dim> rotation;
  };
} // namespace tombolo
