// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <typeinfo>

namespace tombolo
{
  /** "lattice filter" of a class LatticeFilter<3>, for messages. */
  std::string words_of_type(const std::type_info &type);
} // namespace tombolo
