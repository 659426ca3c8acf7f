// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/contact/contact_settings.h>
#include <tombolo/mesh/cell_divisions.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/model/model_input.h>
#include <tombolo/model/point_transfer.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/remeshing/cell_marks.h>
#include <tombolo/physics/remeshing/model_content.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <ostream>
#include <string>
#include <typeinfo>
#include <utility>
#include <vector>

namespace tombolo
{
  /** Decides where cells are divided in a run: a plug-in, `Criterion` in section
   * `Mesh/Adaptive refinement`. */
  template <int dim>
  class RefinementCriterion
  {
  public:
    virtual ~RefinementCriterion() = default;

    /** A clause on the missing data of a scene; empty: none. Parts have no mesh yet. */
    std::string missing(const std::vector<Part<dim>> &parts) const
    {
      std::string result;
      for (const Part<dim> &part : parts)
        if (result = lack(part); result.empty())
          break;
      return result;
    }

    /** The value in each owned cell of all parts, in the order of for_cells(). Collective. */
    virtual std::vector<double> values(const Model<dim> &model) const = 0;

  private:
    /** A clause on the missing data where the value of all cells of a part is zero; else empty. */
    virtual std::string lack(const Part<dim> &part) const = 0;
  };

  template <int dim>
  struct PluginKind<RefinementCriterion<dim>>
  {
    static constexpr const char *name = "refinement criterion";
  };

  /** Calls @p visit(cell, local nodes) for all owned cells, part by part. */
  template <int dim, typename Visitor>
  void for_cells(const Model<dim> &model, const Visitor &visit)
  {
    std::vector<dealii::types::global_dof_index> nodes;
    std::vector<unsigned int> local;
    for (unsigned int part = 0; part < model.parts.size(); ++part)
      for (const auto &cell : cells_of_part(*model.nodes, *model.part_cells, part))
      {
        model.nodes->cell_nodes(cell, nodes);
        local.clear();
        for (const auto node : nodes)
          local.push_back(model.state.partition()->local_index(node));
        visit(cell, local);
      }
  }

  constexpr const char *adaptive_section = "Adaptive refinement",
                       *adaptive_path = "Mesh/Adaptive refinement", *no_criterion = "none";

  /**
   * Finds between two steps which cells a criterion divides or joins, and accounts for the losses
   * by each new mesh: the run itself makes a new model of the same parameters there (Simulation). A
   * cell is divided once in a check; the mesh never becomes coarser than that of the file, from
   * which levels count.
   */
  template <int dim>
  class AdaptiveRefinement : public Process<dim>
  {
  public:
    /** Throws InputError. */
    explicit AdaptiveRefinement(const Entries &e) : section(e.section())
    {
      criterion = e.plugin<RefinementCriterion<dim>>(
          "Criterion", no_criterion,
          "What makes cells fine while the run goes on: the largest `plastic strain` in the cell, "
          "or "
          "the gradient of temperature or stress in it. `none`: the mesh stays as it is.",
          no_criterion);
      const std::optional<double> above = e.optional_number(
          "Refine above", positive(), "of the criterion (1, temperature/L, M/(L^2 T^2))",
          "Cells in which the criterion is above this value become fine.");
      e.refuse(!above, "Criterion",
               "the value above which cells are to be fine is missing: set \"Refine above\".");
      refine_above = above.value_or(0.);
      coarsen_below = e.optional_number(
          "Coarsen below", positive(), "",
          "Cells that were divided in the run are joined again where the criterion is below this "
          "value in all of them, smaller than `Refine above`. Empty: never.");
      e.refuse(coarsen_below && !(*coarsen_below < refine_above), "Coarsen below",
               "allowed is a value below \"Refine above\", which is " + e.given("Refine above") +
                   ": cells would be divided and joined in turn.");
      most_levels = e.integer(
          "Levels", "1", between(1, 12),
          "How often the largest cells of the mesh of the file are halved along each axis, "
          "at most, those of `Refine where` among them. A cell is halved once in a check.");
      interval = e.integer("Steps between checks", "20", between(1, 1000000000),
                           "The criterion is evaluated every so many steps.");
      layers =
          e.integer("Layers", "1", between(0, 1000),
                    "So many layers of cells around those that the criterion names become fine, "
                    "too, so that what moves stays among fine cells until the next check.");
      where = e.optional<Predicate<dim>>("Where", "",
                                         "Cells are divided only where this predicate of their "
                                         "initial centre is true, such as `x < "
                                         "5`, and for neighbours that are. Empty: everywhere.");
      e.plugins<RefinementCriterion<dim>>();
    }

