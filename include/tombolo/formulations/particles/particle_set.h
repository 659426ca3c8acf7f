// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/point.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  /** Whether the nodes of a cell of the mesh, owned or ghost, are particles. */
  template <int dim>
  using CellSelection = std::function<bool(const typename Nodes<dim>::Cell &)>;

  /**
   * The particles of one part on this rank: the nodes of its cells that this rank owns, ascending
   * by their global numbers. Row i of the stencils of the part belongs to particle i. Positions,
   * volumes and supports are those of the start; masses are in the stencils (Stencils::mass).
   */
  template <int dim>
  class ParticleSet
  {
  public:
    /** Of nodes of the cells of a part that depend on others. */
    enum class DependentNodes
    {
      stay,
      give_way ///< the others have their shares of the volume, and reach each other
    };

    /**
     * Finds the particles of the cells of @p is_taken on this rank: their lumped volumes (row sums
     * of ∫ N_k dV), and half widths of supports, @p dilation times the largest distance to a node
     * of the same cell, axis by axis. Returns the masses of the particles with the density of the
     * material of @p setup [M]. Throws InputError where nodes should give way to nodes that have no
     * such cell. Collective.
     */
    std::vector<double> collect(const PartSetup<dim> &setup, double dilation,
                                const CellSelection<dim> &is_taken,
                                DependentNodes dependent_nodes = DependentNodes::stay);

    unsigned int size() const
    {
      return static_cast<unsigned int>(numbers.size());
    }

    /** Global numbers of the nodes, ascending. */
    const std::vector<dealii::types::global_dof_index> &nodes() const
    {
      return numbers;
    }

    /** The index of @p node in nodes(), or size() where it is no particle. */
    std::size_t index_of(const dealii::types::global_dof_index node) const
    {
      // Mostly all numbers of a range are there.
      const std::size_t guess =
          numbers.empty() || node < numbers.front() ? numbers.size() : node - numbers.front();
      if (guess < numbers.size() && numbers[guess] == node)
        return guess;
      const auto found = std::lower_bound(numbers.begin(), numbers.end(), node);
      return found != numbers.end() && *found == node
                 ? static_cast<std::size_t>(found - numbers.begin())
                 : numbers.size();
    }

    /** Identifiers that do not depend on the number of ranks. */
    std::vector<std::uint64_t> persistent_ids() const;

    /** @name Of each particle */
    ///@{
    const std::vector<dealii::Point<dim>> &initial_positions() const
    {
      return positions;
    }
    /** Those that are integrated with [L^dim]. */
    const std::vector<double> &initial_volumes() const
    {
      return volumes;
    }
    /** Half widths, node_stride each [L]. */
    const std::vector<double> &initial_supports() const
    {
      return supports;
    }
    void set_initial_volumes(const std::vector<double> &new_volumes)
    {
      AssertDimension(new_volumes.size(), volumes.size());
      volumes = new_volumes;
    }
    /** Sets other supports than those of the cells; the values of the pad are copied, too. */
    void set_initial_supports(const std::vector<double> &new_supports)
    {
      AssertDimension(new_supports.size(), supports.size());
      supports = new_supports;
    }
    /** Initial positions, node_stride each, zero in the pad [L]. */
    std::vector<double> padded_initial_positions() const;
    ///@}

    /** Smallest initial distance to a neighbouring node along an axis, over this rank [L]; the
     * largest number without particles. */
    double smallest_spacing() const
    {
      return spacing;
    }

    /** A partition with the ghosts @p required and @p images. Collective. */
    std::shared_ptr<const NodePartition> partition(const dealii::IndexSet &required,
                                                   const std::vector<ImageNode> &images) const;

    /** Of the mesh, particles or not. */
    const dealii::IndexSet &owned_nodes() const
    {
      return mesh_nodes->owned();
    }
    /** The volume of a particle in the whole body over that in the mesh. */
    double copies_in_whole_body(const unsigned int i) const
    {
      return mesh_nodes->images()->n_own_images(numbers[i]);
    }
    MPI_Comm communicator() const
    {
      return mpi_communicator;
    }

  private:
    const Nodes<dim> *mesh_nodes = nullptr;
    MPI_Comm mpi_communicator = MPI_COMM_NULL;
    double spacing = 0;

    std::vector<dealii::types::global_dof_index> numbers;
    std::vector<dealii::Point<dim>> positions;
    std::vector<double> volumes, supports;
  };

  extern template class ParticleSet<2>;
  extern template class ParticleSet<3>;
} // namespace tombolo
