// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/formulations/elements/split_number.h>
#include <tombolo/mesh/cell_divisions.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/model/model.h>
#include <tombolo/model/point_transfer.h>
#include <tombolo/state/archive_rows.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /** A node of a cell that is made of another one: the corners of that one, with weights. */
  struct CornerSource
  {
    unsigned int cell, corner; ///< the number of the source cell, and its corner
    double weight;
  };

  /** Corner @p k of child @p child from the corners of the parent. */
  template <int dim>
  std::vector<CornerSource> corner_of_child(const unsigned int child, const unsigned int k)
  {
    std::vector<CornerSource> result;
    Point<dim> unit_point;
    for (unsigned int d = 0; d < dim; ++d)
      unit_point[d] = 0.5 * (((child >> d) & 1u) + ((k >> d) & 1u));
    for (unsigned int corner = 0; corner < GeometryInfo<dim>::vertices_per_cell; ++corner)
      if (const double weight = GeometryInfo<dim>::d_linear_shape_function(unit_point, corner);
          weight > 0.)
        result.push_back({0, corner, weight});
    return result;
  }

  /** The persistent numbers of relevant nodes in two halves. Collective. */
  template <int dim>
  NodalVector persistent_numbers(const Model<dim> &model)
  {
    const std::vector<std::uint64_t> &ids = model.nodes->persistent_ids();
    return nodal_field(model.state.partition(), Quantity::scalars,
                       [&](const unsigned int i, double *const halves)
                       {
                         halves[0] = upper_half(ids[i]);
                         halves[1] = lower_half(ids[i]);
                       });
  }

  /**
   * From which nodes and cells of an archive those of a model are made, whose mesh is another
   * division of the same cells: cells of the model are cells there, children of such or their
   * parents. Nodes that both meshes have are kept as they are; a new node is the mean of those
   * between which it lies. Works on any number of ranks.
   */
  template <int dim>
  class MeshTransfer
  {
  public:
    /** Writes what the constructor needs. The rows of the archive are those of no part. Collective.
     */
    static void write(Model<dim> &model, StateArchive &archive)
    {
      constexpr unsigned int n_corners = GeometryInfo<dim>::vertices_per_cell;
      const NodalVector numbers = persistent_numbers(model);
      NodalVector mass;
      if (model.has_mechanics)
      {
        mass = scalar_field(model.state.partition(),
                            [&](const unsigned int i) { return *model.bridge->mass().node(i); });
        model.state.unsmoothed_velocity.update_ghosts();
      }
      const auto group = archive.group("cells");
      for (unsigned int p = 0; p < model.parts.size(); ++p)
      {
        const auto part_group = archive.group(model.parts[p].name);
        archive.set_rows(model.persistent_ids_of_points(p));
        std::vector<double> halves, motion;
        std::vector<types::global_dof_index> nodes;
        for (const auto &cell : cells_of_part(*model.nodes, *model.part_cells, p))
        {
          model.nodes->cell_nodes(cell, nodes);
          for (const auto node : nodes)
          {
            const unsigned int local = model.state.partition()->local_index(node);
            halves.insert(halves.end(), {numbers.node(local)[0], numbers.node(local)[1]});
            if (!model.has_mechanics)
              continue;
            motion.push_back(*mass.node(local));
            for (unsigned int d = 0; d < dim; ++d)
              motion.push_back(model.state.unsmoothed_velocity.node(local)[d]);
          }
        }
        archive.rows("nodes", 2 * n_corners, halves);
        if (model.has_mechanics)
          archive.rows("motion", (dim + 1) * n_corners, motion);
        PointTransfer<dim>::write(model, p, archive);
      }
    }

    /** Finds sources of all nodes and cells of @p model. Collective. */
    MeshTransfer(const Model<dim> &model, StateArchive &archive)
    {
      const auto group = archive.group("cells");
      std::vector<VisibleCells> visible;
      for (unsigned int p = 0; p < model.parts.size(); ++p)
      {
        const auto part_group = archive.group(model.parts[p].name);
        visible.push_back(find_cells(model, p, archive));
        std::vector<CellSource> owned;
        for (std::size_t c = 0; c < visible[p].cells.size(); ++c)
          if (visible[p].cells[c]->is_locally_owned())
            owned.push_back(visible[p].sources[c]);
        points.emplace_back(model, p, owned, archive);
      }
      find_nodes(model, visible);
      if (model.has_mechanics)
        find_momentum(model, visible);
    }

    /** Of owned nodes, by identifiers of the archive. */
    const RowSources &nodes() const
    {
      return node_sources;
    }

    /** Reads the material points of a part. The group of the archive is that of the part.
     * Collective. */
    void read_points(const Model<dim> &model, const unsigned int part, StateArchive &archive) const
    {
      points[part].read(model, archive);
    }

    /** See PointTransfer. */
    void update_volumes(const Model<dim> &model, const NodalVector &position) const
    {
      for (const PointTransfer<dim> &part_points : points)
        part_points.update_volumes(model, position);
    }

    /** Adds to nodes of joined cells the momentum of nodes that are no longer unknowns, as far as
     * it was not transferred with them; to be called after the state was read. What
     * prescribed components would receive is lost. Collective. */
    void restore_momentum(Model<dim> &model) const
    {
      if (!model.has_mechanics || Utilities::MPI::sum(momenta.size(), model.communicator) == 0)
        return;
      NodalVector sum(model.state.partition());
      for (const auto &[node, momentum] : momenta)
        for (unsigned int d = 0; d < dim; ++d)
          sum.node(model.state.partition()->local_index(node))[d] += momentum[d];
      sum.collect();
      const std::vector<std::uint8_t> &constrained = model.conditions->constrained_components();
      NodalVector &velocity = model.state.unsmoothed_velocity;
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          if (const double mass = *model.bridge->mass().node(i);
              mass > 0. && (constrained.empty() || ((constrained[i] >> d) & 1u) == 0))
            velocity.node(i)[d] += sum.node(i)[d] / mass;
      velocity.distribute();
    }

  private:
    /** Cells of a part that are relevant on this rank, and what they are made of. */
    struct VisibleCells
    {
      std::vector<typename Nodes<dim>::Cell> cells;
      std::vector<CellSource> sources;
      std::vector<std::uint64_t> ids; ///< of the archive that can be needed, ascending
      std::vector<double> numbers;    ///< identifiers of the nodes of these, in halves
      std::vector<double> motion;     ///< masses and velocities of their nodes

      std::size_t number_of(const std::uint64_t id) const
      {
        return static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
      }

      std::size_t number_of(const std::uint64_t cell, const unsigned int corner) const
      {
        return number_of(cell) * GeometryInfo<dim>::vertices_per_cell + corner;
      }

      std::uint64_t node(const std::uint64_t cell, const unsigned int corner) const
      {
        const double *const halves = numbers.data() + number_of(cell, corner) * 2;
        return joined(halves[0], halves[1]);
      }

      double mass(const std::uint64_t cell, const unsigned int corner) const
      {
        return motion[number_of(cell, corner) * (dim + 1)];
      }

      dealii::Tensor<1, dim> velocity(const std::uint64_t cell, const unsigned int corner) const
      {
        return Tensor<1, dim>(dealii::ArrayView<const double>(
            motion.data() + number_of(cell, corner) * (dim + 1) + 1, dim));
      }
    };

    VisibleCells find_cells(const Model<dim> &model, const unsigned int part, StateArchive &archive)
    {
      constexpr unsigned int n_corners = GeometryInfo<dim>::vertices_per_cell;
      VisibleCells result;
      for (const auto &cell : model.nodes->dof_handler().active_cell_iterators())
      {
        if (cell->is_artificial() || model.part_cells->part_of(cell) != part)
          continue;
        result.cells.push_back(cell);
        const std::uint64_t id = persistent_id(cell->id(), dim);
        result.ids.insert(result.ids.end(), {id, parent_of<dim>(id)});
        for (unsigned int child = 0; child < n_corners; ++child)
          result.ids.push_back(child_of<dim>(id, child));
      }
      std::sort(result.ids.begin(), result.ids.end());
      result.ids.erase(std::unique(result.ids.begin(), result.ids.end()), result.ids.end());
      const ArchiveLookup lookup = archive.find_rows(result.ids);
      result.numbers = archive.rows(lookup, "nodes", 2 * n_corners);
      if (model.has_mechanics)
        result.motion = archive.rows(lookup, "motion", (dim + 1) * n_corners);
      std::string problem;
      for (const auto &cell : result.cells)
      {
        const std::uint64_t id = persistent_id(cell->id(), dim);
        CellSource source;
        if (lookup.has(result.number_of(id)))
          source = {CellSource::Kind::same, {id}};
        else if (lookup.has(result.number_of(parent_of<dim>(id))))
          source = {CellSource::Kind::parent, {parent_of<dim>(id)}};
        else
        {
          source.kind = CellSource::Kind::children;
          for (unsigned int child = 0; child < n_corners; ++child)
          {
            source.ids.push_back(child_of<dim>(id, child));
            if (!lookup.has(result.number_of(source.ids.back())))
              problem =
                  "Of the cell at " + position_text(cell->center()) + " the part \"" +
                  model.parts[part].name +
                  "\" has another piece after a change of the mesh: let regions of `Cells` end "
                  "where cells of the mesh end.";
          }
        }
        result.sources.push_back(source);
      }
      throw_on_all_ranks<InputError>(problem, model.communicator);
      return result;
    }

    void find_nodes(const Model<dim> &model, const std::vector<VisibleCells> &visible)
    {
      const IndexSet &owned = model.nodes->owned();
      node_sources.resize(owned.n_elements());
      // Of candidates the one that has the node itself, then that of the first cell.
      std::vector<std::uint64_t> chosen(owned.n_elements(), ~std::uint64_t(0));
      std::vector<types::global_dof_index> nodes;
      for (const VisibleCells &part_cells : visible)
        for (std::size_t c = 0; c < part_cells.cells.size(); ++c)
        {
          const std::uint64_t id = persistent_id(part_cells.cells[c]->id(), dim);
          const CellSource &source = part_cells.sources[c];
          model.nodes->cell_nodes(part_cells.cells[c], nodes);
          for (unsigned int k = 0; k < nodes.size(); ++k)
          {
            if (!owned.is_element(nodes[k]))
              continue;
            const auto i = owned.index_within_set(nodes[k]);
            const std::vector<CornerSource> corners =
                source.kind == CellSource::Kind::same ? std::vector<CornerSource>{{0, k, 1.}}
                : source.kind == CellSource::Kind::children
                    ? std::vector<CornerSource>{{k, k, 1.}}
                    : corner_of_child<dim>(index_in_parent<dim>(id), k);
            const std::uint64_t order = corners.size() == 1 ? 0 : id + 1;
            if (order >= chosen[i])
              continue;
            chosen[i] = order;
            node_sources[i].clear();
            for (const CornerSource &corner : corners)
              node_sources[i].push_back(
                  {part_cells.node(source.ids[corner.cell], corner.corner), corner.weight});
            std::sort(node_sources[i].begin(), node_sources[i].end(),
                      [](const RowSource &a, const RowSource &b) { return a.id < b.id; });
          }
        }
    }

    void find_momentum(const Model<dim> &model, const std::vector<VisibleCells> &visible)
    {
      constexpr unsigned int n_corners = GeometryInfo<dim>::vertices_per_cell;
      // Each node within joined cells counts once, in the first of them; not where it remains
      // an unknown.
      std::map<std::uint64_t, std::uint64_t> first_cell;
      std::set<std::uint64_t> free;
      for (std::size_t p = 0; p < visible.size(); ++p)
      {
        const bool are_free = model.parts[p].formulation->middle_nodes() == MiddleNodes::free;
        for (std::size_t c = 0; c < visible[p].cells.size(); ++c)
        {
          const CellSource &source = visible[p].sources[c];
          if (source.kind == CellSource::Kind::same && are_free)
            for (unsigned int k = 0; k < n_corners; ++k)
              free.insert(visible[p].node(source.ids[0], k));
          if (source.kind != CellSource::Kind::children)
            continue;
          const std::uint64_t id = persistent_id(visible[p].cells[c]->id(), dim);
          for (const std::uint64_t child : source.ids)
            for (unsigned int k = 0; k < n_corners; ++k)
            {
              const auto found = first_cell.emplace(visible[p].node(child, k), id).first;
              found->second = std::min(found->second, id);
            }
        }
      }
      std::vector<types::global_dof_index> nodes;
      for (const VisibleCells &part_cells : visible)
        for (std::size_t c = 0; c < part_cells.cells.size(); ++c)
        {
          const CellSource &source = part_cells.sources[c];
          if (source.kind != CellSource::Kind::children || !part_cells.cells[c]->is_locally_owned())
            continue;
          const std::uint64_t id = persistent_id(part_cells.cells[c]->id(), dim);
          model.nodes->cell_nodes(part_cells.cells[c], nodes);
          std::set<std::uint64_t> counted;
          for (unsigned int child = 0; child < n_corners; ++child)
            for (unsigned int k = 0; k < n_corners; ++k)
            {
              const std::uint64_t node = part_cells.node(source.ids[child], k);
              if (child == k || first_cell.at(node) != id || free.count(node) > 0 ||
                  !counted.insert(node).second)
                continue;
              const std::vector<CornerSource> corners = corner_of_child<dim>(child, k);
              Tensor<1, dim> excess = part_cells.velocity(source.ids[child], k);
              for (const CornerSource &corner : corners)
                excess -=
                    corner.weight * part_cells.velocity(source.ids[corner.corner], corner.corner);
              for (const CornerSource &corner : corners)
                momenta.emplace_back(nodes[corner.corner],
                                     corner.weight * part_cells.mass(source.ids[child], k) *
                                         excess);
            }
        }
    }

    RowSources node_sources;
    /** What corners of owned joined cells receive, by global numbers [M L/T]. */
    std::vector<std::pair<dealii::types::global_dof_index, dealii::Tensor<1, dim>>> momenta;
    std::vector<PointTransfer<dim>> points; ///< of each part
  };
} // namespace tombolo