    AdaptiveRefinement(const Parameters &parameters, const Model<dim> &model)
        : AdaptiveRefinement(parameters.section(adaptive_path))
    {
      file_divisions = model.mesh.of_file ? *model.mesh.of_file : divided_cells(model.mesh);
      Records &all = this->records.group("adaptive refinement");
      all.value("meshes", n_meshes);
      all.value("is announced", is_announced);
      all.value("most cells", most_cells);
      all.sums("lost", lost, interleaved(lost_momentum, lost_angular_momentum));
      if (model.heat)
        model.heat->can_lose_heat = true;
      this->observed.step_limits.connect(
          [this](double, double &fraction) {
            fraction = std::min(fraction, is_announced ? 0.4 : 1.);
          }); // half the size, half the limit
      this->observed.energy("refinement loss", EnergyKind::artificial, lost);
      this->observed.energies.connect(
          [this](EnergyAccounts &accounts)
          { accounts.add_removed_momentum(lost_momentum, lost_angular_momentum); });
      this->observed.column("cells", "1", [this] { return n_cells; });
      this->observed.column("refinements", "1", [this] { return static_cast<double>(n_meshes); });
      this->observed.result("refinements", [this] { return n_meshes; });
      this->observed.result("most_cells", [this] { return most_cells; });
      this->observed.result("refinement_loss", [this, &model]
                            { return dealii::Utilities::MPI::sum(lost, model.communicator); });
      this->observed.audit.connect(
          [this](std::ostream &out)
          {
            out << "Adaptive refinement by " << section.get("Criterion") << " above "
                << refine_above << ", up to " << most_levels
                << (most_levels == 1 ? " level" : " levels") << " every " << interval << " steps\n";
          });
    }

    /** Refuses scenes with what cannot be transferred to another mesh. Throws InputError. */
    void refuse_unfit(const std::vector<Part<dim>> &parts) const;

    /** The divided cells of the next mesh before the step number @p step; nothing where the present
     * mesh stays. Where cells become smaller than all present ones, one step of their size is made
     * before: a long one would excite what only the new mesh can represent. Throws
     * InputError where the mesh does not fit into memory. Collective. */
    std::optional<CellDivisions> next_divisions(const Model<dim> &model, const unsigned long step)
    {
      if (!is_announced && (step == 0 || step % interval != 0))
        return std::nullopt;
      const std::optional<NextMesh> next_mesh = find_next_mesh(model);
      const bool waits =
          next_mesh && next_mesh->has_smaller_cells && !is_announced && model.has_mechanics;
      is_announced = waits;
      if (!next_mesh || waits)
        return std::nullopt;
      return next_mesh->divisions;
    }

    /** Accounts for the change from @p before to @p after by a new mesh. */
    void book(const ModelContent &before, const ModelContent &after, const Model<dim> &model);

    void model_changed(const Model<dim> &model) override
    {
      count_cells(model);
      for (const auto &process : model.processes)
        if (process->roles.divided_cells == ProcessRole::is_refused)
          section.fail("Criterion",
                       "the scene has what keeps a state of one mesh (" +
                           words_of_type(typeid(*process)) +
                           "). Allowed beside cells that are divided in the run are loads, "
                           "prescribed motion, damping, sections and `Contacts`.");
      refuse_too_many_levels(model);
    }

    static void declare_parameters(Parameters &parameters)
    {
      declare<AdaptiveRefinement>(
          Entries(parameters.handler()).subsection("Mesh").subsection(adaptive_section));
    }

    static void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts)
    {
      if (!divides_cells_in_run(parameters))
        return;
      const AdaptiveRefinement refinement(parameters.section(adaptive_path));
      if (std::all_of(parts.begin(), parts.end(),
                      [](const Part<dim> &part) { return part.formulation != nullptr; }))
        refinement.refuse_unfit(parts);
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      return divides_cells_in_run(parameters)
                 ? std::make_unique<AdaptiveRefinement>(parameters, model)
                 : nullptr;
    }

  private:
    /** How often a cell was divided beyond the mesh of the file. */
    static unsigned int levels_beyond(std::uint64_t id, const int level,
                                      const CellDivisions &source)
    {
      unsigned int result = 0;
      for (int l = level; l > 0; --l, ++result)
        if (id = parent_of<dim>(id); std::binary_search(source.begin(), source.end(), id))
          break;
      return result;
    }

