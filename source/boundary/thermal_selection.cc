// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/boundary/thermal_selection.h>

#include <tombolo/base/throw_on_all_ranks.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <iterator>
#include <string>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  ThermalSelection<dim>::ThermalSelection(const std::vector<Section> &sections,
                                          const std::vector<ThermalCondition<dim>> &conditions,
                                          const Nodes<dim> &nodes, TributaryAreas<dim> &areas)
      : conditions(conditions), nodes(nodes), selected_nodes(sections.size()),
        n_selected(sections.size(), 0), n_conflicts(sections.size() * sections.size(), 0)
  {
    // The value of a predicate or a function can be undefined on one rank alone.
    std::string message;
    try
    {
      find_nodes();
      find_faces(areas);
    }
    catch (const InputError &error)
    {
      message = error.what();
    }
    throw_on_all_ranks<InputError>(message, nodes.communicator());
    refuse_what_selects_nothing(sections);
    refuse_conflicts(sections);
  }

  template <int dim>
  std::vector<std::vector<types::global_dof_index>> ThermalSelection<dim>::owned_nodes() const
  {
    std::vector<std::vector<types::global_dof_index>> result(selected_nodes.size());
    for (std::size_t c = 0; c < selected_nodes.size(); ++c)
      std::copy_if(
          selected_nodes[c].begin(), selected_nodes[c].end(), std::back_inserter(result[c]),
          [&](const types::global_dof_index node) { return nodes.owned().is_element(node); });
    return result;
  }

  template <int dim>
  void ThermalSelection<dim>::find_nodes()
  {
    std::vector<types::global_dof_index> cell_nodes;
    std::vector<Point<dim>> cell_points;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
    {
      if (cell->is_artificial())
        continue;
      nodes.cell_nodes(cell, cell_nodes);
      nodes.cell_points(cell, cell_points);
      const auto select = [&](const unsigned int c, const unsigned int k)
      {
        if (conditions[c].place.contains(cell_points[k]))
          selected_nodes[c].push_back(cell_nodes[k]);
      };
      for (unsigned int c = 0; c < conditions.size(); ++c)
      {
        const Place<dim> &place = conditions[c].place;
        if (is_on_faces(conditions[c].type))
          continue;
        if (!place.has_boundaries())
          for (unsigned int k = 0; k < cell_nodes.size(); ++k)
            select(c, k);
        else
          for (const unsigned int f : cell->face_indices())
            if (cell->face(f)->at_boundary() && place.has_boundary(cell->face(f)->boundary_id()))
              for (const unsigned int k : nodes.face_places(f))
                select(c, k);
      }
    }
    for (unsigned int c = 0; c < conditions.size(); ++c)
    {
      std::vector<types::global_dof_index> &selected = selected_nodes[c];
      std::sort(selected.begin(), selected.end());
      selected.erase(std::unique(selected.begin(), selected.end()), selected.end());
      for (const types::global_dof_index node : selected)
        n_selected[c] += nodes.owned().is_element(node) ? 1 : 0;
    }
  }

  template <int dim>
  void ThermalSelection<dim>::find_faces(TributaryAreas<dim> &areas)
  {
    std::vector<types::global_dof_index> cell_nodes, face_nodes;
    std::vector<Point<dim>> cell_points;
    std::vector<unsigned int> present;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
    {
      if (!cell->is_locally_owned() || !cell->at_boundary())
        continue;
      nodes.cell_nodes(cell, cell_nodes);
      nodes.cell_points(cell, cell_points);
      for (const unsigned int f : cell->face_indices())
      {
        if (!cell->face(f)->at_boundary())
          continue;
        face_nodes.clear();
        for (const unsigned int k : nodes.face_places(f))
          face_nodes.push_back(cell_nodes[k]);
        const bool is_outer = nodes.is_outer_face(cell, f);
        present.clear();
        for (unsigned int c = 0; c < conditions.size(); ++c)
        {
          const ThermalCondition<dim> &condition = conditions[c];
          if (condition.type == ThermalConditionType::temperature)
          {
            const std::vector<types::global_dof_index> &all = selected_nodes[c];
            if (std::all_of(face_nodes.begin(), face_nodes.end(),
                            [&](const types::global_dof_index node)
                            { return std::binary_search(all.begin(), all.end(), node); }))
              present.push_back(c);
            continue;
          }
          if (!is_on_faces(condition.type) || (crosses_surface(condition.type) && !is_outer) ||
              !condition.place.contains_face(cell->face(f)->boundary_id(), cell->face(f)->center()))
            continue;
          present.push_back(c);
          ++n_selected[c];
          if (crosses_surface(condition.type))
            areas.add_face(c, face_nodes);
          if (is_film(condition.type))
            for (const LimitedFunction<dim> *function :
                 {&*condition.coefficient, &*condition.ambient})
              if (function->depends_on_place())
                for (const unsigned int k : nodes.face_places(f))
                  function->check_start(cell_points[k]);
        }
        for (const unsigned int later : present)
          for (const unsigned int earlier : present)
            if (earlier < later &&
                !are_compatible(conditions[earlier].type, conditions[later].type))
              ++n_conflicts[later * conditions.size() + earlier];
      }
    }
  }

  template <int dim>
  void
  ThermalSelection<dim>::refuse_what_selects_nothing(const std::vector<Section> &sections) const
  {
    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (Utilities::MPI::sum(n_selected[c], nodes.communicator()) == 0)
        conditions[c].place.fail_empty(
            sections[c], is_on_faces(conditions[c].type) ? nodes.outer_face_text() : "node");
  }

  template <int dim>
  void ThermalSelection<dim>::refuse_conflicts(const std::vector<Section> &sections) const
  {
    std::vector<unsigned int> n_shared(n_conflicts.size());
    Utilities::MPI::sum(n_conflicts, nodes.communicator(), n_shared);
    for (unsigned int later = 0; later < conditions.size(); ++later)
      for (unsigned int earlier = 0; earlier < later; ++earlier)
      {
        const unsigned int n = n_shared[later * conditions.size() + earlier];
        if (n == 0)
          continue;
        const bool is_twice = conditions[later].type == conditions[earlier].type;
        sections[later].fail(
            "Type", (n == 1 ? "a face" : std::to_string(n) + " faces") +
                        " of the boundary that the condition selects " + (n == 1 ? "has" : "have") +
                        " the condition \"" + conditions[earlier].name + "\" of type \"" +
                        sections[earlier].get("Type") + "\" already; " +
                        (is_twice ? "allowed is one condition of a type on a face."
                                  : "a temperature or an adiabatic surface allows no other "
                                    "condition on a face."));
      }
  }

  template class ThermalSelection<2>;
  template class ThermalSelection<3>;
} // namespace tombolo
