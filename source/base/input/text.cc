// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/text.h>

#include <deal.II/base/utilities.h>

#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/split.hpp>

namespace tombolo
{
  using namespace dealii;

  std::string in_quotes(const std::string &text)
  {
    constexpr std::size_t shown = 160;
    if (text.size() <= shown)
      return "\"" + text + "\"";
    std::size_t begin = shown - 40;
    std::size_t end = text.size() - 40;
    const auto is_continuation = [&](const std::size_t i)
    { return (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80; };
    while (begin > 0 && is_continuation(begin))
      --begin;
    while (end < text.size() && is_continuation(end))
      ++end;
    return "\"" + text.substr(0, begin) + " [...] " + text.substr(end) + "\"";
  }

  std::string in_quotes(const std::vector<std::string> &texts)
  {
    std::string result;
    for (const auto &text : texts)
      result += (result.empty() ? "" : ", ") + in_quotes(text);
    return result;
  }

  std::string joined(const std::vector<std::string> &texts, const std::string &separator)
  {
    return boost::join(texts, separator);
  }

  std::string joined_path(const std::string &section, const std::string &name)
  {
    return section.empty() ? name : name.empty() ? section : section + "/" + name;
  }

  std::vector<std::string> split_list(const std::string &text, const char separator)
  {
    std::vector<std::string> items;
    if (text.empty())
      return items;
    boost::split(items, text, [&](const char c) { return c == separator; });
    for (std::string &item : items)
      item = Utilities::trim(item);
    return items;
  }

  std::string parent_path(const std::string &path)
  {
    const std::size_t slash = path.rfind('/');
    return slash == std::string::npos ? "" : path.substr(0, slash);
  }

  std::string last_name(const std::string &path)
  {
    const std::size_t slash = path.rfind('/');
    return slash == std::string::npos ? path : path.substr(slash + 1);
  }
} // namespace tombolo