    /** The mesh by the criterion. */
    struct NextMesh
    {
      CellDivisions divisions;
      bool has_smaller_cells = false;
    };
    std::optional<NextMesh> find_next_mesh(const Model<dim> &model) const
    {
      const std::vector<double> values = criterion->values(model);
      const std::vector<bool> is_fine = cells_to_be_fine(model, values);
      std::size_t number = 0; // of the cell
      const int coarsest_level = levels_of_file(model).first;
      CellDivisions divided;
      unsigned int finest = 0, finest_next = 0;
      std::vector<Joinable> cells;
      for_cells(model,
                [&](const auto &cell, const auto &)
                {
                  const std::uint64_t id = persistent_id(cell->id(), dim);
                  const auto level = static_cast<unsigned int>(cell->level() - coarsest_level);
                  const bool is_of_file =
                      cell->level() == 0 ||
                      std::binary_search(file_divisions.begin(), file_divisions.end(),
                                         parent_of<dim>(id));
                  finest = std::max(finest, level);
                  const bool is_divided = is_fine[number] && level < most_levels;
                  if (is_divided)
                  {
                    divided.push_back(id);
                    finest_next = std::max(finest_next, level + 1);
                  }
                  cells.push_back({parent_of<dim>(id), cell->level(), is_divided,
                                   !is_fine[number] && !is_of_file && coarsen_below &&
                                       values[number] < *coarsen_below});
                  ++number;
                });

      CellDivisions all = divided_cells(model.mesh);
      const CellDivisions present = all;
      const CellDivisions removed = joined_parents(model, std::move(cells));
      all.erase(std::remove_if(all.begin(), all.end(),
                               [&](const std::uint64_t id)
                               { return std::binary_search(removed.begin(), removed.end(), id); }),
                all.end());
      const CellDivisions all_divided = from_all_ranks(divided, model.communicator);
      const std::size_t n_divided = all_divided.size();
      all.insert(all.end(), all_divided.begin(), all_divided.end());
      std::sort(all.begin(), all.end());
      if (all == present)
        return std::nullopt;
      if (n_divided > 0)
        refuse_more_than_memory(
            section, "Levels", model.mesh.triangulation.n_cells(0),
            static_cast<double>((dealii::GeometryInfo<dim>::max_children_per_cell - 1) * n_divided),
            model.communicator);
      return NextMesh{all, dealii::Utilities::MPI::max(finest_next, model.communicator) >
                               dealii::Utilities::MPI::max(finest, model.communicator)};
    }

    /** A cell of for_cells() where cells are joined. */
    struct Joinable
    {
      std::uint64_t parent;
      int level;
      bool is_divided, can_be_joined;
    };

    /** The parents of all ranks whose children can be joined, all of them: not where a neighbour of
     * the parent would be two levels below it, for which the parent would be divided again. The
     * same on all ranks. Collective. */
    CellDivisions joined_parents(const Model<dim> &model, std::vector<Joinable> cells) const
    {
      int finest = 0; // level of cells that can be joined
      std::map<std::uint64_t, unsigned int> n_joinable;
      for (const Joinable &cell : cells)
        if (cell.can_be_joined)
        {
          finest = std::max(finest, cell.level);
          ++n_joinable[cell.parent];
        }
      // Siblings are on one rank.
      for (Joinable &cell : cells)
        cell.can_be_joined =
            cell.can_be_joined &&
            n_joinable[cell.parent] == dealii::GeometryInfo<dim>::max_children_per_cell;
      finest = dealii::Utilities::MPI::max(finest, model.communicator);
      std::vector<std::vector<unsigned int>> nodes;
      if (finest > 0)
        for_cells(model, [&](const auto &, const std::vector<unsigned int> &cell_nodes)
                  { nodes.push_back(cell_nodes); });
      // Smaller cells first: where these are joined, larger ones can be.
      for (int level = finest; level > 0; --level)
      {
        std::vector<bool> is_smaller;
        for (const Joinable &cell : cells)
          is_smaller.push_back(
              cell.level + (cell.is_divided ? 1 : 0) - (cell.can_be_joined ? 1 : 0) > level);
        const NodalVector marks = CellMarks::nodes_of(model.state.partition(), nodes, is_smaller);
        for (std::size_t c = 0; c < cells.size(); ++c)
          if (cells[c].level == level && CellMarks::any_marked(nodes[c], marks))
            n_joinable[cells[c].parent] = 0;
        for (Joinable &cell : cells)
          cell.can_be_joined = cell.can_be_joined && n_joinable[cell.parent] > 0;
      }
      CellDivisions result;
      for (const auto &[parent, n] : n_joinable)
        if (n == dealii::GeometryInfo<dim>::max_children_per_cell)
          result.push_back(parent);
      result = from_all_ranks(result, model.communicator);
      std::sort(result.begin(), result.end());
      return result;
    }

