// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/rigid_contacts.h>

#include <algorithm>
#include <limits>
#include <set>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void NodalYieldStress<dim>::validate(const Section &contact, const std::vector<Part<dim>> &parts)
  {
    if (contact.get("Shear limit") == "yield" && !parts.empty() &&
        std::none_of(parts.begin(), parts.end(),
                     [](const Part<dim> &part) { return part.material->can_yield(); }))
      contact.fail("Shear limit", "no material of the scene has a yield stress; allowed is a "
                                  "number.");
  }

  template <int dim>
  std::unique_ptr<NodalYieldStress<dim>> NodalYieldStress<dim>::create(const Contacts &contacts)
  {
    if (std::any_of(contacts.begin(), contacts.end(),
                    [](const auto &contact) { return contact->needs_yield_stress(); }))
      return std::make_unique<NodalYieldStress>();
    return nullptr;
  }

  template <int dim>
  void NodalYieldStress<dim>::sum_points(const Model<dim> &model, const unsigned int part)
  {
    sums.fit_to(model.state.partition(), Quantity::scalars);
    sums.set_zero();
    const Formulation<dim> &formulation = *model.parts[part].formulation;
    const MaterialPoints &points = formulation.points();
    const double *const strain = points.component(points.find_field("effective plastic strain"), 0);
    const unsigned int kept = points.find_field("temperature");
    const double *const temperature =
        kept < points.fields().size() ? points.component(kept, 0) : nullptr;
    const auto add = [&](const unsigned int node, const unsigned int point)
    {
      double *const sum = sums.node(node);
      sum[0] += strain[point];
      sum[1] += 1.;
      sum[2] += temperature != nullptr ? temperature[point] : 0.;
    };
    if (const ParticleFormulation<dim> *const particles = model.parts[part].particles)
    {
      const std::vector<unsigned int> &node_of_row = particles->stencils().particle_node;
      for (unsigned int row = 0; row < node_of_row.size(); ++row)
        add(node_of_row[row], row);
    }
    else if (formulation.n_points_per_cell() > 0)
    {
      std::vector<types::global_dof_index> cell_nodes;
      unsigned int cell_of_part = 0;
      for (const auto &cell : model.nodes->dof_handler().active_cell_iterators())
      {
        if (!cell->is_locally_owned() || model.part_cells->part_of(cell) != part)
          continue;
        const unsigned int number = cell_of_part++;
        if (formulation.is_removed(number))
          continue;
        model.nodes->cell_nodes(cell, cell_nodes);
        for (const types::global_dof_index node : cell_nodes)
          for (unsigned int q = 0; q < formulation.n_points_per_cell(); ++q)
            add(model.state.partition()->local_index(node), formulation.point_of_cell(number, q));
      }
    }
    sums.add_to_owners();
  }

  template <int dim>
  void NodalYieldStress<dim>::update(const Model<dim> &model, const Contacts &contacts)
  {
    std::set<unsigned int> nodes;
    for (const auto &contact : contacts)
      if (contact->needs_yield_stress())
      {
        nodes.insert(contact->candidate_nodes().begin(), contact->candidate_nodes().end());
        contact->set_yield_stress(yield_stress);
      }
    yield_stress.assign(model.state.partition()->n_owned(), 0.);
    n_points.assign(yield_stress.size(), 0.);
    for (unsigned int part = 0; part < model.parts.size(); ++part)
    {
      const Material &material = *model.parts[part].material;
      if (!material.can_yield())
        continue;
      sum_points(model, part);
      const bool has_heat = model.heat != nullptr;
      for (const unsigned int node : nodes)
      {
        const double *const sum = sums.node(node);
        if (!(sum[1] > 0.))
          continue;
        const double temperature =
            has_heat ? *model.heat->state.present_temperature.node(node) : sum[2] / sum[1];
        yield_stress[node] += sum[1] * material.slow_yield_stress(sum[0] / sum[1], temperature);
        n_points[node] += sum[1];
      }
    }
    for (const unsigned int node : nodes)
      yield_stress[node] = n_points[node] > 0. ? yield_stress[node] / n_points[node]
                                               : std::numeric_limits<double>::max();
  }

  template class NodalYieldStress<2>;
  template class NodalYieldStress<3>;
} // namespace tombolo
