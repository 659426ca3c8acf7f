// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cctype>
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
  inline std::vector<ExpressionToken> split_into_tokens(const std::string &text)
  {
    const auto is = [&](const std::size_t i, const auto &predicate)
    { return i < text.size() && predicate(static_cast<unsigned char>(text[i])); };
    const auto is_digit = [](const unsigned char c) { return std::isdigit(c) != 0 || c == '.'; };
    const auto is_letter = [](const unsigned char c) { return std::isalpha(c) != 0 || c == '_'; };

    std::vector<ExpressionToken> tokens;
    for (std::size_t i = 0; i < text.size();)
    {
      const std::size_t begin = i;
      if (is(i, is_digit))
      {
        while (is(i, is_digit))
          ++i;
        if (i < text.size() && (text[i] == 'e' || text[i] == 'E'))
        {
          const std::size_t exponent =
              i + 1 < text.size() && (text[i + 1] == '-' || text[i + 1] == '+') ? i + 2 : i + 1;
          if (is(exponent, is_digit))
            for (i = exponent; is(i, is_digit);)
              ++i;
        }
        tokens.push_back({ExpressionToken::number, text.substr(begin, i - begin)});
      }
      else if (is(i, is_letter))
      {
        while (is(i, is_letter) || is(i, is_digit))
          ++i;
        tokens.push_back({ExpressionToken::name, text.substr(begin, i - begin)});
      }
      else
      {
        const std::string two = text.substr(i, 2);
        const bool is_double = two == "==" || two == "!=" || two == "<=" || two == ">=" ||
                               two == "&&" || two == "||" || two == "**";
        i += is_double ? 2 : 1;
        if (!std::isspace(static_cast<unsigned char>(text[begin])))
          tokens.push_back({ExpressionToken::sign, text.substr(begin, i - begin)});
      }
    }
    return tokens;
  }

  /** Whether one of the tokens is this name. */
  inline bool has_name(const std::vector<ExpressionToken> &tokens, const std::string &name)
  {
    return std::any_of(tokens.begin(), tokens.end(),
                       [&](const ExpressionToken &token)
                       { return token.kind == ExpressionToken::name && token.text == name; });
  }
} // namespace tombolo
