// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/material_points.h>

#include <tombolo/base/simd/vectorization.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>

namespace tombolo
{
  void MaterialPoints::reinit(const unsigned int n_points,
                              const std::vector<FieldDescription> &internal_variables)
  {
    this->n_points = n_points;
    n_padded = padded_to_lanes(n_points);
    descriptions = {{"stress", "M/(L T^2)", FieldLocation::material_point, 6, true},
                    {"volume", "L^3", FieldLocation::material_point, 1, true},
                    {"volume ratio", "1", FieldLocation::material_point, 1, true}};
    descriptions.insert(descriptions.end(), internal_variables.begin(), internal_variables.end());

    first_component.clear();
    std::size_t n_components = 0;
    for (const FieldDescription &field : descriptions)
    {
      first_component.push_back(n_components);
      n_components += field.n_components;
    }
    data.resize(0);
    data.resize(n_components * n_padded, 0.);
    std::fill_n(component(volume_ratio, 0), n_padded, 1.);
    for (unsigned int f = n_standard_fields; f < descriptions.size(); ++f)
      for (unsigned int c = 0; c < descriptions[f].n_components; ++c)
        std::fill_n(component(f, c), n_padded, descriptions[f].initial_value);
  }

  unsigned int MaterialPoints::find_field(const std::string &name) const
  {
    const auto found =
        std::find_if(descriptions.begin(), descriptions.end(),
                     [&](const FieldDescription &field) { return field.name == name; });
    return static_cast<unsigned int>(found - descriptions.begin());
  }

  void MaterialPoints::restart_trial()
  {
    // In place: formulations keep addresses of components.
    AssertDimension(committed.size(), data.size());
    std::copy(committed.begin(), committed.end(), data.begin());
  }
} // namespace tombolo
