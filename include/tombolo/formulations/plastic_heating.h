// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/material.h>
#include <tombolo/materials/thermal_properties.h>
#include <tombolo/state/material_points.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The heat of the material points of a part, in scenes with heat and mechanics: their
   * temperature, which is that of the nodes raised by the plastic work that the nodes have not
   * received yet; and how much that is. In scenes without heat points have no fields of it.
   */
  class PlasticHeating
  {
  public:
    /** The fields of the temperature of a point, and of the heat that it gave to nodes. */
    static const std::string temperature_name, given_name;

    /** @p heat may be null: no heat. */
    void set(const std::shared_ptr<const ThermalProperties> &heat, const Material &material);

    bool is_on() const
    {
      return properties != nullptr;
    }

    /** The fields that points need; none if off. */
    std::vector<FieldDescription> variables() const;

    void initialize(const MaterialPoints &points);

    /** Advances the temperature of @p n points from @p first on to the present one, from the nodal
     * @p temperature at each of them; its change goes to @p increment, and is zero at the start,
     * when nothing expands from the temperatures that are given. Only if on. */
    void advance(MaterialPoints &points, std::size_t first, unsigned int n,
                 const double *temperature, bool is_start, double *increment) const;

    /** The temperature of all points; null if off. */
    const double *temperature(const MaterialPoints &points) const
    {
      return is_on() ? points.component(temperature_field, 0) : nullptr;
    }

    /** Whether plastic work heats. */
    bool has_plastic_heat() const
    {
      return is_plastic;
    }

    /** The heat of point @p i that the nodes have not received [M L^2/T^2]. */
    double pending(const MaterialPoints &points, unsigned int i) const;

    double pending(const MaterialPoints &points) const;

    /** Returns pending(), and counts it as given. */
    double give(MaterialPoints &points, unsigned int i) const;

    /** Sets the @p pending heat of point @p i, whose plastic work is known, that the nodes have not
     * received. Of its volume, @p old_share keeps the temperature that it has; the rest has that of
     * the node, @p nodal, raised by this heat, so that it does not expand at once. Only if on. */
    void set_pending_heat(MaterialPoints &points, unsigned int i, double old_share, double pending,
                          double nodal) const;

  private:
    std::shared_ptr<const ThermalProperties> properties;
    double fraction = 0; ///< η
    double density = 0;  ///< initial
    bool is_plastic = false;
    unsigned int temperature_field = 0, given_field = 0, work_field = 0;
  };
} // namespace tombolo
