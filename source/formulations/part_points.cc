// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/part_points.h>

#include <algorithm>

namespace tombolo
{
  PartPoints::PartPoints(const Entries &e, const StrainMeasure by_default)
  {
    const std::string measure = e.choice(
        "Strain measure", by_default == StrainMeasure::rate ? "rate" : "logarithmic",
        "rate|logarithmic",
        "What the stress follows: the rate of deformation with an objective rate of the Kirchhoff "
        "stress, or the elastic logarithmic strain, from whose energy the forces derive: in "
        "motions of large amplitude over long times energy neither grows nor decays.");
    strain_measure = measure == "logarithmic" ? StrainMeasure::logarithmic : StrainMeasure::rate;
    bulk_viscosity = BulkViscosity(e);
  }

  void PartPoints::initialize(const std::shared_ptr<const Material> &material,
                              const std::shared_ptr<const ThermalProperties> &heat,
                              const bool has_mechanics)
  {
    part_material = material;
    thermal_properties = heat;
    has_points = has_mechanics;
    if (has_points)
      plastic_heating.set(heat, *material);
    material_points.reinit(0, {});
  }

  void PartPoints::create(const unsigned int n,
                          const std::vector<FieldDescription> &formulation_fields,
                          const std::vector<FieldDescription> &further)
  {
    if (!has_points)
      return;
    std::vector<FieldDescription> fields = part_material->internal_variables();
    const std::size_t n_of_material = MaterialPoints::n_standard_fields + fields.size();
    const std::size_t n_of_formulation = n_of_material + formulation_fields.size();
    for (const std::vector<FieldDescription> &others :
         {formulation_fields, bulk_viscosity.variables(), plastic_heating.variables(), further})
      fields.insert(fields.end(), others.begin(), others.end());
    material_points.reinit(n, fields);
    plastic_heating.initialize(material_points);
    variables_of_material.clear();
    variables_of_formulation.clear();
    turning_variables.clear();
    for (unsigned int f = MaterialPoints::n_standard_fields; f < n_of_material; ++f)
      if (material_points.fields()[f].turns)
      {
        AssertThrow(material_points.fields()[f].n_components == 6,
                    dealii::ExcMessage("The variable \"" + material_points.fields()[f].name +
                                       "\" turns, but is no symmetric tensor."));
        turning_variables.emplace_back();
        for (unsigned int c = 0; c < 6; ++c)
          turning_variables.back()[c] = material_points.component(f, c);
      }
    for (unsigned int f = MaterialPoints::n_standard_fields; f < n_of_formulation; ++f)
      for (unsigned int c = 0; c < material_points.fields()[f].n_components; ++c)
        (f < n_of_material ? variables_of_material : variables_of_formulation)
            .push_back(material_points.component(f, c));
  }

  void PartPoints::complete(MaterialBatch &batch, const std::size_t first,
                            const double *const nodal_temperature,
                            double *const temperature_increment)
  {
    batch.internal_variables.resize(variables_of_material.size());
    for (std::size_t c = 0; c < variables_of_material.size(); ++c)
      batch.internal_variables[c] = variables_of_material[c] + first;
    if (!plastic_heating.is_on())
      return;
    plastic_heating.advance(material_points, first, batch.n, nodal_temperature,
                            batch.time_increment == 0., temperature_increment);
    batch.temperature = temperature(first);
    batch.temperature_increment = temperature_increment;
  }

  EnergyAccounts PartPoints::energies() const
  {
    constexpr unsigned int block_size = 64;
    alignas(64) double density[block_size];
    const double *const volume = material_points.component(MaterialPoints::volume, 0);
    const double *const ratio = material_points.component(MaterialPoints::volume_ratio, 0);
    Lanes elastic = 0.;
    for (unsigned int first = 0; first < material_points.padded_size(); first += block_size)
    {
      const unsigned int n = std::min(block_size, material_points.padded_size() - first);
      const double *stress[6];
      for (unsigned int c = 0; c < 6; ++c)
        stress[c] = material_points.component(MaterialPoints::stress, c) + first;
      part_material->elastic_energy_density(n, stress, temperature(first), density);
      for (unsigned int i = 0; i < n; i += n_lanes)
        elastic += load_lanes(density + i) * load_lanes(volume + first + i) *
                   load_lanes(ratio + first + i); // ½ τ : ε of an initial volume
    }
    EnergyAccounts result;
    result.add("elastic energy", EnergyKind::stored,
               reduce(elastic) + integral_over_initial_volume(material_points, "pressure work"));
    result.add("plastic dissipation", EnergyKind::dissipated,
               integral_over_initial_volume(material_points, "plastic work"));
    result.add("hourglass energy", EnergyKind::stored, 0.);
    result.add("viscous dissipation", EnergyKind::artificial,
               integral_over_initial_volume(material_points, BulkViscosity::dissipation_name));
    if (thermal_properties)
      result.add("thermal work", EnergyKind::external,
                 integral_over_initial_volume(material_points, "thermal work"));
    return result;
  }

  std::vector<double> PartPoints::elastic_energies() const
  {
    const unsigned int n = material_points.padded_size();
    std::vector<double> result(n);
    const double *stress[6];
    for (unsigned int c = 0; c < 6; ++c)
      stress[c] = material_points.component(MaterialPoints::stress, c);
    part_material->elastic_energy_density(n, stress, temperature(), result.data());
    const double *const volume = material_points.component(MaterialPoints::volume, 0);
    const double *const ratio = material_points.component(MaterialPoints::volume_ratio, 0);
    const unsigned int field = material_points.find_field("pressure work");
    const double *const work =
        field < material_points.fields().size() ? material_points.component(field, 0) : nullptr;
    for (unsigned int i = 0; i < n; ++i)
    {
      result[i] *= volume[i] * ratio[i];
      if (work != nullptr)
        result[i] += work[i] * volume[i] / ratio[i];
    }
    return result;
  }
} // namespace tombolo
