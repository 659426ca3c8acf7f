// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace tombolo
{
  /** What is wrong with a mesh file. The message is a sentence that begins with the line, if the
   * trouble has one. */
  class MeshFileError : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
    MeshFileError(unsigned int line, const std::string &message);

    unsigned int line = 0; ///< zero if the trouble has none, or the message has all that it needs
    std::string message;   ///< without the line
  };

  /** What the numbers of lines mean. Lines of files that are put into each other are counted on,
   * and belong to the file whose name is given here. */
  class LinePlaces
  {
  public:
    /** Elements and not lines are counted. */
    void count_elements();
    /** From @p line on lines are those of @p file, beginning with its @p line_of_file. The name of
     * the first file is empty. */
    void begin(unsigned int line, const std::string &file, unsigned int line_of_file);
    /** "line 5", or "line 5 of "mesh.inp"". */
    std::string name(unsigned int line) const;
    unsigned int line_of_file(unsigned int line) const;

    /** The value of an action, whose errors then have the names of files. */
    template <typename Action>
    auto name_lines_of(const Action &action) const
    {
      try
      {
        return action();
      }
      catch (const MeshFileError &error)
      {
        if (error.line == 0)
          throw;
        throw MeshFileError(name(error.line) + ": " + error.message);
      }
    }

  private:
    struct Stretch
    {
      unsigned int first;
      std::string file;
      unsigned int line_of_file;
    };

    const Stretch &stretch_of(unsigned int line) const;

    const char *unit = "line";
    std::vector<Stretch> stretches = {{0, "", 0}};
  };

  /** A file, and how to read those that it names. */
  struct SourceFile
  {
    std::string_view text;
    std::string path;
    /** The text of another file. Throws MeshFileError. */
    std::function<std::string(const std::string &path)> read;
  };

  /** Text in UTF-8 without a byte-order mark: lines that are not UTF-8 are taken as Latin-1. Bytes
   * of binary files stay. Throws MeshFileError for UTF-16. */
  std::string decoded_text(std::string bytes);

  /** Reads text by lines and by words, and knows the line it is in. The text must outlive it. */
  class TextScanner
  {
  public:
    explicit TextScanner(std::string_view text);
    explicit TextScanner(const SourceFile &file);

    /** Goes on with another file, which the current line names relative to its own, and then with
     * the next line. */
    void include(const std::string &name);
    /** Leaves what remains of the current file. */
    void end_file();
    /** The number of files that include the current one. */
    std::size_t depth() const;
    const LinePlaces &places() const;

    /** Moves on to the next line that is not blank and gives it without the blanks around it;
     * false at the end. The rest of a line that was read by words is such a line. */
    bool next_line(std::string_view &line);

    /** What is left of the current line, blank or not; afterwards the next line is current. */
    std::string_view rest_of_line();

    /** Moves on to the next line and gives it as it stands, without the end of the line; false at
     * the end. */
    bool raw_line(std::string_view &line);

    /** The next @p n bytes of a binary part. Throws MeshFileError where there are fewer. */
    std::string_view bytes(std::size_t n, const char *what);

    /** From now on messages name places by bytes and not by lines. */
    void count_bytes();

    /** Whether only blanks are left. */
    bool is_at_end();

    /** The next word, delimited by blanks or ends of lines. @p what is for the message where the
     * text ends. All that follow throw MeshFileError. */
    std::string_view word(const char *what);
    double real(const char *what);
    long long integer(const char *what);
    /** An integer that is not negative. */
    std::size_t count(const char *what);
    /** Text between double quotes. */
    std::string quoted(const char *what);

    /** The same for a word that is given. */
    double to_real(std::string_view word, const char *what) const;
    long long to_integer(std::string_view word, const char *what) const;

    /** The number of the line of what was read last. */
    unsigned int line_number() const;

    /** Throws a MeshFileError at the line of what was read last. */
    [[noreturn]] void fail(const std::string &message) const;
    /** Throws a MeshFileError at another line. */
    [[noreturn]] static void fail_at(unsigned int line, const std::string &message);

  private:
    void skip_blanks();
    /** Goes back to the files that include those that are at their end. */
    void leave_ended_files();
    [[noreturn]] void fail_at_word(std::string_view word, const char *what) const;
    /** Remembers the place of what is read next. */
    void mark_word();

    /** A file that includes others. */
    struct OpenFile
    {
      std::string_view text;
      std::size_t position;
      std::string path;
      std::string name; ///< for messages
      unsigned int line;
    };

    std::string_view text;
    std::string path, name;
    std::function<std::string(const std::string &path)> read;
    std::vector<OpenFile> outer;
    std::list<std::string> included_texts;
    LinePlaces line_places;
    std::size_t position = 0;
    unsigned int line_of_position = 1;
    unsigned int line_of_word = 1;
    std::size_t position_of_word = 0;
    bool counts_bytes = false;
  };
} // namespace tombolo
