// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/base/json.h>
#include <tombolo/model/actions.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/records.h>

#include <functional>
#include <iosfwd>
#include <map>
#include <memory>
#include <string>
#include <typeindex>
#include <utility>
#include <vector>

namespace tombolo
{
  /** Functions that are called together, in the order in which they were connected. */
  template <typename... Arguments>
  class Signal
  {
  public:
    void connect(std::function<void(Arguments...)> slot)
    {
      slots.push_back(std::move(slot));
    }

    bool is_connected() const
    {
      return !slots.empty();
    }

    void operator()(Arguments... arguments) const
    {
      for (const auto &slot : slots)
        slot(arguments...);
    }

  private:
    std::vector<std::function<void(Arguments...)>> slots;
  };

  /** What has changed in a model before the forces of a step are evaluated; the same on all ranks.
   */
  struct ModelChange
  {
    bool stencils = false; ///< values or neighbours of rows: the operators have another spectrum
    bool masses = false;   ///< inertia of nodes
    bool cells = false;    ///< cells were removed: an earlier limit of the step is not valid

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
  class BalanceHistory;
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
   * heat. A model has the processes that its scene requests, and no other; each adds forces,
   * changes the model, observes the step, limits it, names its energies and fills columns of the
   * tables. Processes do not refer to each other. What one of them does to the model (cells, rows,
   * masses) is a change of the model, to which dependent processes respond in model_changed().
   * The few that need more connect to ModelSignals.
   *
   * All functions are collective and are called on all ranks, in the order of the processes, unless
   * stated otherwise. Each has an empty default.
   */
  template <int dim>
  class Process
  {
  public:
    virtual ~Process() = default;

    /** Of a process that the scene names: its section, for messages, and the model as it is
     * initially. Throws InputError. */
    virtual void initialize(const Section &, const Model<dim> &) {}

    /** Changes the model before the forces at t_n: cells, rows, masses. Positions are those of t_n,
     * velocities those of t_{n-1/2}. */
    virtual ModelChange change_model(Model<dim> &, const Clock &)
    {
      return {};
    }

    /** Partition, rows or masses have changed; also called once after the start and after a
     * checkpoint was read. */
    virtual void model_changed(const Model<dim> &) {}

    /** Sets the forces of its actions at t_n. @p force has the nodal forces of the parts and of the
     * processes before this one, at owned nodes [M L/T^2]. */
    virtual void add_forces(const Model<dim> &, const Clock &, const NodalVector & /*force*/) {}

    /** Adds how the forces of the last add_forces() change with positions and velocities, as far
     * as the tangent requires it: bodies at rest for the stiffness, the estimate of the stable step
     * for the viscosity. What is left out costs iterations, and the step may not be stable. */
    virtual void linearize(const Model<dim> &, const Clock &, Tangent<dim> &) {}

    /** Prescribes components of the acceleration of owned nodes at t_n in @p state, or sets forces
     * of actions that follow it; the size of the coming step is known now. */
    virtual void constrain_acceleration(const Model<dim> &, const Clock &, NodalState & /*state*/)
    {}

    /** Works and impulses of the step, beside those of its actions: the acceleration at t_n is
     * complete, with its ghosts. */
    virtual void after_acceleration(const Model<dim> &, const Clock &) {}

    /** Positions in @p state are those of t_{n+1}, velocities those of t_{n+1/2}. */
    virtual void after_motion(const Model<dim> &, const Clock &, NodalState & /*state*/) {}

    /** What it does where not every process is made for; set when it is made. */
    struct Roles
    {
      /** Steps of bodies at rest (`Time integration`): they request forces at trial positions
       * (act(), linearize()), and for works and impulses (complete_step()) where the equilibrium is
       * found; nothing else of a step is called. */
      ProcessRole rest = ProcessRole::acts;
      /** Cells are divided in the run: the records go over to a mesh with other cells. */
      ProcessRole divided_cells = ProcessRole::acts;
      /** Nodes on surfaces are placed anew: ModelSignals::nodes_placed. */
      ProcessRole placed_nodes = ProcessRole::acts;
    };
    Roles roles;

    /** What a ProcessKind does, of a class that is registered by TOMBOLO_REGISTER_PROCESS and has
     * such functions of its own. */
    static void declare_parameters(Parameters &) {}
    static void validate(const Parameters &, const std::vector<Part<dim>> &) {}
    static void prepare(const Parameters &, std::vector<Part<dim>> &) {}

