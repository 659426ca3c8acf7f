// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/converting_cells.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    /** Volumes follow from masses. What viscosity has dissipated is not of the material, and heat
     * that nodes have not received is transferred separately. */
    bool carries_over(const std::string &field)
    {
      return field != "volume" && field != BulkViscosity::dissipation_name &&
             field != PlasticHeating::given_name;
    }
  } // namespace

  StateTransfer::StateTransfer(const std::shared_ptr<const NodePartition> &partition,
                               const MaterialPoints &source, const MaterialPoints &target)
  {
    volume.reinit(partition, Quantity::scalar);
    pending_heat.reinit(partition, Quantity::scalar);
    for (unsigned int f = 0; f < target.fields().size(); ++f)
    {
      const FieldDescription &field = target.fields()[f];
      const unsigned int in_source = source.find_field(field.name);
      if (in_source == source.fields().size() || !carries_over(field.name))
        continue;
      for (unsigned int c = 0; c < field.n_components; ++c)
      {
        components.push_back({in_source, f, c, {}});
        components.back().sum.reinit(partition, Quantity::scalar);
      }
    }
  }

  void StateTransfer::merge(PartPoints &part, const std::vector<unsigned int> &nodes,
                            const std::vector<double> &initial_volume,
                            const MaterialPoints &old_points, const std::vector<double> &old_volume,
                            const std::vector<unsigned int> &old_index) const
  {
    MaterialPoints &points = part.points();
    const PlasticHeating &heating = part.heating();
    const auto n = static_cast<unsigned int>(nodes.size());
    const auto is_old = [&](const std::size_t i) { return old_index[i] < old_volume.size(); };
    std::vector<double> old_share(n, 0.);
    for (unsigned int i = 0; i < n; ++i)
      if (is_old(i))
        old_share[i] =
            *volume.node(nodes[i]) == 0. ? 1. : old_volume[old_index[i]] / initial_volume[i];

    const std::vector<FieldDescription> &fields = points.fields();
    for (unsigned int f = 0; f < fields.size(); ++f)
    {
      const bool is_energy_of_old =
          fields[f].on_division == OnDivision::held &&
          std::none_of(components.begin(), components.end(),
                       [f](const Component &component) { return component.target_field == f; });
      for (unsigned int c = 0; c < fields[f].n_components; ++c)
        for (unsigned int i = 0; i < n; ++i)
          if (is_old(i))
            points.component(f, c)[i] =
                old_points.component(f, c)[old_index[i]] * (is_energy_of_old ? old_share[i] : 1.);
    }
    for (const Component &component : components)
    {
      double *const values = points.component(component.target_field, component.number);
      // The temperature of points is set below.
      if (heating.is_on() &&
          fields[component.target_field].name == PlasticHeating::temperature_name)
        continue;
      for (unsigned int i = 0; i < n; ++i)
        if (const double gained = *volume.node(nodes[i]); gained > 0.)
          values[i] = old_share[i] * values[i] +
                      (1. - old_share[i]) * *component.sum.node(nodes[i]) / gained;
    }
    double *const volumes = points.component(MaterialPoints::volume, 0);
    const double *const ratio = points.component(MaterialPoints::volume_ratio, 0);
    for (unsigned int i = 0; i < n; ++i)
    {
      volumes[i] = initial_volume[i] * ratio[i];
      if (!heating.is_on() || *volume.node(nodes[i]) == 0.)
        continue;
      double pending = *pending_heat.node(nodes[i]);
      if (is_old(i) && heating.has_plastic_heat())
        pending += heating.pending(old_points, old_index[i]);
      heating.set_pending_heat(points, i, old_share[i], pending, *temperature->node(nodes[i]));
    }
  }

  std::vector<NodalVector *> StateTransfer::sums()
  {
    std::vector<NodalVector *> result{&volume, &pending_heat};
    for (Component &component : components)
      result.push_back(&component.sum);
    return result;
  }

  template class Formulation<2>;
  template class Formulation<3>;
} // namespace tombolo
