// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/nodes.h>
#include <tombolo/model/point_transfer.h>
#include <tombolo/state/archive_rows.h>

#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace tombolo
{
  template <int dim>
  class Model;
  class StateArchive;

  /**
   * From which nodes and cells of an archive those of a model are made, whose mesh is another
   * division of the same cells: cells of the model are cells there, children of such or their
   * parents. Nodes that both meshes have are taken as they are; a new node is the mean of those
   * between which it lies. Works on any number of ranks.
   */
  template <int dim>
  class MeshTransfer
  {
  public:
    /** Writes what the constructor needs. The rows of the archive are those of no part. Collective.
     */
    static void write(Model<dim> &model, StateArchive &archive);

    /** Finds sources of all nodes and cells of @p model. Collective. */
    MeshTransfer(const Model<dim> &model, StateArchive &archive);

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
    void settle_volumes(const Model<dim> &model, const NodalVector &position) const
    {
      for (const PointTransfer<dim> &of_part : points)
        of_part.settle_volumes(model, position);
    }

    /** Gives the nodes of joined cells the momentum of nodes that are no unknowns any more, and
     * that those have not taken with them; to be called when the state has been read. What
     * prescribed components would get is lost. Collective. */
    void restore_momentum(Model<dim> &model) const;

  private:
    /** Cells of a part that this rank sees, and what they are made of. */
    struct VisibleCells
    {
      std::vector<typename Nodes<dim>::Cell> cells;
      std::vector<CellSource> sources;
      std::vector<std::uint64_t> ids; ///< of the archive that can be wanted, ascending
      std::vector<double> numbers;    ///< identifiers of the nodes of these, in halves
      std::vector<double> motion;     ///< masses and velocities of their nodes

      std::size_t number_of(std::uint64_t id) const;
      std::uint64_t node(std::uint64_t cell, unsigned int corner) const;
      double mass(std::uint64_t cell, unsigned int corner) const;
      dealii::Tensor<1, dim> velocity(std::uint64_t cell, unsigned int corner) const;
    };

    VisibleCells find_cells(const Model<dim> &model, unsigned int part, StateArchive &archive);
    void find_nodes(const Model<dim> &model, const std::vector<VisibleCells> &visible);
    void find_momentum(const Model<dim> &model, const std::vector<VisibleCells> &visible);

    RowSources node_sources;
    /** What corners of owned joined cells get, by global numbers [M L/T]. */
    std::vector<std::pair<dealii::types::global_dof_index, dealii::Tensor<1, dim>>> momenta;
    std::vector<PointTransfer<dim>> points; ///< of each part
  };
} // namespace tombolo
