// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/smoothed/refined_faces.h>
#include <tombolo/formulations/smoothed/sub_cells.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/geometry_info.h>

#include <algorithm>
#include <array>
#include <vector>

namespace tombolo
{
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
      dealii::Point<dim> result;
      for (const dealii::Point<dim> &corner : corners)
        result += corner / static_cast<double>(corners.size());
      return result;
    }
  };

  /** The cells of the part that this rank owns, in the order of active cells. */
  template <int dim>
  std::vector<SmoothedCell<dim>> smoothed_cells_of(const PartSetup<dim> &setup);

  /** The nodes of a part that can be neighbours of points in its cells on this rank, ascending by
   * their global numbers. */
  template <int dim>
  struct NodeCloud
  {
    /** Half widths of supports are @p dilation times the largest distance to a node of the same
     * cell, axis by axis. Collective. */
    NodeCloud(const PartSetup<dim> &setup, double dilation,
              const std::vector<SmoothedCell<dim>> &cells);

    /** The place of a node that is there. */
    unsigned int place_of(dealii::types::global_dof_index number) const;

    /** The supports. */
    std::vector<dealii::BoundingBox<dim>> boxes() const;

    std::vector<dealii::types::global_dof_index> node;
    std::vector<double> position, support; ///< node_stride each [L]
    std::vector<double> body;              ///< its number in Bodies; empty: there is one
    std::vector<bool> is_void;             ///< whether all of its cells are void; empty: none is
  };
} // namespace tombolo
