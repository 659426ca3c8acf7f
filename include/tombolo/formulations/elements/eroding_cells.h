// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/types.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/elements/mean_limits.h>
#include <tombolo/state/nodal_vector.h>

#include <vector>

namespace tombolo
{
  /** When a cell of elements is removed: where the mean effective plastic strain of its points, or
   * their mean damage, reaches a limit. Off unless a limit is given. */
  class ErosionCriterion : public MeanLimits
  {
  public:
    /** None. */
    ErosionCriterion() = default;
    explicit ErosionCriterion(const Entries &e);
    /** Finds the fields in @p points, which are none where the scene has no mechanics. Throws
     * InputError where the material has no such field. Does nothing if off. */
    void initialize(const MaterialPoints &points, bool has_mechanics);

  private:
    Section section;
  };

  /** The energy and the heat of cells that are removed; sums of this rank. */
  struct RemovedCells
  {
    unsigned int n_cells = 0;
    /** Stored in the cells at t_{n-1/2}, in stress and in hourglass stiffness [M L^2/T^2]. */
    double energy = 0;
    /** Of plastic work, not yet given to the nodes [M L^2/T^2]. */
    double pending_heat = 0;
  };

  /**
   * A part whose cells can be removed while the run goes on: element erosion. A removed cell makes
   * no force, has no mass, conducts no heat and does not limit the step, but it keeps its number
   * among the cells of the part. What plastic flow and viscosity have dissipated in it stays among
   * the energies of the part. Cells are removed between t_{n-1} and t_n: positions are those of
   * t_n, velocities of t_{n-1/2}, and material points still those of t_{n-1}.
   */
  template <int dim>
  class ErodingCells
  {
  public:
    virtual ~ErodingCells() = default;

    /** Whether the part has a criterion; without one nothing else is called. */
    virtual bool erodes() const = 0;

    /** The cells of this rank that fulfil the criterion, or whose volume is no longer positive at
     * these positions, or may be so before their next step; ascending. */
    virtual std::vector<unsigned int> find_failed_cells(const NodalVector &position) const = 0;

    /** Removes cells whose step ratio is one. Ghosts of both vectors must be current;
     * @p time_increment is t_n - t_{n-1}. Masses are different afterwards. */
    virtual RemovedCells remove_cells(const std::vector<unsigned int> &cells,
                                      const NodalVector &position, const NodalVector &velocity,
                                      double time_increment) = 0;

    /** Of a cell of this rank, in the order of Formulation::n_cells(). */
    virtual bool is_removed(unsigned int cell) const = 0;
    virtual unsigned int n_removed_cells() const = 0;

    /** Appends the nodes of each cell that was removed since the start. */
    virtual void add_nodes_of_removed_cells(
        std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells) const = 0;
  };
} // namespace tombolo
