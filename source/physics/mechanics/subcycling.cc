// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/exceptions.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>
#include <tombolo/model/step_groups.h>
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
    constexpr const char *section_name = "Subcycling";

    Entries entries_of(const Parameters &parameters)
    {
      return Entries(parameters.section("Time step")).subsection(section_name);
    }

    /** The largest divisor of @p cycle that is not above @p allowed; at least one. */
    unsigned int ratio_in_cycle(const unsigned int cycle, const double allowed)
    {
      unsigned int ratio = 1;
      for (unsigned int divisor = 2; divisor <= cycle; ++divisor)
        if (cycle % divisor == 0 && divisor <= allowed)
          ratio = divisor;
      return ratio;
    }
  } // namespace

  struct SubcyclingSettings
  {
    explicit SubcyclingSettings(const Entries &e)
    {
      largest_ratio = e.integer(
          "Largest ratio", "1", between(1, 24),
          "A cell of elements whose stable step is so many times the smallest of the scene, and "
          "not more times than this, takes one step for so many of the smallest. 1: all cells take "
          "each step. The table over time and the outputs then have steps that all cells take "
          "part in. Cells that can erode or become particles, and cells that touch something, "
          "take each step, and so do particles.");
      n_layers = e.integer(
          "Overlap", "2", between(1, 10),
          "So many layers of cells around those with smaller steps step with them: waves that "
          "only the finer cells carry, and that would resonate with the longer steps, end in "
          "them.");
    }

    unsigned int largest_ratio, n_layers;
  };

  /**
   * Cells that take longer steps than the smallest of the scene: which they are, by the stable step
   * of each (eq. (41) of Pan et al. 2019) over that of the scene by its spectrum. StepGroups has
   * what they do. The choice is made at the start, and again at the first step of a cycle where the
   * limits have become other ones, or where a cell that takes longer steps touches something: a
   * spring of contact can resonate with them.
   */
  template <int dim>
  class Subcycling : public Process<dim>
  {
  public:
    Subcycling(const SubcyclingSettings &settings, const Parameters &parameters, Model<dim> &model)
        : settings(settings), model(model), groups(model.step_groups),
          estimator(Entries(parameters.section("Time step")).subsection("spectral"), false)
    {
      for (Part<dim> &part : model.parts)
      {
        auto *const cells = dynamic_cast<GroupedCells<dim> *>(part.formulation.get());
        groups.parts.push_back(cells != nullptr && cells->can_be_grouped() ? cells : nullptr);
        if (groups.parts.back() != nullptr)
          part.step_ratios.assign(part.formulation->n_cells(), 1);
      }
      this->roles.rest = ProcessRole::is_refused;
      this->roles.divided_cells = ProcessRole::is_refused;
      model.signals.nodes_placed.connect(
          [this](const Clock &, const NodalVector &former)
          {
            for (auto &motion : groups.motions)
              for (unsigned int i = 0; i < former.partition()->n_local(); ++i)
                for (unsigned int d = 0; d < dim; ++d)
                  motion.last_position.node(i)[d] +=
                      this->model.state.position.node(i)[d] - former.node(i)[d];
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
      if (clock.phase == 0)
      {
        change.cells = begin() || wants_other_ratios(clock);
        if (is_planned)
          // The limit of the next step is that of the new ratios.
          choice.stable_step = 0.;
      }
      groups.begin_step(model.state, clock);
      return change;
    }

    /** After the forces of the cells. */
    void add_forces(const Model<dim> &, const Clock &, const NodalVector &) override
    {
      if (is_planned)
        adopt();
    }

    void after_acceleration(const Model<dim> &, const Clock &clock) override
    {
      if (choice.stable_step == 0.)
        choice.stable_step = clock.stable_step;
      for (const auto &process : model.processes)
        if (process->observed.step_limits.is_connected())
          process->actions.for_touched_nodes(
              [&](const unsigned int node)
              {
                touches_slow_cell = touches_slow_cell || *slow_cells.node(node) > 0.;
                *touched.node(node) = 1.;
              });
    }

    void after_motion(const Model<dim> &, const Clock &clock, NodalState &) override
    {
      groups.add_time(clock.next_step);
    }

    void model_changed(const Model<dim> &) override
    {
      const auto &partition = model.state.partition();
      for (auto &motion : groups.motions)
      {
        motion.last_position.move_to(partition);
        motion.velocity.reinit(partition);
      }
      if (touched.partition() == nullptr)
        touched.reinit(partition, Quantity::scalar);
      else
        touched.move_to(partition);
      find_slow_cells();
    }

  private:
    void list_records()
    {
      Records &of_cells = this->structure.group("subcycling");
      of_cells.value("is chosen", is_chosen);
      of_cells.value("cycle", groups.cycle);
      for (unsigned int p = 0; p < model.parts.size(); ++p)
        if (groups.parts[p] != nullptr)
          of_cells.group("part " + model.parts[p].name)
              .archived(
                  [this, p](StateArchive &archive)
                  {
                    archive.set_rows(model.persistent_ids_of_points(p));
                    std::vector<unsigned int> &ratios = model.parts[p].step_ratios;
                    std::vector<double> numbers(ratios.begin(), ratios.end());
                    archive.rows("step ratios", 1, numbers);
                    ratios.assign(numbers.begin(), numbers.end());
                    groups.parts[p]->plan_step_ratios(ratios);
                  });
      of_cells.on_reading(
          [this]
          {
            next_cycle = groups.cycle;
            adopt();
          });

      Records &all = this->records.group("subcycling");
      all.list(
          [this](Records &now)
          {
            for (auto &motion : groups.motions)
            {
              const std::string name = "motion of ratio " + std::to_string(motion.ratio);
              now.nodal(name, dim, motion.last_position);
              now.value("time of " + name, motion.elapsed);
            }
          });
      all.nodal("touched", 1, touched);
      all.numbers("choice", choice.stable_step, choice.limit, choice.scale);
      all.value("step of choice", choice.step);
      all.value("touches slow cell", touches_slow_cell);
      estimator.list(all.group("spectral estimator"), model);
      all.on_reading(
          [this]
          {
            for (auto &motion : groups.motions)
              motion.last_position.distribute();
          });
    }

    /** Makes the first choice, if it is not made. Returns whether it was made now. */
    bool begin()
    {
      if (is_chosen)
        return false;
      choose();
      adopt();
      return true;
    }

    /** Looks for a better choice where there may be one, and plans it. Returns whether it is
     * another one. Collective. */
    bool wants_other_ratios(const Clock &clock)
    {
      const bool touches = Utilities::MPI::max(touches_slow_cell ? 1 : 0, model.communicator) == 1;
      touches_slow_cell = false;
      constexpr unsigned long shortest_interval = 200;
      const bool is_due =
          clock.step >= choice.step + shortest_interval && limits_have_changed(clock);
      if (!touches && !is_due)
        return false;
      std::vector<std::vector<unsigned int>> before;
      for (const Part<dim> &part : model.parts)
        before.push_back(part.step_ratios);
      if (is_due)
        touched.set_zero(); // those of now come back with the next contact
      choose();
      choice.step = clock.step;
      bool is_other = false;
      for (std::size_t p = 0; p < before.size(); ++p)
        is_other = is_other || before[p] != model.parts[p].step_ratios;
      is_planned = Utilities::MPI::max(is_other ? 1 : 0, model.communicator) == 1;
      return is_planned;
    }

    /** Whether the limit of the scene is another one, or a cell with a longer step has become the
     * one that limits it. Collective. */
    bool limits_have_changed(const Clock &clock) const
    {
      constexpr double threshold = 0.2;
      if (choice.stable_step > 0. &&
          std::abs(clock.stable_step - choice.stable_step) > threshold * choice.stable_step)
        return true;
      std::array<double, 2> smallest = {{StepLimit().time_step, StepLimit().time_step}};
      for_limits(
          [&](const std::size_t p, const std::size_t cell, const double limit)
          {
            const unsigned int ratio = model.parts[p].step_ratios[cell];
            double &of_kind = smallest[ratio > 1 ? 1 : 0];
            of_kind = std::min(of_kind, choice.scale * limit / ratio);
          });
      for (double &of_kind : smallest)
        of_kind = Utilities::MPI::min(of_kind, model.communicator);
      constexpr double tolerance = 0.93;
      return smallest[1] < tolerance * std::min(choice.limit, smallest[0]);
    }

    /** Calls @p use(part, cell, limit) with eq. (41), with the inertia that it has, for each cell
     * of this rank that can take longer steps. */
    template <typename Use>
    void for_limits(const Use &use) const
    {
      std::vector<double> limits;
      for (std::size_t p = 0; p < model.parts.size(); ++p)
      {
        if (groups.parts[p] == nullptr)
          continue;
        const Part<dim> &part = model.parts[p];
        part.formulation->courant_limits(model.state.position, limits);
        for (std::size_t cell = 0; cell < limits.size(); ++cell)
          use(p, cell, limits[cell] * std::sqrt(part.inertia.empty() ? 1. : part.inertia[cell]));
      }
    }

    /** Finds the ratios of all cells (Part::step_ratios) and plans them. Collective. */
    void choose()
    {
      is_chosen = true;
      choice.limit = estimator.estimate(model, choice.limit).time_step;
      double smallest = StepLimit().time_step;
      for_limits([&](const std::size_t, const std::size_t, const double limit)
                 { smallest = std::min(smallest, limit); });
      smallest = Utilities::MPI::min(smallest, model.communicator);
      // The spectrum allows cells of one kind more than eq. (41) by a common factor.
      choice.scale = std::max(1., choice.limit / smallest);
      // Ratios are those of the mesh, which a factor near to one does not change.
      constexpr double tolerance = 1.02;
      const double scale = tolerance * choice.scale / choice.limit;

      next_cycle = best_cycle(scale);
      for_limits([&](const std::size_t p, const std::size_t cell, const double limit)
                 { model.parts[p].step_ratios[cell] = ratio_in_cycle(next_cycle, scale * limit); });
      spread_small_steps();
      for (std::size_t p = 0; p < model.parts.size(); ++p)
        if (groups.parts[p] != nullptr)
          groups.parts[p]->plan_step_ratios(model.parts[p].step_ratios);
    }

    /** The number of steps of a cycle whose divisors suit the cells best; of those that cost nearly
     * the same the smallest. Collective. */
    unsigned int best_cycle(const double scale) const
    {
      std::vector<double> costs(settings.largest_ratio, 0.);
      for_limits(
          [&](const std::size_t p, const std::size_t, const double limit)
          {
            const Part<dim> &part = model.parts[p];
            const double cost = part.formulation->cost_per_cell(*part.material, 1.);
            for (unsigned int cycle = 1; cycle <= costs.size(); ++cycle)
              costs[cycle - 1] += cost / ratio_in_cycle(cycle, scale * limit);
          });
      for (double &cost : costs)
        cost = ordered_sum(cost, model.communicator);
      const double least = *std::min_element(costs.begin(), costs.end());
      constexpr double nearly = 1.02;
      const auto best = std::find_if(costs.begin(), costs.end(),
                                     [&](const double cost) { return cost <= nearly * least; });
      return static_cast<unsigned int>(best - costs.begin()) + 1;
    }

    /** Calls @p use(part, number of the cell in it, its nodes) for each cell of this rank. */
    template <typename Use>
    void for_cells(const Use &use) const
    {
      std::vector<unsigned int> next(model.parts.size(), 0);
      std::vector<types::global_dof_index> nodes;
      for (const auto &cell : model.nodes->dof_handler().active_cell_iterators())
        if (cell->is_locally_owned())
        {
          const unsigned int part = model.part_cells->part_of(cell);
          model.nodes->cell_nodes(cell, nodes);
          use(part, next[part]++, nodes);
        }
    }

    /** Gives layers of cells around those with smaller steps, and around nodes that have touched
     * something, these steps. Collective. */
    void spread_small_steps()
    {
      const NodePartition &partition = *model.state.partition();
      std::vector<std::vector<unsigned int>> ratios;
      for (const Part<dim> &part : model.parts)
        ratios.push_back(part.step_ratios);
      const auto ratio_of = [&](const unsigned int p, const unsigned int cell) -> unsigned int
      {
        if (groups.parts[p] != nullptr)
          return ratios[p][cell];
        return is_rigid(p) ? next_cycle : 1;
      };
      NodalVector marks(model.state.partition(), Quantity::scalar);
      for (unsigned int ratio = 1; ratio < next_cycle; ++ratio)
      {
        if (next_cycle % ratio != 0)
          continue;
        marks.set_zero();
        if (ratio == 1)
          for (unsigned int i = 0; i < partition.n_owned(); ++i)
            *marks.node(i) = *touched.node(i);
        for_cells(
            [&](const unsigned int p, const unsigned int cell, const auto &nodes)
            {
              for (unsigned int k = 0; ratio_of(p, cell) <= ratio && k < nodes.size(); ++k)
                *marks.node(partition.local_index(nodes[k])) += 1.;
            });
        for (unsigned int layer = 0; layer < settings.n_layers; ++layer)
        {
          marks.collect();
          marks.distribute();
          NodalVector next(model.state.partition(), Quantity::scalar);
          for_cells(
              [&](const unsigned int p, const unsigned int cell, const auto &nodes)
              {
                const bool is_near = std::any_of(
                    nodes.begin(), nodes.end(),
                    [&](const auto node) { return *marks.node(partition.local_index(node)) > 0.; });
                if (!is_near)
                  return;
                for (const auto node : nodes)
                  *next.node(partition.local_index(node)) += 1.;
                if (groups.parts[p] != nullptr)
                  model.parts[p].step_ratios[cell] =
                      std::min(model.parts[p].step_ratios[cell], ratio);
              });
          marks = std::move(next);
        }
      }
    }

    bool is_rigid(const unsigned int part) const
    {
      return model.parts[part].particles == nullptr &&
             model.parts[part].formulation->points().size() == 0;
    }

    /** What choose() has planned is so from now on: all cells have acted now. */
    void adopt()
    {
      is_planned = false;
      groups.cycle = next_cycle;
      for (GroupedCells<dim> *const cells : groups.parts)
        if (cells != nullptr)
          cells->adopt_step_ratios();
      groups.motions.clear();
      for (unsigned int ratio = 2; ratio <= groups.cycle; ++ratio)
        if (groups.cycle % ratio == 0)
        {
          auto &motion = groups.motions.emplace_back();
          motion.ratio = ratio;
          motion.last_position = model.state.position.copy();
          motion.velocity.reinit(model.state.partition());
        }
      find_slow_cells();
    }

    /** Marks nodes of cells that do not take each step. Collective. */
    void find_slow_cells()
    {
      slow_cells.reinit(model.state.partition(), Quantity::scalar);
      for_cells(
          [&](const unsigned int p, const unsigned int cell, const auto &nodes)
          {
            if (groups.parts[p] != nullptr && model.parts[p].step_ratios[cell] > 1)
              for (const auto node : nodes)
                *slow_cells.node(model.state.partition()->local_index(node)) += 1.;
          });
      slow_cells.collect();
    }

    /** Numbers of cells by ratio, over all ranks, and the cost of their steps over that of single
     * ones. Collective. */
    std::pair<std::vector<unsigned long>, double> extent() const
    {
      std::vector<unsigned long> counts(groups.cycle + 1, 0);
      std::array<double, 2> costs{};
      for (std::size_t p = 0; p < model.parts.size(); ++p)
      {
        const Part<dim> &part = model.parts[p];
        const double cost = part.formulation->cost_per_cell(*part.material, 1.);
        const unsigned int n = std::max<unsigned int>(
            part.formulation->n_cells(),
            static_cast<unsigned int>(
                part.particles != nullptr ? part.formulation->particle_nodes().size() : 0));
        for (unsigned int cell = 0; cell < n; ++cell)
        {
          const unsigned int ratio = groups.parts[p] != nullptr ? part.step_ratios[cell] : 1;
          ++counts[ratio];
          costs[0] += cost;
          costs[1] += cost / ratio;
        }
      }
      for (unsigned long &count : counts)
        count = Utilities::MPI::sum(count, model.communicator);
      costs = ordered_sum(costs, model.communicator);
      return {counts, costs[0] > 0. ? costs[1] / costs[0] : 1.};
    }

    void describe(std::ostream &text) const
    {
      const auto [counts, cost] = extent();
      text << "  subcycling: cycles of " << groups.cycle << " steps";
      for (unsigned int ratio = 1; ratio < counts.size(); ++ratio)
        if (counts[ratio] > 0)
          text << (ratio > 1 ? ", " : "; ") << counts[ratio] << " cells or particles take every "
               << (ratio == 1 ? "step" : std::to_string(ratio) + "th");
      text << "; forces cost " << cost << " of those of single steps\n";
    }

    Json result() const
    {
      const auto [counts, cost] = extent();
      Json result = Json::object();
      result["cycle"] = groups.cycle;
      for (unsigned int ratio = 1; ratio < counts.size(); ++ratio)
        if (counts[ratio] > 0)
          result["cells_of_ratio_" + std::to_string(ratio)] = counts[ratio];
      result["cost_of_forces"] = cost;
      return result;
    }

    SubcyclingSettings settings;
    Model<dim> &model;
    StepGroups<dim> &groups;
    SpectralEstimator<dim> estimator;

    struct Choice
    {
      double limit = 0;       ///< of the scene in single steps [T]
      double scale = 1;       ///< of the limit of cells over eq. (41)
      double stable_step = 0; ///< that came out of it; zero: not known yet [T]
      unsigned long step = 0; ///< when it was made
    };
    Choice choice;
    bool is_chosen = false, is_planned = false, touches_slow_cell = false;
    unsigned int next_cycle = 1;
    NodalVector touched;    ///< owned nodes that something has touched: one, scalar
    NodalVector slow_cells; ///< number of cells beside a node that do not take each step, scalar
  };

  namespace
  {
    template <int dim>
    class SubcyclingKind : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        SubcyclingSettings(
            Entries(parameters.handler()).subsection("Time step").subsection(section_name));
      }

      void prepare(const Parameters &parameters, std::vector<Part<dim>> &parts) const override
      {
        if (SubcyclingSettings(entries_of(parameters)).largest_ratio == 1)
          return;
        for (Part<dim> &part : parts)
          if (auto *const cells = dynamic_cast<GroupedCells<dim> *>(part.formulation.get()))
            cells->prepare_groups();
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        const SubcyclingSettings settings(entries_of(parameters));
        if (!model.has_mechanics || settings.largest_ratio == 1)
          return nullptr;
        const Section section = parameters.section("Time step").subsection(section_name);
        const auto can_wait = [](const Part<dim> &part)
        {
          const auto *const cells = dynamic_cast<const GroupedCells<dim> *>(part.formulation.get());
          return cells != nullptr && cells->can_be_grouped();
        };
        if (std::none_of(model.parts.begin(), model.parts.end(), can_wait))
          section.fail("Largest ratio", "no part has cells that can take longer steps: these are "
                                        "elements that neither erode nor become particles; "
                                        "allowed is 1.");
        if (model.bridge->is_trace())
          section.fail("Largest ratio",
                       "elements see the field of the particles in each step (`Trace bridge`); "
                       "allowed is 1.");
        return std::make_unique<Subcycling<dim>>(settings, parameters, model);
      }
    };
  } // namespace

  TOMBOLO_REGISTER_PROCESS_KIND(SubcyclingKind, process_order::subcycling)
} // namespace tombolo
