// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <sstream>
#include <string>
#include <typeinfo>

namespace tombolo
{
  /** Texts and numbers one after the other, as a stream writes them: six digits of a number. */
  template <typename... Parts>
  std::string as_text(const Parts &...parts)
  {
    std::ostringstream text;
    (text << ... << parts);
    return text.str();
  }

  /** A position as messages write it: "(1, 2, 3)". */
  template <int dim>
  std::string position_text(const dealii::Tensor<1, dim> &position)
  {
    std::ostringstream text;
    text << "(" << position[0];
    for (unsigned int d = 1; d < dim; ++d)
      text << ", " << position[d];
    text << ")";
    return text.str();
  }

  /** "lattice filter" of a class LatticeFilter<3>, for messages. */
  std::string words_of_type(const std::type_info &type);

  /** A number as text: the shortest that reads back as the same double; whole numbers without a
   * point; "nan", "inf", "-inf". */
  std::string format_number(double value);

  /** A field of a table of comma-separated values, quoted where it must be (RFC 4180). */
  std::string csv_field(const std::string &text);
} // namespace tombolo
