// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * A value of a JSON document: null, a truth value, a number, a string, an array or an object
   * whose keys keep the order in which they were added. Numbers are written as numbers: whole ones
   * without a point, others as the shortest text that reads back as the same double. JSON has no
   * numbers that are not finite: they are written as null.
   */
  class Json
  {
  public:
    /** null; becomes an object with the first key and an array with the first push_back(). */
    Json() = default;
    Json(bool value);
    Json(double value);
    Json(const char *value);
    Json(const std::string &value);

    template <typename Integer, typename = std::enable_if_t<std::is_integral_v<Integer> &&
                                                            !std::is_same_v<Integer, bool>>>
    Json(const Integer value) : kind(std::is_signed_v<Integer> ? Kind::integer : Kind::natural)
    {
      if constexpr (std::is_signed_v<Integer>)
        signed_value = value;
      else
        unsigned_value = value;
    }

    /** An array of all elements. */
    template <typename Element>
    Json(const std::vector<Element> &elements) : kind(Kind::array)
    {
      for (const Element &element : elements)
        values.emplace_back(element);
    }

    static Json object(); ///< without keys
    static Json array();  ///< without elements

    /** The value at a key, null where there was none. This must be null or an object. */
    Json &operator[](const std::string &key);

    /** This must be null or an array. */
    void push_back(const Json &element);

    bool has(const std::string &key) const;
    bool is_null() const;

    /** Keys of an object or elements of an array. */
    std::size_t size() const;

    /** Indented by two blanks a level, in UTF-8; bytes that are not UTF-8 become U+FFFD. */
    void write(std::ostream &out) const;
    std::string to_string() const;

  private:
    enum class Kind
    {
      null,
      truth,
      integer,
      natural,
      real,
      string,
      array,
      object
    };

    void write(std::ostream &out, unsigned int level) const;

    Kind kind = Kind::null;
    bool truth_value = false;
    double real_value = 0;
    std::int64_t signed_value = 0;
    std::uint64_t unsigned_value = 0;
    std::string string_value;
    std::vector<std::string> keys;
    std::vector<Json> values;
  };
} // namespace tombolo
