// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/parameter_declaration.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  /** An InputError that follows from a mistake which is noted already. */
  class KnownMistake : public InputError
  {
  public:
    using InputError::InputError;
  };

  /**
   * What is wrong with an input. While mistakes are collected, they are noted instead of thrown and
   * reading goes on; refuse() throws all of them as one InputError. The entries and sections that
   * mistakes concern are identified by their paths, so that what only follows from a mistake is not
   * reported as another one. All ranks note the same mistakes. While nothing is collected, add()
   * throws.
   */
  class Mistakes
  {
  public:
    /** So many messages are shown by refuse(). */
    static constexpr unsigned int most_shown = 20;

    void collect()
    {
      is_collecting = true;
    }

    bool are_collected() const
    {
      return is_collecting;
    }

    /** Whether nothing was noted. */
    bool empty() const
    {
      return messages.empty();
    }

    /** Notes a message that was not noted before, or throws it. */
    void add(const std::string &message);

    /** Calls @p read. While mistakes are collected, an InputError, or RunError, is noted, unless it
     * follows from another mistake. Returns whether nothing was wrong. */
    bool attempt(const std::function<void()> &read);

    /** The value of the entry was refused. */
    void mark_refused(const std::string &path)
    {
      refused.insert(path);
    }

    bool is_refused(const std::string &path) const
    {
      return refused.count(path) > 0;
    }

    /** Another name was refused, instead of which this entry or section can have been meant. */
    void mark_meant(const std::string &path)
    {
      meant.insert(path);
    }
    /** Whether the entry, or a section that it is in, can have been meant. */
    bool is_meant(const std::string &path) const;

    /** A value for a reader to go on with where the entry has none: what the reader refuses after
     * this is a consequence. Throws KnownMistake where no value would do, as for the name of a
     * plug-in. */
    std::string stand_in(const ParameterDeclaration &entry);

    /** Ends the collection. Throws the InputError of what was noted, if anything was: one message
     * as it is; several with numbers, in the order of @p files and of their lines, at most
     * most_shown.
     */
    void refuse(const std::vector<std::string> &files);

  private:
    bool is_collecting = false;
    bool has_stand_in = false; ///< in the present attempt()
    std::vector<std::string> messages;
    std::set<std::string> refused, meant;
  };
} // namespace tombolo
