// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surface_contact.h>
#include <tombolo/model/model.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/types.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The present yield stress at nodes, for a limit of shear in contacts: the flow stress of a slow
   * test at the plastic strain and the temperature there. That strain is that of the particle, or
   * the mean of the points of all cells at the node; of several materials it is their mean by the
   * number of points.
   */
  template <int dim>
  class NodalYieldStress
  {
  public:
    using Contacts = std::vector<std::unique_ptr<SurfaceContact<dim>>>;

    /** Throws InputError where a contact needs a yield stress and no material of the parts has one.
     */
    static void validate(const Section &contact, const std::vector<Part<dim>> &parts)
    {
      if (contact.get("Shear limit") == "yield" && !parts.empty() &&
          std::none_of(parts.begin(), parts.end(),
                       [](const Part<dim> &part) { return part.material->can_yield(); }))
        contact.fail("Shear limit", "no material of the scene has a yield stress; allowed is a "
                                    "number.");
    }

    /** Null where no contact needs it. */
    static std::unique_ptr<NodalYieldStress<dim>> create(const Contacts &contacts)
    {
      if (std::any_of(contacts.begin(), contacts.end(),
                      [](const auto &contact)
                      { return contact->contact_settings().shears_at_yield; }))
        return std::make_unique<NodalYieldStress>();
      return nullptr;
    }

    /** The nodes of contacts changed. */
    void invalidate_nodes()
    {
      partition = nullptr;
    }

    /** Computes it at the nodes of contacts that need it, and sets it there; the largest number
     * where no material flows. Collective. */
    void update(const Model<dim> &model, const Contacts &contacts)
    {
      if (partition != model.state.partition())
        find_cells(model, contacts);
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

  private:
    /** Sums strain, number and temperature of the points of a part at nodes. Collective. */
    void sum_points(const Model<dim> &model, const unsigned int part)
    {
      sums.fit_to(model.state.partition(), Quantity::scalars);
      sums.set_zero();
      const Formulation<dim> &formulation = *model.parts[part].formulation;
      const MaterialPoints &points = formulation.points();
      const double *const strain =
          points.component(points.find_field("effective plastic strain"), 0);
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
      else
        for (const auto &[cell, node] : cells_at_nodes[part])
          for (unsigned int q = 0;
               q < formulation.n_points_per_cell() && !formulation.is_removed(cell); ++q)
            add(node, formulation.point_of_cell(cell, q));
      sums.add_to_owners();
    }

    /** Finds the nodes of the contacts, and the cells of this rank there. Collective. */
    void find_cells(const Model<dim> &model, const Contacts &contacts)
    {
      partition = model.state.partition();
      const NodalVector marks =
          marked_nodes(partition,
                       [&](const auto &mark)
                       {
                         for (const auto &contact : contacts)
                           if (contact->contact_settings().shears_at_yield)
                           {
                             contact->set_yield_stress(yield_stress);
                             std::for_each(contact->candidate_nodes().begin(),
                                           contact->candidate_nodes().end(), mark);
                           }
                       });
      nodes = positive_nodes(marks, partition->n_owned());
      cells_at_nodes.assign(model.parts.size(), {});
      std::vector<dealii::types::global_dof_index> cell_nodes;
      for (unsigned int part = 0; part < model.parts.size(); ++part)
      {
        unsigned int number = 0;
        for (const auto &cell : cells_of_part(*model.nodes, *model.part_cells, part))
        {
          model.nodes->cell_nodes(cell, cell_nodes);
          for (const dealii::types::global_dof_index node : cell_nodes)
            if (const unsigned int local = partition->local_index(node); *marks.node(local) > 0.)
              cells_at_nodes[part].emplace_back(number, local);
          ++number;
        }
      }
    }

    /** By part: the number of a cell in it, and a local node of the contacts that it has. */
    std::vector<std::vector<std::pair<unsigned int, unsigned int>>> cells_at_nodes;
    std::vector<unsigned int> nodes;                ///< of the contacts, owned
    std::shared_ptr<const NodePartition> partition; ///< of these
    NodalVector sums; ///< plastic strain, number, temperature that points keep
    std::vector<double> yield_stress, n_points; ///< of owned nodes
  };
} // namespace tombolo
