// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/smoothed/sub_cells.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/geometry_info.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <array>
#include <utility>
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

  /** A cell of this rank: its corners, lexicographic, and which of its faces bound what is full of
   * the part. A void cell has no such faces. */
  template <int dim>
  struct SmoothedCell
  {
    std::vector<dealii::types::global_dof_index> nodes;
    typename SubCells<dim>::Corners corners;
    std::array<bool, dealii::GeometryInfo<dim>::faces_per_cell> is_on_boundary{};
    std::array<bool, dealii::GeometryInfo<dim>::faces_per_cell> is_towards_void{};
    /** Of faces on the boundary of the mesh; else numbers::internal_face_boundary_id. */
    std::array<dealii::types::boundary_id, dealii::GeometryInfo<dim>::faces_per_cell> boundary_ids;
    bool is_void = false;
    std::vector<RefinedFace<dim>> refined_faces; ///< towards cells of half its size
    std::vector<RefinedEdge<dim>> refined_edges; ///< beside such cells

    /** Whether it has nodes besides its corners: those of cells of half its size on its faces or
     * edges. */
    bool has_further_nodes() const
    {
      return !refined_faces.empty() || !refined_edges.empty();
    }

    /** These nodes and the corners; some several times. */
    std::vector<dealii::types::global_dof_index> all_nodes() const
    {
      std::vector<dealii::types::global_dof_index> result = nodes;
      for (const RefinedFace<dim> &face : refined_faces)
        for (const auto &part : face.parts)
          result.insert(result.end(), part.nodes.begin(), part.nodes.end());
      for (const RefinedEdge<dim> &edge : refined_edges)
        result.push_back(edge.node);
      return result;
    }

    dealii::BoundingBox<dim> box() const
    {
      return dealii::BoundingBox<dim>(
          std::vector<dealii::Point<dim>>(corners.begin(), corners.end()));
    }

    dealii::Point<dim> centre() const
    {
      return SubCells<dim>::centre(corners);
    }
  };

  /** The cells of the part that this rank owns, in the order of active cells. */
  template <int dim>
  std::vector<SmoothedCell<dim>> smoothed_cells_of(const PartSetup<dim> &setup);

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

  /** The facets of a cell with hanging nodes where its nodes are now, in the order of those of its
   * start. @p place_of: the place of a node by its global number. */
  template <int dim, typename PlaceOf>
  std::vector<GradedFacet<dim>> present_facets(const SmoothedCell<dim> &cell,
                                               const PlaceOf &place_of)
  {
    typename SubCells<dim>::Corners corners;
    for (unsigned int k = 0; k < corners.size(); ++k)
      corners[k] = place_of(cell.nodes[k]);
    std::vector<RefinedFace<dim>> faces = cell.refined_faces;
    std::vector<RefinedEdge<dim>> edges = cell.refined_edges;
    for (RefinedFace<dim> &face : faces)
      for (auto &part : face.parts)
        for (unsigned int k = 0; k < part.nodes.size(); ++k)
          part.points[k] = place_of(part.nodes[k]);
    for (RefinedEdge<dim> &edge : edges)
      edge.point = place_of(edge.node);
    std::vector<GradedFacet<dim>> result = graded_facets<dim>(corners, faces, edges);
    const std::vector<GradedFacet<dim>> of_start =
        graded_facets<dim>(cell.corners, cell.refined_faces, cell.refined_edges);
    for (std::size_t f = 0; f < result.size(); ++f)
      result[f].orientation = of_start[f].orientation;
    return result;
  }

  /** The volumes of the sub-cells that these facets bound [L^dim]. */
  template <int dim>
  std::array<double, SubCells<dim>::n_sub_cells>
  volumes_within(const std::vector<GradedFacet<dim>> &facets)
  {
    std::array<double, SubCells<dim>::n_sub_cells> result{};
    const dealii::Point<dim> origin = facets.front().vertices.front().place;
    for (const GradedFacet<dim> &facet : facets)
    {
      const double volume = facet.area() * (facet.centroid() - origin) / dim;
      result[facet.from] += volume;
      if (facet.to != SubCells<dim>::outside)
        result[facet.to] -= volume;
    }
    return result;
  }

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
    const dealii::IndexSet &required_nodes() const
    {
      return node_set;
    }
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
