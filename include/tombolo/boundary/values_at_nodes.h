// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/boundary/limited_function.h>
#include <tombolo/boundary/region.h>
#include <tombolo/state/nodal_vector.h>

namespace tombolo
{
  /** The values of a function at nodes at one time; one without a place is evaluated once. */
  template <int dim>
  class ValuesAtNodes
  {
  public:
    ValuesAtNodes(const LimitedFunction<dim> &function, const NodalVector &initial_position,
                  const double time)
        : function(function), initial_position(initial_position), time(time)
    {}

    double operator()(const unsigned int node)
    {
      if (!is_known || function.depends_on_place())
        present = function.value(point_of<dim>(initial_position.node(node)), time);
      is_known = true;
      return present;
    }

  private:
    const LimitedFunction<dim> &function;
    const NodalVector &initial_position;
    double time;
    double present = 0;
    bool is_known = false;
  };
} // namespace tombolo
