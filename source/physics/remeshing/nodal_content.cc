// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/nodal_content.h>

#include <tombolo/formulations/smoothed/refined_cell_facets.h>

#include <numeric>

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
                                  const NodalVector &of_part)
      : part(part)
  {
    const auto &partition = model.state.partition();
    mass.reinit(partition, Quantity::scalar);
    mass.copy_from(of_part);
    if (!model.heat)
      return;
    enthalpy = enthalpies(model, temperatures(model));
    initial.reinit(partition, Quantity::scalars);
    initial.copy_from(enthalpy);
  }

  template <int dim>
  NodalVector NodalContent<dim>::temperatures(const Model<dim> &model) const
  {
    NodalVector result;
    result.reinit(model.state.partition(), Quantity::scalars);
    const ThermalState &thermal = model.heat->state;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      if (*mass.node(i) > 0.)
      {
        result.node(i)[0] = *thermal.unsmoothed_temperature.node(i);
        result.node(i)[1] = *thermal.next_unsmoothed_temperature.node(i);
        result.node(i)[2] = *thermal.present_temperature.node(i);
      }
    return result;
  }

  template <int dim>
  NodalVector NodalContent<dim>::enthalpies(const Model<dim> &model,
                                            const NodalVector &temperatures) const
  {
    NodalVector result;
    result.reinit(model.state.partition(), Quantity::scalars);
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      for (unsigned int slot = 0; slot < 3 && *mass.node(i) > 0.; ++slot)
        result.node(i)[slot] = model.parts[part].heat->enthalpy(temperatures.node(i)[slot]);
    result.update_ghosts();
    return result;
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
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      if (*after.node(i) > 0. || *mass.node(i) > 0.)
      {
        change(i, 0, *thermal.enthalpy.node(i), *thermal.unsmoothed_temperature.node(i),
               *thermal.temperature.node(i));
        change(i, 1, *thermal.next_enthalpy.node(i), *thermal.next_unsmoothed_temperature.node(i),
               *thermal.next_temperature.node(i));
        if (*after.node(i) > 0.)
          *thermal.present_temperature.node(i) = properties.temperature(enthalpy.node(i)[2]);
      }
    for (NodalVector *const vector : {&thermal.unsmoothed_temperature, &thermal.temperature,
                                      &thermal.next_unsmoothed_temperature,
                                      &thermal.next_temperature, &thermal.present_temperature})
      vector->update_ghosts();
    model.heat->limit_is_outdated = true;
  }

  template <int dim>
  std::vector<double> former_volumes(const std::vector<RemapCell<dim>> &cells,
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
  template std::vector<double> former_volumes(const std::vector<RemapCell<2>> &,
                                              const std::vector<SmoothedCell<2>> &,
                                              SmoothedIntegrationRule, const NodalVector &,
                                              const NodalVector &, double);
  template std::vector<double> former_volumes(const std::vector<RemapCell<3>> &,
                                              const std::vector<SmoothedCell<3>> &,
                                              SmoothedIntegrationRule, const NodalVector &,
                                              const NodalVector &, double);
} // namespace tombolo
