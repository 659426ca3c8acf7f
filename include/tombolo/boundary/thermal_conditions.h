// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/boundary/conditions.h>
#include <tombolo/boundary/limited_function.h>
#include <tombolo/state/nodal_vector.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  enum class ThermalConditionType
  {
    temperature,
    heat_flux,
    convection,
    radiation,
    adiabatic,
    heat_source
  };

  /** Whether a section "Condition: NAME" is one of these, by its entry `Type`. */
  bool is_thermal(const Section &section);

  inline bool prescribes(const ThermalConditionType type)
  {
    return type == ThermalConditionType::temperature;
  }

  /** Whether what enters depends on the temperature of the surface. */
  bool is_film(ThermalConditionType type);

  /** Whether heat enters through the surface. */
  bool crosses_surface(ThermalConditionType type);

  /** Whether it acts on faces of the boundary, not on nodes. */
  bool is_on_faces(ThermalConditionType type);

  /** Whether both can be on one face. */
  bool are_compatible(ThermalConditionType a, ThermalConditionType b);

  /** The heat that enters the body through a surface. */
  struct SurfaceHeat
  {
    double flux; ///< per area and time [M/T^3]
    double film; ///< the derivative of minus that by the temperature, not less than zero
  };

  /** The content of one section "Condition: NAME" of heat. */
  template <int dim>
  struct ThermalCondition
  {
    std::string name;
    ThermalConditionType type;
    Region<dim> region;
    std::optional<LimitedFunction<dim>> function;    ///< temperature, flux or source
    std::optional<LimitedFunction<dim>> coefficient; ///< film coefficient or emissivity
    std::optional<LimitedFunction<dim>> ambient;     ///< temperature
    double stefan_boltzmann = 0;
    double absolute_zero = 0;

    /** Declares, in the section of one condition, the entries that MechanicalCondition does not. */
    static void declare_parameters(const Entries &e);

    /** Reads what the type needs; @p heat has the absolute zero. Throws InputError. */
    static ThermalCondition read(const Section &section, const Section &heat);

    /** Of convection, h (θ_a - θ), and radiation, ε σ ((θ_a - θ_0)^4 - (θ - θ_0)^4), where @p
     * coefficient is h or ε. */
    SurfaceHeat film_heat(double coefficient, double ambient, double temperature) const;

  private:
    void read_radiation(const Section &section, const Section &heat);
  };

  /**
   * The thermal conditions of a scene, sections "Condition: NAME": temperature, heat flux,
   * convection, radiation and adiabatic surfaces, and heat sources in the volume. Named boundaries
   * or a predicate of the initial position select nodes and faces; functions are of the initial
   * position and of time.
   *
   * A surface without a condition is adiabatic; the type `adiabatic` sets this and excludes others
   * there. Fluxes, convection and radiation add up on one face; one type twice, or a temperature or
   * adiabatic together with another, is refused.
   *
   * Heat crosses faces at their nodes: q_k s_k with s_k = ∫ N_k dA over the faces of the condition,
   * in their current positions, so that the total of a uniform flux is exact (eqs 32, 33).
   */
  template <int dim>
  class ThermalConditions : public Conditions<dim, ThermalCondition<dim>, 1>
  {
  public:
    /** Reads the sections and finds their nodes and faces. @p heat is the section "Heat", which has
     * the absolute zero. Throws InputError where a condition selects nothing, or two on one face
     * exclude each other. Collective. */
    ThermalConditions(const std::vector<Section> &sections, const Section &heat,
                      const Mesh<dim> &mesh, const Nodes<dim> &nodes);

    /** Translates node numbers to those of @p partition. */
    void set_partition(const NodePartition &partition);

    /** Whether heat crosses surfaces at nodes: flux, convection, radiation. */
    bool has_surface_heat() const
    {
      return this->has_type(&crosses_surface);
    }

    bool has_sources() const
    {
      return this->has_type([](const ThermalConditionType type)
                            { return type == ThermalConditionType::heat_source; });
    }

    /** Whether what crosses surfaces depends on the temperature there. */
    bool has_films() const
    {
      return this->has_type(&is_film);
    }

    /** Owned nodes through which heat can cross the surface. Collective. */
    std::vector<unsigned int>
    surface_nodes(const std::shared_ptr<const NodePartition> &partition) const
    {
      return areas.owned_nodes(partition);
    }

    /** Finds s_k in these positions (ghosts current). */
    void update_areas(const NodalVector &position)
    {
      areas.update(position, position);
    }

    /** Adds the heat per unit time that enters through surfaces at @p time, with the temperature of
     * the surface in slot 0 of @p temperature (ghosts current), to slot 0 of @p heat_rate, ghosts
     * too, which the caller collects, and that of each condition on this rank to @p
     * condition_rates. */
    void add_surface_heat(const NodalVector &initial_position, const NodalVector &temperature,
                          double time, NodalVector &heat_rate,
                          std::vector<double> &condition_rates) const;

    /** Adds the derivative of minus that by the temperature, not less than zero, times slot 0 of
     * @p field, to slot 0 of @p result, ghosts too: a linear, symmetric operator. */
    void add_film_action(const NodalVector &initial_position, const NodalVector &temperature,
                         double time, const NodalVector &field, NodalVector &result) const;

    /** Adds the heat per unit time of volumetric sources, Q times the @p initial_volume of owned
     * nodes (scalar), to owned @p heat_rate (scalar), and to @p condition_rates. */
    void add_sources(const NodalVector &initial_position, const NodalVector &initial_volume,
                     double time, NodalVector &heat_rate,
                     std::vector<double> &condition_rates) const;

    /** Sets slot 0 of @p temperature at constrained nodes to what is prescribed at @p time. */
    void prescribe(const NodalVector &initial_position, double time,
                   NodalVector &temperature) const;

  private:
    using Base = Conditions<dim, ThermalCondition<dim>, 1>;
    using Base::areas;
    using Base::conditions;
    using Base::constraint_nodes;
    using Base::constraints;

    /** Adds faces that heat crosses to the areas of their conditions, none of which crosses planes
     * of symmetry. Returns the numbers of faces of this rank with two conditions that exclude each
     * other: [later][earlier]. */
    std::vector<unsigned int> find_faces(const Nodes<dim> &nodes);

    void refuse_conflicts(const std::vector<Section> &sections,
                          const std::vector<unsigned int> &n_conflicts) const;

    /** Calls action(condition, node, area, SurfaceHeat) for the nodes of its faces. */
    template <typename Action>
    void for_each_surface_node(const NodalVector &initial_position, const NodalVector &temperature,
                               double time, bool only_films, const Action &action) const;

    /** By condition: nodes of a temperature, owned ones and, until faces are found, ghosts, or of a
     * source; ascending. */
    std::vector<std::vector<dealii::types::global_dof_index>> selected_nodes;
    std::vector<std::vector<unsigned int>> source_nodes; ///< by condition, local, owned
  };
} // namespace tombolo
