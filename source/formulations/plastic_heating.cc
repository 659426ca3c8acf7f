// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/plastic_heating.h>

#include <algorithm>

namespace tombolo
{
  const std::string PlasticHeating::temperature_name = "temperature";
  const std::string PlasticHeating::given_name = "plastic heat given to nodes";

  void PlasticHeating::set(const std::shared_ptr<const ThermalProperties> &heat,
                           const Material &material)
  {
    properties = heat;
    fraction = material.plastic_heat_fraction();
    density = material.density();
    is_plastic = properties != nullptr && fraction != 0. && material.remembers("plastic work");
  }

  std::vector<FieldDescription> PlasticHeating::variables() const
  {
    if (!is_on())
      return {};
    const FieldLocation point = FieldLocation::material_point;
    std::vector<FieldDescription> fields = {
        {temperature_name, "temperature", point, 1, true, properties->initial_temperature()}};
    if (is_plastic)
      fields.push_back({given_name, "M L^2/T^2", point, 1, true, 0., true, OnDivision::shared});
    return fields;
  }

  void PlasticHeating::initialize(const MaterialPoints &points)
  {
    temperature_field = points.find_field(temperature_name);
    given_field = points.find_field(given_name);
    work_field = points.find_field("plastic work");
  }

  double PlasticHeating::pending(const MaterialPoints &points, const unsigned int i) const
  {
    const double volume = points.component(MaterialPoints::volume, 0)[i];
    // Unused lanes of a batch of cells; after a resume they repeat the last cell in all else.
    if (volume == 0.)
      return 0.;
    const double initial_volume = volume / points.component(MaterialPoints::volume_ratio, 0)[i];
    return fraction * points.component(work_field, 0)[i] * initial_volume -
           points.component(given_field, 0)[i];
  }

  double PlasticHeating::pending(const MaterialPoints &points) const
  {
    double sum = 0;
    if (is_plastic)
      for (unsigned int i = 0; i < points.size(); ++i)
        sum += pending(points, i);
    return sum;
  }

  double PlasticHeating::give(MaterialPoints &points, const unsigned int i) const
  {
    const double heat = pending(points, i);
    points.component(given_field, 0)[i] += heat;
    return heat;
  }

  void PlasticHeating::set_pending_heat(MaterialPoints &points, const unsigned int i,
                                        const double old_share, const double pending,
                                        const double nodal) const
  {
    double now = nodal;
    if (is_plastic)
    {
      const double initial_volume = points.component(MaterialPoints::volume, 0)[i] /
                                    points.component(MaterialPoints::volume_ratio, 0)[i];
      points.component(given_field, 0)[i] =
          fraction * points.component(work_field, 0)[i] * initial_volume - pending;
      now = properties->temperature_after(nodal, pending / (density * initial_volume));
    }
    double &present = points.component(temperature_field, 0)[i];
    present = old_share * present + (1. - old_share) * now;
  }

  void PlasticHeating::advance(MaterialPoints &points, const std::size_t first,
                               const unsigned int n, const double *const nodal, const bool is_start,
                               double *const increment) const
  {
    double *const present = points.component(temperature_field, 0) + first;
    if (is_start)
    {
      std::copy(nodal, nodal + n, present);
      std::fill(increment, increment + n, 0.);
      return;
    }
    if (!is_plastic)
    {
#pragma GCC ivdep
      for (unsigned int i = 0; i < n; ++i)
      {
        increment[i] = nodal[i] - present[i];
        present[i] = nodal[i];
      }
      return;
    }
    const double *const volume = points.component(MaterialPoints::volume, 0) + first;
    const double *const volume_ratio = points.component(MaterialPoints::volume_ratio, 0) + first;
    const double *const work = points.component(work_field, 0) + first;
    const double *const given_heat = points.component(given_field, 0) + first;
    const bool is_linear = properties->capacity().is_constant();
    const double inverse_density = 1. / density, share = fraction;
#pragma GCC ivdep
    for (unsigned int i = 0; i < n; ++i)
    {
      // Unused lanes of a batch of cells have no volume; they release nothing, and must not
      // accumulate it.
      const double initial_volume = volume[i] / volume_ratio[i];
      const bool is_used = initial_volume > 0.;
      const double inverse_volume = is_used ? 1. / initial_volume : 0.;
      increment[i] =
          is_used ? inverse_density * (share * work[i] - inverse_volume * given_heat[i]) : 0.;
    }
    const double inverse_capacity = is_linear ? 1. / properties->capacity().largest() : 0.;
    for (unsigned int i = 0; i < n; ++i)
    {
      const double now = is_linear ? nodal[i] + inverse_capacity * increment[i]
                                   : properties->temperature_after(nodal[i], increment[i]);
      increment[i] = now - present[i];
      present[i] = now;
    }
  }
} // namespace tombolo
