// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace tombolo
{
  /** Where the values of a field are. */
  enum class FieldLocation
  {
    node,
    material_point
  };

  /** What becomes of a quantity at a material point where its cell is divided in a run. */
  enum class OnDivision
  {
    copied, ///< the points of the children have it too; where they are joined, their mean
    held,   ///< so, but that its integral over the initial volume stays
    shared, ///< they share it by their volumes, as what belongs to the whole point
    reset   ///< it is reset, as what belongs to the shape of the cell
  };

  /** The description of one array of the state. Ghost exchange, output and checkpoint iterate over
   * lists of these. */
  struct FieldDescription
  {
    std::string name; ///< in words, for example "unsmoothed velocity"
    std::string unit; ///< in terms of Unit labels: "L/T", "M/(L T^2)", "1"
    FieldLocation location = FieldLocation::node;
    unsigned int n_components = 1; ///< 1, 3 (vector), 6 (xx, yy, zz, yz, xz, xy), 9 (row-major)
    bool persistent = true;        ///< belongs in a checkpoint: cannot be computed from the others
    double initial_value = 0.;     ///< of every component, where nothing else sets it
    bool is_internal = false;      ///< of no meaning by itself: in pictures only on request
    OnDivision on_division = OnDivision::copied;
    /** Of a material, with 6 components: a tensor that turns with the body as the stress does. */
    bool turns = false;
  };

  /** An energy per initial volume at each material point [M/(L T^2)]. */
  inline FieldDescription energy_field(const std::string &name)
  {
    return {name, "M/(L T^2)", FieldLocation::material_point, 1, true, 0., false, OnDivision::held};
  }
} // namespace tombolo
