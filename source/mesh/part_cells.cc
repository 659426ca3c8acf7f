// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/part_cells.h>

#include <tombolo/base/format.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/mesh/boundary_names.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace tombolo
{
  template <int dim>
  struct PartCells<dim>::Rule
  {
    enum class Kind
    {
      predicate,
      material,
      all,
      otherwise,
      from
    };

    Kind kind = Kind::predicate;
    std::set<dealii::types::material_id> materials;
    std::optional<Predicate<dim>> predicate;

    bool contains(const Cell &cell) const
    {
      switch (kind)
      {
      case Kind::predicate:
        return (*predicate)(cell->center());
      case Kind::material:
        return materials.count(cell->material_id()) > 0;
      case Kind::all:
        return true;
      default:
        return false;
      }
    }
  };

  namespace
  {
    const std::string entry = "Cells";

    /** The rest of @p text behind the first word @p keyword, if it begins with it. */
    std::optional<std::string> behind_keyword(const std::string &text, const std::string &keyword)
    {
      if (text.compare(0, keyword.size(), keyword) != 0 || text.size() <= keyword.size() ||
          (text[keyword.size()] != ' ' && text[keyword.size()] != '\t'))
        return {};
      return dealii::Utilities::trim(text.substr(keyword.size()));
    }

    /** The material ids of a group of cells. Throws InputError where the mesh has no such group. */
    template <int dim>
    std::set<dealii::types::material_id> group_ids(const Mesh<dim> &mesh, const Section &section,
                                                   const std::string &name)
    {
      if (mesh.group_names.empty() && mesh.joint_groups.empty())
        section.fail(entry, "The mesh has no groups of cells. Allowed are a predicate of the "
                            "cell's centre, \"material N\", \"all\" and \"otherwise\".");
      std::string problem;
      const auto ids =
          ids_of_name(mesh.group_names, mesh.joint_groups, name, "group", "groups", problem);
      if (ids.empty())
        section.fail(entry, problem);
      return ids;
    }

    /** A cell that breaks the rules. Ordered by the cell's number, which does not depend on the
     * partition, so that every run names the same cell. */
    template <int dim>
    struct Offence
    {
      dealii::CellId::binary_type cell = {};
      dealii::Point<dim> center;
      /** The two parts that have the cell, or twice the number of parts where none does. */
      unsigned int first_part = 0;
      unsigned int second_part = 0;
      /** Why the rules could not be evaluated in the cell, if so. */
      std::string error;

      bool operator<(const Offence &other) const
      {
        if (error.empty() != other.error.empty())
          return other.error.empty();
        return cell < other.cell;
      }

      template <typename Archive>
      void serialize(Archive &archive, const unsigned int)
      {
        for (auto &number : cell)
          archive &number;
        archive &center &first_part &second_part &error;
      }
    };
  } // namespace

  std::optional<std::string> source_of_cells(const std::string &cells)
  {
    const std::string text = dealii::Utilities::trim(cells);
    return text == "from" ? std::string() : behind_keyword(text, "from");
  }

  template <int dim>
  PartCells<dim>::PartCells(const std::vector<Section> &part_sections, const Mesh<dim> &mesh)
      : sections(part_sections)
  {
    rules.reserve(sections.size());
    std::optional<unsigned int> part_of_the_rest;
    for (unsigned int part = 0; part < sections.size(); ++part)
    {
      const Section &section = sections[part];
      const std::string text = dealii::Utilities::trim(section.get(entry));
      Rule rule;
      if (text.empty())
        section.fail(entry, "The cells of the part are not given. Allowed are a predicate of the "
                            "cell's centre (\"x < 5\"), \"material N\", \"group NAME\", "
                            "\"mesh NAME\", \"all\", \"otherwise\" and \"from NAME\".");
      else if (text == "all")
        rule.kind = Rule::Kind::all;
      else if (text == "otherwise")
      {
        rule.kind = Rule::Kind::otherwise;
        if (part_of_the_rest)
          section.fail(entry, "The part \"" + sections[*part_of_the_rest].name() +
                                  "\" takes the other cells already. Only one part can.");
        part_of_the_rest = part;
      }
      else if (source_of_cells(text))
        rule.kind = Rule::Kind::from;
      else if (const auto number = behind_keyword(text, "material"))
      {
        rule.kind = Rule::Kind::material;
        if (number->empty() || number->size() > 9 ||
            number->find_first_not_of("0123456789") != std::string::npos)
          section.fail(entry, "\"" + *number + "\" is not a material number. Allowed is " +
                                  "\"material N\" with a whole number N as in the mesh.");
        rule.materials = {static_cast<dealii::types::material_id>(std::stoul(*number))};
      }
      else if (const auto name = behind_keyword(text, "group"))
      {
        rule.kind = Rule::Kind::material;
        rule.materials = group_ids(mesh, section, *name);
      }
      else if (const auto mesh_name = behind_keyword(text, "mesh"))
      {
        rule.kind = Rule::Kind::material;
        rule.materials = group_ids(mesh, section, "mesh " + *mesh_name);
      }
      else
        rule.predicate.emplace(section, entry);
      rules.push_back(std::move(rule));
    }
  }

  template <int dim>
  PartCells<dim>::~PartCells() = default;

  template <int dim>
  unsigned int PartCells<dim>::part_of(const Cell &cell) const
  {
    unsigned int rest = 0;
    for (unsigned int part = 0; part < rules.size(); ++part)
    {
      if (rules[part].contains(cell))
        return part;
      if (rules[part].kind == Rule::Kind::otherwise)
        rest = part;
    }
    return rest;
  }

  template <int dim>
  struct PartCells<dim>::Survey
  {
    std::vector<std::uint64_t> n_cells; ///< of each part
    std::uint64_t n_without_part = 0;
    std::uint64_t n_with_two = 0;
    std::uint64_t n_errors = 0;                      ///< cells where no rule could be evaluated
    dealii::types::material_id largest_material = 0; ///< of this rank
    Offence<dim> worst; ///< that of the smallest cell number, those with an error first
  };

  template <int dim>
  typename PartCells<dim>::Survey
  PartCells<dim>::survey(const dealii::Triangulation<dim> &triangulation) const
  {
    const MPI_Comm communicator = communicator_of(triangulation);
    const unsigned int n_parts = static_cast<unsigned int>(rules.size());
    const auto rest =
        std::find_if(rules.begin(), rules.end(),
                     [](const Rule &rule) { return rule.kind == Rule::Kind::otherwise; });
    const unsigned int part_of_the_rest = static_cast<unsigned int>(rest - rules.begin());

    Survey result;
    result.n_cells.assign(n_parts, 0);
    std::vector<Offence<dim>> offences;
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
      {
        result.largest_material = std::max(result.largest_material, cell->material_id());
        unsigned int first = n_parts;
        unsigned int second = n_parts;
        std::string error;
        try
        {
          for (unsigned int part = 0; part < n_parts; ++part)
            if (rules[part].contains(cell))
            {
              ++result.n_cells[part];
              if (first == n_parts)
                first = part;
              else if (second == n_parts)
                second = part;
            }
        }
        catch (const std::exception &exception)
        {
          // Other ranks may have no such cell: all must throw together, in check().
          error = exception.what();
          ++result.n_errors;
        }
        if (first == n_parts && part_of_the_rest < n_parts)
        {
          first = part_of_the_rest;
          ++result.n_cells[first];
        }
        if (error.empty())
        {
          if (first < n_parts && second == n_parts)
            continue;
          ++(first == n_parts ? result.n_without_part : result.n_with_two);
        }
        const Offence<dim> offence{cell->id().template to_binary<dim>(), cell->center(), first,
                                   second, error};
        if (offences.empty())
          offences.push_back(offence);
        else
          offences[0] = std::min(offences[0], offence);
      }

    dealii::Utilities::MPI::sum(result.n_cells, communicator, result.n_cells);
    for (std::uint64_t *const n : {&result.n_without_part, &result.n_with_two, &result.n_errors})
      *n = dealii::Utilities::MPI::sum(*n, communicator);
    if (result.n_without_part + result.n_with_two + result.n_errors > 0)
    {
      for (const auto &rank_offences : dealii::Utilities::MPI::all_gather(communicator, offences))
        offences.insert(offences.end(), rank_offences.begin(), rank_offences.end());
      result.worst = *std::min_element(offences.begin(), offences.end());
    }
    return result;
  }

  template <int dim>
  void PartCells<dim>::refuse_empty_parts(const Survey &survey,
                                          const dealii::Triangulation<dim> &triangulation) const
  {
    for (unsigned int part = 0; part < rules.size(); ++part)
      if (survey.n_cells[part] == 0 && rules[part].kind != Rule::Kind::from)
      {
        const Section &section = sections[part];
        switch (rules[part].kind)
        {
        case Rule::Kind::predicate:
          section.fail(entry, "This selects no cell of the mesh: it is true at the centre of none "
                              "of its " +
                                  std::to_string(triangulation.n_global_active_cells()) +
                                  " cells. Correct it, or remove the part \"" + section.name() +
                                  "\".");
        case Rule::Kind::material:
          section.fail(entry, "The mesh has no cells of this material; the largest number in it "
                              "is " +
                                  std::to_string(dealii::Utilities::MPI::max(
                                      survey.largest_material, communicator_of(triangulation))) +
                                  ".");
        default:
          section.fail(entry, "No cells are left for the part \"" + section.name() +
                                  "\": the other parts take them all. Remove it, or make the "
                                  "cells of the others fewer.");
        }
      }
  }

  template <int dim>
  void PartCells<dim>::refuse_cells_without_one_part(const Survey &survey) const
  {
    const Offence<dim> &worst = survey.worst;
    if (survey.n_without_part + survey.n_with_two == 0)
      return;
    if (worst.first_part == rules.size())
      sections.back().fail(entry, "The cell at " + position_text(worst.center) +
                                      " is in no part (" + std::to_string(survey.n_without_part) +
                                      " cells in all). Give it to a part, or let the last part "
                                      "take the rest with \"otherwise\".");
    sections[worst.second_part].fail(
        entry, "The cell at " + position_text(worst.center) + " is in two parts, \"" +
                   sections[worst.first_part].name() + "\" and \"" +
                   sections[worst.second_part].name() + "\" (" + std::to_string(survey.n_with_two) +
                   " cells in all). Each cell must be in one: correct one of them, or use "
                   "\"otherwise\" for the part that takes the rest.");
  }

  template <int dim>
  void PartCells<dim>::check(const dealii::Triangulation<dim> &triangulation) const
  {
    const Survey result = survey(triangulation);
    if (result.n_errors > 0)
      throw InputError(result.worst.error);
    // An empty part first: it is the likely cause of cells in no part.
    refuse_empty_parts(result, triangulation);
    refuse_cells_without_one_part(result);
  }

  template <int dim>
  void balance(Mesh<dim> &mesh, const PartCells<dim> &part_cells,
               const std::vector<std::function<StepCost(double)>> &cost_of_part)
  {
    using Triangulation = dealii::Triangulation<dim>;
    using Cell = typename Triangulation::cell_iterator;
    if (dealii::Utilities::MPI::n_mpi_processes(communicator_of(mesh.triangulation)) == 1)
      return;
    // Of ranks around a node the first along the curve of p4est owns it: the rank of the first
    // cell. Identifiers of cells are in the order of this curve.
    std::vector<std::pair<dealii::CellId, Cell>> cells;
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
      if (!cell->is_artificial())
        cells.emplace_back(cell->id(), cell);
    std::sort(cells.begin(), cells.end(),
              [](const auto &a, const auto &b) { return a.first < b.first; });

    std::vector<double> work(mesh.triangulation.n_active_cells(), 0.);
    std::vector<unsigned int> first_cell(mesh.triangulation.n_vertices(),
                                         dealii::numbers::invalid_unsigned_int);
    std::vector<std::vector<bool>> is_counted(
        cost_of_part.size(), std::vector<bool>(mesh.triangulation.n_vertices(), false));
    for (const auto &[id, cell] : cells)
    {
      const unsigned int part = part_cells.part_of(cell);
      const StepCost cost = cost_of_part[part](cell->bounding_box().volume() / cell->measure());
      work[cell->active_cell_index()] += cost.per_cell;
      for (const unsigned int v : cell->vertex_indices())
      {
        const unsigned int vertex = cell->vertex_index(v);
        if (first_cell[vertex] == dealii::numbers::invalid_unsigned_int)
          first_cell[vertex] = cell->active_cell_index();
        if (!is_counted[part][vertex])
          work[first_cell[vertex]] += cost.per_node;
        is_counted[part][vertex] = true;
      }
    }
    const auto connection = mesh.triangulation.signals.weight.connect(
        [&](const Cell &cell, const typename Triangulation::CellStatus)
        {
          // p4est adds whole numbers in 64 bits: a tenth of a cost unit is its resolution.
          constexpr double weight_per_unit = 10., largest_weight = 1e9;
          const double weight = weight_per_unit * work[cell->active_cell_index()];
          Assert(std::isfinite(weight), dealii::ExcMessage("Work must be finite."));
          return static_cast<unsigned int>(std::clamp(weight, 1., largest_weight));
        });
    mesh.triangulation.repartition();
    connection.disconnect();
  }

  template class PartCells<2>;
  template class PartCells<3>;
  template void balance(Mesh<2> &, const PartCells<2> &,
                        const std::vector<std::function<StepCost(double)>> &);
  template void balance(Mesh<3> &, const PartCells<3> &,
                        const std::vector<std::function<StepCost(double)>> &);
} // namespace tombolo
