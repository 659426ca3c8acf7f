// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

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
} // namespace tombolo
