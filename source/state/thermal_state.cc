// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/thermal_state.h>

namespace tombolo
{
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
