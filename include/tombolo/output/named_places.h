// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>

#include <tombolo/base/input/parameters.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** A place that an output is asked for, and what its columns are called. */
  template <int dim>
  struct NamedPlace
  {
    std::string name;
    dealii::Point<dim> location;
  };

  /** The places of an entry, a list, separated by semicolons, of `name: x, y, z`; one without a
   * name is called @p word and its number in the list. Throws InputError. */
  template <int dim>
  std::vector<NamedPlace<dim>> read_named_places(const Section &section, const std::string &entry,
                                                 const std::string &word);
} // namespace tombolo
