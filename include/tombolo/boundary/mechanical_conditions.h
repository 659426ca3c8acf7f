// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/boundary/load_sum.h>
#include <tombolo/boundary/mechanical_condition.h>
#include <tombolo/boundary/tributary_areas.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_state.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The mechanical conditions of a model, one section "Condition: NAME" each: tractions, pressures,
   * body forces and gravity, which give loads that act at positions, and velocities, displacements
   * and clamps, which prescribe components of the motion. Named boundaries or a predicate of the
   * initial position select nodes and faces. Functions are of the initial position and of time.
   */
  template <int dim>
  class MechanicalConditions
  {
  public:
    /** Declares the section of one condition; the handler is in it. */
    static void declare_parameters(const Entries &e);

    /** Reads the section of one condition, and refuses what can be seen to be wrong without a mesh.
     */
    static void validate(const Section &section);

    /** Reads the sections "Condition: NAME" and finds their nodes and faces. Throws InputError, for
     * example where a condition selects nothing. Collective. */
    MechanicalConditions(const std::vector<Section> &sections, const Mesh<dim> &mesh,
                         const Nodes<dim> &nodes);
    ~MechanicalConditions();

    /** Nodes whose values this rank needs: those of its loaded faces. */
    dealii::IndexSet required_nodes() const;

    /** Translates node numbers to those of @p partition. */
    void set_partition(const NodePartition &partition);

    /** Tractions no longer act on the faces of these cells, each given by its nodes.
     * set_partition() must follow. */
    void
    remove_faces(const std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells);

    /** A bit per component of each owned node that is prescribed; empty where nothing is. */
    const std::vector<std::uint8_t> &constrained_components() const;

    bool has_loads() const;
    bool has_constraints() const;

    /** Owned nodes at which loads can act. Collective. */
    std::vector<unsigned int> loaded_nodes(const NodalState &state) const;

    /** Loads at positions (force per node) at @p time: ∫ t over the tributary part of the faces in
     * their current positions (s_k of doc/method.md, section 5), -p ∫ n of a pressure likewise, m b
     * for body forces, where m is @p body_mass (scalar). Owned values are complete. @p loads is
     * zeroed; @p sums are this rank's shares of each condition, by number, with the moments of
     * forces at @p places (current ghosts). Where @p take_alone is given it is called with the
     * number of each load and its own loads, whose owned values are complete. Collective.
     */
    void compute_loads(const NodalState &state, double time, const NodalVector &places,
                       NodalVector &loads, std::vector<LoadSum> &sums, const NodalVector &body_mass,
                       const std::function<void(unsigned int condition, const NodalVector &loads)>
                           &take_alone = {}) const;

    /** Sets the constrained components of the acceleration to (v_p - v̂)/Δt_n, where v_p is the
     * prescribed velocity of the coming interval, from @p time to @p time + @p position_time_step.
     * For a displacement v_p reaches the prescribed place at its end. */
    void prescribe_acceleration(NodalState &state, double time, double velocity_time_step,
                                double position_time_step) const;

    /** Sets the constrained components of v̂ to the prescribed velocity at @p time; that of a
     * displacement is its rate over the short @p interval after it. Ghosts are current then.
     * Collective. */
    void prescribe_initial_velocity(NodalState &state, double time, double interval) const;

    /** The first failure on this rank, empty for none: a function without a finite
     * value. Loads and prescribed values are not complete then. Not agreed among ranks. */
    const std::string &failure() const;

    /** Owned nodes with prescribed components (global numbers); known from the beginning. */
    dealii::IndexSet prescribed_nodes() const;

    /** Owned constrained nodes (local numbers). */
    const std::vector<unsigned int> &constrained_nodes() const;

    /** The number of the condition that prescribes a component of a node, by its place in
     * constrained_nodes(); -1: none. */
    int prescribing_condition(std::size_t constrained_node, unsigned int component) const;

    /** All conditions, by their number. */
    const std::vector<MechanicalCondition<dim>> &all() const;

    /** A component of an owned node that two conditions prescribe; the later one acts. */
    struct Overlap
    {
      unsigned int earlier, later; ///< numbers of conditions
      unsigned int component;
      dealii::Point<dim> point; ///< the initial position
    };
    const std::vector<Overlap> &overlaps() const;

  private:
    struct Constraint
    {
      dealii::types::global_dof_index global_node;
      unsigned int node;
      std::array<int, dim> condition; ///< which prescribes the component, or -1
    };

    struct Selection;
    using Cell = typename dealii::DoFHandler<dim>::active_cell_iterator;

    /** Adds the nodes and faces of a cell that conditions select, tractions to `areas`. */
    void select(const Nodes<dim> &nodes, const Cell &cell, Selection &selection);
    void select_node(dealii::types::global_dof_index node, const dealii::Point<dim> &point,
                     unsigned int c, Selection &selection) const;
    /** Makes condition @p c that of a component, unless a later one has it. */
    static void prescribe(unsigned int c, unsigned int component, const dealii::Point<dim> &point,
                          Constraint &constraint, Selection &selection);
    void add_surface_forces(unsigned int c, const NodalState &state, double time,
                            const NodalVector &places, NodalVector &loads, LoadSum &sum,
                            NodalVector *alone) const;
    void add_body_forces(const MechanicalCondition<dim> &condition, const NodalState &state,
                         const NodalVector &mass, double time, const NodalVector &places,
                         NodalVector &loads, LoadSum &sum, NodalVector *alone) const;
    /** Does @p action; a RunError of it becomes the failure() of this rank. */
    void evaluate(const std::function<void()> &action) const;

    std::vector<MechanicalCondition<dim>> conditions;
    mutable std::string local_failure;
    mutable NodalVector loads_alone;   ///< of one condition; only where they are asked for
    mutable TributaryAreas<dim> areas; ///< by condition, of tractions
    std::vector<Constraint> constraints;
    std::vector<Overlap> overlapping;
    std::vector<unsigned int> constraint_nodes;
    std::vector<std::uint8_t> constrained;
    dealii::IndexSet owned;
  };
} // namespace tombolo
