// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/subcycling.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/model/moving_parts.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  namespace
  {
    using Ratios = std::vector<std::vector<unsigned int>>; // by part and cell; none: one

    /** Limits of cells that have left their part are larger. */
    constexpr double departed_limit = 1e200;

    /** Calls @p use(part, cell, limit) with eq. (41), by its present inertia, for each cell of this
     * rank that can have longer steps. */
    template <int dim, typename Use>
    void for_limits(const Model<dim> &model, const Use &use)
    {
      std::vector<double> limits;
      for (std::size_t p = 0; p < model.parts.size(); ++p)
      {
        const Part<dim> &part = model.parts[p];
        if (part.template as<GroupedCells>() == nullptr)
          continue;
        part.formulation->courant_limits(model.state.position, limits);
        for (std::size_t cell = 0; cell < limits.size(); ++cell)
          use(p, cell, limits[cell] * std::sqrt(part.inertia.empty() ? 1. : part.inertia[cell]));
      }
    }

    /** The largest limit of a cell by the spectrum over eq. (41), from the @p limit of the scene:
     * cells of one kind have a common factor. Collective. */
    template <int dim>
    double scale_of_limits(const Model<dim> &model, const double limit)
    {
      double smallest = StepLimit().time_step;
      for_limits(model, [&](const std::size_t, const std::size_t, const double cell_limit)
                 { smallest = std::min(smallest, cell_limit); });
      return std::max(1., limit / Utilities::MPI::min(smallest, model.communicator));
    }

    /** Calls @p count(part, number, ratio) for parts of this rank with the number of particles or
     * cells with each step, and for each further cell that has not left. */
    template <int dim, typename Count>
    void for_ratios(const Model<dim> &model, const Ratios &ratios, const Count &count)
    {
      for (std::size_t p = 0; p < model.parts.size(); ++p)
        if (const Part<dim> &part = model.parts[p]; part.template as<GroupedCells>() == nullptr)
          count(p,
                part.particles != nullptr ? part.formulation->particle_nodes().size()
                                          : std::size_t(part.formulation->n_cells()),
                1u);
      for_limits(model,
                 [&](const std::size_t p, const std::size_t cell, const double limit)
                 {
                   if (limit < departed_limit)
                     count(p, std::size_t(1), ratios[p][cell]);
                 });
    }

    /** The ratio of a cell whose limit is so many of the smallest steps. */
    unsigned int ratio_up_to(const double n_steps, const unsigned int largest)
    {
      // Ratios are those of the mesh, which a factor near to one does not change.
      constexpr double tolerance = 1.02;
      unsigned int ratio = 1;
      while (2 * ratio <= std::min(tolerance * n_steps, double(largest)))
        ratio *= 2;
      return ratio;
    }

    /** The ratios by the limits of the cells, each times @p scale in the smallest steps. */
    template <int dim>
    Ratios ratios_by_limits(const Model<dim> &model, const double scale, const unsigned int largest)
    {
      Ratios ratios(model.parts.size());
      for_limits(model,
                 [&](const std::size_t p, const std::size_t, const double cell_limit)
                 {
                   // Cells that have left count as new cells beside the others.
                   ratios[p].push_back(
                       cell_limit < departed_limit ? ratio_up_to(scale * cell_limit, largest) : 1);
                 });
      return ratios;
    }

    /** The cost of forces with these ratios over that in single steps. Collective. */
    template <int dim>
    double relative_cost(const Model<dim> &model, const Ratios &ratios)
    {
      std::array<double, 2> costs{};
      for_ratios(model, ratios,
                 [&](const std::size_t p, const std::size_t number, const unsigned int ratio)
                 {
                   const Part<dim> &part = model.parts[p];
                   const StepCost part_cost = part.formulation->step_cost(*part.material, 1.);
                   const double cost = double(number) * (part_cost.per_cell + part_cost.per_node);
                   costs[0] += cost;
                   costs[1] += cost * (1. - 1. / ratio);
                 });
      costs = ordered_sum(costs, model.communicator);
      return costs[0] > 0. ? 1. - costs[1] / costs[0] : 1.;
    }
  } // namespace

  template <int dim>
  double cost_with_longer_steps(const Model<dim> &model, const double limit)
  {
    return relative_cost(model, ratios_by_limits(model, scale_of_limits(model, limit) / limit, 8));
  }

  template double cost_with_longer_steps(const Model<2> &, double);
  template double cost_with_longer_steps(const Model<3> &, double);

  /**
   * Cells with longer steps than the smallest of the scene (StepGroups), chosen by the stable step
   * of each (eq. (41) of Pan et al. 2019) over that of the scene by its spectrum. One layer of
   * cells around those of each ratio has it, too: waves that only finer cells carry end there. The
   * choice is made at the start, and again at the first step of a cycle where the limits have
   * changed, or where a cell with longer steps touches something, whose springs would resonate with
   * them, or is to leave or lies beside one that leaves.
   */
  template <int dim>
  class Subcycling : public Process<dim>
  {
  public:
    Subcycling(const unsigned int largest_ratio, const Parameters &parameters, Model<dim> &model)
        : largest_ratio(largest_ratio), model(model), groups(model.step_groups),
          estimator(Entries(parameters.section("Time step")).subsection("spectral"), false)
    {
      for (Part<dim> &part : model.parts)
      {
        groups.parts.push_back(part.template as<GroupedCells>());
        if (groups.parts.back() != nullptr)
          part.step_ratios.assign(part.formulation->n_cells(), 1);
      }
      this->roles = {ProcessRole::is_refused, ProcessRole::is_refused, ProcessRole::acts};
      model.signals.nodes_placed.connect(
          [this](const Clock &, const NodalVector &former)
          {
            for (auto &group : groups.groups)
              for (unsigned int i = 0; i < former.partition()->n_local(); ++i)
                for (unsigned int d = 0; d < dim; ++d)
                  group.position.node(i)[d] +=
                      this->model.state.position.node(i)[d] - former.node(i)[d];
          });
      this->observed.energies.connect(
          [this](EnergyAccounts &energies)
          {
            energies.add("energy between steps", EnergyKind::stored,
                         groups.work_ahead(this->model.state.position));
          });
      this->observed.audit.connect(
          [this](std::ostream &text)
          {
            begin();
            describe(text);
          });
      this->observed.result("subcycling", [this] { return result(); });
      list_records();
    }

    ModelChange change_model(Model<dim> &, const Clock &clock) override
    {
      ModelChange change;
      if (groups.step_in_cycle == 0)
        change.cells = begin() || chooses_again(clock);
      return change;
    }

    void after_acceleration(const Model<dim> &, const Clock &clock) override
    {
      if (choice.stable_step == 0.)
        choice.stable_step = clock.stable_step;
      for (const auto &process : model.processes)
        if (process->observed.step_limits.is_connected())
          process->actions.for_touched_nodes([&](const unsigned int node)
                                             { *groups.fast_nodes.node(node) = 1.; });
    }

    void after_motion(const Model<dim> &, const Clock &, NodalState &) override
    {
      groups.complete_step();
    }

    void model_changed(const Model<dim> &) override
    {
      const auto &partition = model.state.partition();
      if (groups.fast_nodes.partition() == partition) // only rows and masses have changed
        return;
      if (groups.fast_nodes.partition() == nullptr)
        groups.fast_nodes.reinit(partition, Quantity::scalar);
      else
        groups.fast_nodes.move_to(partition);
      groups.set_partition(model);
    }

    static void declare_parameters(Parameters &parameters)
    {
      read(Entries(parameters.handler()).subsection("Time step"));
    }

    static void prepare(const Parameters &parameters, std::vector<Part<dim>> &parts)
    {
      if (std::none_of(parts.begin(), parts.end(), has_motion<dim>) ||
          read(parameters.section("Time step")) == 1)
        return;
      for (Part<dim> &part : parts)
        if (auto *const cells = part.template as<GroupedCells>())
          cells->prepare_groups();
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      if (!model.has_mechanics)
        return nullptr;
      const unsigned int largest_ratio = read(parameters.section("Time step"));
      if (largest_ratio == 1)
        return nullptr;
      const Section section = parameters.section("Time step").subsection(section_name);
      if (std::all_of(model.parts.begin(), model.parts.end(),
                      [](const Part<dim> &part)
                      { return part.template as<GroupedCells>() == nullptr; }))
        section.fail("Largest ratio", "no part has cells that can take longer steps: these are "
                                      "elements; allowed is 1.");
      if (model.bridge->is_trace())
        section.fail("Largest ratio", "elements see the field of the particles in each step "
                                      "(`Bridge` = trace); allowed is 1.");
      return std::make_unique<Subcycling>(largest_ratio, parameters, model);
    }

  private:
    static constexpr const char *section_name = "Subcycling";

    /** The largest ratio, from the section of the time step. */
    static unsigned int read(const Entries &time_step)
    {
      return static_cast<unsigned int>(
          std::stoul(time_step.subsection(section_name)
                         .choice("Largest ratio", "1", "1|2|4|8|16",
                                 "Cells of elements take one step for 2, 4, 8 or 16 of the "
                                 "smallest of the scene, as far "
                                 "as their own limit allows and up to this number. Particles, "
                                 "smoothed cells, and cells "
                                 "that touch something, are about to be removed or to become "
                                 "particles, or lie beside "
                                 "such cells, take each step. 1: all cells do.")));
    }

    void list_records()
    {
      Records &structure_records = this->structure.group("subcycling");
      structure_records.value("is chosen", is_chosen);
      for (unsigned int p = 0; p < model.parts.size(); ++p)
        if (groups.parts[p] != nullptr)
          structure_records.group("part " + model.parts[p].name)
              .archived(
                  [this, p](auto &archive)
                  {
                    archive.set_rows(model.persistent_ids_of_points(p));
                    std::vector<unsigned int> &ratios = model.parts[p].step_ratios;
                    std::vector<double> numbers(ratios.begin(), ratios.end());
                    archive.rows("step ratios", 1, numbers);
                    ratios.assign(numbers.begin(), numbers.end());
                  });
      structure_records.on_reading([this] { adopt(); });

      Records &all = this->records.group("subcycling");
      all.value("step in cycle", groups.step_in_cycle);
      all.list(
          [this](Records &now)
          {
            for (auto &group : groups.groups)
            {
              const std::string ratio = " of ratio " + std::to_string(group.ratio);
              now.value("age" + ratio, group.age);
              now.nodal("position" + ratio, dim, group.position);
              for (auto &share : group.shares)
              {
                const std::string force_name =
                    "force of part " + model.parts[share.part].name + ratio;
                now.nodal(force_name, dim, share.force);
                now.nodal("last " + force_name, dim, share.last_force);
              }
            }
          });
      all.nodal("touched", 1, groups.fast_nodes);
      all.numbers("choice", choice.stable_step, choice.limit, choice.scale);
      all.value("step of choice", choice.step);
      estimator.list(all.group("spectral estimator"), model);
      all.on_reading([this] { groups.set_partition(model); });
    }

    /** Makes the first choice, if it is not made. Returns whether it was made now. Collective. */
    bool begin()
    {
      if (is_chosen)
        return false;
      choose();
      adopt();
      return true;
    }

    /** Repeats the choice where there may be a better one. Returns whether it has changed.
     * Collective. */
    bool chooses_again(const Clock &clock)
    {
      int touches = 0;
      for (const auto &group : groups.groups)
        for (const unsigned int node : group.owned)
          touches = *groups.fast_nodes.node(node) > 0. ? 1 : touches;
      const bool is_needed = Utilities::MPI::max(touches, model.communicator) == 1;
      constexpr unsigned long shortest_interval = 200;
      const bool is_due =
          clock.step >= choice.step + shortest_interval && limits_have_changed(clock);
      if (!is_needed && !is_due)
        return false;
      std::vector<std::vector<unsigned int>> before;
      for (const Part<dim> &part : model.parts)
        before.push_back(part.step_ratios);
      if (is_due && !is_needed)
        groups.fast_nodes.set_zero(); // present contacts mark them again
      choose();
      choice.step = clock.step;
      choice.stable_step = 0.;
      int is_other = 0;
      for (std::size_t p = 0; p < before.size(); ++p)
        if (before[p] != model.parts[p].step_ratios)
          is_other = 1;
      if (Utilities::MPI::max(is_other, model.communicator) == 0)
        return false;
      model.bridge->smooth_velocity(model.state);
      groups.synchronize(model, clock,
                         model.heat ? &model.heat->state.present_temperature : nullptr);
      adopt();
      return true;
    }

    /** Whether the limit of the scene has changed, or a cell with a longer step limits it now.
     * Collective. */
    bool limits_have_changed(const Clock &clock) const
    {
      constexpr double threshold = 0.2;
      if (choice.stable_step > 0. &&
          std::abs(clock.stable_step - choice.stable_step) > threshold * choice.stable_step)
        return true;
      std::array<double, 2> smallest = {{StepLimit().time_step, StepLimit().time_step}};
      for_limits(model,
                 [&](const std::size_t p, const std::size_t cell, const double limit)
                 {
                   const unsigned int ratio = model.parts[p].step_ratios[cell];
                   double &kind_limit = smallest[ratio > 1 ? 1 : 0];
                   kind_limit = std::min(kind_limit, choice.scale * limit / ratio);
                 });
      for (double &kind_limit : smallest)
        kind_limit = Utilities::MPI::min(kind_limit, model.communicator);
      constexpr double tolerance = 0.93;
      return smallest[1] < tolerance * std::min(choice.limit, smallest[0]);
    }

    /** Finds the ratios of all cells (Part::step_ratios). Collective. */
    void choose()
    {
      is_chosen = true;
      choice.limit = round_down(estimator.estimate(model, choice.limit).time_step);
      groups.first_step = choice.limit;
      choice.scale = scale_of_limits(model, choice.limit);
      const Ratios ratios = ratios_by_limits(model, choice.scale / choice.limit, largest_ratio);
      for (std::size_t p = 0; p < ratios.size(); ++p)
        model.parts[p].step_ratios = ratios[p];
      spread_small_steps();
    }

    /** Calls @p use(part, number of the cell in it, its nodes) for each cell of this rank. */
    template <typename Use>
    void for_cells(const Use &use) const
    {
      std::vector<types::global_dof_index> nodes;
      for (unsigned int p = 0; p < model.parts.size(); ++p)
      {
        unsigned int number = 0;
        for (const auto &cell : cells_of_part(*model.nodes, *model.part_cells, p))
        {
          model.nodes->cell_nodes(cell, nodes);
          for (types::global_dof_index &node : nodes)
            node = model.state.partition()->local_index(node);
          use(p, number++, nodes);
        }
      }
    }

    unsigned int ratio_of(const unsigned int part, const unsigned int cell) const
    {
      return groups.parts[part] != nullptr ? model.parts[part].step_ratios[cell] : 1;
    }

    /** Sets the ratio of the cells beside those of each ratio to this ratio, and gives the shortest
     * step to cells at nodes that have touched something, and to cells beside them. Collective. */
    void spread_small_steps()
    {
      NodalVector marks(model.state.partition(), Quantity::scalar);
      for (unsigned int ratio = 1; ratio < largest_ratio; ratio *= 2)
      {
        const auto spread = [&](const auto &is_mark)
        {
          marks.set_zero();
          is_mark();
          marks.collect();
          marks.distribute();
          for_cells(
              [&](const unsigned int p, const unsigned int cell, const auto &nodes)
              {
                if (groups.parts[p] != nullptr &&
                    std::any_of(nodes.begin(), nodes.end(),
                                [&](const auto node)
                                { return *marks.node(static_cast<unsigned int>(node)) > 0.; }))
                  model.parts[p].step_ratios[cell] =
                      std::min(model.parts[p].step_ratios[cell], ratio);
              });
        };
        if (ratio == 1)
          spread(
              [&]
              {
                for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
                  *marks.node(i) = *groups.fast_nodes.node(i);
              });
        spread(
            [&]
            {
              for_cells(
                  [&](const unsigned int p, const unsigned int cell, const auto &nodes)
                  {
                    for (unsigned int k = 0; ratio_of(p, cell) <= ratio && k < nodes.size(); ++k)
                      *marks.node(static_cast<unsigned int>(nodes[k])) += 1.;
                  });
            });
      }
    }

    /** Applies the result of choose(). Collective. */
    void adopt()
    {
      for (std::size_t p = 0; p < model.parts.size(); ++p)
        if (groups.parts[p] != nullptr)
          groups.parts[p]->set_step_ratios(model.parts[p].step_ratios);
      groups.make(model);
    }

    /** Numbers of cells and particles by ratio, over all ranks, and the cost of their steps over
     * that of single ones. Collective. */
    std::pair<std::vector<unsigned long>, double> extent() const
    {
      std::vector<unsigned long> counts(groups.cycle() + 1, 0);
      Ratios ratios;
      for (const Part<dim> &part : model.parts)
        ratios.push_back(part.step_ratios);
      for_ratios(model, ratios,
                 [&](const std::size_t, const std::size_t number, const unsigned int ratio)
                 { counts[ratio] += number; });
      for (unsigned long &count : counts)
        count = Utilities::MPI::sum(count, model.communicator);
      return {counts, relative_cost(model, ratios)};
    }

    void describe(std::ostream &text) const
    {
      const auto [counts, cost] = extent();
      text << "  subcycling: ";
      for (unsigned int ratio = 1; ratio < counts.size(); ++ratio)
        if (counts[ratio] > 0)
          text << counts[ratio] << " cells or particles take "
               << (ratio == 1 ? "each step" : "one step for " + std::to_string(ratio)) << ", ";
      text << "forces cost " << cost << " of those of single steps\n";
    }

    Json result() const
    {
      const auto [counts, cost] = extent();
      Json result = Json::object();
      for (unsigned int ratio = 1; ratio < counts.size(); ++ratio)
        if (counts[ratio] > 0)
          result["cells_of_ratio_" + std::to_string(ratio)] = counts[ratio];
      result["cost_of_forces"] = cost;
      return result;
    }

    unsigned int largest_ratio;
    Model<dim> &model;
    StepGroups<dim> &groups;
    SpectralEstimator<dim> estimator;

    struct Choice
    {
      double limit = 0;       ///< of the scene in single steps [T]
      double scale = 1;       ///< of the limit of cells over eq. (41)
      double stable_step = 0; ///< of the result; zero: not computed yet [T]
      unsigned long step = 0; ///< when it was made
    };
    Choice choice;
    bool is_chosen = false;
  };

  TOMBOLO_REGISTER_PROCESS(Subcycling, process_order::subcycling)
} // namespace tombolo
