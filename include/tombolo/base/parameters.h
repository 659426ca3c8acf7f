#pragma once

#include <deal.II/base/parameter_handler.h>

#include <tombolo/base/exceptions.h>

#include <mpi.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace tombolo
{
  /** Where an entry of a parameter file stands. */
  struct SourceLocation
  {
    std::string file; ///< as the user wrote it, or "--set" for an override
    unsigned int line = 0;
  };

  class Section;

  /**
   * The parameters of one run. Reading is in two passes: read_file() and add_override() collect the
   * entries with their places (a scanner of our own, since ParameterHandler forgets them); raw()
   * answers what is needed to know which sections exist (`Dimension`, `Parts`, `Plugin
   * libraries`, ...); then everything is declared in handler(), and assign() gives every collected
   * entry to it, refusing unknown, doubled and unsuitable ones with file, line, entry, value, what
   * is allowed and the nearest valid name. Entries are called by their path, "Section/Entry".
   *
   * The files are read on rank 0 of the communicator and sent to the others; all ranks hold the
   * same parameters and throw the same errors.
   */
  class Parameters
  {
  public:
    explicit Parameters(MPI_Comm communicator);

    /** Scans a deal.II parameter file: `set`, `subsection`, `end`, `#` comments, `\` continuation,
     * `include` relative to the including file. Throws InputError. */
    void read_file(const std::string &file_name);

    /** Scans text as if it stood in a file called @p name. */
    void read_text(const std::string &text, const std::string &name);

    /** An override from the command line, "Section/Entry = value". */
    void add_override(const std::string &assignment);

    /** The text of an entry before declaration; @p fallback where it is not given. */
    std::string raw(const std::string &path, const std::string &fallback = "") const;

    /** The comma-separated list of an entry before declaration, trimmed; empty if not given.
     * Refuses a name that stands twice. */
    std::vector<std::string> raw_list(const std::string &path) const;

    /** Where to declare. */
    dealii::ParameterHandler &handler();

    /** Declares a mandatory entry: one without a default that assign() refuses to miss. Call it
     * while the handler is in the subsection of the entry. Entries that are mandatory only inside
     * an unused alternative (the subsections of unselected plug-ins) are not missed: only sections
     * for which require() was called are checked. */
    static void declare_mandatory(dealii::ParameterHandler &handler, const std::string &entry,
                                  const dealii::Patterns::PatternBase &pattern,
                                  const std::string &documentation);

    /** Gives the collected entries to the handler. Throws InputError. */
    void assign();

    /** The section at a path, "" for the root. */
    Section section(const std::string &path) const;

    /** Where an entry was set; a location with an empty file if it has its default. */
    SourceLocation location(const std::string &path) const;

    /** Throws an InputError about an entry: "file:line: Entry "path" = value: message". With an
     * empty entry, about the section. */
    [[noreturn]] void fail(const std::string &path, const std::string &message) const;

    /** Entries that were set in the file but that nothing read: an input that does nothing is an
     * error. Throws an InputError that names the first. */
    void refuse_unused() const;

    /** The file given to read_file(), and the text of all files as they were read. */
    const std::string &file_name() const;
    const std::string &original_text() const;

    /** All entries with values in use, as "prm", "json" or "xml". */
    void print(std::ostream &out, const std::string &format, bool with_documentation) const;

  private:
    friend class Section;

    struct RawEntry
    {
      std::string value;
      SourceLocation location;
    };

    void scan(const std::string &text, const std::string &file_name,
              std::vector<std::string> &include_stack, std::vector<std::string> &sections);

    MPI_Comm communicator;
    std::string main_file;
    std::string all_text;
    std::map<std::string, RawEntry> entries;
    std::map<std::string, RawEntry> overrides;
    std::map<std::string, SourceLocation> section_locations;
    dealii::ParameterHandler parameter_handler;
    mutable std::map<std::string, bool> used;
  };

  /**
   * One (sub)section of the assigned parameters. A light handle on Parameters, which must outlive
   * it. Reading an entry marks it as used. All readers throw InputError with the place of the entry.
   */
  class Section
  {
  public:
    Section(const Parameters &parameters, const std::string &path);

    std::string get(const std::string &entry) const;
    double get_double(const std::string &entry) const;
    unsigned int get_unsigned(const std::string &entry) const;
    bool get_bool(const std::string &entry) const;
    /** Comma-separated. */
    std::vector<std::string> get_list(const std::string &entry) const;
    std::vector<double> get_doubles(const std::string &entry) const;

    /** As get_double, refusing zero, negative and non-finite values. */
    double get_positive(const std::string &entry) const;

    /** Whether the file or an override sets the entry. */
    bool is_set(const std::string &entry) const;

    Section subsection(const std::string &name) const;
    const std::string &path() const;
    /** The last component of path(), for "Part: steel side" the name after the colon. */
    std::string name() const;
    const Parameters &all() const;

    /** Throws an InputError about this entry. */
    [[noreturn]] void fail(const std::string &entry, const std::string &message) const;

  private:
    const Parameters *parameters;
    std::string section_path;
  };
} // namespace tombolo
