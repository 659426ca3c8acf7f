// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <tombolo/base/input/mistakes.h>
#include <tombolo/base/input/parameter_declaration.h>
#include <tombolo/base/input/parameter_scanner.h>

#include <mpi.h>

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  class Section;

  /**
   * The parameters of one run. Reading is in two passes: read_file() and add_override() collect the
   * entries with their positions (a scanner of our own, since ParameterHandler drops them); raw()
   * returns what decides which sections exist (`Dimension`, `Parts`, `Plugin
   * libraries`, ...); then everything is declared in handler(), and assign() passes every collected
   * entry to it, refusing unknown, doubled and unsuitable ones with file, line, entry, value, what
   * is allowed and the nearest valid name. Entries are called by their path, "Section/Entry".
   *
   * The files are read on rank 0 of the communicator and sent to the others; all ranks hold the
   * same parameters and throw the same errors.
   *
   * Each function throws at the first mistake. After collect_mistakes() what is unknown, unsuitable
   * or missing is noted, reading goes on, and refuse_mistakes() throws all of it at once.
   */
  class Parameters
  {
  public:
    explicit Parameters(const MPI_Comm communicator) : scanner(communicator, mistakes) {}

    /** From now on mistakes are noted, until refuse_mistakes(). A missing entry is read as a
     * substitute value. */
    void collect_mistakes()
    {
      mistakes.collect();
    }

    /** Calls @p read. While mistakes are collected, an InputError that it throws is noted, unless
     * it follows from another mistake; otherwise it passes. Returns whether nothing was wrong. */
    bool attempt(const std::function<void()> &read) const
    {
      return mistakes.attempt(read);
    }

    /** fail(), or a note of it while mistakes are collected. */
    void refuse(const std::string &path, const std::string &message) const;

    /** Ends the collection and throws the InputError of all that was noted, if anything was. */
    void refuse_mistakes() const
    {
      mistakes.refuse(scanner.file_names());
    }

    /** Scans a deal.II parameter file: `set`, `subsection`, `end`, `#` comments, `\` continuation,
     * `include` relative to the including file. Throws InputError. */
    void read_file(const std::string &file_name);

    /** Takes these lines in place of those that were read, the later of two entries at a path. */
    void replace_items(const std::vector<ParameterScanner::Item> &items)
    {
      scanner.replace_items(items);
    }

    /** Scans text like a file called @p name. */
    void read_text(const std::string &text, const std::string &name);

    /** An override from the command line, "Section/Entry = value". Without a value it resets the
     * entry, as though no file had set it. */
    void add_override(const std::string &assignment);

    /** The text of an entry before declaration; @p fallback where it is not given. */
    std::string raw(const std::string &path, const std::string &fallback = "") const;

    /** The comma-separated list of an entry before declaration, trimmed; empty if not given.
     * Refuses a repeated name. */
    std::vector<std::string> raw_list(const std::string &path) const;

    /** Where to declare. */
    dealii::ParameterHandler &handler()
    {
      return parameter_handler;
    }

    /** Declares a mandatory entry, one without a default, in the present subsection of the handler.
     * Reading it while nothing sets it throws the InputError that it is missing. The entries of
     * plug-ins that are not selected are never read, so that they need not be set. */
    static void declare_mandatory(dealii::ParameterHandler &handler, const std::string &entry,
                                  const dealii::Patterns::PatternBase &pattern,
                                  const std::string &documentation);

    /** Passes the collected entries to the handler. Throws InputError. */
    void assign();

    /** The section at a path, "" for the root. */
    Section section(const std::string &path) const;

    /** Where an entry was set; a location with an empty file if it has its default. */
    SourceLocation location(const std::string &path) const;

    /** The beginning of messages about an entry, `file:line: entry "path" = "value"`, or about a
     * section, `file:line: section "path"`. */
    std::string describe(const std::string &path) const;

    /** Throws an InputError about an entry or a section: describe(path) and the message. */
    [[noreturn]] void fail(const std::string &path, const std::string &message) const;

    /** Entries that were set in the file but that nothing read: an input that does nothing is an
     * error, but where a file that includes theirs, or an override, chooses another section. Throws
     * an InputError that names the first, or notes each. What is read later is not printed: a file
     * that sets it would be refused here. */
    void refuse_unused() const;

    /** A sentence for each entry that is set under a former name (an alias that is declared as
     * deprecated), which names the present one. After assign(). */
    std::vector<std::string> renaming_notes() const;

    /** Of the ranks that hold the same parameters. */
    MPI_Comm communicator() const
    {
      return scanner.mpi_communicator();
    }

    /** The file given to read_file() (or the name given to read_text()), and the text of all files
     * as they were read. */
    const std::string &file_name() const
    {
      return main_file;
    }

    std::string original_text() const
    {
      return scanner.text();
    }

    /** The entries with their values, as "prm", "json" or "xml", or all declarations without values
     * as "markdown" (print_parameter_page()). Before anything was read these are all entries;
     * afterwards those that were read or set, so that the result has what the run used. In "prm"
     * the remaining ones are kept as comments @p with_documentation, and in every case the output
     * can be read again as a parameter file of the same run. "xml" is the format of the graphical
     * editor of deal.II, always with all entries. With @p section that section alone; of "Part:
     * NAME" the word "Part" is enough. Throws InputError for another format or section. */
    void print(std::ostream &out, const std::string &format, bool with_documentation,
               const std::string &section = "") const;

  private:
    friend class Section;

    using Item = ParameterScanner::Item;

    /** What sets an entry: an override or else a file; nullptr where nothing does. */
    const Item *setting(const std::string &path) const;

    /** The declarations; collected anew as long as assign() has not been called. */
    const ParameterDeclaration &declarations() const;

    /** Refuses a section that is not declared; with @p repeats also where the one that it is in is
     * not. */
    void check_section(const std::string &path, const std::string &prefix, bool repeats) const;
    void assign_entry(const Item &item);
    std::string prefix(const Item &item) const;
    /** The beginning of messages about what an item sets. */
    std::string prefix_with_value(const Item &item) const;
    /** Whether an override without a value resets the entry. */
    bool is_reset(const std::string &path) const;
    std::string value(const std::string &path) const;
    /** The value of an entry that is read, or its substitute. */
    std::string read(const ParameterDeclaration &entry) const;
    void refuse_missing(const ParameterDeclaration &entry) const;
    /** Empty: there is no mistake. @p is_certain: another choice was made, whatever was read. */
    std::string reason_of_no_effect(const std::string &path, bool &is_certain) const;
    bool is_used_below(const std::string &section) const;

    mutable Mistakes mistakes;
    ParameterScanner scanner;
    std::string main_file;
    std::map<std::string, Item> overrides;
    std::map<std::string, std::string> aliases; // old path -> path, of those that are set
    dealii::ParameterHandler parameter_handler;
    mutable ParameterDeclaration declaration_tree;
    bool is_assigned = false;
    mutable std::set<std::string> used, used_in_check;
  };

  /**
   * One (sub)section of the assigned parameters. A light handle on Parameters, which must outlive
   * it. Reading an entry marks it as used. All readers throw InputError with the position of the
   * entry.
   */
  class Section
  {
  public:
    /** Of no parameters, until another one is assigned. */
    Section() = default;
    Section(const Parameters &parameters, const std::string &path)
        : parameters(&parameters), section_path(path)
    {}

    std::string get(const std::string &entry) const;
    double get_double(const std::string &entry) const;
    unsigned int get_unsigned(const std::string &entry) const;
    bool get_bool(const std::string &entry) const;
    /** Comma-separated. */
    std::vector<std::string> get_list(const std::string &entry) const;
    std::vector<double> get_doubles(const std::string &entry) const;

    /** As get_double, refusing zero, negative and non-finite values. */
    double get_positive(const std::string &entry) const;

    /** Whether the section has such an entry: plug-ins differ in theirs. */
    bool is_declared(const std::string &entry) const;
    /** Whether the file or an override sets the entry. */
    bool is_set(const std::string &entry) const
    {
      return parameters->setting(joined_path(section_path, entry)) != nullptr;
    }
    /** Whether all entries of both sections, and of those in them, are the same. */
    bool is_equal_to(const Section &other) const;

    Section subsection(const std::string &name) const
    {
      return {*parameters, joined_path(section_path, name)};
    }
    /** The section that this is a subsection of. */
    Section parent() const
    {
      return {*parameters, parent_path(section_path)};
    }

    const std::string &path() const
    {
      return section_path;
    }

    /** The last component of path(), for "Part: steel side" the name after the colon. */
    std::string name() const;

    const Parameters &all() const
    {
      return *parameters;
    }

    /** The beginning of messages about an entry of this section; see Parameters::describe(). */
    std::string describe(const std::string &entry) const
    {
      return parameters->describe(joined_path(section_path, entry));
    }

    /** Throws an InputError about this entry. */
    [[noreturn]] void fail(const std::string &entry, const std::string &message) const
    {
      parameters->fail(joined_path(section_path, entry), message);
    }

  private:
    const Parameters *parameters = nullptr;
    std::string section_path;
  };

  /** The names in the entry @p list at the top of the file, each of which names a section such
   * as "Part: NAME". Throws InputError where one is missing, repeated, or contains "/", which
   * separates a section from what is in it. */
  std::vector<std::string> section_names(const Parameters &parameters, const std::string &list);
} // namespace tombolo
