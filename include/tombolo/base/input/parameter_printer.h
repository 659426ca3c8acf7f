// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameter_declaration.h>

#include <functional>
#include <iosfwd>
#include <string>

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

  /** Entries with their values as they are declared, for files that can be read again. */
  struct PrintedEntries
  {
    bool are_all; ///< or only those in use
    // Of an entry by its path.
    std::function<bool(const std::string &path)> is_in_use;
    std::function<std::string(const std::string &path)> value;

    bool has(const ParameterDeclaration &declaration) const;
  };

  /** Prints @p section as a deal.II parameter file, with the lines of those that it is in. @p
   * with_documentation all entries are printed, those that are not in use as comments. */
  void print_prm(std::ostream &out, const PrintedEntries &entries,
                 const ParameterDeclaration &section, bool with_documentation);

  /** Prints what is in @p section as JSON. */
  void print_json(std::ostream &out, const PrintedEntries &entries,
                  const ParameterDeclaration &section);

  /** Throws the InputError of a format that there is not, or of "xml" where it is of one section.
   */
  [[noreturn]] void refuse_format(const std::string &format);
} // namespace tombolo