    /** Sets its sources of heat (Actions::add_heat()) to that of a thermal step from @p begin to @p
     * end, where it does not come with the steps of the mechanics. */
    virtual void add_heat(const Model<dim> &, double /*begin*/, double /*end*/) {}

    /** When warnings are requested. */
    enum class Occasion
    {
      audit, ///< before the run: about the input
      row,   ///< with each row of the table over time: what has come up since
      end
    };

    /** What a process shows to others, beside its actions; listed in its constructor or in
     * initialize(). */
    struct Observed
    {
      /** This rank's share of an energy [M L^2/T^2]. */
      void energy(const std::string &name, EnergyKind kind, const double &share);

      /** A column of the table over time; the value is the same on all ranks. */
      void column(const std::string &name, const std::string &unit, std::function<double()> value);

      /** An entry of the summary of the run; the value is the same on all ranks. */
      void result(const std::string &name, std::function<Json()> value);

      /** Fills the rows of a table of histories, by its name; of one that several processes fill,
       * those with a lower @p order come first. Collective. */
      void history(const std::string &table, std::function<void(BalanceHistory<dim> &)> rows,
                   int order = 0);

      /** An object of a type by which others find it (shown_by_processes()): refers to it. */
      template <typename T>
      void object(const T &shown)
      {
        objects.emplace_back(typeid(T), &shown);
      }

      /** Add this rank's shares of other energies, and of momenta. */
      Signal<EnergyAccounts &> energies;
      /** Fill columns whose number is not known before. */
      Signal<TimeTable &> columns;
      /** Add to the summary what follows from the table. */
      Signal<const TimeTable &, Json &> results;
      /** Write lines for the audit. */
      Signal<std::ostream &> audit;
      /** Add warnings: sentences, the same on all ranks. */
      Signal<const Clock &, Occasion, std::vector<std::string> &> warnings;
      /** Add what outputs may show. Not collective. */
      Signal<OutputView<dim> &> views;
      /** Lower the fraction of the limit of the step of the bodies [T] at which they are stable
       * together with the process. The same on all ranks. */
      Signal<double /*stable_step*/, double & /*fraction*/> step_limits;
      std::vector<std::pair<std::type_index, const void *>> objects;
    };
    Observed observed;

    /** What makes the last forces useless on this rank, for a message; empty if nothing does. Not
     * thrown, since other ranks have no failure. */
    std::string failure;

    /** What is kept from step to step, beside what its actions keep; listed in its constructor or
     * in initialize(). It is read when the model has the state of its nodes and points. */
    Records records;

    /** Of that, which cells and particles there are: read before the state of parts and nodes;
     * complete when that of the parts is read. */
    Records structure;

    /** Its forces and its heat, made in its constructor or in initialize(). */
    Actions actions;

    /** For steps: add_forces(), whose forces are added to @p force. */
    void act(const Model<dim> &model, const Clock &clock, NodalVector &force);

    /** For steps: add_heat(). Returns whether the process has sources of heat. */
    bool supply_heat(const Model<dim> &model, double begin, double end);

    /** constrain_acceleration(), and the actions that follow the acceleration. */
    void constrain(Model<dim> &model, const Clock &clock);

    /** after_acceleration(), and works and impulses of the actions. */
    void complete_step(Model<dim> &model, const Clock &clock);

    /** The observed energies, and the works of the actions. */
    void add_energies(EnergyAccounts &accounts) const;

  private:
    void collect_heat(const Model<dim> &model, bool on_rank_only);
  };

  /** The objects of type T that the processes of a model show, such as contacts, in their order. */
  template <typename T, int dim>
  std::vector<const T *> shown_by_processes(const Model<dim> &model)
  {
    std::vector<const T *> result;
    for (const auto &process : model.processes)
      for (const auto &[type, object] : process->observed.objects)
        if (type == typeid(T))
          result.push_back(static_cast<const T *>(object));
    return result;
  }

  /**
   * Makes the processes of one kind from a parameter file, or none. A kind is registered by one
   * line, TOMBOLO_REGISTER_PROCESS_KIND, in the source file of the process; nothing else in the
   * library is edited. A process that is alone of its kind is registered by
   * TOMBOLO_REGISTER_PROCESS instead, and has the functions of its kind itself; one that the file
   * names in `Processes` is a plug-in of kind Process.
   */
  template <int dim>
  class ProcessKind
  {
  public:
    virtual ~ProcessKind() = default;

