// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/cell_divisions.h>
#include <tombolo/model/model.h>
#include <tombolo/state/archive_rows.h>
#include <tombolo/state/field.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/fe/mapping_q1.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace tombolo
{
  /** The stress of @p parts at nodes, with ghosts: the mean by volume of their cells around them,
   * by components, zero elsewhere. Collective. */
  template <int dim>
  std::array<NodalVector, 6> stress_at_nodes(const Model<dim> &model,
                                             const std::vector<unsigned int> &parts)
  {
    const auto &partition = model.state.partition();
    std::array<NodalVector, 6> result;
    for (NodalVector &component : result)
      component.reinit(partition, Quantity::scalar);
    const auto add = [&](NodalVector &volumes)
    {
      std::vector<types::global_dof_index> nodes;
      for (const unsigned int part : parts)
      {
        const Formulation<dim> &formulation = *model.parts[part].formulation;
        const MaterialPoints &points = formulation.points();
        unsigned int row = 0;
        for (const auto &cell : cells_of_part(*model.nodes, *model.part_cells, part))
        {
          model.nodes->cell_nodes(cell, nodes);
          for (unsigned int q = 0; q < formulation.n_points_per_cell(); ++q)
          {
            const unsigned int i = formulation.point_of_cell(row, q);
            const double volume = points.component(MaterialPoints::volume, 0)[i];
            for (const auto node : nodes)
            {
              const unsigned int local = partition->local_index(node);
              *volumes.node(local) += volume;
              for (unsigned int c = 0; c < 6; ++c)
                *result[c].node(local) += volume * points.component(MaterialPoints::stress, c)[i];
            }
          }
          ++row;
        }
      }
    };
    const NodalVector volumes = sums_at_owners(partition, Quantity::scalar, add);
    for (NodalVector &component : result)
    {
      component.add_to_owners(); // with those of the volumes they were added up
      component.fill(
          [&](const unsigned int i, double *const stress)
          {
            if (*volumes.node(i) > 0.)
              *stress /= *volumes.node(i);
          });
    }
    return result;
  }

  /** The cells of an archive that a cell of this rank is made of. */
  struct CellSource
  {
    enum class Kind
    {
      same,
      parent,
      children
    };
    Kind kind = Kind::same;
    std::vector<std::uint64_t> ids;
  };

  /**
   * The material points of a part whose cells are made of those of an archive (MeshTransfer). Cells
   * that both meshes have keep their points as they are; others take theirs from the nearest points
   * of the parent, with the gradient that the stress has there, or the mean of those of the
   * children.
   */
  template <int dim>
  class PointTransfer
  {
  public:
    /** Writes what the constructor needs; the rows of the archive are the cells of the part.
     * Collective. */
    static void write(const Model<dim> &model, const unsigned int part, StateArchive &archive)
    {
      const Formulation<dim> &formulation = *model.parts[part].formulation;
      const unsigned int n_points = model.has_mechanics ? formulation.n_points_per_cell() : 0;
      if (n_points == 0)
        return;
      const std::array<NodalVector, 6> stress = stress_at_nodes(model, {part});
      std::vector<double> positions, volumes, corner_stress;
      std::vector<types::global_dof_index> nodes;
      unsigned int row = 0;
      for (const auto &cell : cells_of_part(*model.nodes, *model.part_cells, part))
      {
        model.nodes->cell_nodes(cell, nodes);
        for (const auto node : nodes)
          for (const NodalVector &component : stress)
            corner_stress.push_back(*component.node(model.state.partition()->local_index(node)));
        for (unsigned int q = 0; q < n_points; ++q)
        {
          const unsigned int i = formulation.point_of_cell(row, q);
          for (unsigned int d = 0; d < dim; ++d)
            positions.push_back(formulation.initial_point_positions()[i][d]);
          volumes.push_back(initial_volume(formulation.points(), i));
        }
        ++row;
      }
      archive.rows("places of points", n_points * dim, positions);
      archive.rows("initial volumes of points", n_points, volumes);
      archive.rows("stress at corners", 6 * GeometryInfo<dim>::vertices_per_cell, corner_stress);
    }

    /** @p cells are the owned ones of the part, in their order; the group of the archive is that of
     * write(). Collective. */
    PointTransfer(const Model<dim> &model, const unsigned int part,
                  std::vector<CellSource> cells_of_part, StateArchive &archive)
        : part(part),
          n_points(model.has_mechanics ? model.parts[part].formulation->n_points_per_cell() : 0),
          cells(std::move(cells_of_part))
    {
      if (n_points == 0)
        return;
      for (const CellSource &source : cells)
        ids.insert(ids.end(), source.ids.begin(), source.ids.end());
      std::sort(ids.begin(), ids.end());
      ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
      const ArchiveLookup lookup = archive.find_rows(ids);
      positions = archive.rows(lookup, "places of points", n_points * dim);
      volumes = archive.rows(lookup, "initial volumes of points", n_points);
      corner_stress =
          archive.rows(lookup, "stress at corners", 6 * GeometryInfo<dim>::vertices_per_cell);
      find_points(model);
    }

    /** Reads the points. The group of the archive is that of the part. Collective. */
    void read(const Model<dim> &model, StateArchive &archive) const
    {
      Formulation<dim> &formulation = *model.parts[part].formulation;
      MaterialPoints &points = formulation.points();
      if (n_points == 0)
        return;
      const auto n_rows = static_cast<unsigned int>(cells.size());
      const ArchiveLookup lookup = archive.find_rows(ids);
      for (unsigned int f = 0; f < points.fields().size(); ++f)
      {
        const FieldDescription &field = points.fields()[f];
        if (!field.persistent)
          continue;
        const std::vector<double> old =
            archive.rows(lookup, field.name, n_points * field.n_components);
        for (unsigned int row = 0; row < n_rows; ++row)
          for (unsigned int q = 0; q < n_points; ++q)
            for (unsigned int c = 0; c < field.n_components; ++c)
              points.component(f, c)[formulation.point_of_cell(row, q)] =
                  value_of_point(row, q, c, field, old);
        if (f == MaterialPoints::stress)
          add_gradient_of_stress(model);
        if (f != MaterialPoints::volume)
          formulation.fill_unused_lanes(f);
      }
      // The volume of a new point is that of its part of the cell, with the compression that it
      // has.
      for (unsigned int row = 0; row < n_rows; ++row)
        for (unsigned int q = 0; q < n_points; ++q)
          if (cells[row].kind != CellSource::Kind::same)
          {
            const unsigned int i = formulation.point_of_cell(row, q);
            points.component(MaterialPoints::volume, 0)[i] =
                sources.volume[row * n_points + q] *
                points.component(MaterialPoints::volume_ratio, 0)[i];
          }
    }

    /** Sets the volumes of new points at @p position, that of their state, with the
     * integrals of what is held. */
    void update_volumes(const Model<dim> &model, const NodalVector &position) const
    {
      if (n_points == 0)
        return;
      Formulation<dim> &formulation = *model.parts[part].formulation;
      MaterialPoints &points = formulation.points();
      std::vector<bool> are_new(points.size(), false);
      const auto for_new_points = [&](const auto &visit)
      {
        for (unsigned int row = 0; row < cells.size(); ++row)
          for (unsigned int q = 0; q < n_points && cells[row].kind != CellSource::Kind::same; ++q)
            visit(formulation.point_of_cell(row, q), sources.from[std::size_t(row) * n_points + q],
                  cells[row].kind);
      };
      for_new_points([&](const unsigned int i, const auto &, CellSource::Kind)
                     { are_new[i] = true; });
      formulation.find_volumes(position, are_new);
      // A volume at these positions over a volume ratio is not quite the initial volume.
      std::map<std::pair<std::size_t, unsigned int>, double> volume_sum;
      for_new_points(
          [&](const unsigned int i, const std::vector<PointSource> &from,
              const CellSource::Kind kind)
          {
            if (kind == CellSource::Kind::parent)
              volume_sum[{from[0].cell, from[0].point}] += initial_volume(points, i);
          });
      for_new_points(
          [&](const unsigned int i, const std::vector<PointSource> &from,
              const CellSource::Kind kind)
          {
            double before = 0;
            for (const PointSource &source : from)
              before += volumes[source.cell * n_points + source.point];
            const double now = kind == CellSource::Kind::parent
                                   ? volume_sum.at({from[0].cell, from[0].point})
                                   : initial_volume(points, i);
            for (unsigned int f = 0; f < points.fields().size(); ++f)
              if (points.fields()[f].on_division == OnDivision::held)
                for (unsigned int c = 0; c < points.fields()[f].n_components; ++c)
                  points.component(f, c)[i] *= before / now;
          });
      for (unsigned int f = 0; f < points.fields().size(); ++f)
        if (points.fields()[f].on_division == OnDivision::held)
          formulation.fill_unused_lanes(f);
    }

  private:
    /** The initial volume of a point. */
    static double initial_volume(const MaterialPoints &points, const unsigned int i)
    {
      return points.component(MaterialPoints::volume, 0)[i] /
             points.component(MaterialPoints::volume_ratio, 0)[i];
    }

    /** The nearest of @p n_candidates positions; of those at the same distance the first. */
    template <typename PositionOf>
    static unsigned int nearest(const Point<dim> &to, const unsigned int n_candidates,
                                const PositionOf &position_of)
    {
      unsigned int result = 0;
      double smallest = position_of(0).distance(to);
      for (unsigned int q = 1; q < n_candidates; ++q)
        if (const double distance = position_of(q).distance(to); distance < (1. - 1e-9) * smallest)
        {
          smallest = distance;
          result = q;
        }
      return result;
    }

    /** A point of the archive: the number of its cell among those of the archive, and its share in
     * a mean. */
    struct PointSource
    {
      std::size_t cell;
      unsigned int point;
      double share;
    };

    /** Of the points of a part, cell by cell, those that they are made of. */
    struct Points
    {
      std::vector<std::vector<PointSource>> from;
      std::vector<double> volume; ///< initial ones
      /** The sum of the initial volumes of the points that are made of one. */
      std::map<std::pair<std::size_t, unsigned int>, double> volume_sum;
    };

    void find_points(const Model<dim> &model)
    {
      const Formulation<dim> &formulation = *model.parts[part].formulation;
      const auto old_position = [&](const std::size_t cell, const unsigned int q)
      {
        return Point<dim>(Tensor<1, dim>(
            dealii::ArrayView<const double>(positions.data() + (cell * n_points + q) * dim, dim)));
      };
      sources.from.resize(cells.size() * n_points);
      sources.volume.resize(sources.from.size());
      for (unsigned int row = 0; row < cells.size(); ++row)
      {
        const CellSource &source = cells[row];
        const auto new_position = [&](const unsigned int q)
        { return formulation.initial_point_positions()[formulation.point_of_cell(row, q)]; };
        for (unsigned int q = 0; q < n_points; ++q)
          sources.volume[row * n_points + q] =
              initial_volume(formulation.points(), formulation.point_of_cell(row, q));
        if (source.kind == CellSource::Kind::children)
          for (const std::uint64_t id : source.ids)
            for (unsigned int r = 0; r < n_points; ++r)
            {
              const std::size_t cell = number_of(id);
              const unsigned int q = nearest(old_position(cell, r), n_points, new_position);
              sources.from[row * n_points + q].push_back({cell, r, volumes[cell * n_points + r]});
            }
        else
          for (unsigned int q = 0; q < n_points; ++q)
          {
            const std::size_t cell = number_of(source.ids[0]);
            const unsigned int r = source.kind == CellSource::Kind::same
                                       ? q
                                       : nearest(new_position(q), n_points,
                                                 [&](const unsigned int old_point)
                                                 { return old_position(cell, old_point); });
            sources.from[row * n_points + q].push_back({cell, r, 1.});
            sources.volume_sum[{cell, r}] += sources.volume[row * n_points + q];
          }
        for (unsigned int q = 0; q < n_points; ++q)
        {
          double sum = 0;
          for (const PointSource &point : sources.from[row * n_points + q])
            sum += point.share;
          for (PointSource &point : sources.from[row * n_points + q])
            point.share /= sum;
        }
      }
    }

    std::size_t number_of(const std::uint64_t id) const
    {
      return static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
    }

    /** @p old are the values of the field at all points of the cells of the archive. */
    double value_of_point(const unsigned int row, const unsigned int q,
                          const unsigned int component, const FieldDescription &field,
                          const std::vector<double> &old) const
    {
      const std::size_t k = std::size_t(row) * n_points + q;
      const std::vector<PointSource> &from = sources.from[k];
      const auto value_of = [&](const PointSource &source)
      { return old[(source.cell * n_points + source.point) * field.n_components + component]; };
      const CellSource::Kind kind = cells[row].kind;
      if (kind == CellSource::Kind::same)
        return value_of(from[0]);
      if (field.on_division == OnDivision::reset)
        return field.initial_value;
      double result = 0;
      for (const PointSource &source : from)
        if (field.on_division != OnDivision::shared)
          result += source.share * value_of(source);
        else if (kind == CellSource::Kind::children)
          result += value_of(source);
        else
          result += value_of(source) * sources.volume[k] /
                    sources.volume_sum.at({source.cell, source.point});
      return result;
    }

    /** Adds to points of new cells the gradient that the means of stress at nodes have; the mean of
     * those that are made of one point stays. */
    void add_gradient_of_stress(const Model<dim> &model) const
    {
      constexpr unsigned int n_corners = GeometryInfo<dim>::vertices_per_cell;
      Formulation<dim> &formulation = *model.parts[part].formulation;
      using Stress = std::array<double, 6>;
      std::vector<Stress> point_stress(sources.from.size());
      std::map<std::pair<std::size_t, unsigned int>, Stress> means; // of the points of a source
      unsigned int row = 0;
      const auto for_new_points = [&](const auto &visit)
      {
        row = 0;
        for (const auto &cell : cells_of_part(*model.nodes, *model.part_cells, part))
        {
          if (cells[row].kind == CellSource::Kind::parent)
            for (unsigned int q = 0; q < n_points; ++q)
              visit(cell, q, std::size_t(row) * n_points + q);
          ++row;
        }
      };
      for_new_points(
          [&](const auto &cell, const unsigned int q, const std::size_t k)
          {
            const Point<dim> unit_point = StaticMappingQ1<dim>::mapping.transform_real_to_unit_cell(
                cell, formulation.initial_point_positions()[formulation.point_of_cell(row, q)]);
            const unsigned int child = index_in_parent<dim>(persistent_id(cell->id(), dim));
            Point<dim> in_parent;
            for (unsigned int d = 0; d < dim; ++d)
              in_parent[d] = 0.5 * (((child >> d) & 1u) + unit_point[d]);
            const PointSource &source = sources.from[k][0];
            point_stress[k] = {};
            for (unsigned int corner = 0; corner < n_corners; ++corner)
              for (unsigned int c = 0; c < 6; ++c)
                point_stress[k][c] +=
                    GeometryInfo<dim>::d_linear_shape_function(in_parent, corner) *
                    corner_stress[(source.cell * n_corners + corner) * 6 + c];
            Stress &mean =
                means.emplace(std::make_pair(source.cell, source.point), Stress{}).first->second;
            for (unsigned int c = 0; c < 6; ++c)
              mean[c] += point_stress[k][c] * sources.volume[k] /
                         sources.volume_sum.at({source.cell, source.point});
          });
      MaterialPoints &points = formulation.points();
      for_new_points(
          [&](const auto &, const unsigned int q, const std::size_t k)
          {
            const PointSource &source = sources.from[k][0];
            for (unsigned int c = 0; c < 6; ++c)
              points.component(MaterialPoints::stress, c)[formulation.point_of_cell(row, q)] +=
                  point_stress[k][c] - means.at({source.cell, source.point})[c];
          });
    }

    unsigned int part;
    unsigned int n_points = 0; ///< of a cell; zero: the part has none
    std::vector<CellSource> cells;
    // Of the archive, in the order of the identifiers.
    std::vector<std::uint64_t> ids;
    std::vector<double> positions, volumes,
        corner_stress; ///< initial positions and volumes of points
    Points sources;
  };
} // namespace tombolo
