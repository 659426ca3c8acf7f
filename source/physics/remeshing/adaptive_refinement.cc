// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/adaptive_refinement.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/contact/contact_settings.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/model/model_input.h>
#include <tombolo/physics/remeshing/cell_marks.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <map>
#include <ostream>
#include <typeinfo>

namespace tombolo
{
  namespace
  {
    const char *const adaptive_section = "Adaptive refinement";
    const char *const adaptive_path = "Mesh/Adaptive refinement";
    const char *const no_criterion = "none";

    /** How often a cell was divided beyond the mesh of the file. */
    template <int dim>
    unsigned int levels_beyond(std::uint64_t id, const int level, const CellDivisions &source)
    {
      unsigned int result = 0;
      for (int l = level; l > 0; --l, ++result)
        if (id = parent_of<dim>(id); std::binary_search(source.begin(), source.end(), id))
          break;
      return result;
    }
  } // namespace

  template <int dim>
  AdaptiveRefinement<dim>::AdaptiveRefinement(const Entries &e) : section(e.section())
  {
    criterion = e.plugin<RefinementCriterion<dim>>(
        "Criterion", no_criterion,
        "What makes cells fine while the run goes on: the largest `plastic strain` in the cell, or "
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
    most_levels =
        e.integer("Levels", "1", between(1, 12),
                  "How often the largest cells of the mesh of the file are halved along each axis, "
                  "at most, those of `Refine where` among them. A cell is halved once in a check.");
    interval = e.integer("Steps between checks", "20", between(1, 1000000000),
                         "The criterion is evaluated every so many steps.");
    layers = e.integer("Layers", "1", between(0, 1000),
                       "So many layers of cells around those that the criterion names become fine, "
                       "too, so that what moves stays among fine cells until the next check.");
    where = e.optional<Predicate<dim>>(
        "Where", "",
        "Cells are divided only where this predicate of their initial centre is true, such as `x < "
        "5`, and for neighbours that are. Empty: everywhere.");
    e.plugins<RefinementCriterion<dim>>();
  }

  template <int dim>
  AdaptiveRefinement<dim>::AdaptiveRefinement(const Parameters &parameters, const Model<dim> &model)
      : AdaptiveRefinement(parameters.section(adaptive_path))
  {
    of_file = model.mesh.of_file ? *model.mesh.of_file : divided_cells(model.mesh);
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
    this->observed.result("refinement_loss",
                          [this, &model] { return Utilities::MPI::sum(lost, model.communicator); });
    this->observed.audit.connect(
        [this](std::ostream &out)
        {
          out << "Adaptive refinement by " << section.get("Criterion") << " above " << refine_above
              << ", up to " << most_levels << (most_levels == 1 ? " level" : " levels") << " every "
              << interval << " steps\n";
        });
  }

  template <int dim>
  void AdaptiveRefinement<dim>::validate(const std::vector<Part<dim>> &parts) const
  {
    const Parameters &parameters = section.all();
    if (const std::string missing = criterion->missing(parts); !missing.empty())
      section.fail("Criterion", missing + ", so that the criterion is zero everywhere.");
    for (const Part<dim> &part : parts)
    {
      const Section of_part = parameters.section("Part: " + part.name);
      const bool becomes_other =
          part.source ||
          std::any_of(parts.begin(), parts.end(),
                      [&](const Part<dim> &other)
                      { return other.source && parts[*other.source].name == part.name; });
      if (!part.formulation->can_be_divided() || part.formulation->degree() > 1)
        of_part.fail("Formulation", "cells of this part cannot be divided in a run (\"" +
                                        std::string(adaptive_path) +
                                        "\"); allowed are elements of degree one and smoothed "
                                        "cells.");
      if (becomes_other || part.formulation->can_lose_cells())
        of_part.fail("Formulation", "cells of this part can leave, by erosion, conversion or "
                                    "refills, which excludes \"" +
                                        std::string(adaptive_path) + "\".");
    }
    for (const Section &contact : named_sections(parameters, "Contacts", "Contact"))
    {
      const std::string surface = contact.get("Surface");
      if (surface == surface_of_part)
        contact.fail("Surface", "that of a part keeps a state of one mesh, which excludes \"" +
                                    std::string(adaptive_path) + "\"; allowed are rigid ones.");
      if (contact.get("Method") == "kinematic" && surface != "plane")
        contact.fail("Method", "a node that divides the face between two others can lie behind a "
                               "surface that is not plane, and would jump out of it; allowed with "
                               "\"" +
                                   std::string(adaptive_path) + "\" is penalty or surface.");
    }
    if (parameters.section("").get("Time integration") != "explicit")
      parameters.fail("Time integration",
                      "allowed with \"" + std::string(adaptive_path) + "\" is `explicit`.");
  }

  template <int dim>
  std::optional<CellDivisions> AdaptiveRefinement<dim>::next_divisions(const Model<dim> &model,
                                                                       const unsigned long step)
  {
    if (!is_announced && (step == 0 || step % interval != 0))
      return std::nullopt;
    const std::optional<Wanted> wanted = find_wanted(model);
    const bool waits = wanted && wanted->has_smaller_cells && !is_announced && model.has_mechanics;
    is_announced = waits;
    if (!wanted || waits)
      return std::nullopt;
    return wanted->divisions;
  }

  template <int dim>
  void AdaptiveRefinement<dim>::model_changed(const Model<dim> &model)
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

  template <int dim>
  std::pair<int, int> AdaptiveRefinement<dim>::levels_of_file(const Model<dim> &model) const
  {
    const auto &triangulation = model.mesh.triangulation;
    int coarsest = static_cast<int>(triangulation.n_global_levels()), finest = 0;
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
      {
        const unsigned int divisions =
            levels_beyond<dim>(persistent_id(cell->id(), dim), cell->level(), of_file);
        coarsest = std::min(coarsest, cell->level() - static_cast<int>(divisions));
        finest = std::max(finest, cell->level() - static_cast<int>(divisions));
      }
    return {Utilities::MPI::min(coarsest, model.communicator),
            Utilities::MPI::max(finest, model.communicator)};
  }

  template <int dim>
  void AdaptiveRefinement<dim>::refuse_too_many_levels(const Model<dim> &model) const
  {
    const auto [coarsest, finest_of_file] = levels_of_file(model);
    constexpr int most_of_all = 12; // that numbers of cells can tell apart
    const int finest = std::max(coarsest + static_cast<int>(most_levels), finest_of_file);
    const double bits =
        std::log2(static_cast<double>(model.mesh.triangulation.n_cells(0))) + dim * (finest + 2.);
    if (finest > most_of_all || bits > 63.)
      section.fail("Levels", "These are too many levels: with those of the mesh of the file there "
                             "would be " +
                                 std::to_string(finest) +
                                 " below its coarse cells, more than numbers of nodes and cells "
                                 "can tell apart (" +
                                 std::to_string(most_of_all) + ", fewer of many coarse cells).");
  }

  template <int dim>
  std::vector<bool>
  AdaptiveRefinement<dim>::cells_to_be_fine(const Model<dim> &model,
                                            const std::vector<double> &values) const
  {
    std::vector<bool> result;
    for (const double value : values)
      result.push_back(value > refine_above);
    std::vector<Point<dim>> centres;
    std::vector<std::vector<unsigned int>> nodes;
    for_cells(model,
              [&](const auto &cell, const std::vector<unsigned int> &of_cell)
              {
                centres.push_back(cell->center());
                nodes.push_back(of_cell);
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
      result = CellMarks::cells_marked(nodes,
                                       CellMarks::nodes_of(model.state.partition(), nodes, result));
    }
  }

  template <int dim>
  std::optional<typename AdaptiveRefinement<dim>::Wanted>
  AdaptiveRefinement<dim>::find_wanted(const Model<dim> &model) const
  {
    const std::vector<double> values = criterion->values(model);
    const std::vector<bool> is_fine = cells_to_be_fine(model, values);
    std::size_t number = 0; // of the cell
    const int coarsest_level = levels_of_file(model).first;
    CellDivisions divided;
    unsigned int finest = 0, finest_wanted = 0;
    std::map<std::uint64_t, unsigned int> n_joinable; // children of a parent
    for_cells(model,
              [&](const auto &cell, const auto &)
              {
                const std::uint64_t id = persistent_id(cell->id(), dim);
                const auto level = static_cast<unsigned int>(cell->level() - coarsest_level);
                const bool is_of_file =
                    cell->level() == 0 ||
                    std::binary_search(of_file.begin(), of_file.end(), parent_of<dim>(id));
                finest = std::max(finest, level);
                if (is_fine[number] && level < most_levels)
                {
                  divided.push_back(id);
                  finest_wanted = std::max(finest_wanted, level + 1);
                }
                else if (!is_fine[number] && !is_of_file && coarsen_below &&
                         values[number] < *coarsen_below)
                  ++n_joinable[parent_of<dim>(id)];
                ++number;
              });
    // Siblings are on one rank.
    CellDivisions joined;
    for (const auto &[parent, n] : n_joinable)
      if (n == GeometryInfo<dim>::max_children_per_cell)
        joined.push_back(parent);

    CellDivisions all = divided_cells(model.mesh);
    const CellDivisions present = all;
    std::vector<std::uint64_t> removed;
    for (const CellDivisions &of_rank : Utilities::MPI::all_gather(model.communicator, joined))
      removed.insert(removed.end(), of_rank.begin(), of_rank.end());
    std::sort(removed.begin(), removed.end());
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const std::uint64_t id)
                             { return std::binary_search(removed.begin(), removed.end(), id); }),
              all.end());
    std::size_t n_divided = 0;
    for (const CellDivisions &of_rank : Utilities::MPI::all_gather(model.communicator, divided))
    {
      all.insert(all.end(), of_rank.begin(), of_rank.end());
      n_divided += of_rank.size();
    }
    std::sort(all.begin(), all.end());
    if (all == present)
      return std::nullopt;
    if (n_divided > 0)
      refuse_more_than_memory(
          section, "Levels", model.mesh.triangulation.n_cells(0),
          static_cast<double>((GeometryInfo<dim>::max_children_per_cell - 1) * n_divided),
          model.communicator);
    return Wanted{all, Utilities::MPI::max(finest_wanted, model.communicator) >
                           Utilities::MPI::max(finest, model.communicator)};
  }

  template <int dim>
  void AdaptiveRefinement<dim>::book(const ModelContent &before, const ModelContent &after,
                                     const Model<dim> &model)
  {
    ++n_meshes;
    count_cells(model); // after what was read of the mesh before
    if (Utilities::MPI::this_mpi_process(model.communicator) != 0)
      return;
    lost += before.energy - after.energy;
    if (model.heat)
    {
      const double now = before.enthalpy - after.enthalpy;
      model.heat->eroded_heat += now;
      model.heat->eroding_heat += before.next_enthalpy - after.next_enthalpy - now;
    }
    for (unsigned int d = 0; d < 3; ++d)
    {
      lost_momentum[d] += before.momentum[d] - after.momentum[d];
      lost_angular_momentum[d] += before.angular_momentum[d] - after.angular_momentum[d];
    }
  }

  namespace
  {
    template <int dim>
    class AdaptiveRefinementKind : public ProcessKind<dim>
    {
      void declare_parameters(Parameters &parameters) const override
      {
        declare<AdaptiveRefinement<dim>>(
            Entries(parameters.handler()).subsection("Mesh").subsection(adaptive_section));
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        if (!divides_cells_in_run(parameters))
          return;
        const AdaptiveRefinement<dim> refinement(parameters.section(adaptive_path));
        if (std::all_of(parts.begin(), parts.end(),
                        [](const Part<dim> &part) { return part.formulation != nullptr; }))
          refinement.validate(parts);
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        return divides_cells_in_run(parameters)
                   ? std::make_unique<AdaptiveRefinement<dim>>(parameters, model)
                   : nullptr;
      }
    };
  } // namespace

  template class AdaptiveRefinement<2>;
  template class AdaptiveRefinement<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(AdaptiveRefinementKind, process_order::conversion + 6)
} // namespace tombolo
