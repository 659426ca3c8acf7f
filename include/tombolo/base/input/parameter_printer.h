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

  /** Prints entries with their values as they are declared, in files that can be read again. */
  class ParameterPrinter
  {
  public:
    /** Of an entry by its path. */
    using IsInUse = std::function<bool(const std::string &path)>;
    using Value = std::function<std::string(const std::string &path)>;

    /** Of the entries that are in use, or of all if @p prints_all. */
    ParameterPrinter(bool prints_all, IsInUse is_in_use, Value value);

    /** As a deal.II parameter file, @p section with the lines of those that it is in. @p
     * with_documentation all entries are printed, those that are not in use as comments. */
    void print_prm(std::ostream &out, bool with_documentation,
                   const ParameterDeclaration &section) const;

    /** What is in @p section. */
    void print_json(std::ostream &out, const ParameterDeclaration &section) const;

  private:
    bool is_printed(const ParameterDeclaration &declaration) const;
    void print_prm(std::ostream &out, const ParameterDeclaration &section, unsigned int depth,
                   bool with_documentation) const;
    void print_json(std::ostream &out, const ParameterDeclaration &section,
                    unsigned int depth) const;

    bool prints_all;
    IsInUse is_in_use;
    Value value;
  };
} // namespace tombolo
