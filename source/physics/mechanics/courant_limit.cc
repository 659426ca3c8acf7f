// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/courant_limit.h>

#include <tombolo/model/step_limit.h>

#include <cmath>

namespace tombolo
{
  double round_down(const double step)
  {
    int exponent;
    const double mantissa = std::frexp(step, &exponent);
    return std::ldexp(std::floor(mantissa * 512.) / 512., exponent);
  }

  template <int dim>
  StepLimit courant_limit(const Model<dim> &model)
  {
    std::vector<StepLimit> of_parts;
    for (const Part<dim> &part : model.parts)
    {
      of_parts.push_back(
          part.formulation->courant_limit(model.state.position, part.inertia, part.step_ratios));
      of_parts.back().entity += " of part \"" + part.name + "\"";
    }
    return smallest_limit(of_parts, model.communicator);
  }

  template StepLimit courant_limit<2>(const Model<2> &);
  template StepLimit courant_limit<3>(const Model<3> &);
} // namespace tombolo
