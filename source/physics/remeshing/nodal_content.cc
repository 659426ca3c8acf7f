// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/nodal_content.h>

#include <tombolo/formulations/smoothed/smoothed_cell.h>

#include <numeric>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Of the points of a cell whose nodes are where @p place_of says, by their local numbers. */
    template <int dim, typename PlaceOf>
    std::vector<double> volumes_of_cell(const SmoothedIntegrationRule rule,
                                        const SmoothedCell<dim> &of_lattice,
                                        const RemapCell<dim> &cell, const NodePartition &partition,
                                        const PlaceOf &place_of)
    {
      typename SubCells<dim>::Corners corners;
      for (unsigned int k = 0; k < corners.size(); ++k)
        corners[k] = place_of(cell.nodes[k]);
      if (rule != SmoothedIntegrationRule::smoothed)
        return {determinant(PointOfCell<dim>(corners).jacobian)};
      const auto volumes = !of_lattice.has_further_nodes()
                               ? CellSimplices<dim>::volumes(corners)
                               : volumes_within<dim>(present_facets<dim>(
                                     of_lattice, [&](const types::global_dof_index node)
                                     { return place_of(partition.local_index(node)); }));
      return {volumes.begin(), volumes.end()};
    }
  } // namespace

  template <int dim>
  NodalContent<dim>::NodalContent(const Model<dim> &model, const unsigned int part,
                                  NodalVector of_part)
      : mass(std::move(of_part)), part(part)
  {
    if (!model.heat)
      return;
    enthalpy = enthalpies(model, temperatures(model));
    initial = enthalpy.copy();
  }

  template <int dim>
  NodalVector NodalContent<dim>::temperatures(const Model<dim> &model) const
  {
    const ThermalState &thermal = model.heat->state;
    return nodal_field(model.state.partition(), Quantity::scalars,
                       [&](const unsigned int i, double *const values)
                       {
                         if (!(*mass.node(i) > 0.))
                           return;
                         values[0] = *thermal.unsmoothed_temperature.node(i);
                         values[1] = *thermal.next_unsmoothed_temperature.node(i);
                         values[2] = *thermal.present_temperature.node(i);
                       });
  }

  template <int dim>
  NodalVector NodalContent<dim>::enthalpies(const Model<dim> &model,
                                            const NodalVector &temperatures) const
  {
    const ThermalProperties &properties = *model.parts[part].heat;
    return nodal_field(model.state.partition(), Quantity::scalars,
                       [&](const unsigned int i, double *const values)
                       {
                         for (unsigned int slot = 0; slot < 3 && *mass.node(i) > 0.; ++slot)
                           values[slot] = properties.enthalpy(temperatures.node(i)[slot]);
                       });
  }

  template <int dim>
  void NodalContent<dim>::give_heat(Model<dim> &model, const NodalVector &after) const
  {
    ThermalState &thermal = model.heat->state;
    const ThermalProperties &properties = *model.parts[part].heat;
    const auto change = [&](const unsigned int i, const unsigned int slot, double &of_node,
                            double &unsmoothed, double &field)
    {
      of_node += *after.node(i) * enthalpy.node(i)[slot] - *mass.node(i) * initial.node(i)[slot];
      if (*after.node(i) == 0.)
        return;
      field -= unsmoothed;
      unsmoothed = model.heat->nodal_enthalpy.temperature(i, of_node);
      field += unsmoothed;
    };
    change_owned(
        {&thermal.unsmoothed_temperature, &thermal.temperature,
         &thermal.next_unsmoothed_temperature, &thermal.next_temperature,
         &thermal.present_temperature},
        [&]
        {
          for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
          {
            if (!(*after.node(i) > 0. || *mass.node(i) > 0.))
              continue;
            change(i, 0, *thermal.enthalpy.node(i), *thermal.unsmoothed_temperature.node(i),
                   *thermal.temperature.node(i));
            change(i, 1, *thermal.next_enthalpy.node(i),
                   *thermal.next_unsmoothed_temperature.node(i), *thermal.next_temperature.node(i));
            if (*after.node(i) > 0.)
              *thermal.present_temperature.node(i) = properties.temperature(enthalpy.node(i)[2]);
          }
        });
    model.heat->limit_is_outdated = true;
  }

  template <int dim>
  std::vector<double>
  NodalContent<dim>::former_volumes(const std::vector<RemapCell<dim>> &cells,
                                    const std::vector<SmoothedCell<dim>> &lattice,
                                    const SmoothedIntegrationRule rule, const NodalVector &after,
                                    const NodalVector &velocity, const double step)
  {
    std::vector<double> result;
    for (std::size_t c = 0; c < cells.size(); ++c)
    {
      // The state is that of t_{n-1}, and the step to t_n is still to come.
      const auto volumes_since = [&](const double since)
      {
        const auto place_of = [&](const unsigned int node)
        {
          Point<dim> result;
          for (unsigned int d = 0; d < dim; ++d)
            result[d] = after.node(node)[d] - since * velocity.node(node)[d];
          return result;
        };
        return volumes_of_cell<dim>(rule, lattice[c], cells[c], *after.partition(), place_of);
      };
      const std::vector<double> volumes = volumes_since(0.), former = volumes_since(step);
      const double now = std::accumulate(volumes.begin(), volumes.end(), 0.);
      const double before = std::accumulate(former.begin(), former.end(), 0.);
      for (const double volume : volumes)
        result.push_back(cells[c].is_void_after ? 0. : volume * before / now);
    }
    return result;
  }

  template class NodalContent<2>;
  template class NodalContent<3>;
} // namespace tombolo
