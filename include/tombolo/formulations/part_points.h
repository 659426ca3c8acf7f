// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/simd/unroll.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/formulations/plastic_heating.h>
#include <tombolo/materials/kinematics.h>
#include <tombolo/materials/material.h>
#include <tombolo/materials/thermal_properties.h>
#include <tombolo/state/material_points.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The material points of one part and what makes their stress: material, strain measure,
   * artificial viscosity and heat. PointSweep advances them, PointStiffness has their elastic
   * stiffness, LinearizedPoints their tangent; formulations place and move them.
   */
  class PartPoints
  {
  public:
    /** Without artificial viscosity. */
    PartPoints() = default;
    explicit PartPoints(const BulkViscosity &viscosity,
                        const StrainMeasure measure = StrainMeasure::rate)
        : bulk_viscosity(viscosity), strain_measure(measure)
    {}

    /** Strain measure, with this default, and viscosity of a section. */
    explicit PartPoints(const Entries &e, StrainMeasure by_default = StrainMeasure::rate);

    /** Sets material and heat (null: none). There are no points yet, or none with heat alone. */
    void initialize(const std::shared_ptr<const Material> &material,
                    const std::shared_ptr<const ThermalProperties> &heat, bool has_mechanics);

    /** Makes @p n points without volume, with the fields of the material, @p formulation_fields,
     * those of viscosity and heat, and @p further ones; none in a scene of heat alone. */
    void create(unsigned int n, const std::vector<FieldDescription> &formulation_fields = {},
                const std::vector<FieldDescription> &further = {});

    /** Uses the volumes as those of the start, in so many dimensions. */
    void begin_with_volumes(int dimension)
    {
      if (has_points)
        bulk_viscosity.initialize(*part_material, dimension, material_points);
    }

    bool has_mechanics() const
    {
      return has_points;
    }
    const Material &material() const
    {
      return *part_material;
    }
    /** Null in scenes without heat. */
    const ThermalProperties *heat() const
    {
      return thermal_properties.get();
    }
    const MaterialPoints &points() const
    {
      return material_points;
    }
    MaterialPoints &points()
    {
      return material_points;
    }
    bool is_logarithmic() const
    {
      return strain_measure == StrainMeasure::logarithmic;
    }
    const BulkViscosity &viscosity() const
    {
      return bulk_viscosity;
    }
    const PlasticHeating &heating() const
    {
      return plastic_heating;
    }
    /** The temperature of points from @p first on; null in scenes without heat. */
    const double *temperature(const std::size_t first = 0) const
    {
      const double *const temperatures = plastic_heating.temperature(material_points);
      return temperatures == nullptr ? nullptr : temperatures + first;
    }

    /** Addresses of the components that the formulation has at the points, those of point 0. */
    const std::vector<double *> &formulation_variables() const
    {
      return variables_of_formulation;
    }

    /** Volume times stress, less the artificial pressure, of n_lanes points from @p i on. */
    TOMBOLO_ALWAYS_INLINE void integrate_stress(const std::size_t i, Lanes (&stress)[6]) const
    {
      const Lanes volume = load_lanes(material_points.component(MaterialPoints::volume, 0) + i);
      for (unsigned int c = 0; c < 6; ++c)
        stress[c] = volume * load_lanes(material_points.component(MaterialPoints::stress, c) + i);
      if (bulk_viscosity.is_on())
        for (unsigned int c = 0; c < 3; ++c)
          stress[c] -= volume * load_lanes(bulk_viscosity.pressure(material_points) + i);
    }

    /** Sets the data of the points of @p batch, from @p first on, beside stress, strain and
     * volumes: the variables of the material, and with heat their temperature, which it advances
     * from that of the nodes at the points; its change is kept in @p temperature_increment. */
    void complete(MaterialBatch &batch, std::size_t first, const double *nodal_temperature,
                  double *temperature_increment);

    /** Turns the material's tensors at n_lanes points from @p i on, as rotate() does the stress. */
    TOMBOLO_ALWAYS_INLINE void turn_variables(const std::size_t i, const Lanes (&spin)[3])
    {
      for (const std::array<double *, 6> &component : turning_variables)
      {
        Lanes tensor[6];
        for (unsigned int c = 0; c < 6; ++c)
          tensor[c] = load_lanes(component[c] + i);
        rotate(spin, tensor);
        for (unsigned int c = 0; c < 6; ++c)
          store_lanes(tensor[c], component[c] + i);
      }
    }

    /** What has no stiffness in LinearizedPoints, for a message; empty: nothing. */
    std::string unfit_to_linearize() const
    {
      return bulk_viscosity.is_on() ? "artificial bulk viscosity, which resists rates" : "";
    }

    /** As Formulation::energies(), without hourglass modes. */
    EnergyAccounts energies() const;

    /** The elastic energy of each point, padding included [M L^2/T^2]. */
    std::vector<double> elastic_energies() const;

  private:
    std::shared_ptr<const Material> part_material;
    std::shared_ptr<const ThermalProperties> thermal_properties;
    bool has_points = false;
    BulkViscosity bulk_viscosity;
    StrainMeasure strain_measure = StrainMeasure::rate;
    PlasticHeating plastic_heating;
    MaterialPoints material_points;
    std::vector<double *> variables_of_material, variables_of_formulation; // those of point 0
    std::vector<std::array<double *, 6>> turning_variables;                // those of point 0
  };
} // namespace tombolo
