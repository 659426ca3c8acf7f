// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/text_scanner.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace tombolo
{
  namespace
  {
    constexpr const char *blanks = " \t\r\n\v\f";

    /** A word for a message: not more of it than a reader can use. */
    std::string shown(std::string_view word)
    {
      constexpr std::size_t longest = 40;
      return '"' + std::string(word.substr(0, longest)) + (word.size() > longest ? "..." : "") +
             '"';
    }

    template <typename Number>
    bool parse(std::string_view word, Number &value)
    {
      if (!word.empty() && word.front() == '+')
        word.remove_prefix(1);
      const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
      return result.ec == std::errc() && result.ptr == word.data() + word.size();
    }

    /** A number as Fortran writes it, with a D or no letter before the exponent (7.85-09). */
    bool parse_fortran(std::string word, double &value)
    {
      const std::size_t letter = word.find_first_of("dD");
      const std::size_t sign = word.find_first_of("+-", 1);
      if (letter != word.npos)
        word[letter] = 'e';
      else if (sign != word.npos && word.find_first_of("eE") == word.npos)
        word.insert(sign, "e");
      return parse<double>(word, value);
    }
  } // namespace

  TextScanner::TextScanner(std::string_view text) : text(text) {}

  void TextScanner::skip_blanks()
  {
    const std::size_t next = std::min(text.find_first_not_of(blanks, position), text.size());
    for (; position < next; ++position)
      if (text[position] == '\n')
        ++line_of_position;
  }

  void TextScanner::mark_word()
  {
    line_of_word = line_of_position;
    position_of_word = position;
  }

  std::string_view TextScanner::bytes(const std::size_t n, const char *what)
  {
    mark_word();
    if (n > text.size() - position)
      fail(std::string("The file ends where ") + what + " should stand.");
    const std::string_view result = text.substr(position, n);
    position += n;
    return result;
  }

  bool TextScanner::next_line(std::string_view &line)
  {
    skip_blanks();
    mark_word();
    if (position == text.size())
      return false;
    const std::size_t end = std::min(text.find('\n', position), text.size());
    line = text.substr(position, end - position);
    line = line.substr(0, line.find_last_not_of(blanks) + 1);
    position = end;
    return true;
  }

  std::string_view TextScanner::rest_of_line()
  {
    mark_word();
    const std::size_t end = std::min(text.find('\n', position), text.size());
    const std::string_view rest = text.substr(position, end - position);
    position = end;
    if (position < text.size())
    {
      ++position;
      ++line_of_position;
    }
    return rest;
  }

  bool TextScanner::is_at_end()
  {
    skip_blanks();
    return position == text.size();
  }

  std::string_view TextScanner::word(const char *what)
  {
    skip_blanks();
    mark_word();
    if (position == text.size())
      fail(std::string("The file ends where ") + what + " should stand.");
    const std::size_t end = std::min(text.find_first_of(blanks, position), text.size());
    const std::string_view result = text.substr(position, end - position);
    position = end;
    return result;
  }

  void TextScanner::fail_at_word(const std::string_view word, const char *what) const
  {
    fail(shown(word) + " stands where " + what + " should.");
  }

  double TextScanner::to_real(std::string_view word, const char *what) const
  {
    double value = 0;
    if (!parse(word, value) && !parse_fortran(std::string(word), value))
      fail_at_word(word, what);
    if (!std::isfinite(value))
      fail(shown(word) + " is not finite, and stands where " + what + " should.");
    return value;
  }

  long long TextScanner::to_integer(std::string_view word, const char *what) const
  {
    long long value = 0;
    if (!parse(word, value))
      fail_at_word(word, what);
    return value;
  }

  std::size_t TextScanner::count(const char *what)
  {
    const std::string_view text_of_count = word(what);
    const long long value = to_integer(text_of_count, what);
    if (value < 0)
      fail(shown(text_of_count) + " is negative, and stands where " + what + " should.");
    return static_cast<std::size_t>(value);
  }

  std::string TextScanner::quoted(const char *what)
  {
    skip_blanks();
    mark_word();
    const std::size_t end =
        position < text.size() && text[position] == '"' ? text.find('"', position + 1) : text.npos;
    if (end == text.npos)
      fail(std::string("There is no text in double quotes where ") + what + " should stand.");
    const std::string result(text.substr(position + 1, end - position - 1));
    position = end + 1;
    return result;
  }

  void TextScanner::fail(const std::string &message) const
  {
    if (counts_bytes)
      throw MeshFileError("byte " + std::to_string(position_of_word) + ": " + message);
    fail_at(line_of_word, message);
  }

  void TextScanner::fail_at(const unsigned int line, const std::string &message)
  {
    throw MeshFileError("line " + std::to_string(line) + ": " + message);
  }

  namespace
  {
    bool is_utf8(const std::string_view line)
    {
      for (std::size_t i = 0; i < line.size();)
      {
        const auto first = static_cast<unsigned char>(line[i++]);
        std::size_t n_further = first < 0x80   ? 0
                                : first < 0xc2 ? 4
                                : first < 0xe0 ? 1
                                : first < 0xf0 ? 2
                                : first < 0xf5 ? 3
                                               : 4;
        if (n_further == 4)
          return false;
        for (; n_further > 0; --n_further, ++i)
          if (i == line.size() || (static_cast<unsigned char>(line[i]) & 0xc0) != 0x80)
            return false;
      }
      return true;
    }

    void append_latin_1(const std::string_view line, std::string &text)
    {
      for (const char character : line)
      {
        const auto code = static_cast<unsigned char>(character);
        if (code >= 0x80)
          text += static_cast<char>(0xc0 | (code >> 6));
        text += code < 0x80 ? character : static_cast<char>(0x80 | (code & 0x3f));
      }
    }
  } // namespace

  std::string decoded_text(std::string bytes)
  {
    if (bytes.compare(0, 2, "\xff\xfe") == 0 || bytes.compare(0, 2, "\xfe\xff") == 0)
      throw MeshFileError("The file is UTF-16 text. Save it as UTF-8 or Latin-1.");
    if (bytes.find('\0') != bytes.npos)
      return bytes;
    if (bytes.compare(0, 3, "\xef\xbb\xbf") == 0)
      bytes.erase(0, 3);
    if (is_utf8(bytes))
      return bytes;
    std::string text;
    for (std::size_t begin = 0; begin < bytes.size();)
    {
      const std::size_t end = std::min(bytes.find('\n', begin), bytes.size() - 1) + 1;
      const auto line = std::string_view(bytes).substr(begin, end - begin);
      if (is_utf8(line))
        text += line;
      else
        append_latin_1(line, text);
      begin = end;
    }
    return text;
  }
} // namespace tombolo
