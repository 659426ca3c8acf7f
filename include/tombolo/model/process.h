// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/base/json.h>
#include <tombolo/model/actions.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/records.h>

#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /** What has changed in a model before the forces of a step are evaluated; the same on all ranks.
   */
  struct ModelChange
  {
    bool stencils = false; ///< values or neighbours of rows: the operators have another spectrum
    bool masses = false;   ///< inertia of nodes
    bool cells = false;    ///< cells were removed: an earlier limit of the step says nothing

    ModelChange &operator|=(const ModelChange &other)
    {
      stencils = stencils || other.stencils;
      masses = masses || other.masses;
      cells = cells || other.cells;
      return *this;
    }
  };

  class Parameters;
  class TimeTable;
  template <int dim>
  class Model;
  template <int dim>
  struct OutputView;
  template <int dim>
  struct Part;
  template <int dim>
  struct Tangent;

  /** What a process does in a situation. */
  enum class ProcessRole
  {
    acts,
    is_idle,   ///< it is there with its accounts and columns only, as what resists motion at rest
    is_refused ///< the scene is refused
  };

  /**
   * Something optional that acts in a step: a load, a contact, a failure, a filter, a source of
   * heat. A model has the processes that its scene asks for, and no other; each adds forces,
   * changes the model, observes the step, limits it, names its energies and fills columns of the
   * tables. Processes do not know each other. What one of them does to the model (cells, rows,
   * masses) is a change of the model, to which whoever depends on it responds in model_changed().
   *
   * All functions are collective and are called on all ranks, in the order of the processes, unless
   * they say otherwise. Each has an empty default.
   */
  template <int dim>
  class Process
  {
  public:
    virtual ~Process() = default;

    /** Of a process that the scene names: its section, for messages, and the model as it is
     * initially. Throws InputError. */
    virtual void initialize(const Section &, Model<dim> &) {}

    /** Changes the model before the forces at t_n: cells, rows, masses. Positions are those of t_n,
     * velocities those of t_{n-1/2}. */
    virtual ModelChange change_model(Model<dim> &, const Clock &)
    {
      return {};
    }

    /** The model is about to change, with the smoothed velocity of the rows as they are: whatever
     * has to be accounted for with the present nodes, masses or cells is accounted for now. */
    virtual void prepare_change(Model<dim> &) {}

    /** Partition, rows or masses are other ones; also called once after the start and after a
     * checkpoint was read. */
    virtual void model_changed(Model<dim> &) {}

    /** Nodes were placed anew, at positions to which no motion has led, as when a part is refilled;
     * @p before has their former positions, with the ghosts of now. Called after model_changed().
     */
    virtual void nodes_were_placed(Model<dim> &, const Clock &, const NodalVector & /*before*/) {}

    /** Owned nodes of which @p slides (scalar) is positive are about to be placed at @p position.
     * @p from: where they are now, or those next to them on the surface of now. Moves those deeper
     * in a surface than these, and those that touched it, to where they are as deep, and marks them
     * in @p is_bound (scalar). If @p slides is below one, a node may leave a surface steeply. */
    virtual void keep_outside(const Clock &, const NodalVector & /*slides*/,
                              const NodalVector & /*from*/, NodalVector & /*position*/,
                              NodalVector & /*is_bound*/) const
    {}

    /** How deep nodes with these positions are in its surfaces: @p gaps are their signed distances,
     * negative inside, from the surface that is named, or from the nearest less its radius [L];
     * beyond @p reach any larger number. Returns whether there is such a surface. Not collective.
     */
    virtual bool find_gaps(const std::string & /*surface*/, double /*reach*/,
                           const NodalVector & /*position*/,
                           const std::vector<unsigned int> & /*nodes*/, double /*time*/,
                           std::vector<double> & /*gaps*/) const
    {
      return false;
    }

    /** Called before and after (@p is_added) a part adds its internal force at t_n, number @p part
     * in the model, with the vector that it goes to: at local nodes, ghosts and images not
     * collected yet. Not collective. */
    virtual void part_force(std::size_t /*part*/, const NodalVector & /*force*/, bool /*is_added*/)
    {}

    /** Gives its actions their forces at t_n. @p force has the nodal forces of the parts and of the
     * processes before this one, at owned nodes [M L/T^2]. */
    virtual void add_forces(Model<dim> &, const Clock &, const NodalVector & /*force*/) {}

    /** Adds how the forces of the last add_forces() change with positions and velocities, as far
     * as the tangent asks for it: bodies at rest for the stiffness, the estimate of the stable step
     * for the viscosity. What is left out costs iterations, and the step may not be stable. */
    virtual void linearize(Model<dim> &, const Clock &, Tangent<dim> &) {}

    /** A step of bodies at rest begins, where nothing resists rates, and what is apart by less than
     * @p touch_distance [L] touches. Forces are asked for at several positions, each time with the
     * records as this function leaves them. The clock has in `stable_step` the time of which
     * springs of contacts are made, and in `previous_step` the length of the step, zero at the
     * start of the run. */
    virtual void begin_trials(Model<dim> &, const Clock &, double /*touch_distance*/) {}

    /** What made the last call useless on this rank, for a message; empty if nothing did. Not
     * thrown from there, since other ranks do not know. Not collective. */
    virtual std::string failure() const
    {
      return {};
    }

    /** Prescribes components of the acceleration of owned nodes at t_n, or gives forces to actions
     * that follow it; the size of the coming step is known now. */
    virtual void constrain_acceleration(Model<dim> &, const Clock &) {}

    /** Works and impulses of the step, beside those of its actions: the acceleration at t_n is
     * complete, with its ghosts. */
    virtual void after_acceleration(Model<dim> &, const Clock &) {}

    /** Positions are those of t_{n+1}, velocities those of t_{n+1/2}. */
    virtual void after_motion(Model<dim> &, const Clock &) {}

    /** What it does where not every process is made for; set when it is made. */
    struct Roles
    {
      /** Steps of bodies at rest (`Time integration`): they ask for forces at trial positions
       * (act(), part_force(), linearize()), and for works and impulses (complete_step()) where the
       * equilibrium is found; nothing else of a step is called. */
      ProcessRole rest = ProcessRole::acts;
      /** Cells are divided in the run: the records go over to a mesh with other cells. */
      ProcessRole divided_cells = ProcessRole::acts;
      /** Nodes on surfaces are placed anew: nodes_were_placed(). */
      ProcessRole placed_nodes = ProcessRole::acts;
    };
    Roles roles;

    /** The fraction of @p stable_step, the limit of the step of the bodies [T], at which they are
     * stable together with the process. The same on all ranks. */
    virtual double stable_fraction(double /*stable_step*/) const
    {
      return 1.;
    }

    /** Gives its sources of heat (Actions::add_heat()) that of a thermal step from @p begin to @p
     * end, where it does not come with the steps of the mechanics. */
    virtual void add_heat(Model<dim> &, double /*begin*/, double /*end*/) {}

    /** Adds this rank's shares of its energies and impulses, beside those of its actions. */
    virtual void account(EnergyAccounts &) const {}

    /** Fills columns of the table over time, beyond those of its energies and its heat. */
    virtual void report(const Model<dim> &, TimeTable &) const {}

    /** Adds entries to the summary of the run. */
    virtual void summarize(const Model<dim> &, const TimeTable &, Json & /*summary*/) const {}

    /** Lines for the audit. */
    virtual void describe(const Model<dim> &, std::ostream &) const {}

    /** When warnings are asked for. */
    enum class Occasion
    {
      audit,       ///< before the run: about the input
      row,         ///< with each row of the table over time: what has come up since
      energy_lost, ///< the balance of energy does not hold, and ends the run: why
      end
    };
    /** What should be known then: sentences, the same on all ranks. */
    virtual std::vector<std::string> warnings(const Model<dim> &, const Clock &, Occasion)
    {
      return {};
    }

    /** Adds what outputs may show. Not collective. */
    virtual void show(OutputView<dim> &) const {}

    /** What is kept from step to step, beside what its actions keep; listed in its constructor or
     * in initialize(). It is read when the model has the state of its nodes and points. */
    Records records;

    /** Of that, which cells and particles there are: read before the state of parts and nodes;
     * complete when that of the parts is read. */
    Records structure;

    /** Its forces and its heat, made in its constructor or in initialize(). */
    Actions actions;

    /** What steps call: add_forces(), and @p force with what it has given. */
    void act(Model<dim> &model, const Clock &clock, NodalVector &force);

    /** add_heat(), and what it has given. Returns whether the process ever heats. */
    bool give_heat(Model<dim> &model, double begin, double end);

    /** constrain_acceleration(), and the actions that follow the acceleration. */
    void constrain(Model<dim> &model, const Clock &clock);

    /** after_acceleration(), and works and impulses of the actions. */
    void complete_step(Model<dim> &model, const Clock &clock);

    /** account(), and the works of the actions. */
    void add_energies(EnergyAccounts &accounts) const;

  private:
    void collect_heat(Model<dim> &model, bool on_rank_only);
  };

  /**
   * Makes the processes of one kind from a parameter file, or none. A kind is known by one line,
   * TOMBOLO_REGISTER_PROCESS_KIND, in the source file of the process; nothing else in the library
   * is edited. Kinds whose entries stand in sections of their own derive from this class; a process
   * that the file names in `Processes` is a plug-in of kind Process.
   */
  template <int dim>
  class ProcessKind
  {
  public:
    virtual ~ProcessKind() = default;

    /** Declares entries and sections. */
    virtual void declare_parameters(Parameters &) const {}

    /** Refuses what can be seen to be wrong without a mesh. Throws InputError. */
    virtual void validate(const Parameters &, const std::vector<Part<dim>> &) const {}

    /** Prepares parts that have no mesh yet. Throws InputError. */
    virtual void prepare(const Parameters &, std::vector<Part<dim>> &) const {}

    /** The process, or null where the scene does not ask for it. Throws InputError. Collective. */
    virtual std::unique_ptr<Process<dim>> create_one(const Parameters &, Model<dim> &) const
    {
      return nullptr;
    }

    /** All processes of the kind that the scene asks for, in their order. Collective. */
    virtual std::vector<std::unique_ptr<Process<dim>>> create(const Parameters &parameters,
                                                              Model<dim> &model) const
    {
      std::vector<std::unique_ptr<Process<dim>>> result;
      if (auto process = create_one(parameters, model))
        result.push_back(std::move(process));
      return result;
    }
  };

  /** Where a process stands among the others: lower ones come first. */
  namespace process_order
  {
    constexpr int damping = -10, sections = -5, prescribed_motion = 0, loads = 10, erosion = 20,
                  conversion = 30, bond_failure = 40, renewal = 50, mass_scaling = 60, contact = 70,
                  fragment_contact = 80, named = 100;
  } // namespace process_order

  /** All kinds, by order. */
  template <int dim>
  class ProcessKinds
  {
  public:
    static ProcessKinds &instance();

    void add(int order, std::unique_ptr<const ProcessKind<dim>> kind);

    /** In the order of the steps. */
    std::vector<const ProcessKind<dim> *> all() const;

  private:
    std::vector<std::pair<int, std::unique_ptr<const ProcessKind<dim>>>> kinds;
  };

  template <int dim>
  struct PluginKind<Process<dim>>
  {
    static constexpr const char *name = "process";
  };

  namespace internal
  {
    template <int dim, typename Kind>
    struct ProcessKindRegistration
    {
      explicit ProcessKindRegistration(const int order)
      {
        ProcessKinds<dim>::instance().add(order, std::make_unique<Kind>());
      }
    };
  } // namespace internal
} // namespace tombolo

/** Makes the class template Kind<dim> known as a ProcessKind. To stand once, in a source file. */
#define TOMBOLO_REGISTER_PROCESS_KIND(Kind, order)                                                 \
  namespace                                                                                        \
  {                                                                                                \
    const ::tombolo::internal::ProcessKindRegistration<2, Kind<2>>                                 \
        TOMBOLO_UNIQUE_NAME(process_kind_2_)(order);                                               \
    const ::tombolo::internal::ProcessKindRegistration<3, Kind<3>>                                 \
        TOMBOLO_UNIQUE_NAME(process_kind_3_)(order);                                               \
  }
