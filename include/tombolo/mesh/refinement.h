// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/expression_tokens.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/mesh/mesh.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Local refinement of a mesh, whatever its source: `Refine where` and `Refinement levels` of
   * section Mesh. A cell whose centre fulfils the predicate of a region is divided into 2^dim
   * cells, as often as the region has levels; neighbours across faces, edges and corners differ by
   * one level at most. Nodes in the middle of edges and faces lie there, on the faces of the
   * source.
   */
  template <int dim>
  class MeshRefinement
  {
  public:
    /** Throws InputError. */
    explicit MeshRefinement(const Entries &e) : section(e.section())
    {
      const std::string text = dealii::Utilities::trim(e.text(
          where_entry, "", "",
          "Where the mesh is finer than its source says: a predicate of the cell's centre such as "
          "`x "
          "< 5`, or several, separated by \";\". Cells that lie beside others differ from them by "
          "one level at most, which are refined for it. The size of cells can change among "
          "elements "
          "of degree one that stay and inside of parts of `smoothed cells`. Empty: nowhere."));
      if (e.declares())
        e.text(
            levels_entry, "1", "",
            "How often cells are halved along each axis there: a whole number from 1 for each "
            "predicate of `Refine where`, separated by \";\". Where several predicates are true, "
            "the largest counts.");
      if (text.empty())
        return;
      read_regions(text);
      read_levels();
    }

    /** Refines a mesh whose cells have one level. Throws the InputError of a region without cells,
     * or of a mesh that does not fit into memory, before it refines anything. Collective. */
    void refine(Mesh<dim> &mesh) const
    {
      if (regions == nullptr)
        return;
      auto &triangulation = mesh.triangulation;
      const unsigned int base_level = triangulation.n_global_levels() - 1;
      check_levels(mesh, base_level);
      for (bool is_first = true;; is_first = false)
      {
        const Survey found = survey(mesh, base_level);
        for (unsigned int region = 0; region < levels.size() && is_first; ++region)
          if (found.n_cells[region] == 0)
            section.fail(where_entry,
                         (levels.size() == 1 ? "This" : "Predicate " + std::to_string(region + 1)) +
                             " is true at the centre of none of the " +
                             std::to_string(triangulation.n_global_active_cells()) +
                             " cells of the source. Correct it, or make the region wider than a "
                             "cell.");
        if (found.n_to_be_refined == 0)
          return;
        refuse_more_than_memory(section, levels_entry, triangulation.n_cells(0),
                                found.n_cells_at_the_end, communicator_of(triangulation));
        if (found.n_cells_at_the_end >
            std::numeric_limits<dealii::types::global_dof_index>::max() / 2.)
        {
          section.fail(levels_entry, as_text("The mesh would have ", found.n_cells_at_the_end,
                                             " cells, more than this deal.II can number."));
        }
        for (const auto &cell : triangulation.active_cell_iterators())
          if (cell->is_locally_owned() && found.is_to_be_refined[cell->active_cell_index()])
            cell->set_refine_flag();
        triangulation.execute_coarsening_and_refinement();
      }
    }

  private:
    inline static const std::string where_entry = "Refine where",
                                    levels_entry = "Refinement levels";

    /** Levels below the coarse cells that numbers of nodes and cells can distinguish. */
    static constexpr unsigned int most_levels = 12;

    struct Survey
    {
      std::vector<bool> is_to_be_refined; ///< by the active cell index
      std::vector<std::uint64_t> n_cells; ///< in each region
      std::uint64_t n_to_be_refined = 0;  ///< cells of all ranks
      double n_cells_at_the_end = 0;      ///< at the least
    };

    /** Which cells are to be refined, beyond a level that all cells have at least. Collective. */
    Survey survey(const Mesh<dim> &mesh, const unsigned int base_level) const
    {
      const MPI_Comm communicator = communicator_of(mesh.triangulation);
      Survey result;
      result.is_to_be_refined.assign(mesh.triangulation.n_active_cells(), false);
      result.n_cells.assign(levels.size(), 0);
      // Other ranks may have no such cell: all must throw together.
      attempt_on_all_ranks<InputError, RunError>(
          communicator,
          [&]
          {
            for (const auto &cell : mesh.triangulation.active_cell_iterators())
            {
              if (!cell->is_locally_owned())
                continue;
              const auto level = static_cast<unsigned int>(cell->level()) - base_level;
              unsigned int required_level = 0;
              for (unsigned int region = 0; region < levels.size(); ++region)
                if (regions->value(cell->center(), 0., region) != 0.)
                {
                  ++result.n_cells[region];
                  required_level = std::max(required_level, levels[region]);
                }
              const bool is_too_coarse = level < required_level;
              result.is_to_be_refined[cell->active_cell_index()] = is_too_coarse;
              result.n_to_be_refined += is_too_coarse ? 1 : 0;
              result.n_cells_at_the_end +=
                  is_too_coarse ? std::pow(2., dim * static_cast<double>(required_level - level))
                                : 1.;
            }
          });
      dealii::Utilities::MPI::sum(result.n_cells, communicator, result.n_cells);
      result.n_to_be_refined = dealii::Utilities::MPI::sum(result.n_to_be_refined, communicator);
      result.n_cells_at_the_end =
          dealii::Utilities::MPI::sum(result.n_cells_at_the_end, communicator);
      return result;
    }

    void read_regions(const std::string &text)
    {
      const auto n_regions =
          static_cast<unsigned int>(std::count(text.begin(), text.end(), ';') + 1);
      regions = std::make_unique<Expression<dim>>(section, where_entry, n_regions);
      if (regions->depends_on_time())
        section.fail(where_entry, "a condition on points cannot depend on t.");
      for (const std::string &predicate :
           dealii::Utilities::split_string_list(text, std::string(";")))
      {
        const auto tokens = split_into_tokens(predicate);
        const bool compares = std::any_of(tokens.begin(), tokens.end(),
                                          [](const ExpressionToken &token) {
                                            return token.text.find_first_of("<>") == 0 ||
                                                   token.text == "==" || token.text == "!=";
                                          });
        if (!compares)
          section.fail(where_entry, "a condition is needed, for example \"x < 5 && y > 0\"; \"" +
                                        predicate +
                                        "\" is a number that is compared with nothing.");
      }
    }

    void read_levels()
    {
      for (const std::string &text :
           dealii::Utilities::split_string_list(section.get(levels_entry), std::string(";")))
      {
        if (text.empty() || text.size() > 9 ||
            text.find_first_not_of("0123456789") != std::string::npos || std::stoul(text) == 0)
          section.fail(
              levels_entry,
              "\"" + text + "\" is not a number of levels. Allowed is a whole number from 1 to " +
                  std::to_string(most_levels) +
                  ": the mesh of the source is the coarsest, choose fewer cells there for a "
                  "coarser one.");
        levels.push_back(static_cast<unsigned int>(std::stoul(text)));
      }
      if (levels.size() != regions->n_components())
        section.fail(levels_entry,
                     "There must be a number for each predicate of `" + where_entry +
                         "`, separated by \";\": " + std::to_string(regions->n_components()) +
                         ", found " + std::to_string(levels.size()) + ".");
    }

    void check_levels(const Mesh<dim> &mesh, const unsigned int base_level) const
    {
      const unsigned int finest = base_level + *std::max_element(levels.begin(), levels.end());
      // Nodes are numbered on the lattice of the finest level in all coarse cells, in 64 bits.
      const double bits = std::log2(static_cast<double>(mesh.triangulation.n_cells(0))) +
                          dim * (static_cast<double>(finest) + 2.);
      if (finest > most_levels || bits > 63.)
        section.fail(
            levels_entry,
            "These are too many levels: with those of the source there would be " +
                std::to_string(finest) + " below its coarse cells, and at most " +
                std::to_string(std::min(most_levels,
                                        static_cast<unsigned int>(
                                            finest - std::ceil(std::max(0., bits - 63.) / dim)))) +
                " are possible.");
    }

    Section section;
    std::unique_ptr<Expression<dim>> regions; ///< a predicate each; null: none
    std::vector<unsigned int> levels;         ///< of each region
  };
} // namespace tombolo
