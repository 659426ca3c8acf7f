// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/text.h>

#include <boost/preprocessor/cat.hpp>

#include <experimental/type_traits>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tombolo
{
  class Section;

  /** The name of a kind of plug-in for messages and listings, for example "formulation". */
  template <typename Interface>
  struct PluginKind;

  /** The entry of @p candidates that is closest to @p name in edit distance; empty if there is
   * none at a distance of less than half of the length of @p name. */
  std::string nearest_name(const std::string &name, const std::vector<std::string> &candidates);

  /** One line for --list-plugins. */
  struct PluginDescription
  {
    std::string kind;
    std::string name;
    std::string description;
  };

  /** All plug-ins of all kinds, sorted by kind and name, each listed once for all dimensions. */
  std::vector<PluginDescription> list_plugins();

  namespace internal
  {
    /** Adds one line to list_plugins(); a repeated (kind, name) is listed once. */
    void note_plugin(const PluginDescription &description);

    /** Keeps the message of a registration that failed while a library was being loaded, where
     * nothing can be thrown; release_registration_problems() returns all of them once. */
    void note_registration_problem(const std::string &problem);
    std::string release_registration_problems();
  } // namespace internal

  /**
   * All plug-ins of one kind, by name. A plug-in is a class derived from @p Interface with
   * either a constructor from `const Entries &` (tombolo/base/input/entries.h), or `static void
   * declare_parameters(dealii::ParameterHandler &)` and a constructor from a `const Section &`, or
   * none of them where it has no entries; one line at the end of its source file,
   * TOMBOLO_REGISTER or TOMBOLO_REGISTER_FOR_DIMENSIONS, registers it. Nothing else in the
   * library is edited, and the source may be in a shared object that the parameter file names in
   * `Plugin libraries`.
   */
  template <typename Interface>
  class Registry
  {
  public:
    using Declare = std::function<void(dealii::ParameterHandler &)>;
    using Factory = std::function<std::unique_ptr<Interface>(const Section &)>;

    struct Entry
    {
      std::string description;
      Declare declare_parameters;
      Factory create;
      bool has_entries = true;
    };

    /** The one registry of this kind in the process. */
    static Registry &instance()
    {
      static Registry registry;
      return registry;
    }

    /** Registers a plug-in. A second plug-in of the same name is an error. */
    void add(const std::string &name, Entry entry)
    {
      internal::note_plugin({PluginKind<Interface>::name, name, entry.description});
      if (!entries.emplace(name, std::move(entry)).second)
        throw InputError("Two plug-ins of kind " + std::string(PluginKind<Interface>::name) +
                         " are called \"" + name + "\".");
    }

    /** The same while a library is loaded: keeps the message of an error. */
    static void register_plugin(const std::string &name, Entry entry)
    {
      try
      {
        instance().add(name, std::move(entry));
      }
      catch (const InputError &error)
      {
        internal::note_registration_problem(error.what());
      }
    }

    bool has(const std::string &name) const
    {
      return entries.count(name) > 0;
    }

    /** The names, sorted. */
    std::vector<std::string> names() const
    {
      std::vector<std::string> result;
      for (const auto &entry : entries)
        result.push_back(entry.first);
      return result;
    }

    /** The names separated by '|', for dealii::Patterns::Selection. */
    std::string selection() const
    {
      return joined(names(), "|");
    }

    /** Declares each plug-in's parameters in a subsection of the plug-in's name, an empty one only
     * @p with_empty. */
    void declare_all(dealii::ParameterHandler &handler, const bool with_empty = true) const
    {
      for (const auto &entry : entries)
      {
        if (!with_empty && !entry.second.has_entries)
          continue;
        handler.enter_subsection(entry.first);
        entry.second.declare_parameters(handler);
        handler.leave_subsection();
      }
    }

    /** @p section is the plug-in's own subsection. The name must be known. */
    std::unique_ptr<Interface> create(const std::string &name, const Section &section) const
    {
      return entries.at(name).create(section);
    }

  private:
    std::map<std::string, Entry> entries;
  };

  namespace internal
  {
    template <typename Plugin>
    using OwnDeclaration =
        decltype(Plugin::declare_parameters(std::declval<dealii::ParameterHandler &>()));

    template <typename Plugin>
    constexpr bool has_entries = std::experimental::is_detected_v<OwnDeclaration, Plugin> ||
                                 std::is_constructible<Plugin, dealii::ParameterHandler &>::value;

    template <typename Plugin>
    void declare(dealii::ParameterHandler &handler)
    {
      if constexpr (std::experimental::is_detected_v<OwnDeclaration, Plugin>)
        Plugin::declare_parameters(handler);
      else if constexpr (std::is_constructible<Plugin, dealii::ParameterHandler &>::value)
        Plugin discarded(handler); // whose constructor from Entries declares them
    }

    template <typename Plugin>
    std::unique_ptr<Plugin> create(const Section &section)
    {
      if constexpr (std::is_constructible<Plugin, const Section &>::value)
        return std::make_unique<Plugin>(section);
      else
        return std::make_unique<Plugin>();
    }

    template <typename Interface, typename Plugin>
    struct Registration
    {
      Registration(const char *name, const char *description)
      {
        Registry<Interface>::register_plugin(
            name, {description, &internal::declare<Plugin>,
                   [](const Section &section) -> std::unique_ptr<Interface>
                   { return create<Plugin>(section); },
                   has_entries<Plugin>});
      }
    };
  } // namespace internal
} // namespace tombolo

/** A name that is unique in the translation unit; lines repeat where sources are compiled
 * together. */
#define TOMBOLO_UNIQUE_NAME(prefix) BOOST_PP_CAT(prefix, __COUNTER__)

/** Registers class Plugin as a plug-in of kind Interface. Once, in a source file, at
 * global scope or in namespace tombolo. */
#define TOMBOLO_REGISTER(Interface, Plugin, name, description)                                     \
  namespace                                                                                        \
  {                                                                                                \
    const ::tombolo::internal::Registration<Interface, Plugin>                                     \
        TOMBOLO_UNIQUE_NAME(registration_)(name, description);                                     \
  }

/** Registers the class template Plugin<dim> as a plug-in of kind Interface<dim>, dim = 2 and 3. */
#define TOMBOLO_REGISTER_FOR_DIMENSIONS(Interface, Plugin, name, description)                      \
  namespace                                                                                        \
  {                                                                                                \
    const ::tombolo::internal::Registration<Interface<2>, Plugin<2>>                               \
        TOMBOLO_UNIQUE_NAME(registration_2_)(name, description);                                   \
    const ::tombolo::internal::Registration<Interface<3>, Plugin<3>>                               \
        TOMBOLO_UNIQUE_NAME(registration_3_)(name, description);                                   \
  }
