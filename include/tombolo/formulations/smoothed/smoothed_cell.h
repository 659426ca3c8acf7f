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
   * A face of a cell with further nodes: the 2^(dim-1) faces of smaller cells beside it, one at
   * each corner of the face. The cell is bounded by these, cut into triangles as the small cells
   * cut them, so that both sides of each of them agree.
   */
  template <int dim>
  struct FaceNodes
  {
    static constexpr unsigned int n_parts = 1u << (dim - 1);

    /** The nodes of a small face: the corner of the cell, then the middles of the edges of the face
     * that meet there, then the middle of the face (in the plane the corner and the middle). */
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

  /** An edge of a cell in space with a node in its middle, which smaller cells beside it have. */
  template <int dim>
  struct EdgeNode
  {
    std::array<unsigned int, 2> corners{}; ///< of the cell, at its ends
    dealii::types::global_dof_index node = 0;
    dealii::Point<dim> point;
  };

  /** A cell of this rank: corners, lexicographic, and faces that bound what is full; a void cell
   * has none. */
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
    std::vector<FaceNodes<dim>> face_nodes; ///< of faces towards cells of half its size
    std::vector<EdgeNode<dim>> edge_nodes;  ///< beside such cells

    /** Whether it has nodes besides its corners: those of cells of half its size beside it. */
    bool has_further_nodes() const
    {
      return !face_nodes.empty() || !edge_nodes.empty();
    }

    /** These nodes and the corners; some several times. */
    std::vector<dealii::types::global_dof_index> all_nodes() const
    {
      std::vector<dealii::types::global_dof_index> result = nodes;
      for (const FaceNodes<dim> &face : face_nodes)
        for (const auto &part : face.parts)
          result.insert(result.end(), part.nodes.begin(), part.nodes.end());
      for (const EdgeNode<dim> &edge : edge_nodes)
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

  /** A plane facet of a cell with further nodes; see SubCells::Facet. */
  template <int dim>
  struct CellFacet
  {
    /** A vertex: the sum of the shares of nodes. */
    struct Vertex
    {
      dealii::Point<dim> position;
      std::vector<std::pair<dealii::types::global_dof_index, double>> row;
    };

    std::array<Vertex, dim> vertices;
    double orientation = 1.;
    unsigned int from = 0, to = 0;
    unsigned int face = 0; ///< of the cell; faces_per_cell for inner facets

    dealii::Point<dim> centroid() const;
    /** Area times normal, from `from` to `to` [L^(dim-1)]. */
    dealii::Tensor<1, dim> area() const
    {
      std::array<dealii::Point<dim>, dim> positions;
      for (unsigned int v = 0; v < dim; ++v)
        positions[v] = vertices[v].position;
      return SubCells<dim>::area_of(positions, orientation);
    }
  };

  /** The facets of the sub-cells. Where nodes are not in the middle of their edge, facets are two
   * @p at_edge_nodes of faces without further nodes. Their order does not depend on positions. */
  template <int dim>
  std::vector<CellFacet<dim>> facets_of(const SmoothedCell<dim> &cell, bool at_edge_nodes);

  /** The facets of a cell where its nodes are now, in the order of those of its start. @p
   * position_of: the position of a node by its global number. */
  template <int dim, typename PositionOf>
  std::vector<CellFacet<dim>> present_facets(const SmoothedCell<dim> &cell,
                                             const PositionOf &position_of)
  {
    SmoothedCell<dim> present = cell;
    for (unsigned int k = 0; k < present.corners.size(); ++k)
      present.corners[k] = position_of(cell.nodes[k]);
    for (FaceNodes<dim> &face : present.face_nodes)
      for (auto &part : face.parts)
        for (unsigned int k = 0; k < part.nodes.size(); ++k)
          part.points[k] = position_of(part.nodes[k]);
    for (EdgeNode<dim> &edge : present.edge_nodes)
      edge.point = position_of(edge.node);
    std::vector<CellFacet<dim>> result = facets_of(present, true);
    const std::vector<CellFacet<dim>> initial_facets = facets_of(cell, true);
    for (std::size_t f = 0; f < result.size(); ++f)
      result[f].orientation = initial_facets[f].orientation;
    return result;
  }

  /** The volumes of the sub-cells that these facets bound [L^dim]. */
  template <int dim>
  std::array<double, SubCells<dim>::n_sub_cells>
  volumes_within(const std::vector<CellFacet<dim>> &facets)
  {
    std::array<double, SubCells<dim>::n_sub_cells> result{};
    const dealii::Point<dim> origin = facets.front().vertices.front().position;
    for (const CellFacet<dim> &facet : facets)
    {
      const double volume = facet.area() * (facet.centroid() - origin) / dim;
      result[facet.from] += volume;
      if (facet.to != SubCells<dim>::outside)
        result[facet.to] -= volume;
    }
    return result;
  }

  /**
   * Differences between the lumped masses of cells with and without further nodes: a cell with
   * nodes on its faces gives its mass to its corners and to these nodes, as the simplices of its
   * sub-cells lie. The mass of each cell stays, and where its faces are plane its centre. Without
   * it such a node would have the stiffness of a large cell and none of its mass.
   */
  template <int dim>
  class FurtherMasses
  {
  public:
    void initialize(const PartSetup<dim> &setup);

    const dealii::IndexSet &required_nodes() const
    {
      return node_set;
    }
    void set_partition(const NodePartition &partition);

    /** Adds the differences to a scalar vector. */
    void add_mass(NodalVector &mass) const;

    /** Adds (f - 1) times them, with a factor f for each cell of the part on this rank. */
    void add_extra_mass(const std::vector<double> &factors, NodalVector &mass) const;

    /** Adds such differences of numbers that cells of the part here distribute to nodes by mass. */
    void add_shares(const std::vector<double> &cell_values, NodalVector &result) const;

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
