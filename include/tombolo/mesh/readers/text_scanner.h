// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace tombolo
{
  /** What is wrong with a mesh file: a sentence that begins with the line, if there is one. */
  class MeshFileError : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };

  /** Text in UTF-8 without a byte-order mark: lines that are not UTF-8 are taken as Latin-1. Bytes
   * of binary files stay. Throws MeshFileError for UTF-16. */
  std::string decoded_text(std::string bytes);

  /** Reads text by lines and by words, and counts the lines. The text must outlive it. */
  class TextScanner
  {
  public:
    explicit TextScanner(std::string_view text);

    /** Moves on to the next line that is not blank and returns it without the blanks around it;
     * false at the end. The rest of a line that was read by words is such a line. */
    bool next_line(std::string_view &line);

    /** What is left of the current line, blank or not; afterwards the next line is current. */
    std::string_view rest_of_line();

    /** The next @p n bytes of a binary part. Throws MeshFileError where there are fewer. */
    std::string_view bytes(std::size_t n, const char *what);

    /** From now on messages name positions by bytes and not by lines. */
    void count_bytes()
    {
      counts_bytes = true;
    }

    /** Whether only blanks are left. */
    bool is_at_end();

    /** The next word, delimited by blanks or ends of lines. @p what is for the message where the
     * text ends. All that follow throw MeshFileError. */
    std::string_view word(const char *what);
    double real(const char *what)
    {
      return to_real(word(what), what);
    }
    long long integer(const char *what)
    {
      return to_integer(word(what), what);
    }
    /** An integer that is not negative. */
    std::size_t count(const char *what);
    /** Text between double quotes. */
    std::string quoted(const char *what);

    /** The same for a word that is given. */
    double to_real(std::string_view word, const char *what) const;
    long long to_integer(std::string_view word, const char *what) const;

    /** The number of the line of what was read last. */
    unsigned int line_number() const
    {
      return line_of_word;
    }

    /** Throws a MeshFileError at the line of what was read last. */
    [[noreturn]] void fail(const std::string &message) const;
    /** Throws a MeshFileError at another line. */
    [[noreturn]] static void fail_at(unsigned int line, const std::string &message);

  private:
    void skip_blanks();
    [[noreturn]] void fail_at_word(std::string_view word, const char *what) const;
    /** Stores the position of what is read next. */
    void mark_word();

    std::string_view text;
    std::size_t position = 0;
    unsigned int line_of_position = 1;
    unsigned int line_of_word = 1;
    std::size_t position_of_word = 0;
    bool counts_bytes = false;
  };
} // namespace tombolo
