// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <sstream>
#include <string>

namespace tombolo
{
  /** A place as messages give it: "(1, 2, 3)". */
  template <int dim>
  std::string place_text(const dealii::Tensor<1, dim> &place)
  {
    std::ostringstream text;
    text << "(" << place[0];
    for (unsigned int d = 1; d < dim; ++d)
      text << ", " << place[d];
    text << ")";
    return text.str();
  }
} // namespace tombolo
