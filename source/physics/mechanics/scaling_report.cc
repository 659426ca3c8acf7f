// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/scaling_report.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/physics/mechanics/step_estimator.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tombolo
{
  template <int dim>
  ScalingReport<dim>::ScalingReport(const Model<dim> &model) : model(model)
  {
    std::array<double, 2> sums{};
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      sums[0] += *model.true_mass.node(i);
      sums[1] += *model.state.mass.node(i);
    }
    sums = ordered_sum(sums, model.communicator);
    true_mass = sums[0];
    inertia = model.scaling->settings().is_selective()
                  ? sums[1]
                  : model.scaling->settings().inertia_factor() * true_mass;
  }

  template <int dim>
  double ScalingReport<dim>::mass() const
  {
    return true_mass;
  }

  template <int dim>
  double ScalingReport<dim>::added_mass() const
  {
    const ScalingSettings &settings = model.scaling->settings();
    const double uniform = (settings.mass_factor - 1.) * true_mass;
    if (!settings.is_selective())
      return uniform;
    const double square = settings.process_time_factor * settings.process_time_factor;
    return uniform + (inertia - settings.inertia_factor() * true_mass) / square;
  }

  template <int dim>
  void ScalingReport<dim>::print(std::ostream &text) const
  {
    const ScalingSettings &settings = model.scaling->settings();
    const auto extent = model.scaling->extent(model.state.position);
    text << "  scaled inertia: mass factor " << settings.mass_factor << ", process "
         << settings.process_time_factor << " times faster, mass " << added_mass() << " added ("
         << 100. * added_mass() / true_mass << " %)";
    if (settings.is_selective())
      text << " with the target step " << settings.target_time_step << " in " << extent.cells
           << " cells and " << extent.particles << " particles";
    text << "; inertia, and kinetic energy with it, is " << inertia / true_mass
         << " times that of the mass\n"
         << "  smallest step by eq. (41) " << extent.smallest_step << " without scaling, "
         << courant_limit(model).time_step << " with it\n";
  }

  template <int dim>
  void ScalingReport<dim>::add_to(TimeTable &statistics, const EnergyBalance &balance) const
  {
    if (model.scaling->settings().is_selective())
      statistics.add("mass scaling work", "M L^2/T^2", balance.mass_scaling);
    statistics.add("added mass", "M", added_mass());
    const double internal = internal_energy(balance);
    if (internal > 0.)
      statistics.add("kinetic over internal energy", "1", balance.kinetic / internal);
  }

  template <int dim>
  Json ScalingReport<dim>::summary(const TimeTable &statistics) const
  {
    const ScalingSettings &settings = model.scaling->settings();
    const auto extent = model.scaling->extent(model.state.position);
    Json result = Json::object();
    result["mass_factor"] = settings.mass_factor;
    result["process_time_factor"] = settings.process_time_factor;
    if (settings.is_selective())
    {
      result["target_time_step"] = settings.target_time_step;
      result["cells_with_added_mass"] = extent.cells;
      result["particles_with_added_mass"] = extent.particles;
    }
    result["mass"] = true_mass;
    result["added_mass"] = added_mass();
    result["inertia_over_mass"] = inertia / true_mass;
    result["smallest_step_unscaled"] = extent.smallest_step;
    result["smallest_step_scaled"] = courant_limit(model).time_step;

    const auto elastic = statistics.column("elastic energy");
    const auto plastic = statistics.column("plastic dissipation");
    const auto kinetic = statistics.column("kinetic energy");
    double largest = 0.;
    for (std::size_t i = 0; i < elastic.size(); ++i)
      largest = std::max(largest, elastic[i] + plastic[i]);
    result["largest_kinetic_over_internal_energy"] = Json();
    double ratio = 0.;
    for (std::size_t i = 0; i < elastic.size(); ++i)
      if (elastic[i] + plastic[i] > 0. && elastic[i] + plastic[i] >= 0.01 * largest)
      {
        ratio = std::max(ratio, kinetic[i] / (elastic[i] + plastic[i]));
        result["largest_kinetic_over_internal_energy"] = ratio;
      }
    return result;
  }

  template <int dim>
  double ScalingReport<dim>::internal_energy(const EnergyBalance &balance)
  {
    return balance.elastic + balance.plastic;
  }

  template class ScalingReport<2>;
  template class ScalingReport<3>;
} // namespace tombolo
