// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/moment.h>
#include <tombolo/boundary/conditions.h>
#include <tombolo/boundary/prescribed_frame.h>
#include <tombolo/state/nodal_state.h>
#include <tombolo/state/oblique_nodes.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  enum class MechanicalConditionType
  {
    traction,   ///< force per area, in a given direction
    pressure,   ///< force per current area against the outward normal of the current face
    body_force, ///< force per mass
    gravity,    ///< the same, of everything unless a region is given
    velocity,
    displacement,
    clamp
  };

  /** Whether conditions of this type prescribe components of the motion. */
  bool prescribes(MechanicalConditionType type);

  /** Whether they act on faces of the boundary. */
  bool is_on_faces(MechanicalConditionType type);

  /** Whether they act on all of the body. */
  bool is_on_volume(MechanicalConditionType type);

  /** The content of one section "Condition: NAME" of mechanics. */
  template <int dim>
  struct MechanicalCondition
  {
    std::string name;
    MechanicalConditionType type;
    Region<dim> region;
    /** Of position and time: dim components, one of a pressure, none of a clamp. */
    std::optional<Expression<dim>> function;

    /** How the selected nodes of a displacement turn. */
    struct Turn
    {
      /** The change of a component of @p position [L] by the rotation by the angle at @p time, or
       * by its change @p since another time. The rotation is stored for further calls with the same
       * times, as for all nodes of a step. Throws RunError where the angle has no finite value. */
      double displacement(const dealii::Point<dim> &position, unsigned int component, double time,
                          std::optional<double> since = {}) const;

      Expression<dim> angle;         ///< of time [rad]
      dealii::Tensor<1, dim> centre; ///< a point of the axis [L]
      dealii::Tensor<1, 3> axis;     ///< of length one; z in two dimensions
      mutable std::optional<std::pair<double, std::optional<double>>> times_of_rotation;
      mutable dealii::Tensor<2, dim> rotation;
    };
    std::optional<Turn> turn;

    LocalAxes<dim> axes; ///< of its components

    bool has_initial_areas = false; ///< a traction per initial area, whose forces stay

    /** It acts from the one time to the other [T]. */
    double start = -std::numeric_limits<double>::infinity();
    double end = std::numeric_limits<double>::infinity();

    bool acts_at(const double time) const
    {
      return start <= time && time < end;
    }

    /** Whether it does so at some times only. */
    bool is_timed() const
    {
      return std::isfinite(start) || std::isfinite(end);
    }

    /** Whether it prescribes motion along axes of its own, or at some times only. */
    bool needs_frames() const
    {
      return prescribes(type) && (axes.are_local() || is_timed());
    }

    /** Declares the section of one condition; the handler is in it. */
    static void declare_parameters(const Entries &e);

    /** Throws InputError. */
    static MechanicalCondition read(const Section &section);

    /** Reads `Start` and `End`. Throws InputError. */
    void read_times(const Section &section);

    /** The prescribed displacement from @p initial at @p time, of a displacement: R(angle) (X - c)
     * - (X - c) where it turns, and the function [L]; components are along the axes. Throws
     * RunError. */
    double displacement(const dealii::Point<dim> &initial, unsigned int component,
                        double time) const;

    /** The prescribed velocity of the interval from @p time to @p time + @p time_step of a node
     * that is at @p position [L/T]; that of a displacement reaches the prescribed position at its
     * end, and with a `Start` it changes as the displacement does and turns the node from where it
     * is. @p direction is that of the component where it is not that of the coordinates, else null.
     * Throws RunError where the function has no finite value. */
    double prescribed_velocity(const dealii::Point<dim> &initial, const double *position,
                               unsigned int component, double time, double time_step,
                               const dealii::Tensor<1, dim> *direction = nullptr) const;

    /** The prescribed velocity at @p time; that of a displacement is its rate over the short @p
     * interval after it. Throws likewise. */
    double initial_velocity(const dealii::Point<dim> &initial, const double *position,
                            unsigned int component, double time, double interval) const;

    /** The value of a traction or a body force at a point, along the axes of the coordinates.
     * Throws likewise. */
    dealii::Tensor<1, dim> load_at(const dealii::Point<dim> &initial, double time) const;
  };

  /**
   * The mechanical conditions of a model, one section "Condition: NAME" each: tractions, pressures,
   * body forces and gravity, which are loads that act at positions, and velocities, displacements
   * and clamps, which prescribe components of the motion. Named boundaries or a predicate of the
   * initial position select nodes and faces. Functions are of the initial position and of time.
   */
  template <int dim>
  class MechanicalConditions : public Conditions<dim, MechanicalCondition<dim>, dim>
  {
  public:
    /** Reads the sections "Condition: NAME" and finds their nodes and faces. Throws InputError, for
     * example where a condition selects nothing. Collective. */
    MechanicalConditions(const std::vector<Section> &sections, const Mesh<dim> &mesh,
                         const Nodes<dim> &nodes);

    bool has_loads() const
    {
      return this->has_type([](const MechanicalConditionType type) { return !prescribes(type); });
    }

    /** Whether conditions prescribe the motion at some times only. */
    bool are_timed() const;

    /** Whether others do so at @p time than now; the same on all ranks. */
    bool will_change(double time) const;

    /** Makes those conditions prescribe the motion that act at @p time, as those at 0 do at first.
     * Constraints are valid again after set_partition(). */
    void act_at(double time);

    /** Translates node numbers to those of @p partition. */
    void set_partition(const NodePartition &partition);

    /** Owned nodes of which directions are prescribed that are no axes of the coordinates: a
     * component of prescribing_condition() is an axis of their frame. */
    const ObliqueNodes &oblique_nodes() const
    {
      return oblique;
    }

    /** Leaves of a vector at owned nodes the motion that is free. */
    void remove_prescribed(NodalVector &vector) const;

    /** Owned nodes at which loads can act. Collective. */
    std::vector<unsigned int> loaded_nodes(const NodalState &state) const;

    /** Loads at positions (force per node) at @p time: ∫ t over the tributary part of the faces in
     * their current or initial positions (s_k of doc/method.md, section 5), -p ∫ n of a pressure
     * likewise, m b for body forces, where m is @p body_mass (scalar). Owned values are complete.
     * @p loads is zeroed; @p sums are this rank's shares of each condition, by number, with the
     * moments of forces at @p positions (current ghosts). Where @p receive_alone is given it is
     * called with the number of each load and its own loads, whose owned values are complete.
     * Collective. */
    void compute_loads(const NodalState &state, double time, const NodalVector &positions,
                       NodalVector &loads, std::vector<LoadSum> &sums, const NodalVector &body_mass,
                       const std::function<void(unsigned int condition, const NodalVector &loads)>
                           &receive_alone = {}) const;

    /** Sets the constrained components of the acceleration to (v_p - v̂)/Δt_n, where v_p is the
     * prescribed velocity of the coming interval, from @p time to @p time + @p position_time_step.
     * For a displacement v_p reaches the prescribed position at its end. */
    void prescribe_acceleration(NodalState &state, double time, double velocity_time_step,
                                double position_time_step) const;

    /** Sets the constrained components of v̂ to the prescribed velocity at @p time; that of a
     * displacement is its rate over the short @p interval after it. Ghosts are current then.
     * Collective. */
    void prescribe_initial_velocity(NodalState &state, double time, double interval) const;

    /** Owned nodes with prescribed components (global numbers); fixed from the beginning. */
    dealii::IndexSet prescribed_nodes() const;

    /** A component of an owned node that two conditions prescribe; the later one acts. */
    struct Overlap
    {
      unsigned int earlier, later; ///< numbers of conditions
      unsigned int component;
      dealii::Point<dim> point; ///< the initial position
    };

    const std::vector<Overlap> &overlaps() const
    {
      return overlapping;
    }

  private:
    using Base = Conditions<dim, MechanicalCondition<dim>, dim>;
    using Base::areas;
    using Base::conditions;
    using Base::constraint_nodes;
    using Base::constraints;

    /** Call put(node, force) for the nodes of this rank on which a condition acts, those of faces
     * with ghosts; the force has three components. */
    template <typename Put>
    void for_surface_forces(unsigned int c, const NodalState &state, double time,
                            const Put &put) const;
    template <typename Put>
    void for_body_forces(unsigned int c, const NodalState &state, const NodalVector &mass,
                         double time, const Put &put) const;
    /** Sets the prescribed components of a vector: value(condition, node, component, direction),
     * where the last is null for an axis of the coordinates. */
    template <typename Value>
    void prescribe(NodalVector &vector, const Value &value) const;
    using NodeRows = std::map<dealii::types::global_dof_index, std::vector<PrescribedRow<dim>>>;
    /** Sets the rows of nodes with local axes or times. */
    void set_rows(NodeRows rows);
    void find_frames();

    /** The prescribed motion of a node where that differs from its constraint. */
    struct Combination
    {
      std::size_t constraint;
      PrescribedFrame<dim> frame;
    };

    /** By condition: owned nodes on which one of the volume acts, local numbers, ascending. */
    std::vector<std::vector<unsigned int>> nodes_in_volume;
    mutable NodalVector loads_alone; ///< of one condition; only where they are requested
    std::vector<Overlap> overlapping;
    std::vector<bool> acting; ///< by condition
    /** With the indices of their constraints, ascending. */
    std::vector<std::pair<std::size_t, std::vector<PrescribedRow<dim>>>> rows_of_nodes;
    std::vector<Combination> combinations; ///< ascending
    ObliqueNodes oblique;
  };

  extern template class MechanicalConditions<2>;
  extern template class MechanicalConditions<3>;
} // namespace tombolo
