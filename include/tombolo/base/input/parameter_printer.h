// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameter_declaration.h>

#include <functional>
#include <iosfwd>
#include <string>

namespace tombolo
{
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
