// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/model/part.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /** A face of a cell of one part beside cells of half its size of another or the same part. */
  template <int dim>
  struct UnequalFace
  {
    CellId::binary_type cell = {};
    unsigned int face = 0;
    Point<dim> position;
    unsigned int part = 0, fine_part = 0;

    bool operator<(const UnequalFace &other) const
    {
      return cell != other.cell ? cell < other.cell : face < other.face;
    }
  };

  /** Why cells of a part cannot be the larger or the smaller ones at a face; empty: they can. */
  template <int dim>
  std::string why_unfit(const unsigned int number, const std::vector<Part<dim>> &parts)
  {
    const Formulation<dim> &formulation = *parts[number].formulation;
    const MiddleNodes middle_nodes = formulation.middle_nodes();
    if (middle_nodes == MiddleNodes::refused)
      return "take no nodes in the middle of their faces";
    if (formulation.degree() > 1)
      return "of a degree above one take no nodes in the middle of their faces";
    const bool becomes_particles = std::any_of(
        parts.begin(), parts.end(), [&](const Part<dim> &other) { return other.source == number; });
    if (middle_nodes != MiddleNodes::free && (formulation.can_lose_cells() || becomes_particles))
      return "whose cells can leave while the run goes on take no nodes in the middle of their "
             "faces";
    return {};
  }

  /** The same of the large cells of a part beside small ones of another. */
  template <int dim>
  std::string why_unfit_beside(const unsigned int number, const unsigned int small_part,
                               const std::vector<Part<dim>> &parts)
  {
    std::string reason = why_unfit(number, parts);
    if (reason.empty() && number != small_part &&
        parts[number].formulation->middle_nodes() == MiddleNodes::free)
      reason = "take nodes in the middle of their faces beside cells of their own part only";
    if (reason.empty() && parts[number].particles != nullptr &&
        parts[small_part].particles != nullptr)
      reason = "take no nodes in the middle of their faces beside cells of particles";
    return reason;
  }

  /** The first face of this rank that is refused; none, or one. */
  template <int dim>
  std::vector<UnequalFace<dim>> first_refused_face(const Mesh<dim> &mesh,
                                                   const PartCells<dim> &part_cells,
                                                   const std::vector<Part<dim>> &parts)
  {
    std::vector<UnequalFace<dim>> result;
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
    {
      if (!cell->is_locally_owned())
        continue;
      const unsigned int part = part_cells.part_of(cell);
      for (const unsigned int f : cell->face_indices())
      {
        const auto face = cell->face(f);
        if (cell->at_boundary(f) || !face->has_children())
          continue;
        for (unsigned int child = 0; child < face->n_children(); ++child)
        {
          const unsigned int fine = part_cells.part_of(cell->neighbor_child_on_subface(f, child));
          if (why_unfit_beside(part, fine, parts).empty() && why_unfit(fine, parts).empty())
            continue;
          const UnequalFace<dim> found{cell->id().template to_binary<dim>(), f, face->center(),
                                       part, fine};
          if (result.empty())
            result.push_back(found);
          result[0] = std::min(result[0], found);
        }
      }
    }
    return result;
  }

  /** Nodes on which another one depends, by global numbers. */
  using NodeWeights = std::vector<std::pair<types::global_dof_index, double>>;

  /** Adds the nodes in the middle of a face and of its edges, with those between which they lie.
   * Child k of a face has its corner k; numbers of opposite corners add up to the last one. */
  template <int dim>
  void add_middle_nodes(const typename Nodes<dim>::Cell &cell, const unsigned int f,
                        std::map<types::global_dof_index, NodeWeights> &rows)
  {
    constexpr unsigned int n = GeometryInfo<dim>::vertices_per_face;
    const auto face = cell->face(f);
    // The nodes of a small face are known where the rank has the cell behind it, which it has
    // around the nodes that it owns.
    std::set<unsigned int> known;
    for (unsigned int child = 0; child < n; ++child)
      if (const auto behind = cell->neighbor_child_on_subface(f, child); !behind->is_artificial())
        for (const unsigned int g : behind->face_indices())
          known.insert(static_cast<unsigned int>(behind->face_index(g)));
    for (unsigned int k = 0; k < n; ++k)
      for (unsigned int other = 0; other < n; ++other)
      {
        if (other == k || known.count(static_cast<unsigned int>(face->child_index(k))) == 0)
          continue;
        NodeWeights weights;
        if (dim == 3 && (other ^ k) == n - 1)
          for (unsigned int corner = 0; corner < n; ++corner)
            weights.emplace_back(face->vertex_dof_index(corner, 0), 1. / n);
        else
          for (const unsigned int corner : {k, other})
            weights.emplace_back(face->vertex_dof_index(corner, 0), 0.5);
        std::sort(weights.begin(), weights.end());
        rows[face->child(k)->vertex_dof_index(other, 0)] = weights;
      }
  }

  /** Refuses a mesh in which the size of cells changes where a formulation does not allow it (see
   * MiddleNodes), with the position of the first such face. Throws InputError. Collective. */
  template <int dim>
  void refuse_unfit_gradings(const Mesh<dim> &mesh, const PartCells<dim> &part_cells,
                             const std::vector<Part<dim>> &parts,
                             const std::vector<Section> &part_sections)
  {
    const auto all = from_all_ranks(first_refused_face(mesh, part_cells, parts),
                                    communicator_of(mesh.triangulation));
    if (all.empty())
      return;
    const UnequalFace<dim> &first = *std::min_element(all.begin(), all.end());
    const std::string large_reason = why_unfit_beside(first.part, first.fine_part, parts);
    const unsigned int unfit = large_reason.empty() ? first.fine_part : first.part;
    const Section &section = part_sections[unfit];
    section.fail(
        "Formulation",
        "At " + position_text(first.position) + " a cell of the part \"" +
            part_sections[first.part].name() + "\" lies beside cells of half its size" +
            (first.fine_part == first.part
                 ? ""
                 : " of the part \"" + part_sections[first.fine_part].name() + "\"") +
            ", and cells of \"" + section.get("Formulation") + "\" " +
            (large_reason.empty() ? why_unfit(unfit, parts) : large_reason) +
            ". Refine all of the part or nothing of it (`Refine where` in section Mesh), or "
            "choose \"smoothed cells\" or elements of degree one that stay.");
  }

  /** The nodes in the middle of faces and edges of cells where these are means, ascending: as far
   * as this rank has cells, so all around nodes that it owns. */
  template <int dim>
  std::vector<DependentNode> find_hanging_nodes(const Nodes<dim> &nodes,
                                                const PartCells<dim> &part_cells,
                                                const std::vector<Part<dim>> &parts)
  {
    std::map<types::global_dof_index, NodeWeights> rows;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      if (!cell->is_artificial() &&
          parts[part_cells.part_of(cell)].formulation->middle_nodes() == MiddleNodes::means)
        for (const unsigned int f : cell->face_indices())
          if (!cell->at_boundary(f) && cell->face(f)->has_children())
            add_middle_nodes<dim>(cell, f, rows);
    std::vector<DependentNode> result;
    for (const auto &[node, weights] : rows)
      result.push_back({node, weights});
    return result;
  }
} // namespace tombolo
