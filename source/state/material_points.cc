#include <tombolo/state/material_points.h>

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
  }

  unsigned int MaterialPoints::size() const
  {
    return n_points;
  }

  unsigned int MaterialPoints::padded_size() const
  {
    return static_cast<unsigned int>(n_padded);
  }

  const std::vector<FieldDescription> &MaterialPoints::fields() const
  {
    return descriptions;
  }

  std::size_t MaterialPoints::memory_consumption() const
  {
    return data.memory_consumption();
  }
} // namespace tombolo
