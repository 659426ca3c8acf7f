// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/base/log.h>
#include <tombolo/base/symmetric_tensors.h>
#include <tombolo/model/model.h>
#include <tombolo/output/unit_labels.h>
#include <tombolo/simulation/short_number.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  template <int dim>
  void warn_of_wave_speeds(const Model<dim> &model, const UnitLabels &labels, Log &log)
  {
    constexpr double slowest = 100., fastest = 10000.;
    const std::optional<double> length = labels.in_si("L"), time = labels.in_si("T");
    if (!length || !time)
      return;
    for (const Part<dim> &part : model.parts)
    {
      const Material &material = *part.material;
      if (!material.has_mechanics())
        continue;
      const double meters_per_second =
          std::sqrt(material.inertial_density() / material.density()) * *length / *time;
      const double compression = material.longitudinal_wave_speed() * meters_per_second;
      const double shear = material.shear_wave_speed() * meters_per_second;
      // Without compressibility P waves have any speed.
      if (compression < slowest || shear > fastest)
        log.warn("Waves would travel through part \"" + part.name + "\" at " +
                 short_number(compression) + " m/s (P) and " + short_number(shear) +
                 " m/s (S) by `Unit labels`, in solids it is 100 to 10000: are density, modulus, "
                 "length and time in units that belong together?");
    }
  }

  /** Warns of initial stresses at which a material flows at once, which takes a part of their
   * energy in the first step. Collective. */
  template <int dim>
  void warn_of_initial_flow(const Model<dim> &model, Log &log)
  {
    constexpr double round_off = 1e-6;
    for (const Part<dim> &part : model.parts)
    {
      if (!part.material->can_yield())
        continue;
      const MaterialPoints &points = part.formulation->points();
      const unsigned int field = points.find_field("temperature");
      const double start = part.heat ? part.heat->initial_temperature() : 0.;
      std::string text;
      const std::vector<Point<dim>> &positions = part.formulation->initial_point_positions();
      for (unsigned int i = 0; i < positions.size() && text.empty(); ++i)
      {
        SymmetricComponents stress;
        for (unsigned int c = 0; c < 6; ++c)
          stress[c] = points.component(MaterialPoints::stress, c)[i];
        const double effective_stress = von_mises_stress(stress.data());
        if (effective_stress == 0.)
          continue; // the yield stress of all points would take its time
        const double temperature =
            field < points.fields().size() ? points.component(field, 0)[i] : start;
        const double yield_stress = part.material->slow_yield_stress(0., temperature);
        if (effective_stress > (1. + round_off) * yield_stress)
          text = "The von Mises stress at the start is " + short_number(effective_stress) + " at " +
                 position_text(positions[i]) + ", but part \"" + part.name + "\" yields at " +
                 short_number(yield_stress) +
                 ": it flows at once, and the energy balance lacks what that takes.";
      }
      if (const std::string first = first_text(model.communicator, text); !first.empty())
        log.warn(first);
    }
  }

  /** Of scenes with units: numbers without them may have any ratio. */
  template <int dim>
  void warn_of_yield_stresses(const Model<dim> &model, const UnitLabels &labels, Log &log)
  {
    constexpr double largest_strain = 0.1;
    if (!labels.in_si("L") || !labels.in_si("T"))
      return;
    for (const Part<dim> &part : model.parts)
    {
      if (!part.material->can_yield())
        continue;
      const double bulk = part.material->bulk_modulus(), shear = part.material->shear_modulus();
      const double modulus = 9. * bulk * shear / (3. * bulk + shear);
      const double yield = part.material->slow_yield_stress(0., 0.);
      if (yield > largest_strain * modulus)
        log.warn("Part \"" + part.name + "\" yields at " + short_number(yield) + ", " +
                 short_number(yield / modulus) +
                 " times its Young's modulus, where metals yield below 0.02 times theirs: are "
                 "both in the same unit of stress?");
    }
  }

  /** Of scenes with units of length and time: tungsten has 132 J/(kg K), water 4186. */
  template <int dim>
  void warn_of_heat_capacities(const Model<dim> &model, const UnitLabels &labels, Log &log)
  {
    constexpr double smallest = 50., largest = 10000.;
    const std::optional<double> length = labels.in_si("L"), time = labels.in_si("T");
    if (!length || !time)
      return;
    for (const Part<dim> &part : model.parts)
    {
      if (part.heat == nullptr)
        continue;
      const double joules = part.heat->capacity().value(part.heat->initial_temperature()) *
                            (*length / *time) * (*length / *time);
      if (joules < smallest || joules > largest)
        log.warn("Part \"" + part.name + "\" has a specific heat capacity of " +
                 short_number(joules) +
                 " J/(kg K) by `Unit labels`, in solids it is 100 to 5000: is it in the unit of "
                 "length^2/(time^2 temperature)?");
    }
  }
} // namespace tombolo
