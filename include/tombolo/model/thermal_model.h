// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/boundary/thermal_conditions.h>
#include <tombolo/coupling/bridge.h>
#include <tombolo/materials/nodal_enthalpy.h>
#include <tombolo/model/assembly.h>
#include <tombolo/model/part.h>
#include <tombolo/state/nodal_state.h>

#include <deal.II/base/index_set.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * The heat of a model: state, conditions, and the operators of the heat equation on the one nodal
   * index space (doc/method.md, section 10). With S and Φ of a bridge whose weights are capacities,
   * the enthalpies of the nodes change by
   *
   * @verbatim
   *   dH/dt = Sᵀ [ -∫ k ∇(S θ̂) · ∇φ + Φᵀ q s(θ^h) ] + Q V,   θ^h = Φ S θ̂
   * @endverbatim
   *
   * (eqs 28-40 for every smoothing; for elements S = Φ = I). Σ H changes by the heat that enters,
   * to round-off, for any capacity. The weights of the smoothing are the capacities at the initial
   * temperature.
   */
  template <int dim>
  class ThermalModel
  {
  public:
    /** Declares the section "Heat". */
    static void declare_parameters(const Entries &e)
    {
      e.number("Absolute zero", "0", any_number(), "",
               "The absolute zero in the temperature scale of the file: 0 for kelvin, -273.15 for "
               "degrees Celsius. Needed for radiation.");
    }

    /** @p parts and @p initial_position must outlive this. Throws InputError. Collective. */
    ThermalModel(const std::vector<Section> &conditions, const Section &heat, const Mesh<dim> &mesh,
                 const Nodes<dim> &nodes, std::vector<Part<dim>> &parts,
                 const NodalVector &initial_position, const SmoothingSettings &smoothing,
                 bool trace);

    /** Nodes whose values this rank needs. */
    dealii::IndexSet required_nodes() const
    {
      return conditions.required_nodes();
    }

    /** After the parts have @p partition and their shape functions: capacities, volumes, bridge.
     * The state is moved there. Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);

    /** After shape functions changed their values only. Collective. */
    void update_shape_functions()
    {
      bridge.update_nodal_mass();
      field_is_of_state = false;
    }

    /** θ̂ and enthalpy of the materials' initial temperatures. */
    void set_initial_temperature();

    /** S of a nodal @p field of scalars, with current ghosts; constrained nodes keep their values.
     * Collective. */
    void smooth(NodalVector &field, NodalVector &smoothed);

    /** Its transpose: Sᵀ of @p nodal_heat (owned, slot 0), added to @p result (scalar): of a
     * direction or of a rate. The heat of constrained nodes stays there. Destroys @p nodal_heat.
     * Collective. */
    void add_transposed_smoothing(NodalVector &nodal_heat, NodalVector &result);

    /** From θ̂ (owned values) to θ^h = Φ S θ̂, both with current ghosts. Keeps S θ̂ for heat_rate().
     * Collective. */
    void find_field(NodalVector &unsmoothed, NodalVector &field);

    /** The same for the state, unless the last field that was found is that of the state already.
     * Collective. */
    void find_field_of_state()
    {
      if (!field_is_of_state)
        find_field(state.unsmoothed_temperature, state.temperature);
      field_is_of_state = true;
    }

    /** The last field that was found has become that of the state, and nothing has moved since. */
    void keep_field_of_state();
    /** Rows or temperatures can change. */
    void discard_field_of_state()
    {
      field_is_of_state = false;
    }

    /** The heat per unit time that comes to nodes by conduction, surfaces and sources: dH/dt of
     * owned nodes (scalar), from the last field of find_field(). At constrained nodes it is what
     * reaches the reservoir. Adds what comes through conditions on this rank to @p condition_heat.
     * Collective. */
    void heat_rate(const NodalVector &position, const NodalVector &field, double time,
                   NodalVector &rate, std::vector<double> &condition_heat);

    /** @p result = A @p direction (owned, slot 0 of node_stride), minus the derivative of
     * heat_rate() by θ̂ with k as it is at @p field: symmetric, not negative. Rows and columns of
     * constrained nodes are zero. Collective. */
    void apply_conduction(const NodalVector &position, const NodalVector &field, double time,
                          const NodalVector &direction, NodalVector &result);

    /** Adds the derivative of the heat that leaves by surfaces by the temperature at each owned
     * node: the diagonal of that part of apply_conduction() for elements. Collective. */
    void add_film_diagonal(double time, const NodalVector &field, NodalVector &diagonal);

    /** θ̂ of owned nodes from their enthalpies, without regard to conditions. */
    void find_free_temperature(const NodalVector &enthalpy, NodalVector &unsmoothed) const;

    /** θ̂ of owned nodes from their enthalpies, and prescribed temperatures at @p time, whose heat
     * is booked to conditions: the enthalpy of constrained nodes follows. */
    void find_temperature(double time, NodalVector &enthalpy, NodalVector &unsmoothed,
                          std::vector<double> &condition_heat) const;

    /** Whether plastic work can heat in this scene. */
    bool has_plastic_heat() const;

    /** Moves the plastic heat from the points to @p enthalpy at
     * owned nodes. Collective. */
    void add_plastic_heat(NodalVector &enthalpy);

    /** Adds the pending heat (ThermalState::pending) to nodes, through Sᵀ Φᵀ. Collective. */
    void add_pending_heat();

    /** Removes the heat of removed cells: that of the mass which these owned nodes have lost, at
     * their temperature, and the @p pending heat of the points of the cells. To be called after
     * set_partition() with the masses that are left. */
    void lose_heat(const std::vector<unsigned int> &nodes, double pending);

    /** Whether no property depends on the temperature, and no surface heat does. */
    bool is_linear() const;

    /** ρ c l²/(2 k) of eq. (41): the smallest over all ranks, with the cell or particle that has
     * it. Collective. */
    StepLimit diffusion_limit(const NodalVector &position) const;

    ThermalState state;
    ThermalConditions<dim> conditions;
    Bridge bridge;
    NodalEnthalpy nodal_enthalpy;
    // What lose_heat() removed, on this rank: before the thermal step in progress, and the
    // difference that it makes at its end.
    double eroded_heat = 0, eroding_heat = 0;
    bool limit_is_outdated = false; ///< of explicit steps
    bool can_lose_heat = false;     ///< lose_heat() can be called in the run

  private:
    void add_conduction(const NodalVector &position, const NodalVector &field,
                        const NodalVector &smoothed, NodalVector &heat_of_nodes);

    /** Adds @p factor times what comes to nodes from the heat at surfaces in `loads`, with those of
     * ghosts and images, to `heat`. Collective. */
    void add_surface_loads(double factor);

    std::vector<Part<dim>> &parts;
    const NodalVector &initial_position;
    NodalVector element_capacity;     // scalar
    NodalVector initial_volume;       // scalar; only with sources
    NodalVector smoothed_temperature; // S θ̂ of the last field that was found
    bool has_field = false;           // since the last change of the partition
    bool field_is_of_state = false;
    Assembly<dim> assembly;
    NodalVector heat, loads, load_heat, adjoint, direction_field, smoothed_direction;
    NodalVector plastic_heating;             // scalar
    std::vector<double> kept;                // buffer, of constrained nodes
    std::vector<unsigned int> surface_nodes; // owned, at which surfaces can have heat
  };

  extern template class ThermalModel<2>;
  extern template class ThermalModel<3>;
} // namespace tombolo
