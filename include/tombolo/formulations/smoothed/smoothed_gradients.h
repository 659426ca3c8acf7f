// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/convex_approximation.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/smoothed/sub_cells.h>
#include <tombolo/materials/temperature_table.h>

#include <deal.II/base/index_set.h>

#include <memory>
#include <vector>

namespace tombolo
{
  template <int dim>
  class CellSurroundings;
  template <int dim>
  struct SmoothedRow;

  /**
   * The gradients of convex approximation at the points of the cells of one part, in the initial
   * configuration. With `Integration = smoothed` point q is a sub-cell of the volume V_q, and
   *
   * @verbatim
   *   G_qJ = 1/V_q Σ_T A_T Ψ_J(x_T)
   * @endverbatim
   *
   * with area vectors A_T and centroids x_T of its facets T. On the boundary of the part, towards
   * other parts too, Ψ is the linear interpolation of the nodes of the face. So Σ_J G_qJ = 0,
   * Σ_J x_J ⊗ G_qJ = 1, and Σ_q V_q G_qJ is the area vector of node J on the boundary, that of
   * linear elements: the patch test is passed, also beside elements. The other rule has ∇Ψ_J at the
   * middle of a cell, and passes it on lattices only.
   *
   * Points are in the order of CellPoints: point q of cell c is number (c / n_lanes · n_points + q)
   * · n_lanes + c % n_lanes, where void cells are not counted; unused lanes of the last batch
   * repeat the last cell. A support ends where its body ends.
   */
  template <int dim>
  class SmoothedGradients
  {
  public:
    /** Throws InputError. */
    explicit SmoothedGradients(const Entries &e);

    SmoothedIntegrationRule integration_rule() const
    {
      return rule;
    }

    unsigned int n_points_per_cell() const
    {
      return static_cast<unsigned int>(shares_of_points.size());
    }

    /** Computes the rows. Throws the InputError of a cell without a positive volume, or of a point
     * outside of the hull of its neighbours; then they stay. With @p position, whose ghosts are
     * current, that is the reference configuration, and functions have the weights of the initial
     * one (ConvexApproximation::evaluate_moved()); null: the initial one. Collective. */
    void initialize(const PartSetup<dim> &setup, const NodalVector *position = nullptr);

    /** Makes required_nodes() those of all positions that initialize() can get; before it. */
    void prepare_positions()
    {
      can_move = true;
    }

    /** Gradients at points: rows are the points, particle_node a node of their cell. */
    const Stencils &stencils() const
    {
      return rows;
    }

    /** V_q of each point, padding included [L^dim]. */
    const std::vector<double> &volumes() const
    {
      return point_volumes;
    }

    /** The shares of the corners of its cell (lexicographic) in the position of each point. */
    const std::vector<std::vector<double>> &corner_shares() const
    {
      return shares_of_points;
    }

    /** Formulation::add_conduction(): -Σ_q V_q k ∇θ · ∇φ with the gradients carried to the present
     * @p position, and k at the mean of the corners of each point. */
    void add_conduction(const CellBatches<dim> &cells, const TemperatureTable &conductivity,
                        const NodalVector &position, const NodalVector &conductivity_temperature,
                        const NodalVector &temperature, NodalVector &heat_rate) const;

    /** Formulation::find_couplings(): a cell acts on all neighbours of its points. */
    void find_couplings(unsigned int n_cells, const NodeGroupAction &use) const;

    const dealii::IndexSet &required_nodes() const
    {
      return node_set;
    }
    void set_partition(const NodePartition &partition);

  private:
    void find_node_set(const std::vector<SmoothedRow<dim>> &rows_of_cells,
                       dealii::types::global_dof_index n_nodes);

    /** Puts rows of cells into the order of points. @p first_node has a node of each cell. */
    void arrange(const std::vector<SmoothedRow<dim>> &rows_of_cells,
                 const std::vector<dealii::types::global_dof_index> &first_node);

    double dilation;
    SmoothedIntegrationRule rule;
    std::shared_ptr<const Kernel> kernel;
    bool can_move = false;
    std::shared_ptr<const CellSurroundings<dim>> surroundings; // kept where positions can move
    std::vector<std::vector<double>> shares_of_points;

    Stencils rows;
    std::vector<double> point_volumes;
    std::vector<dealii::types::global_dof_index> neighbour_nodes; // as Stencils::neighbour
    std::vector<dealii::types::global_dof_index> row_nodes;       // as Stencils::particle_node
    dealii::IndexSet node_set;
  };
} // namespace tombolo
