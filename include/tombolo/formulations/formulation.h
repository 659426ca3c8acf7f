// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/formulations/part_points.h>
#include <tombolo/formulations/step_cost.h>
#include <tombolo/mesh/bodies.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/point.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  class Records;
  template <int dim>
  class ParticleFormulation;
  template <int dim>
  class VoidCells;

  /** The arguments of Formulation::initialize(): a part is cells × formulation × material. */
  template <int dim>
  struct PartSetup
  {
    std::string name;
    unsigned int index = 0;
    const Nodes<dim> *nodes = nullptr;
    const PartCells<dim> *part_cells = nullptr; ///< also has the part of ghost cells
    const Bodies<dim> *bodies = nullptr;        ///< of the mesh; set where a part has particles
    std::shared_ptr<const Material> material;
    MPI_Comm communicator = MPI_COMM_NULL;
    std::shared_ptr<const ThermalProperties> heat; ///< null: a scene without heat
    bool has_mechanics = true; ///< otherwise the scene is one of heat alone: no material points
    bool trace_bridge = false; ///< elements use the particles' field at shared nodes
    /** Cells of some part can be removed or become particles while the run goes on. */
    bool cells_can_leave = false;
    /** The part whose cells become this part's while the run goes on; it has none before. */
    std::optional<unsigned int> source;
    /** Other parts of this formulation with the same entries, of this and of another material. */
    std::vector<unsigned int> equal_parts, parts_of_other_material;
    /** Whether the cells of @p part are of this part or of an equal one. */
    bool is_of_equals(const unsigned int part) const
    {
      return part == index ||
             std::find(equal_parts.begin(), equal_parts.end(), part) != equal_parts.end();
    }
    /** Whether values of rows include the cells of @p part, for what is smoothed. */
    bool smooths_over(const unsigned int part) const
    {
      return is_of_equals(part) ||
             std::find(parts_of_other_material.begin(), parts_of_other_material.end(), part) !=
                 parts_of_other_material.end();
    }
    /** Rows include the cells of the part alone. */
    void end_at_own_cells()
    {
      equal_parts.clear();
      parts_of_other_material.clear();
    }
    /** Those that this rank owns, in the order of Formulation::n_cells(). */
    std::vector<typename Nodes<dim>::Cell> cells() const
    {
      std::vector<typename Nodes<dim>::Cell> result;
      for (const auto &cell : nodes->dof_handler().active_cell_iterators())
        if (cell->is_locally_owned() &&
            (part_cells == nullptr || part_cells->part_of(cell) == index))
          result.push_back(cell);
      return result;
    }
    /** Owned nodes whose motion is prescribed in some component; empty: none. */
    dealii::IndexSet prescribed_nodes;
    const VoidCells<dim> *void_cells = nullptr; ///< of a part of smoothed cells; null: none
  };

  /** A bound on the time step, and the one cell or particle that sets it, on this rank. */
  struct StepLimit
  {
    double time_step = 1e300;
    std::string entity;        ///< "cell", "particle", "node"
    dealii::Point<3> position; ///< its current position
  };

  /** The result of update_neighbourhoods(). */
  enum class NeighbourhoodChange
  {
    none,
    values,    ///< shape functions have new values, at the same neighbours or fewer of them
    neighbours ///< rows have other neighbours; shape functions are rebuilt
  };

  /** The nodes in the middle of faces and edges of a cell beside cells of half its size. */
  enum class MiddleNodes
  {
    refused,
    means, ///< of the corners between which they lie
    free   ///< they move by themselves, since the field of the cell follows them
  };

  /** The motion that a step's forces are computed from. */
  struct MechanicalInput
  {
    const NodalVector *position; ///< x at t_n, ghosts current
    const NodalVector *velocity; ///< v at t_{n-1/2}, ghosts current
    double time_increment;       ///< t_n - t_{n-1}; zero in the first evaluation
    /** Temperature at the nodes at t_n, in slot 0, ghosts current; null in scenes without heat. */
    const NodalVector *temperature = nullptr;
  };

  /** The contribution of a cell to the linear equations of a static step. */
  struct CellEquations
  {
    std::vector<unsigned int> nodes; ///< local numbers
    /** ∂f/∂x of the internal force f of the cell (eq. (16), sign of +K) with the positions at the
     * end of the step, row by row; component d of node k is row and column dim k + d. */
    std::vector<double> matrix;
    std::vector<double> force; ///< f, by component of each node

    /** The place of @p node among the nodes, which are ascending. */
    std::size_t index_of(const unsigned int node) const
    {
      return static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), node) -
                                      nodes.begin());
    }
  };

  /** Called with groups of local node numbers. */
  using NodeGroupAction = std::function<void(const std::vector<unsigned int> &)>;

  /**
   * How a part turns nodal motion into stress and nodal force: an element type or a particle
   * method. One virtual call per part and step. All nodal vectors share one NodePartition whose
   * local numbers the formulation caches: set_partition() is called first and whenever it changes.
   *
   * A part holds the cells (or the particles: nodes of its cells) that this rank owns; forces are
   * added at local nodes, ghosts included, and collected by the caller
   * (NodalVector::add_to_owners).
   */
  template <int dim>
  class Formulation
  {
  public:
    virtual ~Formulation() = default;

    /** The degree of the nodes that this needs, the same in all parts of a scene. Zero: any. */
    virtual unsigned int degree() const = 0;

    virtual MiddleNodes middle_nodes() const
    {
      return MiddleNodes::refused;
    }

    virtual bool can_be_divided() const
    {
      return false;
    }

    /** Sets the volumes of the points that @p are_new, in cells that a run has divided or joined,
     * to those at these positions, which have ghosts. The volumes before set how the points of a
     * cell share its volume, where they do. */
    virtual void find_volumes(const NodalVector & /*position*/,
                              const std::vector<bool> & /*are_new*/)
    {}

    /** The cost of a step for cells and nodes of the part with points of @p material, in the
     * relative units of StepCosts, where the box along the axes around a cell has @p box_ratio
     * times its volume: supports are such boxes. The mesh is distributed so that all ranks have the
     * same sum of it. Called before initialize(). */
    virtual StepCost step_cost(const Material &material, const double /*box_ratio*/) const
    {
      return StepCosts::element_cost(dim, std::max(degree(), 1u), std::max(n_points_per_cell(), 1u),
                                     StepCosts::per_point, material);
    }

    /** Collects cells, initial geometry, material points. Collective. Throws InputError. */
    virtual void initialize(const PartSetup<dim> &setup) = 0;

    /** Nodes whose values this rank needs: nodes of its cells, neighbours of its particles. */
    virtual dealii::IndexSet required_nodes() const = 0;

    /** Images of nodes that this rank needs, in any order; their sources are required_nodes(),
     * with which they change. */
    virtual std::vector<ImageNode> required_image_nodes() const
    {
      return {};
    }

    /** Translates cached node numbers to the local numbers of @p partition. */
    virtual void set_partition(const NodePartition &partition) = 0;

    /** Adds the initial mass at nodes, lumped (scalar); ghosts are collected by the caller. */
    virtual void add_mass(NodalVector &mass) const = 0;

    /** Advances the stress to t_n (objective rate, eqs 13, 5, 19), adds -Gᵀ(V σ) (eq. 16). */
    virtual void add_internal_force(const MechanicalInput &input, NodalVector &force) = 0;

    /** The phase that the time of add_internal_force() is counted as: a literal. */
    virtual const char *phase() const
    {
      return "element forces";
    }

    /** What made the last add_internal_force() useless on this rank, with its position ("the cell
     * at (1, 2, 3) is turned inside out ..."); empty if nothing did. Not thrown, since other ranks
     * do not know it: the caller exchanges it and throws a RunError on all. */
    virtual std::string failure() const
    {
      return {};
    }

    /** Adds the force that nodal velocities cause per unit time, K v + (2/Δt) C v with the elastic
     * stiffness K and the artificial viscosity C at the present configuration, with the sign of
     * +K: the operator whose largest eigenvalue bounds the step by λ Δt² = 4. Changes no state. */
    virtual void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                         double time_step, NodalVector &force) const = 0;

    /** Hands over the equations of each present cell for the motion of @p input (current ghosts),
     * from material points at the start of the step: for implicit steps. Afterwards the points are
     * in no state of use: within a Trial, which is restarted next. Not collective. */
    virtual void find_cell_equations(const MechanicalInput & /*input*/,
                                     const std::function<void(const CellEquations &)> & /*take*/)
    {}

    /** Calls @p use with groups of local nodes that act on each other beside those of cells. */
    virtual void find_couplings(const NodeGroupAction & /*use*/) const {}

    /** What find_cell_equations() does not linearize, for a message; empty: nothing. Null: all. */
    virtual std::optional<std::string> unfit_to_linearize() const
    {
      return std::nullopt;
    }

    /** eq. (41) without its factor, characteristic length over wave speed, of every cell or
     * particle of this rank with the inertial density of the material: cells in the order of active
     * cells of the triangulation, particles in that of their shape functions, 1e300 of cells that
     * are removed. None where the formulation does not have them. */
    virtual void courant_limits(const NodalVector & /*position*/,
                                std::vector<double> &time_steps) const
    {
      time_steps.clear();
    }

    /** The smallest of courant_limits(), each times the root of its factor among @p inertia
     * (Part::inertia), over its ratio (Part::step_ratios). */
    StepLimit courant_limit(const NodalVector &position, const std::vector<double> &inertia = {},
                            const std::vector<unsigned int> &step_ratios = {}) const
    {
      std::vector<double> time_steps;
      courant_limits(position, time_steps);
      StepLimit limit;
      limit.entity = particle_nodes().empty() ? "cell" : "particle";
      unsigned int shortest = 0;
      for (unsigned int i = 0; i < time_steps.size(); ++i)
        if (const double step = time_steps[i] * std::sqrt(inertia.empty() ? 1. : inertia[i]) /
                                (step_ratios.empty() ? 1 : step_ratios[i]);
            step < limit.time_step)
        {
          limit.time_step = step;
          shortest = i;
        }
      if (limit.time_step == StepLimit().time_step)
        return limit;
      std::vector<dealii::Point<dim>> points;
      point_positions(position, points);
      const bool is_point = !particle_nodes().empty();
      const unsigned int n_points = is_point ? 1 : n_points_per_cell();
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int d = 0; d < dim; ++d)
          limit.position[d] +=
              points[is_point ? shortest : point_of_cell(shortest, q)][d] / n_points;
      return limit;
    }

    /** Adds, as add_mass() does, the mass beyond the initial one where each cell, in the order of
     * courant_limits(), has its factor among @p inertia times it. Elements only: the masses of
     * particles are those of their rows (Bridge::reinit()). */
    virtual void add_extra_mass(const std::vector<double> & /*inertia*/,
                                NodalVector & /*mass*/) const
    {
      throw InputError("A part has a formulation whose cells cannot be given mass one by one.");
    }

    /** Energies of the part, this rank's shares, from the state of its points: "elastic energy" (Σ
     * ½ σ : C⁻¹ : σ V), "hourglass energy" (zero-energy modes), "plastic dissipation", "viscous
     * dissipation" (artificial, of hourglass control too), "thermal work" (given to the elastic
     * energy by changes of temperature; with heat only), and others. */
    virtual EnergyAccounts energies() const
    {
      return part_points.energies();
    }

    /** Adds the heat per unit time that conduction brings to the nodes, -∫ k ∇θ · ∇φ (eqs 29, 35
     * without its source), to slot 0 of @p heat_rate; k is that at the temperatures @p
     * conductivity_temperature and θ is slot 0 of @p temperature, so that with two fields this is a
     * linear operator. All have node_stride a node and are in the present positions. Throws
     * InputError where the formulation conducts no heat. */
    virtual void add_conduction(const NodalVector & /*position*/,
                                const NodalVector & /*conductivity_temperature*/,
                                const NodalVector & /*temperature*/,
                                NodalVector & /*heat_rate*/) const
    {
      throw InputError(
          "A part has a formulation that conducts no heat, but its material has heat.");
    }

    /** eq. (41) for heat without its factor: ρ c l²/(2 k), the smallest, by the largest k/c. */
    virtual StepLimit diffusion_limit(const NodalVector & /*position*/) const
    {
      return {};
    }

    /** Adds the heat of plastic work since the last call (scalar; the caller collects ghosts), and
     * counts it as given. */
    virtual void add_plastic_heat(NodalVector & /*heat*/) {}

    /** The heat that add_plastic_heat() would add now, over this rank [M L^2/T^2]. */
    double pending_plastic_heat() const
    {
      return part_points.heating().pending(points());
    }

    /** Rebuilds neighbourhoods at these positions where their criterion requires it. When
     * neighbours or ghosts changed, the caller makes a new partition with required_nodes(), and
     * calls set_partition() before the next use. The same result on all ranks. Collective. */
    virtual NeighbourhoodChange update_neighbourhoods(const NodalVector & /*position*/)
    {
      return NeighbourhoodChange::none;
    }

    /** Positions of the material points (size(): points().size()) for given nodal positions. */
    virtual void point_positions(const NodalVector &position,
                                 std::vector<dealii::Point<dim>> &points) const = 0;

    /** In the order of points(). */
    virtual const std::vector<dealii::Point<dim>> &initial_point_positions() const = 0;

    const MaterialPoints &points() const
    {
      return part_points.points();
    }
    MaterialPoints &points()
    {
      return part_points.points();
    }
    const Material &material() const
    {
      return part_points.material();
    }

    /** For output: the number of cells of this rank, in the order of active ones, zero for
     * particles; and of material points in each. */
    virtual unsigned int n_cells() const = 0;
    virtual unsigned int n_points_per_cell() const = 0;

    /** Whether a cell of this rank is no cell of the part any more. */
    virtual bool is_removed(const unsigned int /*cell*/) const
    {
      return false;
    }

    virtual bool can_lose_cells() const
    {
      return false;
    }

    /** This, where it is a method of particles; null otherwise. */
    virtual ParticleFormulation<dim> *as_particles()
    {
      return nullptr;
    }

    /** Owned nodes that are particles of the part (local numbers); none of elements. */
    virtual const std::vector<unsigned int> &particle_nodes() const
    {
      static const std::vector<unsigned int> none;
      return none;
    }

    /** The index in points() of material point @p q of a cell. */
    virtual unsigned int point_of_cell(const unsigned int cell, const unsigned int q) const
    {
      return cell * n_points_per_cell() + q;
    }

    /** Sets points that stand for no cell to the values of a cell, where these have been set. */
    virtual void fill_unused_lanes(const unsigned int /*field*/) {}

    /** Lists what the part stores beyond points(). Rows of the archive are the part's: one per
     * cell, or per particle. After reading, required_nodes() and set_partition() are called as
     * after a change of neighbours, then complete_reading(). Collective. */
    virtual void list(Records & /*records*/) {}

    /** Computes the data that follow from those that were read. @p buffer is a vector of positions
     * with current ghosts, free to be overwritten. Collective. */
    virtual void complete_reading(NodalVector & /*buffer*/) {}

  protected:
    PartPoints part_points; ///< initialize() sets the material, and creates the points
  };

  template <int dim>
  struct PluginKind<Formulation<dim>>
  {
    static constexpr const char *name = "formulation";
  };

  extern template class Formulation<2>;
  extern template class Formulation<3>;
} // namespace tombolo
