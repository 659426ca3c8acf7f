// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/text.h>

#include <mpi.h>

#include <map>
#include <string>
#include <vector>

namespace tombolo
{
  class Mistakes;

  /** The position of an entry of a parameter file. */
  struct SourceLocation
  {
    std::string file; ///< as the user wrote it, or "--set" for an override
    unsigned int line = 0;
    unsigned int depth = 0; ///< the number of files that include it, one within the other
  };

  /** "file:line", or the file alone where there is no line. */
  std::string to_string(const SourceLocation &location);

  /**
   * Reads the text of deal.II parameter files into a list of sections and entries with their
   * positions, whatever is declared. Files are read on rank 0 of the communicator and sent
   * to the others; all ranks hold the same list and throw the same InputError.
   *
   * Refused are: what is not text, an entry or a section that is repeated in one file, a section
   * that is not closed, a circle of includes, and an included file that changes an entry which the
   * including file has already set. Otherwise a later file changes entries of an earlier one.
   */
  class ParameterScanner
  {
  public:
    /** One `subsection` or `set` line. */
    struct Item
    {
      bool is_section = false;
      std::string path;
      std::string value; ///< of entries
      SourceLocation location;
    };

    /** Mistakes after which the next line can be read as it is meant go to @p mistakes, which must
     * outlive this. */
    ParameterScanner(MPI_Comm communicator, Mistakes &mistakes);

    /** Collective. */
    void read_file(const std::string &file_name);

    /** Scans text like a file called @p name. Collective if it includes files. */
    void read_text(const std::string &text, const std::string &name);

    /** Takes these lines in place of those that were read, the later of two entries at a path. */
    void replace_items(const std::vector<Item> &items);

    /** All lines in the order of reading. */
    const std::vector<Item> &items() const
    {
      return all_items;
    }

    /** The entry in effect at a path; nullptr if no file sets it. */
    const Item *entry(const std::string &path) const;

    /** Where a section is first opened; nullptr if no file has it. */
    const SourceLocation *section(const std::string &path) const;

    /** The texts of all files, one after the other, includes after the including file. */
    std::string text() const;

    /** The names of all files in the order in which they were opened. */
    std::vector<std::string> file_names() const;

    MPI_Comm mpi_communicator() const
    {
      return communicator;
    }

  private:
    struct OpenFile
    {
      std::string name;
      std::string identity; ///< the same for all ways to name one file
      std::map<std::string, unsigned int> entry_lines;
      std::map<std::string, unsigned int> section_lines;
    };

    void scan(const std::string &text, const std::string &name, const std::string &identity,
              std::vector<std::string> &sections);
    void scan_line(const std::string &line, unsigned int line_number,
                   std::vector<std::string> &sections, std::vector<unsigned int> &opened);
    /** Of a line that begins with no keyword: reads it as what it seems to be meant as. */
    void scan_unknown_line(const std::string &keyword, const std::string &text,
                           const SourceLocation &location, std::vector<std::string> &sections,
                           std::vector<unsigned int> &opened);
    /** Mistakes::add() of a line. */
    void refuse_line(const SourceLocation &location, const std::string &message) const;
    void add_entry(const std::string &rest, const SourceLocation &location,
                   const std::vector<std::string> &sections);
    void add_section(const std::string &name, const SourceLocation &location,
                     std::vector<std::string> &sections);
    void include(const std::string &name, const SourceLocation &location,
                 std::vector<std::string> &sections);

    MPI_Comm communicator;
    Mistakes &mistakes;
    std::vector<OpenFile> open_files;
    unsigned int n_includes = 0;
    std::vector<Item> all_items;
    std::map<std::string, std::size_t> entries;
    std::map<std::string, SourceLocation> section_locations;
    std::vector<std::pair<std::string, std::string>> texts; // name, text
  };

  /** What an override of the command line, "Section/Entry = value", sets; blanks around names do
   * not count. Throws InputError. */
  ParameterScanner::Item read_override(const std::string &assignment);
} // namespace tombolo
