// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/formulations/elements/grouped_cells.h>
#include <tombolo/state/nodal_vector.h>

#include <cstddef>
#include <functional>
#include <vector>

namespace tombolo
{
  template <int dim>
  class Model;

  /**
   * The cells of a model that take longer steps than its nodes do, each a power of two of them, its
   * ratio r. Nodes move in each step. The forces of a group of cells act for r steps, as they are
   * where the nodes are in the mean over these: x̄ = x + (r - 1)/2 Δt v + r²/8 Δt² a, with the
   * acceleration a by the forces of the groups with shorter steps. Between two of these, for a
   * ratio of two and a linear force, x̄ is the mean of x_n and of x_{n+1} without the force, and
   * the force is spread as the mean is taken: the step is symplectic. Linear momentum is kept by
   * each cell. All groups act together in the first step of each cycle.
   *
   * With ratios of one only there are no groups, and all is as without this class.
   */
  template <int dim>
  class StepGroups
  {
  public:
    /** The forces of a part's cells of one ratio. */
    struct Share
    {
      std::size_t part;
      std::vector<unsigned int> nodes; ///< owned, that have them
      NodalVector force;               ///< at owned nodes [M L/T^2]
      NodalVector last_force;          ///< that before
    };

    /** The state and the forces of the cells of one ratio. */
    struct Group
    {
      unsigned int ratio = 1;
      NodalVector position; ///< x̄, at which the forces act, at nodes of the cells [L]
      std::vector<Share> shares;
      std::vector<unsigned int> owned; ///< nodes that these cells move with
      std::vector<unsigned int> local; ///< nodes of these cells
      double age = 0; ///< of `position`, in steps; of a mean in the future less than zero
    };

    std::vector<Group> groups; ///< of ratios above one, ascending
    /** Of each part of the model; null: all of its cells take each step. Empty: so do all parts. */
    std::vector<GroupedCells<dim> *> parts;
    NodalVector fast_nodes; ///< owned ones whose cells are to take each step: one, scalar
    unsigned int step_in_cycle = 0;
    double first_step = 0; ///< about the step to come, at the start [T]

    /** Steps in a cycle. */
    unsigned int cycle() const
    {
      return groups.empty() ? 1 : groups.back().ratio;
    }

    /** Makes the groups of the ratios that the parts have now; all cells have the stresses of the
     * present positions. Collective. */
    void make(const Model<dim> &model);

    /** Finds stresses of all cells at the present positions, by the present smoothed velocity. */
    void synchronize(const Model<dim> &model, const Clock &clock, const NodalVector *temperature);

    /** Leaves in @p cells of a part, by its number, those that take each step: these can leave it
     * now. Others are to take each step from the next cycle on. Returns whether no rank has others.
     * Collective. */
    bool keep_ready(const Model<dim> &model, std::size_t part, std::vector<unsigned int> &cells);

    /** For another partition, or other values of owned nodes. Collective. */
    void set_partition(const Model<dim> &model);

    /** Formulation::add_internal_force() of those cells of a part, by its number, that take each
     * step. */
    void add_internal_force(std::size_t part, Formulation<dim> &formulation,
                            const MechanicalInput &input, NodalVector &force) const;

    /** Calls a function that evaluates cells of a part, by its number, and checks for failures. */
    using Evaluation = std::function<void(std::size_t, const std::function<void()> &)>;

    /** Adds the forces of all other cells to @p force, at owned nodes. Collective. */
    void add_further_forces(const Model<dim> &model, const Clock &clock,
                            const NodalVector *temperature, const Evaluation &evaluate,
                            NodalVector &force);

    /** Formulation::apply_elastic_stiffness() of a part, with each cell in its own step, such that
     * the largest eigenvalue bounds @p time_step, the shortest. */
    void apply_elastic_stiffness(std::size_t part, const Formulation<dim> &formulation,
                                 const NodalVector &position, const NodalVector &velocity,
                                 double time_step, NodalVector &force) const;

    /** The nodes have moved for a step. */
    void complete_step();

    /** What the energies of the cells have more at the present positions of nodes than where they
     * act, to second order, of this rank [M L^2/T^2]. */
    double work_ahead(const NodalVector &position) const;

  private:
    void act(const Model<dim> &model, const Clock &clock, const NodalVector *temperature,
             const Evaluation &evaluate, const NodalVector &shorter, Group &group);

    GroupedCells<dim> *cells_of(const std::size_t part) const
    {
      return part < parts.size() ? parts[part] : nullptr;
    }

    NodalVector next, velocity; // buffers
    bool is_synchronized = false;
  };
} // namespace tombolo
