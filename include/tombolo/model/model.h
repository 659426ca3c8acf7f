// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/boundary/mechanical_conditions.h>
#include <tombolo/contact/penalty_contact.h>
#include <tombolo/coupling/bridge.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/mesh/part_cells.h>
#include <tombolo/model/part.h>
#include <tombolo/model/thermal_model.h>
#include <tombolo/output/erosion_loss.h>
#include <tombolo/physics/failure/momentum_redistribution.h>
#include <tombolo/physics/mechanics/mass_scaling.h>
#include <tombolo/state/nodal_state.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  template <int dim>
  struct Physics;

  /**
   * Everything that a parameter file describes, built and ready for its first step: mesh, nodes,
   * parts, state, conditions and bridge. Members are public: the model is data, and the steps
   * change it.
   */
  template <int dim>
  class Model
  {
  public:
    /** Declares the sections of the scene that @p parameters names. */
    static void declare_parameters(Parameters &parameters);

    /** Makes every plug-in that the file selects, without a mesh: refuses bad values. Returns what
     * there is of mechanics and heat. */
    static Physics<dim> validate(const Parameters &parameters);

    /** Builds. Throws InputError. Collective. */
    Model(const Parameters &parameters, MPI_Comm communicator);
    ~Model();

    /** Rebuilds neighbourhoods where their criterion asks for it, and what hangs on them: ghosts,
     * masses, load patterns. Returns whether shape functions changed. The set of ghost nodes may
     * have changed even if this returns false. Collective. */
    bool update_neighbourhoods();

    /** Adds mass to cells and particles whose step has fallen below the target, where there is a
     * target and the check is due in @p step. Returns whether state.mass changed. Collective. */
    bool raise_masses(unsigned long step);

    /** Looks for cells of eroding parts that fail, before the evaluation at t_n. Returns whether
     * there are any on any rank; the smoothed velocity is then that of t_{n-1/2}. Collective; only
     * if erodes(). */
    bool find_failed_cells();

    /** Removes what find_failed_cells() has found, and adds what goes with it to @p loss (this
     * rank's share). Nodes without mass stay where they are. Collective. */
    void remove_failed_cells(const Clock &clock, ErosionLoss &loss);

    /** Whether cells can be removed in the run. */
    bool erodes() const;

    /** Over all ranks. Collective. */
    unsigned long n_removed_cells() const;

    /** Finds the cells that fulfil the criterion of their part, with the layers around them, where
     * the check is due in @p step. Returns whether there are any on any rank. Collective; only if
     * converts(). */
    bool find_converting_cells(unsigned long step);

    /** Makes particles of the cells of find_converting_cells(), before the evaluation. Adds to @p
     * lost_energy the decrease of the energy stored in the parts, and the energy that isolated
     * particles released (this rank's share). Mass, momentum, heat and what was dissipated stay.
     * Collective. */
    void convert(double &lost_energy);

    /** Whether cells can become particles in the run. */
    bool converts() const;

    /** Over all ranks. Collective. */
    unsigned long n_converted_cells() const;

    /** Whether bonds between particles can break in the run. */
    bool loses_bonds() const;

    /** Whether there is contact between fragments of a part. */
    bool has_self_contact() const;

    /** Writes to a checkpoint, or reads from it, the state of nodes and parts between two steps:
     * the positions of the coming and the stresses of the last evaluation. Reading makes the
     * neighbours of the run that wrote. Throws InputError where it is not of this model.
     * Collective. */
    void serialize(StateArchive &archive);

    /** Numbers over all ranks. Collective. */
    struct Counts
    {
      unsigned long nodes = 0, element_nodes = 0, shared_nodes = 0, particles = 0, cells = 0;
    };
    Counts counts() const;

    bool has_particles() const;

    /** Whether plastic work or contacts heat. */
    bool has_heat_sources() const;
    bool has_contact_heat() const;

    /** The forces of all contacts at the time of @p clock: contact_force. Collective. */
    void compute_contact_force(const Clock &clock);

    /** The sum of all contacts over all ranks; the largest penetration. Collective. */
    ContactBalance contact_balance() const;

    MPI_Comm communicator;
    unsigned int degree = 1;
    Mesh<dim> mesh;
    std::unique_ptr<PartCells<dim>> part_cells;
    std::unique_ptr<Nodes<dim>> nodes;
    std::vector<Part<dim>> parts;
    bool has_mechanics = true; ///< false where no material has stresses: a scene of heat alone
    std::shared_ptr<const Symmetry> symmetry; ///< null: no planes of symmetry
    std::unique_ptr<MechanicalConditions<dim>> conditions;
    std::vector<std::unique_ptr<PenaltyContact<dim>>> contacts;
    NodalState state;
    NodalVector element_mass; ///< inertia of the elements at nodes, scalar, owned values [M]
    std::unique_ptr<MassScaling<dim>> scaling; ///< null: inertia is that of the true mass
    NodalVector true_mass;  ///< scalar, owned values [M]; only where inertia is scaled
    NodalVector loads;      ///< forces at positions [M L/T^2]; only if there are loads
    NodalVector load_force; ///< Φᵀ loads [M L/T^2]; only if there are loads
    /** As `loads` and `load_force`, of contact; only if there is any. */
    NodalVector contact_loads, contact_force;
    std::unique_ptr<Bridge> bridge; ///< null without mechanics
    LatticeFilterSettings filter;
    std::unique_ptr<ThermalModel<dim>> heat; ///< null where no material has heat
    /** Owned nodes all of whose cells were removed. */
    std::vector<unsigned int> massless_nodes;
    /** Cells were removed or became particles since the stable step was found last. */
    bool has_eroded = false;

  private:
    void serialize_conversions(StateArchive &archive);
    std::vector<std::uint64_t> persistent_ids_of_cells(unsigned int part) const;
    /** Remembers that these cells of a part became particles, on all ranks that see them.
     * Collective. */
    void note_conversion(unsigned int source, const std::vector<unsigned int> &cells);
    /** The particles of @p part are those of the cells that have become some. Collective. */
    void give_cells_to(Part<dim> &part, const StateTransfer *converted);
    void set_filter_rate();
    void serialize_points(StateArchive &archive, Part<dim> &part, unsigned int index);
    void set_partition();
    /** For the nodes that parts require now, and all that has it. Collective. */
    void renew_partition();
    void set_masses();
    void set_element_mass();
    /** The bridges of motion and of heat have the same rows, which either can change. Collective.
     */
    void settle_rows();
    /** The bridge for the present masses, and what hangs on it. */
    void set_inertia();
    /** From the conditions, which must have a partition. */
    void remove_faces_of_removed_cells();
    void find_massless_nodes();
    void set_initial_conditions(const Parameters &parameters);
    void create_contacts(const Parameters &parameters);
    void set_contact_buffers();
    SmoothingSettings initialize_parts(const std::vector<Section> &part_sections, bool has_heat,
                                       bool trace);
    void set_initial_positions();

    std::shared_ptr<const NodePartition> partition;
    std::unique_ptr<MomentumRedistribution<dim>>
        momentum_redistribution;    // null: bonds do not break
    std::vector<bool> is_converted; // by active cell, ghosts included; empty before the first
    std::vector<std::vector<unsigned int>> converting_cells; // of each part, in this step
    std::vector<unsigned int> nodes_in_contact;              // buffer
    // Buffers, scalar; only of several contacts that exchange heat.
    NodalVector pending_contact_heat, contact_exposure;
    std::vector<Stencils *> stencils() const;
  };
} // namespace tombolo
