// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/boundary/mechanical_conditions.h>
#include <tombolo/coupling/bridge.h>
#include <tombolo/mesh/bodies.h>
#include <tombolo/mesh/cell_divisions.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/mesh/part_cells.h>
#include <tombolo/model/impulse_account.h>
#include <tombolo/model/part.h>
#include <tombolo/model/process.h>
#include <tombolo/model/step_groups.h>
#include <tombolo/model/thermal_model.h>
#include <tombolo/state/nodal_state.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace tombolo
{
  /** Signals for processes that need more than functions of Process provide.
   * Collective, but for part_force. */
  struct ModelSignals
  {
    /** Masses, cells or rows are about to change: receivers account now for what depends on the
     * present ones, by the smoothed velocity of the present rows. */
    Signal<> change;
    /** Rows of a part are about to change in update_stencils(), and then: all have changed, with
     * the partition of before. */
    Signal<> rows_change, rows_changed;
    /** The number of a part, the vector of its internal force at t_n at local nodes,
     * ghosts and images not collected yet, and whether it is added already. */
    Signal<std::size_t, const NodalVector &, bool> part_force;
    /** Owned nodes of which the first vector (scalar) is positive are about to be placed: where
     * they are now, or those next to them on the present surface, and where they go. Moves those
     * deeper in a surface than these, and those that touched it, to where they are as deep, and
     * marks them in the last vector (scalar). A node with less than one may leave a surface
     * steeply. */
    Signal<const Clock &, const NodalVector &, const NodalVector &, NodalVector &, NodalVector &>
        nodes_move;
    /** Nodes were placed anew, at positions to which no motion has led, as when a part is refilled;
     * their former positions, with the present ghosts. Emitted after Process::model_changed(). */
    Signal<const Clock &, const NodalVector &> nodes_placed;
    /** A step of bodies at rest begins, where nothing resists rates, and what is apart by less than
     * the length touches. Forces are requested at several positions, each time with the records
     * that are left now. The clock has in `stable_step` the time of which springs of contacts are
     * made, and in `previous_step` the length of the step, zero at the start of the run. */
    Signal<const Clock &, double> trials;
  };

  template <int dim>
  struct Physics;

  /** How often parts of the model have changed: data that depend on them is renewed after a
   * comparison. */
  struct Revisions
  {
    unsigned long stencils = 0; ///< values or neighbours of rows
    unsigned long cells = 0;    ///< cells were removed or became particles
  };

  /**
   * Everything that a parameter file describes, built and ready for its first step: mesh, nodes,
   * parts, state, conditions, bridge and processes. Members are public: the model is data, and the
   * steps and processes act on it.
   */
  template <int dim>
  class Model
  {
  public:
    /** Changes the mesh of the file before the model is built on it. */
    using MeshChange = std::function<void(DividedMesh<dim> &)>;

    /** Throws InputError. Collective. */
    Model(const Parameters &parameters, MPI_Comm communicator, const MeshChange &change_mesh = {});

    /** Renews neighbourhoods and rows where their criterion requires it, and what depends on them:
     * ghosts, masses. The set of ghost nodes may have changed even if it returns no change.
     * Collective. */
    ModelChange update_stencils();

    /** Called before cells, rows or masses change in a step: the smoothed velocity is then that of
     * t_{n-1/2} by the rows as they are, and processes prepare. update_stencils() does so by
     * itself. Collective. */
    void begin_change();

    /** For the nodes that parts require now, and all that has them; then renew_masses().
     * Collective. */
    void renew_partition()
    {
      set_partition();
      state.move_to(partition);
      renew_masses();
    }

    /** For the masses that parts have now, and the rows of their particles. Collective. */
    void renew_masses();

    /** The same where only factors of the inertia have changed. Collective. */
    void renew_inertia();

    /** The partition alone, where the state is read afterwards. Collective. */
    void set_partition();

    /** Removes the faces of these cells, each given by its nodes, from all conditions.
     * renew_masses() must follow. */
    void
    remove_faces(const std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells);

    /** For parts that a checkpoint was read into, before the state of nodes is: processes respond,
     * then the partition, the parts and the masses are renewed. Collective. */
    void parts_were_read();

    /** Numbers over all ranks. Collective. */
    struct Counts
    {
      unsigned long nodes = 0, element_nodes = 0, shared_nodes = 0, particles = 0, cells = 0;
    };
    Counts counts() const;

    /** The formulations of particle parts, in the order of the parts. */
    std::vector<ParticleFormulation<dim> *> particle_parts() const;

    bool has_particles() const
    {
      return !particle_parts().empty();
    }

    /** What body forces act on, and what is lost with a body that leaves; scalar, owned values [M].
     */
    const NodalVector &body_mass() const
    {
      return inertia_is_mass ? state.mass : mass_of_bodies;
    }

    /** Whether plastic work or processes heat. */
    bool has_heat_sources() const;

    /** The process of this type; null where the scene has none. */
    template <typename Type>
    Type *find_process() const
    {
      for (const auto &process : processes)
        if (auto *const found = dynamic_cast<Type *>(process.get()))
          return found;
      return nullptr;
    }

    /** Numbers of the rows of a part, which are its cells or its particles, that do not depend on
     * the number of ranks. */
    std::vector<std::uint64_t> persistent_ids_of_points(unsigned int part) const;

    MPI_Comm communicator;
    unsigned int degree = 1;
    DividedMesh<dim> mesh;
    std::unique_ptr<PartCells<dim>> part_cells;
    std::unique_ptr<Bodies<dim>> bodies; ///< null: a model without particles
    std::unique_ptr<Nodes<dim>> nodes;
    std::vector<Part<dim>> parts;
    bool has_mechanics = true; ///< false where no material has stresses: a scene of heat alone
    std::unique_ptr<MechanicalConditions<dim>> conditions;
    NodalState state;
    NodalVector element_mass; ///< inertia of the elements at nodes, scalar, owned values [M]
    /** Whether inertia is that of the mass everywhere: for all materials, and without a
     * Part::inertia on any rank. */
    bool inertia_is_mass = true;
    std::unique_ptr<Bridge> bridge;                       ///< null without mechanics
    std::unique_ptr<ThermalModel<dim>> heat;              ///< null where no material has heat
    std::vector<std::unique_ptr<Process<dim>>> processes; ///< in their order in a step
    ImpulseAccount impulses;                              ///< of all forces from outside
    StepGroups<dim> step_groups; ///< of cells that do not take each step; none by default
    Revisions revisions;
    /** Whether a change of rows is reported once and not repeated, as when bonds break: the limit
     * of the step keeps it until it is estimated anew. */
    bool stencils_change_for_good = false;
    mutable ModelSignals signals; ///< connecting changes nothing of the model

  private:
    void create_mesh(const Parameters &parameters, const std::vector<Section> &part_sections,
                     const MeshChange &change_mesh);
    void set_element_mass();
    /** The bridges of motion and of heat have the same rows, which either can change. Collective.
     */
    void match_rows();
    /** The bridge for the present masses. */
    void set_inertia();
    void notify_processes();
    SmoothingSettings initialize_parts(const std::vector<Section> &part_sections, bool has_heat,
                                       bool trace);
    void set_initial_positions();

    bool change_has_begun = false; // in this step
    std::shared_ptr<const NodePartition> partition;
    NodalVector mass_of_bodies; // where inertia is not that of the mass
  };

  /** Declares the sections of the scene that @p parameters names. */
  template <int dim>
  void declare_model(Parameters &parameters);

  /** Makes every plug-in that the file selects, without a mesh: refuses bad values. Returns what
   * there is of mechanics and heat. */
  template <int dim>
  Physics<dim> validate_model(const Parameters &parameters);
} // namespace tombolo
