// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/smoothed/sub_cells.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <array>
#include <vector>

namespace tombolo
{
  /**
   * A face at which a cell lies beside cells of half its size: 2^(dim-1) faces of these, one at
   * each corner of the face. The coarse cell is bounded by the fine faces, cut into triangles as
   * the fine cells cut them, so that both sides of each of them agree.
   */
  template <int dim>
  struct RefinedFace
  {
    static constexpr unsigned int n_parts = 1u << (dim - 1);

    /** The nodes of a fine face: the corner of the cell, then the middles of the edges of the face
     * that meet there, then the middle of the face (in two dimensions the corner and the middle).
     */
    struct Part
    {
      unsigned int corner = 0; ///< of the cell
      std::array<dealii::types::global_dof_index, n_parts> nodes{};
      std::array<dealii::Point<dim>, n_parts> points;
      /** In three dimensions the corners of the cell at the other ends of the two edges. */
      std::array<unsigned int, 2> neighbours{};
    };

    unsigned int face = 0;
    std::array<Part, n_parts> parts;
  };

  /** An edge of a cell in space with a node in its middle, which cells of half the size beside the
   * edge have. */
  template <int dim>
  struct RefinedEdge
  {
    std::array<unsigned int, 2> corners{}; ///< of the cell, at its ends
    dealii::types::global_dof_index node = 0;
    dealii::Point<dim> point;
  };

  /** The refined faces of an active cell, which must be one of this rank. */
  template <int dim>
  std::vector<RefinedFace<dim>> refined_faces_of(const typename Nodes<dim>::Cell &cell);

  /** The refined edges of such a cell, those of its refined faces too. None in the plane, where
   * edges are faces. */
  template <int dim>
  std::vector<RefinedEdge<dim>> refined_edges_of(const typename Nodes<dim>::Cell &cell);

  /** A plane facet of a cell with refined faces; see SubCells::Facet. */
  template <int dim>
  struct GradedFacet
  {
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;

    /** A vertex: the sum of the shares of the corners of the cell and of hanging nodes. */
    struct Vertex
    {
      dealii::Point<dim> place;
      typename SubCells<dim>::Shares of_corners{};
      std::vector<std::pair<dealii::types::global_dof_index, double>> of_hanging_nodes;
    };

    std::array<Vertex, dim> vertices;
    double orientation = 1.;
    unsigned int from = 0, to = 0;
    unsigned int face = 0; ///< of the cell; faces_per_cell for inner facets

    dealii::Point<dim> centroid() const;
    /** Area times normal, from `from` to `to` [L^(dim-1)]. */
    dealii::Tensor<1, dim> area() const;
  };

  /** The facets of the sub-cells of a cell with these refined faces. Where hanging nodes are not in
   * the middle of their edge, the facets of unrefined faces at @p refined_edges are to be given,
   * which are two then. Their number and order do not depend on places. */
  template <int dim>
  std::vector<GradedFacet<dim>>
  graded_facets(const typename SubCells<dim>::Corners &corners,
                const std::vector<RefinedFace<dim>> &refined_faces,
                const std::vector<RefinedEdge<dim>> &refined_edges = {});

  /**
   * What the masses of hanging nodes have of the cells on whose faces they lie, and what the
   * corners of these cells have less: a cell with refined faces gives its mass to its corners and
   * to the hanging nodes, as the simplices of its sub-cells lie. The mass of each cell stays, and
   * where its faces are plane its centre. Without it a hanging node would have the stiffness of a
   * coarse cell and none of its mass.
   */
  template <int dim>
  class HangingMasses
  {
  public:
    void initialize(const PartSetup<dim> &setup);

    /** The nodes that have such masses. */
    const dealii::IndexSet &required_nodes() const;
    void set_partition(const NodePartition &partition);

    /** Adds the differences to a scalar vector. */
    void add_mass(NodalVector &mass) const;

    /** Adds (f - 1) times them, with a factor f for each cell of the part on this rank. */
    void add_extra_mass(const std::vector<double> &factors, NodalVector &mass) const;

    /** Adds what these nodes get, and corners less, of numbers that cells of the part on this rank
     * give to their nodes by mass. */
    void add_shares(const std::vector<double> &of_cells, NodalVector &result) const;

  private:
    struct Entry
    {
      unsigned int cell; // of the part, on this rank
      dealii::types::global_dof_index node;
      double mass;
      double share; // of the mass of the cell
    };

    std::vector<Entry> entries;
    std::vector<unsigned int> local_nodes; // of the entries
    dealii::IndexSet node_set;
  };
} // namespace tombolo
