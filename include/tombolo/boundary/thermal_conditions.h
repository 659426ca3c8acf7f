// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The thermal conditions of a scene, sections "Condition: NAME": temperature, heat flux,
   * convection, radiation and adiabatic surfaces, and heat sources in the volume. Where is said by
   * named boundaries or by a predicate of the initial position; functions are of the initial
   * position and of time.
   *
   * A surface without a condition is adiabatic; the type `adiabatic` says so and refuses others
   * there. Fluxes, convection and radiation add up on one face; one type twice, or a temperature
   * or adiabatic together with another, is refused.
   *
   * Heat crosses faces at their nodes: q_k s_k with s_k = ∫ N_k dA over the faces of the condition,
   * in their current positions, so that the total of a uniform flux is exact (eqs 32, 33).
   */
  template <int dim>
  class ThermalConditions
  {
  public:
    /** Whether a section "Condition: NAME" is one of these, by its type. */
    static bool is_thermal(const Section &section);

    /** Declares, in the section of one condition, the entries that MechanicalConditions does not.
     */
    static void declare_parameters(const Entries &e);

    /** Reads the section of one condition, and refuses what can be seen to be wrong without a mesh.
     * @p heat is the section "Heat", which has the absolute zero. */
    static void validate(const Section &section, const Section &heat);

    /** Reads the sections and finds their nodes and faces. Throws InputError. Collective. */
    ThermalConditions(const std::vector<Section> &sections, const Section &heat,
                      const Mesh<dim> &mesh, const Nodes<dim> &nodes);
    ~ThermalConditions();

    /** Nodes whose values this rank must see: nodes of faces with conditions. */
    dealii::IndexSet required_nodes() const;

    /** Translates node numbers to those of @p partition. */
    void set_partition(const NodePartition &partition);

    /** No heat passes any more through the faces of these cells, each given by its nodes.
     * set_partition() must follow. */
    void
    remove_faces(const std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells);

    unsigned int n_conditions() const;
    const std::string &name(unsigned int condition) const;

    /** Whether heat crosses surfaces at nodes: flux, convection, radiation. */
    bool has_surface_heat() const;
    bool has_sources() const;
    /** Whether what crosses surfaces depends on the temperature there. */
    bool has_films() const;
    /** Whether temperatures are prescribed, on this rank or on another. */
    bool has_constraints() const;

    /** All bits set at owned nodes whose temperature is prescribed, for Bridge::reinit(); empty
     * where none is on any rank. Owned nodes with them, ascending. */
    const std::vector<std::uint8_t> &constrained_components() const;
    const std::vector<unsigned int> &constrained_nodes() const;

    /** Owned nodes through which heat can cross the surface. Collective. */
    std::vector<unsigned int>
    surface_nodes(const std::shared_ptr<const NodePartition> &partition) const;

    /** Finds s_k in these positions (ghosts current). */
    void update_areas(const NodalVector &position);

    /** Adds the heat per unit time that enters through surfaces at @p time, with the temperature of
     * the surface in slot 0 of @p temperature (ghosts current), to slot 0 of @p heat_rate, ghosts
     * too: the caller collects. Adds what each condition gives on this rank to @p of_condition. */
    void add_surface_heat(const NodalVector &initial_position, const NodalVector &temperature,
                          double time, NodalVector &heat_rate,
                          std::vector<double> &of_condition) const;

    /** Adds the derivative of minus that by the temperature, not less than zero, times slot 0 of
     * @p field, to slot 0 of @p result, ghosts too: a linear, symmetric operator. */
    void add_film_action(const NodalVector &initial_position, const NodalVector &temperature,
                         double time, const NodalVector &field, NodalVector &result) const;

    /** Adds the heat per unit time of volumetric sources, Q times the @p initial_volume of owned
     * nodes (scalar), to owned @p heat_rate (scalar), and to @p of_condition. */
    void add_sources(const NodalVector &initial_position, const NodalVector &initial_volume,
                     double time, NodalVector &heat_rate, std::vector<double> &of_condition) const;

    /** Sets slot 0 of @p temperature at constrained nodes to what is prescribed at @p time. */
    void prescribe(const NodalVector &initial_position, double time,
                   NodalVector &temperature) const;

    /** The condition that prescribes the temperature of entry @p k of constrained_nodes(). */
    unsigned int condition_of_constraint(std::size_t k) const;

    /** What went wrong on this rank since it was made: a function without a finite value. Not
     * agreed among ranks. */
    const std::string &failure() const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation;
  };
} // namespace tombolo
