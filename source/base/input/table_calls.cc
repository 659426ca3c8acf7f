// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/table_calls.h>

#include <cctype>

namespace tombolo
{
  namespace
  {
    constexpr char word[] = "table";

    bool is_of_name(const char character)
    {
      return std::isalnum(static_cast<unsigned char>(character)) != 0 || character == '_';
    }

    std::string trimmed(const std::string &text)
    {
      const std::size_t begin = text.find_first_not_of(" \t");
      if (begin == std::string::npos)
        return "";
      return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
    }

    /** The place of the next `table` that is a word and is called, and of its parenthesis. */
    bool find_call(const std::string &text, std::size_t &begin, std::size_t &parenthesis)
    {
      while ((begin = text.find(word, begin)) != std::string::npos)
      {
        const std::size_t end = begin + sizeof(word) - 1;
        parenthesis = text.find_first_not_of(" \t", end);
        if ((begin == 0 || !is_of_name(text[begin - 1])) && parenthesis != std::string::npos &&
            text[parenthesis] == '(')
          return true;
        begin = end;
      }
      return false;
    }

    std::size_t closing_parenthesis(const std::string &text, const std::size_t opening)
    {
      int depth = 0;
      for (std::size_t i = opening; i < text.size(); ++i)
      {
        depth += text[i] == '(' ? 1 : text[i] == ')' ? -1 : 0;
        if (depth == 0)
          return i;
      }
      return std::string::npos;
    }
  } // namespace

  TableCalls::TableCalls(const std::string &expression)
  {
    std::size_t done = 0, begin = 0, opening = 0;
    while (find_call(expression, begin, opening))
    {
      const std::size_t closing = closing_parenthesis(expression, opening);
      const std::size_t comma = expression.find(',', opening);
      Call call;
      if (closing != std::string::npos && comma < closing)
      {
        call.file = trimmed(expression.substr(opening + 1, comma - opening - 1));
        call.argument = trimmed(expression.substr(comma + 1, closing - comma - 1));
      }
      if (call.file.empty() || call.argument.empty())
      {
        problem = "a table is `table(FILE, ARGUMENT)`, for example `table(load.csv, t)`.";
        return;
      }
      call.name = std::string(word) + "_" + std::to_string(calls.size() + 1);
      text += expression.substr(done, begin - done) + call.name;
      calls.push_back(call);
      done = begin = closing + 1;
    }
    text += expression.substr(done);
  }
} // namespace tombolo
