// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/registry.h>

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  /** Instead of a default: the entry has none, see Parameters::declare_mandatory(). */
  constexpr std::nullopt_t mandatory = std::nullopt;

  /**
   * The numbers that an entry allows. The first two bounds are in its pattern, so that listings
   * of parameters name them; with the others what is read is compared.
   */
  struct Range
  {
    static constexpr double infinite = std::numeric_limits<double>::max();

    double smallest = -infinite, largest = infinite;
    double lower = -infinite, upper = infinite;
    bool is_positive = false;
    std::string words; ///< of the message about lower and upper, after "allowed is "

    /** Throws InputError. */
    void check(const Section &section, const std::string &entry, double value) const;
  };

  Range any_number();
  Range at_least(double smallest);
  Range between(double smallest, double largest);
  /** Above zero, which is compared, and in the pattern at least @p smallest. */
  Range positive(double smallest = -Range::infinite);
  Range zero_or_positive();
  Range from_to(double lower, double upper);
  /** Above zero and up to @p upper, with one message for both. */
  Range above_zero_up_to(double upper);
  /** The same with a message of its own about numbers that are not above zero; the @p reason ends
   * the message about @p upper. */
  Range positive_up_to(double upper, const std::string &reason = ".");

  /**
   * The entries of a section, either to be declared in a ParameterHandler or to be read. A class
   * with settings has a constructor from Entries that names each of its entries once, with default,
   * range, unit and documentation, and stores the value:
   *
   * @verbatim
   *   explicit Settings(Entries e)
   *   {
   *     scale = e.number("Scale", "1", positive(), "", "Coordinates are multiplied by this.");
   *   }
   * @endverbatim
   *
   * `declare<Settings>(handler)` declares them, `Settings(section)` reads them. While entries are
   * declared the values are those of a default constructor, and nothing is refused; the constructor
   * returns before anything that needs values. All functions that read throw InputError with the
   * position of the entry. A unit ends the documentation as " Units: UNIT."; none does where it is
   * empty.
   */
  class Entries
  {
  public:
    using Default = std::optional<std::string>;

    /** To be declared, in the present subsection of @p handler, which must outlive this. Implicit,
     * as the next constructor: both represent the entries of a section. */
    Entries(dealii::ParameterHandler &handler) : handler(&handler) {}

    /** To be read. */
    Entries(const Section &section) : read_section(section) {}

    bool declares() const
    {
      return handler != nullptr;
    }

    /** Whether the entries that follow are declared, or else read since @p condition is fulfilled;
     * what is not read must not be set. */
    bool when(const bool condition) const
    {
      return declares() || condition;
    }

    /** Those of a section within this one. */
    Entries subsection(const std::string &name) const;

    /** Where entries are read; nothing can be read from it while they are declared. */
    const Section &section() const
    {
      return read_section;
    }

    /** Whether the file sets the entry; no entry is set while they are declared. */
    bool is_set(const std::string &entry) const
    {
      return !declares() && section().is_set(entry);
    }

    /** The text of an entry, for messages; empty while entries are declared. */
    std::string given(const std::string &entry) const
    {
      return declares() ? "" : section().get(entry);
    }

    /** Throws InputError about an entry that was read if @p is_wrong. */
    void refuse(const bool is_wrong, const std::string &entry, const std::string &message) const
    {
      if (is_wrong && !declares())
        section().fail(entry, message);
    }

    /** The text of an entry that fits to a pattern; its default while entries are declared. */
    std::string entry(const std::string &name, const Default &by_default,
                      const dealii::Patterns::PatternBase &pattern, const std::string &unit,
                      const std::string &documentation) const;

    double number(const std::string &entry, const Default &by_default, const Range &range,
                  const std::string &unit, const std::string &documentation) const;

    /** A number, or nothing where the entry is empty, as it is by default. */
    std::optional<double> optional_number(const std::string &entry, const Range &range,
                                          const std::string &unit,
                                          const std::string &documentation) const;

    unsigned int integer(const std::string &entry, const Default &by_default, const Range &range,
                         const std::string &documentation) const;

    bool flag(const std::string &entry, const Default &by_default,
              const std::string &documentation) const
    {
      this->entry(entry, by_default, dealii::Patterns::Bool(), "", documentation);
      return !declares() && section().get_bool(entry);
    }

    /** @p n numbers, separated by commas. */
    std::vector<double> numbers(const std::string &entry, const Default &by_default,
                                const unsigned int n, const std::string &unit,
                                const std::string &documentation) const
    {
      using namespace dealii::Patterns;
      this->entry(entry, by_default, List(Double(), n, n, ","), unit, documentation);
      return declares() ? std::vector<double>(n) : section().get_doubles(entry);
    }

    /** One of the @p alternatives, which are separated by "|". */
    std::string choice(const std::string &entry, const Default &by_default,
                       const std::string &alternatives, const std::string &documentation) const
    {
      return this->entry(entry, by_default, dealii::Patterns::Selection(alternatives), "",
                         documentation);
    }

    /** A list separated by commas, none of whose items is empty. */
    std::vector<std::string> list(const std::string &entry, const Default &by_default,
                                  const std::string &documentation) const
    {
      text(entry, by_default, "", documentation);
      return declares() ? std::vector<std::string>() : section().get_list(entry);
    }

    /** Declares a former name of an entry. */
    void alias(const std::string &entry, const std::string &former) const
    {
      if (declares())
        within([&](dealii::ParameterHandler &section_handler)
               { section_handler.declare_alias(entry, former, true); });
    }

    /** Text whose form the caller checks: expressions, names, lists of unknown length. */
    std::string text(const std::string &entry, const Default &by_default, const std::string &unit,
                     const std::string &documentation) const
    {
      this->entry(entry, by_default, dealii::Patterns::Anything(), unit, documentation);
      return given(entry);
    }

    /** What is made of the text of the entry: a T(section, entry, arguments...). */
    template <typename T, typename... Arguments>
    T object(const std::string &entry, const Default &by_default, const std::string &unit,
             const std::string &documentation, const Arguments &...arguments) const
    {
      if (!declares())
        return T(section(), entry, arguments...);
      text(entry, by_default, unit, documentation);
      return T();
    }

    /** The same, or nothing where the entry is empty, as it is by default. */
    template <typename T, typename... Arguments>
    std::optional<T> optional(const std::string &entry, const std::string &unit,
                              const std::string &documentation, const Arguments &...arguments) const
    {
      if (text(entry, "", unit, documentation).empty())
        return {};
      return std::optional<T>(std::in_place, section(), entry, arguments...);
    }

    /** The same, or nothing where the file does not set the entry, which is not read then. */
    template <typename T, typename... Arguments>
    std::optional<T> if_set(const std::string &entry, const std::string &unit,
                            const std::string &documentation, const Arguments &...arguments) const
    {
      if (when(is_set(entry)))
        text(entry, "", unit, documentation);
      if (!is_set(entry))
        return {};
      return std::optional<T>(std::in_place, section(), entry, arguments...);
    }

    /** What @p reader makes of the text of the entry. */
    template <typename T>
    T read(const std::string &entry, const Default &by_default, const std::string &unit,
           const std::string &documentation,
           T (*reader)(const Section &, const std::string &)) const
    {
      text(entry, by_default, unit, documentation);
      return declares() ? T() : reader(section(), entry);
    }

    /** The plug-in that the entry names, read from the section of its name; nullptr where it names
     * @p nothing, and while entries are declared. */
    template <typename Interface>
    std::unique_ptr<Interface> plugin(const std::string &entry, const Default &by_default,
                                      const std::string &documentation,
                                      const std::string &nothing = "") const
    {
      const Registry<Interface> &registry = Registry<Interface>::instance();
      const std::string name =
          choice(entry, by_default, (nothing.empty() ? "" : nothing + "|") + registry.selection(),
                 documentation);
      if (declares() || name == nothing)
        return nullptr;
      return registry.create(name, section().subsection(name));
    }

    /** Declares the entries of all plug-ins of this kind, each in a section of its name; those that
     * have none have a section only @p with_empty. */
    template <typename Interface>
    void plugins(const bool with_empty = true) const
    {
      if (declares())
        within([&](dealii::ParameterHandler &section_handler)
               { Registry<Interface>::instance().declare_all(section_handler, with_empty); });
    }

  private:
    double checked_number(const std::string &name, const Range &range) const;

    /** Calls @p function with the handler in the section of this. */
    void within(const std::function<void(dealii::ParameterHandler &)> &function) const;

    dealii::ParameterHandler *handler = nullptr;
    std::vector<std::string> path; ///< from the subsection in which the handler is
    Section read_section;
  };

  /** Declares the entries of settings, a class with a constructor from Entries and @p arguments. */
  template <typename Settings, typename... Arguments>
  void declare(const Entries &entries, const Arguments &...arguments)
  {
    const Settings discarded(entries, arguments...);
    (void)discarded;
  }

  /** The same, in a section of all parameters. */
  template <typename Settings, typename... Arguments>
  void declare_section(Parameters &parameters, const std::string &section,
                       const Arguments &...arguments)
  {
    declare<Settings>(Entries(parameters.handler()).subsection(section), arguments...);
  }
} // namespace tombolo