    /** Whether each cell of for_cells() is to be fine: by the criterion, or near such a cell.
     * Collective. */
    std::vector<bool> cells_to_be_fine(const Model<dim> &model,
                                       const std::vector<double> &values) const
    {
      std::vector<bool> result;
      for (const double value : values)
        result.push_back(value > refine_above);
      std::vector<dealii::Point<dim>> centres;
      std::vector<std::vector<unsigned int>> nodes;
      for_cells(model,
                [&](const auto &cell, const std::vector<unsigned int> &local_nodes)
                {
                  centres.push_back(cell->center());
                  nodes.push_back(local_nodes);
                });
      for (unsigned int layer = 0;; ++layer)
      {
        std::string failure;
        try
        {
          for (std::size_t c = 0; c < result.size(); ++c)
            result[c] = result[c] && (!where || (*where)(centres[c]));
        }
        catch (const std::exception &exception)
        {
          failure = exception.what(); // other ranks may have no such cell
        }
        throw_on_all_ranks<RunError>(failure, model.communicator);
        if (layer == layers)
          return result;
        result = CellMarks::cells_marked(
            nodes, CellMarks::nodes_of(model.state.partition(), nodes, result));
      }
    }

    /** The coarsest and the finest level of the mesh of the file. Collective. */
    std::pair<int, int> levels_of_file(const Model<dim> &model) const
    {
      const auto &triangulation = model.mesh.triangulation;
      int coarsest = static_cast<int>(triangulation.n_global_levels()), finest = 0;
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
        {
          const unsigned int divisions =
              levels_beyond(persistent_id(cell->id(), dim), cell->level(), file_divisions);
          coarsest = std::min(coarsest, cell->level() - static_cast<int>(divisions));
          finest = std::max(finest, cell->level() - static_cast<int>(divisions));
        }
      return {dealii::Utilities::MPI::min(coarsest, model.communicator),
              dealii::Utilities::MPI::max(finest, model.communicator)};
    }

    void count_cells(const Model<dim> &model)
    {
      n_cells = static_cast<double>(model.mesh.triangulation.n_global_active_cells());
      most_cells = std::max(most_cells, n_cells);
    }

    void refuse_too_many_levels(const Model<dim> &model) const
    {
      const auto [coarsest, finest_of_file] = levels_of_file(model);
      constexpr int most_of_all = 12; // that numbers of cells distinguish
      const int finest = std::max(coarsest + static_cast<int>(most_levels), finest_of_file);
      const double bits =
          std::log2(static_cast<double>(model.mesh.triangulation.n_cells(0))) + dim * (finest + 2.);
      if (finest > most_of_all || bits > 63.)
        section.fail("Levels",
                     "These are too many levels: with those of the mesh of the file there "
                     "would be " +
                         std::to_string(finest) +
                         " below its coarse cells, more than numbers of nodes and cells "
                         "can tell apart (" +
                         std::to_string(most_of_all) + ", fewer of many coarse cells).");
    }

    Section section;
    std::unique_ptr<RefinementCriterion<dim>> criterion;
    std::optional<Predicate<dim>> where; ///< none: everywhere
    double refine_above;
    std::optional<double> coarsen_below;
    unsigned int most_levels, layers, interval;

    CellDivisions file_divisions; ///< of the mesh of the file, which the run never makes coarser
    bool is_announced = false;    ///< smaller cells come after this step
    unsigned long n_meshes = 0;   ///< that the run has made
    double n_cells = 0, most_cells = 0;
    // On the first rank.
    double lost = 0;
    std::array<double, 3> lost_momentum{}, lost_angular_momentum{};
  };

  extern template class AdaptiveRefinement<2>;
  extern template class AdaptiveRefinement<3>;
} // namespace tombolo
