// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/cell_size.h>

#include <tombolo/base/format.h>

#include <cmath>
#include <sstream>

namespace tombolo
{
  template <int dim>
  std::string describe_unusable_cell(const dealii::Point<dim> &centre,
                                     const dealii::Point<dim> &initial_centre, const double volume)
  {
    bool is_finite = true;
    for (unsigned int d = 0; d < dim; ++d)
      is_finite = is_finite && std::isfinite(centre[d]);
    std::ostringstream message;
    message << "the cell at " << place_text(is_finite ? centre : initial_centre);
    if (is_finite && std::isfinite(volume))
      message << " is turned inside out, at least in one of its integration points (volume "
              << volume << ")";
    else
      message << (is_finite ? "" : " at the start") << " has nodes that are not finite";
    return message.str();
  }

  template std::string describe_unusable_cell<2>(const dealii::Point<2> &, const dealii::Point<2> &,
                                                 double);
  template std::string describe_unusable_cell<3>(const dealii::Point<3> &, const dealii::Point<3> &,
                                                 double);
} // namespace tombolo
