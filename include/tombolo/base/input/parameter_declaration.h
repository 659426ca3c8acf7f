// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * What a ParameterHandler contains about one entry or one section, in the order of declaration:
   * the basis of messages ("did you mean", "allowed is") and of listings, which the handler itself
   * does not offer.
   */
  struct ParameterDeclaration
  {
    std::string name;
    std::string path; ///< "Section/Entry", "" for the root
    bool is_section = false;

    // Of entries only.
    std::string default_value;
    std::string documentation;
    std::string pattern; ///< as dealii::Patterns describe themselves to machines
    std::string alias;   ///< the entry of the same section that this one is an alias of, or empty
    bool is_deprecated = false; ///< of an alias: a former name of the entry
    bool is_mandatory = false;

    std::vector<ParameterDeclaration> children; ///< of sections only

    /** The section or entry at a path below this one; nullptr where there is none. */
    const ParameterDeclaration *find(const std::string &path) const;

    /** The names of the entries, or of the sections, directly below. */
    std::vector<std::string> entry_names() const;
    std::vector<std::string> section_names() const;
  };

  /** All declarations of a handler. */
  ParameterDeclaration collect_declarations(const dealii::ParameterHandler &handler);

  /** Sets the value of an entry of a handler, which is outside of all sections; false where its
   * pattern does not match, and the entry keeps the value that it has. */
  bool set_value(dealii::ParameterHandler &handler, const ParameterDeclaration &entry,
                 const std::string &value);

  /** The machine description of a pattern in words, to follow "allowed is ". */
  std::string describe_pattern(const std::string &pattern);

  /** The alternatives of a Selection or MultipleSelection; empty for other patterns. */
  std::vector<std::string> pattern_alternatives(const std::string &pattern);

  /** Begins the documentation of mandatory entries, and distinguishes them. */
  constexpr const char *mandatory_mark = "Mandatory. ";

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
