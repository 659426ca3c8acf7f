// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace tombolo
{
  /** A number, a name or a sign of an expression. */
  struct ExpressionToken
  {
    enum Kind
    {
      number,
      name,
      sign ///< an operator, a parenthesis or a comma
    };
    Kind kind;
    std::string text;
  };

  /** The tokens of an expression, without blanks. Every text has some: nothing is refused. */
  std::vector<ExpressionToken> split_into_tokens(const std::string &text);

  /** Whether one of the tokens is this name. */
  bool has_name(const std::vector<ExpressionToken> &tokens, const std::string &name);
} // namespace tombolo
