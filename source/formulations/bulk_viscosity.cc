// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/bulk_viscosity.h>

#include <tombolo/base/simd/vector_math.h>

#include <cmath>

namespace tombolo
{
  const std::string BulkViscosity::dissipation_name = "bulk viscosity dissipation";

  BulkViscosity::BulkViscosity(const Entries &e)
  {
    linear = e.number("Linear bulk viscosity", "0", from_to(0., 10.), "1",
                      "Coefficient $c_1$ of the artificial pressure rho l (c_1 c |tr D| + c_2 l "
                      "(tr D)^2) in compression; 0 is none, 0.06 is usual.");
    quadratic = e.number("Quadratic bulk viscosity", "0", from_to(0., 10.), "1",
                         "Coefficient $c_2$ of the same; 0 is none, 1.5 is usual.");
  }

  std::vector<FieldDescription> BulkViscosity::variables() const
  {
    if (!is_on())
      return {};
    return {{"bulk viscosity pressure", "M/(L T^2)", FieldLocation::material_point, 1, true},
            {"bulk viscosity tangent", "M/(L T)", FieldLocation::material_point, 1, true, 0., true},
            energy_field(dissipation_name)};
  }

  void BulkViscosity::initialize(const Material &material, const int dimension,
                                 MaterialPoints &points)
  {
    if (!is_on())
      return;
    wave_speed = material.longitudinal_wave_speed();
    density = material.inertial_density();
    inverse_dimension = 1. / dimension;
    pressure_field = points.find_field("bulk viscosity pressure");
    tangent_field = points.find_field("bulk viscosity tangent");
    dissipation_field = points.find_field(dissipation_name);
    work_field = points.find_field("viscous work");
    has_work = work_field < points.fields().size();
    const double *const volume = points.component(MaterialPoints::volume, 0);
    double *const tangent = points.component(tangent_field, 0);
    for (unsigned int i = 0; i < points.padded_size(); ++i)
      tangent[i] = density * std::pow(volume[i], inverse_dimension) * linear * wave_speed;
  }

  void BulkViscosity::advance(MaterialPoints &points, const std::size_t first, const unsigned int n,
                              const double *const strain_increment[3],
                              const double time_increment) const
  {
    if (has_work)
      advance_points<true>(points, first, n, strain_increment, time_increment);
    else
      advance_points<false>(points, first, n, strain_increment, time_increment);
  }

  template <bool heats>
  void BulkViscosity::advance_points(MaterialPoints &points, const std::size_t first,
                                     const unsigned int n, const double *const strain_increment[3],
                                     const double time_increment) const
  {
    const double inverse_time_increment = time_increment > 0. ? 1. / time_increment : 0.;
    const double *const xx = strain_increment[0];
    const double *const yy = strain_increment[1];
    const double *const zz = strain_increment[2];
    const double *const volume = points.component(MaterialPoints::volume, 0) + first;
    const double *const volume_ratio = points.component(MaterialPoints::volume_ratio, 0) + first;
    double *const pressure = points.component(pressure_field, 0) + first;
    double *const tangent = points.component(tangent_field, 0) + first;
    double *const dissipation = points.component(dissipation_field, 0) + first;
    double *const work = heats ? points.component(work_field, 0) + first : nullptr;
    const double c1 = linear * wave_speed, c2 = quadratic, exponent = inverse_dimension,
                 initial_density = density;
#pragma GCC ivdep
    for (unsigned int i = 0; i < n; ++i)
    {
      const double trace = xx[i] + yy[i] + zz[i];
      const double compression = trace < 0. ? -trace : 0.;
      const double rate = compression * inverse_time_increment;
      const double length = std::pow(volume[i], exponent);
      const double j = volume_ratio[i];
      // The moduli are constant: c grows with √J.
      const double impedance = initial_density / j * length;
      const double linear_part = c1 * std::sqrt(j);
      const double new_pressure = impedance * (linear_part + c2 * length * rate) * rate;
      tangent[i] = impedance * (linear_part + 2. * c2 * length * rate);
      const double gained = 0.5 * (pressure[i] + new_pressure) * j * (1. - 0.5 * trace) * trace;
      dissipation[i] -= gained;
      if constexpr (heats)
        work[i] -= gained;
      pressure[i] = new_pressure;
    }
  }

  double integral_over_initial_volume(const MaterialPoints &points, const std::string &field)
  {
    const unsigned int number = points.find_field(field);
    if (number == points.fields().size())
      return 0.;
    const double *const value = points.component(number, 0);
    const double *const volume = points.component(MaterialPoints::volume, 0);
    const double *const volume_ratio = points.component(MaterialPoints::volume_ratio, 0);
    double sum = 0.;
    for (unsigned int i = 0; i < points.size(); ++i)
      sum += value[i] * volume[i] / volume_ratio[i];
    return sum;
  }
} // namespace tombolo
