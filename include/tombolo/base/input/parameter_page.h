// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameter_declaration.h>

#include <iosfwd>

namespace tombolo
{
  /**
   * Writes all declarations below @p root as a page in GitHub-flavoured markdown: one heading for
   * each section, with its path, and one table row for each entry, with its default, what is
   * allowed, and its documentation. A section that belongs to a plug-in begins with the
   * description under which the plug-in was registered. Values that a file sets are not shown:
   * the page depends on the declarations only.
   */
  void print_parameter_page(std::ostream &out, const ParameterDeclaration &root);
} // namespace tombolo
