// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/nodal_state.h>

namespace tombolo
{
  std::vector<std::pair<FieldDescription, NodalVector *>> NodalState::fields()
  {
    if (!moves)
      return {{{"initial position", "L", FieldLocation::node, 3, true}, &initial_position},
              {{"position", "L", FieldLocation::node, 3, true}, &position}};
    return {{{"initial position", "L", FieldLocation::node, 3, true}, &initial_position},
            {{"position", "L", FieldLocation::node, 3, true}, &position},
            {{"unsmoothed velocity", "L/T", FieldLocation::node, 3, true}, &unsmoothed_velocity},
            {{"velocity", "L/T", FieldLocation::node, 3, false}, &velocity},
            {{"force", "M L/T^2", FieldLocation::node, 3, false}, &force},
            {{"acceleration", "L/T^2", FieldLocation::node, 3, false}, &acceleration},
            {{"mass", "M", FieldLocation::node, 1, false}, &mass}};
  }

  void NodalState::reinit(const std::shared_ptr<const NodePartition> &partition,
                          const bool has_mechanics)
  {
    moves = has_mechanics;
    for (const auto &[description, vector] : fields())
    {
      const bool is_position = vector == &position || vector == &initial_position;
      vector->reinit(partition, description.n_components == 1 ? 1 : node_stride,
                     is_position ? ReflectionParity::point : ReflectionParity::vector);
    }
  }

  void NodalState::move_to(const std::shared_ptr<const NodePartition> &partition)
  {
    for (const auto &[description, vector] : fields())
      vector->move_to(partition);
  }

  const std::shared_ptr<const NodePartition> &NodalState::partition() const
  {
    return position.partition();
  }

  std::size_t NodalState::memory_consumption()
  {
    std::size_t bytes = 0;
    for (const auto &[description, vector] : fields())
      bytes += vector->memory_consumption();
    return bytes;
  }
} // namespace tombolo
