// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/nodal_state.h>

namespace tombolo
{
  std::vector<std::pair<FieldDescription, NodalVector *>> NodalState::fields()
  {
    std::vector<std::pair<FieldDescription, NodalVector *>> result{
        {{"initial position", "L", FieldLocation::node, 3, true}, &initial_position},
        {{"position", "L", FieldLocation::node, 3, true}, &position},
        {{"unsmoothed velocity", "L/T", FieldLocation::node, 3, true}, &unsmoothed_velocity},
        {{"velocity", "L/T", FieldLocation::node, 3, false}, &velocity},
        {{"force", "M L/T^2", FieldLocation::node, 3, false}, &force},
        {{"acceleration", "L/T^2", FieldLocation::node, 3, false}, &acceleration},
        {{"mass", "M", FieldLocation::node, 1, false}, &mass}};
    if (!moves)
      result.resize(2);
    else if (has_unsmoothed_position)
      result.push_back(
          {{"unsmoothed position", "L", FieldLocation::node, 3, true}, &unsmoothed_position});
    return result;
  }

  void NodalState::reinit(const std::shared_ptr<const NodePartition> &partition,
                          const bool has_mechanics, const bool with_unsmoothed_position)
  {
    moves = has_mechanics;
    has_unsmoothed_position = with_unsmoothed_position;
    for (const auto &[description, vector] : fields())
    {
      const bool is_position =
          vector == &position || vector == &initial_position || vector == &unsmoothed_position;
      vector->reinit(partition, description.n_components == 1 ? Quantity::scalar
                                : is_position                 ? Quantity::position
                                                              : Quantity::vector);
    }
  }

  void NodalState::move_to(const std::shared_ptr<const NodePartition> &partition)
  {
    for (const auto &[description, vector] : fields())
      vector->move_to(partition);
  }

  std::vector<std::pair<FieldDescription, NodalVector *>> ThermalState::fields()
  {
    const FieldLocation node = FieldLocation::node;
    return {{{"enthalpy", "M L^2/T^2", node, 1, true}, &enthalpy},
            {{"unsmoothed temperature", "temperature", node, 1, true}, &unsmoothed_temperature},
            {{"temperature", "temperature", node, 1, true}, &temperature},
            {{"next enthalpy", "M L^2/T^2", node, 1, true}, &next_enthalpy},
            {{"next unsmoothed temperature", "temperature", node, 1, true},
             &next_unsmoothed_temperature},
            {{"next temperature", "temperature", node, 1, true}, &next_temperature},
            {{"present temperature", "temperature", node, 1, false}, &present_temperature},
            {{"pending heat", "M L^2/T^2", node, 1, false}, &pending}};
  }

  void ThermalState::reinit(const std::shared_ptr<const NodePartition> &partition)
  {
    for (const auto &[description, vector] : fields())
    {
      const bool is_scalar = vector == &enthalpy || vector == &next_enthalpy || vector == &pending;
      vector->reinit(partition, is_scalar ? Quantity::scalar : Quantity::scalars);
    }
  }

  void ThermalState::move_to(const std::shared_ptr<const NodePartition> &partition)
  {
    for (const auto &[description, vector] : fields())
      vector->move_to(partition);
  }
} // namespace tombolo
