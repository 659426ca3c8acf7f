// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/archive_rows.h>
#include <tombolo/state/field.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace tombolo
{
  template <int dim>
  class Model;
  class StateArchive;

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
    static void write(const Model<dim> &model, unsigned int part, StateArchive &archive);

    /** @p cells are the owned ones of the part, in their order; the group of the archive is that of
     * write(). Collective. */
    PointTransfer(const Model<dim> &model, unsigned int part, std::vector<CellSource> cells,
                  StateArchive &archive);

    /** Reads the points. The group of the archive is that of the part. Collective. */
    void read(const Model<dim> &model, StateArchive &archive) const;

    /** Gives new points the volumes that they have at @p position, that of their state, with the
     * integrals of what is held. */
    void settle_volumes(const Model<dim> &model, const NodalVector &position) const;

  private:
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
      std::map<std::pair<std::size_t, unsigned int>, double> taken;
    };

    void find_points(const Model<dim> &model);

    std::size_t number_of(const std::uint64_t id) const
    {
      return static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
    }

    /** @p old are the values of the field at all points of the cells of the archive. */
    double value_of_point(unsigned int row, unsigned int q, unsigned int component,
                          const FieldDescription &field, const std::vector<double> &old) const;
    /** Gives points of new cells the gradient that the means of stress at nodes have; the mean of
     * those that are made of one point stays. */
    void add_gradient_of_stress(const Model<dim> &model) const;

    unsigned int part;
    unsigned int n_points = 0; ///< of a cell; zero: the part has none
    std::vector<CellSource> cells;
    // Of the archive, in the order of the identifiers.
    std::vector<std::uint64_t> ids;
    std::vector<double> places, volumes, corner_stress; ///< initial places and volumes of points
    Points sources;
  };

  /** The stress of @p parts at nodes, with ghosts: the mean by volume of their cells around them,
   * by components, zero elsewhere. Collective. */
  template <int dim>
  std::array<NodalVector, 6> stress_at_nodes(const Model<dim> &model,
                                             const std::vector<unsigned int> &parts);
} // namespace tombolo
