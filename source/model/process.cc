// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/process.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_input.h>
#include <tombolo/output/output.h>

#include <nlohmann/json.hpp>

namespace tombolo
{
  template <int dim>
  void Process<dim>::act(const Model<dim> &model, const Clock &clock, NodalVector &force)
  {
    actions.begin();
    failure.clear();
    add_forces(model, clock, force);
    actions.collect(*model.bridge, force);
    collect_heat(model, false);
  }

  template <int dim>
  void Process<dim>::collect_heat(const Model<dim> &model, const bool on_rank_only)
  {
    if (actions.has_heat())
      actions.collect_heat(model.heat->state.pending, on_rank_only);
  }

  template <int dim>
  bool Process<dim>::supply_heat(const Model<dim> &model, const double begin, const double end)
  {
    add_heat(model, begin, end);
    collect_heat(model, false);
    return actions.has_heat();
  }

  template <int dim>
  void Process<dim>::constrain(Model<dim> &model, const Clock &clock)
  {
    actions.begin(true);
    constrain_acceleration(model, clock, model.state);
    actions.collect_late(*model.bridge, model.conditions->constrained_components(),
                         model.conditions->oblique_nodes(), model.state);
    collect_heat(model, true);
  }

  template <int dim>
  void Process<dim>::complete_step(Model<dim> &model, const Clock &clock)
  {
    after_acceleration(model, clock);
    actions.complete_step(model.state, clock, model.impulses);
    collect_heat(model, true);
  }

  template <int dim>
  void Process<dim>::add_energies(EnergyAccounts &accounts) const
  {
    observed.energies(accounts);
    actions.account(accounts);
  }

  template <int dim>
  void Process<dim>::Observed::energy(const std::string &name, const EnergyKind kind,
                                      const double &share)
  {
    energies.connect([=, &share](EnergyAccounts &accounts) { accounts.add(name, kind, share); });
  }

  template <int dim>
  void Process<dim>::Observed::column(const std::string &name, const std::string &unit,
                                      std::function<double()> value)
  {
    columns.connect([=](TimeTable &table) { table.add(name, unit, value()); });
  }

  template <int dim>
  void Process<dim>::Observed::result(const std::string &name, std::function<Json()> value)
  {
    results.connect([=](const TimeTable &, Json &summary) { summary[name] = value(); });
  }

  template <int dim>
  void Process<dim>::Observed::history(const std::string &table,
                                       std::function<void(BalanceHistory<dim> &)> rows,
                                       const int order)
  {
    views.connect([=](OutputView<dim> &view) { view.histories[table].emplace(order, rows); });
  }

  template <int dim>
  ProcessKinds<dim> &ProcessKinds<dim>::instance()
  {
    static ProcessKinds kinds;
    return kinds;
  }

  template <int dim>
  std::vector<const ProcessKind<dim> *> ProcessKinds<dim>::all() const
  {
    std::vector<const ProcessKind<dim> *> result;
    for (const auto &entry : kinds)
      result.push_back(entry.second.get());
    return result;
  }

  namespace
  {
    /** The processes that the entry `Processes` names: plug-ins of kind Process. */
    template <int dim>
    class NamedProcesses : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        parameters.handler().declare_entry("Processes", "", Patterns::Anything(),
                                           "Names of further processes, each with a section "
                                           "`Process: NAME`: plug-ins that act in a step.");
        for (const std::string &name : section_names(parameters, "Processes"))
        {
          const Entries e = Entries(parameters.handler()).subsection("Process: " + name);
          e.choice("Type", mandatory, Registry<Process<dim>>::instance().selection(),
                   "What the process is.");
          e.plugins<Process<dim>>();
        }
      }

      void validate(const Parameters &parameters, const std::vector<Part<dim>> &) const override
      {
        for (const Section &section : named_sections(parameters, "Processes", "Process"))
          parameters.attempt([&] { create_selected<Process<dim>>(section, "Type"); });
      }

      std::vector<std::unique_ptr<Process<dim>>> create(const Parameters &parameters,
                                                        Model<dim> &model) const override
      {
        std::vector<std::unique_ptr<Process<dim>>> result;
        for (const Section &section : named_sections(parameters, "Processes", "Process"))
        {
          result.push_back(create_selected<Process<dim>>(section, "Type"));
          result.back()->initialize(section, model);
        }
        return result;
      }
    };
  } // namespace

  template class Process<2>;
  template class Process<3>;
  template class ProcessKinds<2>;
  template class ProcessKinds<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(NamedProcesses, process_order::named)
} // namespace tombolo