    /** Declares entries and sections. */
    virtual void declare_parameters(Parameters &) const {}

    /** Checks what can be checked without a mesh. There are no parts where one of the file has no
     * material: nothing is missing then. Throws InputError. */
    virtual void validate(const Parameters &, const std::vector<Part<dim>> &) const {}

    /** Prepares parts that have no mesh yet. Throws InputError. */
    virtual void prepare(const Parameters &, std::vector<Part<dim>> &) const {}

    /** The process, or null where the scene does not request it. Throws InputError. Collective. */
    virtual std::unique_ptr<Process<dim>> create_one(const Parameters &, Model<dim> &) const
    {
      return nullptr;
    }

    /** All processes of the kind that the scene requests, in their order. Collective. */
    virtual std::vector<std::unique_ptr<Process<dim>>> create(const Parameters &parameters,
                                                              Model<dim> &model) const
    {
      std::vector<std::unique_ptr<Process<dim>>> result;
      if (auto process = create_one(parameters, model))
        result.push_back(std::move(process));
      return result;
    }
  };

  /** The kind of processes of one class. Made<dim> has a static function make(), which does what
   * ProcessKind::create_one() describes, and may have others of the names below. */
  template <int dim, template <int> class Made>
  class PlainKind : public ProcessKind<dim>
  {
  public:
    void declare_parameters(Parameters &parameters) const override
    {
      Made<dim>::declare_parameters(parameters);
    }

    void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts) const override
    {
      Made<dim>::validate(parameters, parts);
    }

    void prepare(const Parameters &parameters, std::vector<Part<dim>> &parts) const override
    {
      Made<dim>::prepare(parameters, parts);
    }

    std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                             Model<dim> &model) const override
    {
      return Made<dim>::make(parameters, model);
    }
  };

  /** The order of processes: lower numbers come first. */
  namespace process_order
  {
    constexpr int damping = -10, sections = -5, prescribed_motion = 0, loads = 10, erosion = 20,
                  conversion = 30, bond_failure = 40, renewal = 50, mass_scaling = 60, contact = 70,
                  fragment_contact = 80, named = 100, subcycling = 200;
  } // namespace process_order

  /** All kinds, by order and, where it is the same, by name. */
  template <int dim>
  class ProcessKinds
  {
  public:
    static ProcessKinds &instance();

    void add(const int order, const std::string &name, std::unique_ptr<const ProcessKind<dim>> kind)
    {
      kinds.emplace(std::make_pair(order, name), std::move(kind));
    }

    /** In the order of the steps. */
    std::vector<const ProcessKind<dim> *> all() const;

  private:
    std::multimap<std::pair<int, std::string>, std::unique_ptr<const ProcessKind<dim>>> kinds;
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
      ProcessKindRegistration(const int order, const char *name)
      {
        ProcessKinds<dim>::instance().add(order, name, std::make_unique<Kind>());
      }
    };
  } // namespace internal

  extern template class Process<2>;
  extern template class Process<3>;
} // namespace tombolo

/** Registers the class template Kind<dim> as a ProcessKind. Once, in a source file. */
#define TOMBOLO_REGISTER_PROCESS_KIND(Kind, order)                                                 \
  namespace                                                                                        \
  {                                                                                                \
    const ::tombolo::internal::ProcessKindRegistration<2, Kind<2>>                                 \
        TOMBOLO_UNIQUE_NAME(process_kind_2_)(order, #Kind);                                        \
    const ::tombolo::internal::ProcessKindRegistration<3, Kind<3>>                                 \
        TOMBOLO_UNIQUE_NAME(process_kind_3_)(order, #Kind);                                        \
  }

/** Registers the class template Made<dim> as a process by PlainKind. Once, in a source
 * file. */
#define TOMBOLO_REGISTER_PROCESS(Made, order)                                                      \
  namespace                                                                                        \
  {                                                                                                \
    template <int dim>                                                                             \
    using KindOf##Made = ::tombolo::PlainKind<dim, Made>;                                          \
  }                                                                                                \
  TOMBOLO_REGISTER_PROCESS_KIND(KindOf##Made, order)
