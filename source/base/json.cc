// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/json.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The number of bytes of the UTF-8 character that starts at @p i; 0 where there is none: not a
     * start, cut off, longer than it need be, a surrogate, or beyond U+10FFFF. */
    std::size_t utf8_length(const std::string &text, const std::size_t i)
    {
      const auto byte = [&](const std::size_t j)
      { return j < text.size() ? static_cast<unsigned char>(text[j]) : 0u; };
      const unsigned int first = byte(i);
      const std::size_t length = first < 0x80                     ? 1
                                 : first >= 0xC2 && first < 0xE0  ? 2
                                 : first >= 0xE0 && first < 0xF0  ? 3
                                 : first >= 0xF0 && first <= 0xF4 ? 4
                                                                  : 0;
      for (std::size_t j = 1; j < length; ++j)
        if ((byte(i + j) & 0xC0) != 0x80)
          return 0;
      const unsigned int second = byte(i + 1);
      if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second >= 0xA0) ||
          (first == 0xF0 && second < 0x90) || (first == 0xF4 && second >= 0x90))
        return 0;
      return length;
    }

    void write_string(std::ostream &out, const std::string &text)
    {
      static const char *const hexadecimal = "0123456789abcdef";
      out << '"';
      for (std::size_t i = 0; i < text.size();)
      {
        const std::size_t length = utf8_length(text, i);
        const char character = text[i];
        if (length == 0)
          out << "\\ufffd";
        else if (length > 1)
          out << text.substr(i, length);
        else if (character == '"' || character == '\\')
          out << '\\' << character;
        else if (character == '\n')
          out << "\\n";
        else if (character == '\t')
          out << "\\t";
        else if (character == '\r')
          out << "\\r";
        else if (character >= 0 && character < 0x20)
          out << "\\u00" << hexadecimal[character / 16] << hexadecimal[character % 16];
        else
          out << character;
        i += std::max<std::size_t>(length, 1);
      }
      out << '"';
    }

    void write_real(std::ostream &out, const double value)
    {
      if (!std::isfinite(value))
      {
        out << "null";
        return;
      }
      char text[64];
      const auto end = std::to_chars(text, text + sizeof(text), value);
      out << std::string(text, end.ptr);
    }
  } // namespace

  Json::Json(const bool value) : kind(Kind::truth), truth_value(value) {}

  Json::Json(const double value) : kind(Kind::real), real_value(value) {}

  Json::Json(const char *value) : kind(Kind::string), string_value(value) {}

  Json::Json(const std::string &value) : kind(Kind::string), string_value(value) {}

  Json Json::object()
  {
    Json result;
    result.kind = Kind::object;
    return result;
  }

  Json Json::array()
  {
    Json result;
    result.kind = Kind::array;
    return result;
  }

  Json &Json::operator[](const std::string &key)
  {
    if (kind == Kind::null)
      kind = Kind::object;
    AssertThrow(kind == Kind::object, ExcMessage("The JSON value is not an object."));
    const auto found = std::find(keys.begin(), keys.end(), key);
    if (found != keys.end())
      return values[static_cast<std::size_t>(found - keys.begin())];
    keys.push_back(key);
    values.emplace_back();
    return values.back();
  }

  void Json::push_back(const Json &element)
  {
    if (kind == Kind::null)
      kind = Kind::array;
    AssertThrow(kind == Kind::array, ExcMessage("The JSON value is not an array."));
    values.push_back(element);
  }

  bool Json::has(const std::string &key) const
  {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
  }

  bool Json::is_null() const
  {
    return kind == Kind::null;
  }

  std::size_t Json::size() const
  {
    return values.size();
  }

  void Json::write(std::ostream &out) const
  {
    write(out, 0);
    out << '\n';
  }

  std::string Json::to_string() const
  {
    std::ostringstream out;
    write(out);
    return out.str();
  }

  void Json::write(std::ostream &out, const unsigned int level) const
  {
    switch (kind)
    {
    case Kind::null:
      out << "null";
      return;
    case Kind::truth:
      out << (truth_value ? "true" : "false");
      return;
    case Kind::integer:
      out << std::to_string(signed_value);
      return;
    case Kind::natural:
      out << std::to_string(unsigned_value);
      return;
    case Kind::real:
      write_real(out, real_value);
      return;
    case Kind::string:
      write_string(out, string_value);
      return;
    case Kind::array:
    case Kind::object:
      break;
    }

    const bool is_object = kind == Kind::object;
    const std::string indent(2 * (level + 1), ' ');
    out << (is_object ? '{' : '[');
    for (std::size_t i = 0; i < values.size(); ++i)
    {
      out << (i == 0 ? "\n" : ",\n") << indent;
      if (is_object)
      {
        write_string(out, keys[i]);
        out << ": ";
      }
      values[i].write(out, level + 1);
    }
    if (!values.empty())
      out << '\n' << std::string(2 * level, ' ');
    out << (is_object ? '}' : ']');
  }
} // namespace tombolo
