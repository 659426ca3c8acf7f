// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameter_scanner.h>

#include <deal.II/base/utilities.h>

#include <boost/locale/utf.hpp>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/mistakes.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/base/on_ranks.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace tombolo
{
  namespace
  {
    constexpr std::size_t largest_line = 100000;
    constexpr std::size_t largest_file = 64000000;
    constexpr std::size_t deepest_section = 32;
    constexpr unsigned int most_includes = 1000;

    /** Reads a file on this process; returns why it cannot be read, or nothing. */
    std::string read_locally(const std::string &name, std::string &text)
    {
      std::error_code error;
      const auto status = std::filesystem::status(name, error);
      if (!std::filesystem::exists(status))
        return "there is no such file";
      if (std::filesystem::is_directory(status))
        return "it is a directory";
      errno = 0;
      std::ifstream in(name, std::ios::binary);
      if (!in)
        return std::strerror(errno);
      std::array<char, 65536> buffer;
      while (in && text.size() <= largest_file)
      {
        in.read(buffer.data(), buffer.size());
        text.append(buffer.data(), static_cast<std::size_t>(in.gcount()));
      }
      if (in.bad())
        return errno != 0 ? std::strerror(errno) : "reading fails";
      if (text.size() > largest_file)
        return "it is larger than 64 MB, which no parameter file is";
      if (text.find_first_not_of(" \t\r\n") == std::string::npos)
        return "it is empty";
      return "";
    }

    struct FileContent
    {
      std::string text, identity, problem;
    };

    /** Reads a file on rank 0 and sends all of it to the others. */
    FileContent read_on_root(const std::string &name, const MPI_Comm communicator)
    {
      const std::vector<std::string> message = from_first_rank(
          communicator,
          [&]
          {
            std::string text;
            const std::string problem = read_locally(name, text);
            std::error_code error;
            const auto path = std::filesystem::weakly_canonical(name, error);
            return std::vector<std::string>{text, error ? name : path.string(), problem};
          });
      return {message[0], message[1], message[2]};
    }

    /** Refuses lines that are not UTF-8 text. */
    void check_line(const std::string &line, const SourceLocation &location)
    {
      if (line.size() > largest_line)
        throw InputError(to_string(location) + ": this line has " + std::to_string(line.size()) +
                         " characters; allowed are " + std::to_string(largest_line) + ".");
      for (auto at = line.begin(); at != line.end();)
      {
        const auto character = at;
        const auto byte = static_cast<unsigned char>(*character);
        namespace utf = boost::locale::utf;
        if (!utf::is_valid_codepoint(utf::utf_traits<char>::decode(at, line.end())) ||
            (byte < 0x20 && byte != '\t' && byte != '\r') || byte == 0x7f)
        {
          std::array<char, 8> number;
          std::snprintf(number.data(), number.size(), "0x%02x", byte);
          throw InputError(to_string(location) + ": this is not text: byte " + number.data() +
                           " at column " + std::to_string(character - line.begin() + 1) +
                           ". A parameter file is UTF-8 text.");
        }
      }
    }

    std::string path_of(const std::vector<std::string> &sections, const std::string &name)
    {
      return joined_path(joined(sections, "/"), name);
    }
  } // namespace

  std::string to_string(const SourceLocation &location)
  {
    return location.line == 0 ? location.file : location.file + ":" + std::to_string(location.line);
  }

  ParameterScanner::ParameterScanner(const MPI_Comm communicator, Mistakes &mistakes)
      : communicator(communicator), mistakes(mistakes)
  {}

  void ParameterScanner::refuse_line(const SourceLocation &location,
                                     const std::string &message) const
  {
    mistakes.add(to_string(location) + ": " + message);
  }

  std::vector<std::string> ParameterScanner::file_names() const
  {
    std::vector<std::string> names;
    for (const auto &[name, text] : texts)
      names.push_back(name);
    return names;
  }

  void ParameterScanner::read_file(const std::string &file_name)
  {
    const FileContent file = read_on_root(file_name, communicator);
    if (!file.problem.empty())
      throw InputError("The parameter file " + in_quotes(file_name) +
                       " cannot be read: " + file.problem + ".");
    std::vector<std::string> sections;
    scan(file.text, file_name, file.identity, sections);
  }

  void ParameterScanner::read_text(const std::string &text, const std::string &name)
  {
    std::vector<std::string> sections;
    scan(text, name, "text of " + name, sections);
  }

  void ParameterScanner::replace_items(const std::vector<Item> &items)
  {
    all_items = items;
    entries.clear();
    section_locations.clear();
    for (std::size_t i = 0; i < all_items.size(); ++i)
      if (all_items[i].is_section)
        section_locations.emplace(all_items[i].path, all_items[i].location);
      else
        entries[all_items[i].path] = i;
  }

  const ParameterScanner::Item *ParameterScanner::entry(const std::string &path) const
  {
    const auto found = entries.find(path);
    return found == entries.end() ? nullptr : &all_items[found->second];
  }

  const SourceLocation *ParameterScanner::section(const std::string &path) const
  {
    const auto found = section_locations.find(path);
    return found == section_locations.end() ? nullptr : &found->second;
  }

  std::string ParameterScanner::text() const
  {
    std::string result;
    for (const auto &[name, text] : texts)
    {
      if (&text != &texts.front().second)
        result += "\n# ---- file " + name + "\n";
      result += text;
    }
    return result;
  }

  void ParameterScanner::scan(const std::string &text, const std::string &name,
                              const std::string &identity, std::vector<std::string> &sections)
  {
    texts.emplace_back(name, text);
    open_files.push_back({name, identity, {}, {}});

    std::vector<unsigned int> opened; // lines of the sections that are open in this file
    std::string joined;               // a line with those that continue it
    unsigned int first_line = 0;
    bool continues = false;
    unsigned int line_number = 0;
    const bool has_byte_order_mark = text.compare(0, 3, "\xef\xbb\xbf") == 0;
    for (std::size_t begin = has_byte_order_mark ? 3 : 0; begin < text.size();)
    {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      const std::string raw_line = text.substr(begin, end - begin);
      begin = end + 1;
      ++line_number;
      const SourceLocation location{name, line_number};
      check_line(raw_line, location);

      const std::size_t comment = raw_line.find('#');
      std::string line = Utilities::trim(raw_line.substr(0, comment));
      if (comment != std::string::npos && Utilities::trim(raw_line).back() == '\\')
        throw InputError(to_string(location) + ": this comment ends in \"\\\", which would make "
                                               "the next line a part of it. Remove the \"\\\".");
      if (!continues)
      {
        joined.clear();
        first_line = line_number;
      }
      continues = !line.empty() && line.back() == '\\';
      if (continues)
        line.pop_back();
      joined += line;
      if (joined.size() > largest_line)
        throw InputError(to_string({name, first_line}) + ": this line and those that continue it " +
                         "have more than " + std::to_string(largest_line) + " characters.");
      if (!continues)
        scan_line(joined, first_line, sections, opened);
    }
    if (continues)
      throw InputError(to_string({name, line_number}) +
                       ": the last line ends in \"\\\", but nothing continues it.");
    if (!opened.empty())
      throw InputError(to_string({name, opened.back()}) + ": subsection " +
                       in_quotes(sections.back()) + " is not closed: an \"end\" is missing.");
    open_files.pop_back();
  }

  void ParameterScanner::scan_line(const std::string &line, const unsigned int line_number,
                                   std::vector<std::string> &sections,
                                   std::vector<unsigned int> &opened)
  {
    const SourceLocation location{open_files.back().name, line_number,
                                  static_cast<unsigned int>(open_files.size() - 1)};
    const std::string text = Utilities::trim(line);
    if (text.empty())
      return;
    const std::size_t blank = text.find_first_of(" \t");
    const std::string keyword = text.substr(0, blank);
    const std::string rest =
        blank == std::string::npos ? "" : Utilities::trim(text.substr(blank + 1));

    if (keyword == "set" || keyword == "SET")
      add_entry(rest, location, sections);
    else if (keyword == "subsection" || keyword == "SUBSECTION")
    {
      add_section(rest, location, sections);
      opened.push_back(line_number);
    }
    else if (keyword == "end" || keyword == "END")
    {
      if (!rest.empty())
        refuse_line(location, "\"end\" stands alone on its line, found " + in_quotes(text) + ".");
      if (opened.empty())
        throw InputError(to_string(location) +
                         ": \"end\" without a subsection that is open in this file.");
      opened.pop_back();
      sections.pop_back();
    }
    else if (keyword == "include" || keyword == "INCLUDE")
      include(rest, location, sections);
    else
      scan_unknown_line(keyword, text, location, sections, opened);
  }

  void ParameterScanner::scan_unknown_line(const std::string &keyword, const std::string &text,
                                           const SourceLocation &location,
                                           std::vector<std::string> &sections,
                                           std::vector<unsigned int> &opened)
  {
    if (text.front() == '*' || text.front() == '$')
      throw InputError(to_string(location) + ": " + in_quotes(text) +
                       " begins no parameter file but a deck or a mesh. A mesh is named in a "
                       "parameter file, as \"Mesh/file/File\"; scripts/import writes a "
                       "parameter file of a deck of LS-DYNA or Abaqus.");
    const std::string nearest = nearest_name(keyword, {"set", "subsection", "end", "include"});
    const bool has_value = text.find('=') != std::string::npos;
    std::string hint;
    if (!nearest.empty() && !(nearest == "end" && has_value))
      hint = " Did you mean \"" + nearest + "\"?";
    else if (has_value)
      hint = " Did you mean " + in_quotes("set " + text) + "?";
    refuse_line(location,
                "a line begins with \"set\", \"subsection\", \"end\" or \"include\", found " +
                    in_quotes(text) + "." + hint);
    const std::string rest = text.substr(keyword.size());
    if (nearest == "subsection" || nearest == "set" || (nearest == "end" && rest.empty()))
      scan_line(nearest + rest, location.line, sections, opened);
    else if (has_value)
      scan_line("set " + text, location.line, sections, opened);
  }

  void ParameterScanner::add_entry(const std::string &rest, const SourceLocation &location,
                                   const std::vector<std::string> &sections)
  {
    const std::size_t equal = rest.find('=');
    const std::string name = Utilities::trim(rest.substr(0, equal));
    if (equal == std::string::npos)
    {
      refuse_line(location, "\"set\" without \"=\", found " + in_quotes("set " + rest) +
                                ". Write \"set Entry = value\".");
      mistakes.mark_meant(path_of(sections, rest));
      return;
    }
    if (name.empty())
    {
      refuse_line(location, "the name of the entry is missing before \"=\".");
      return;
    }
    if (name.find('/') != std::string::npos)
      refuse_line(location, "the name of entry " + in_quotes(name) +
                                " has a \"/\". In a file, sections are opened with "
                                "\"subsection\".");

    const std::string path = path_of(sections, name);
    auto &file = open_files.back();
    const auto [first, is_new] = file.entry_lines.emplace(path, location.line);
    if (!is_new)
    {
      const auto section = file.section_lines.find(parent_path(path));
      if (section == file.section_lines.end() || section->second != 0)
        refuse_line(location, "entry " + in_quotes(path) + " is set twice, here and at " +
                                  to_string({file.name, first->second}) + ". Remove one of them.");
      return;
    }
    for (const auto &outer : open_files)
      if (&outer != &file && outer.entry_lines.count(path) > 0)
      {
        refuse_line(location, "entry " + in_quotes(path) + " is already set at " +
                                  to_string({outer.name, outer.entry_lines.at(path)}) +
                                  ", before this file is included. Set it after the \"include\" to "
                                  "change what the included file says.");
        return;
      }
    entries[path] = all_items.size();
    all_items.push_back({false, path, Utilities::trim(rest.substr(equal + 1)), location});
  }

  void ParameterScanner::add_section(const std::string &name, const SourceLocation &location,
                                     std::vector<std::string> &sections)
  {
    if (name.empty())
      throw InputError(to_string(location) + ": the name of the subsection is missing.");
    if (name.find('/') != std::string::npos)
      refuse_line(location, "the name of subsection " + in_quotes(name) +
                                " has a \"/\", which separates sections in paths. Choose another "
                                "name.");
    if (sections.size() >= deepest_section)
      throw InputError(to_string(location) + ": subsection " + in_quotes(name) + " lies within " +
                       std::to_string(sections.size()) +
                       " others, and more are not allowed. Is an \"end\" missing?");
    const std::string path = path_of(sections, name);

    auto &file = open_files.back();
    const auto [first, is_new] = file.section_lines.emplace(path, location.line);
    if (!is_new)
    {
      refuse_line(location,
                  "subsection " + in_quotes(path) + " stands twice, here and at " +
                      to_string(first->second != 0 ? SourceLocation{file.name, first->second}
                                                   : section_locations.at(path)) +
                      ". Put their entries into one.");
      first->second = 0; // its entries are not reported as duplicates
    }
    section_locations.emplace(path, location);
    all_items.push_back({true, path, "", location});
    sections.push_back(name);
  }

  void ParameterScanner::include(const std::string &name, const SourceLocation &location,
                                 std::vector<std::string> &sections)
  {
    if (++n_includes > most_includes)
      throw InputError(to_string(location) + ": more than " + std::to_string(most_includes) +
                       " files are included, each time counted; allowed are " +
                       std::to_string(most_includes) + ".");
    if (name.empty())
      throw InputError(to_string(location) + ": the name of the file to include is missing.");
    const std::string file_name =
        (std::filesystem::path(location.file).parent_path() / name).lexically_normal().string();
    const FileContent file = read_on_root(file_name, communicator);
    if (!file.problem.empty())
      throw InputError(to_string(location) + ": the included file " + in_quotes(file_name) +
                       " cannot be read: " + file.problem +
                       ". Names are relative to the directory of the including file.");
    if (std::any_of(open_files.begin(), open_files.end(),
                    [&](const OpenFile &open) { return open.identity == file.identity; }))
    {
      std::string circle;
      for (const auto &open : open_files)
        circle += open.name + " -> ";
      throw InputError(to_string(location) + ": a circle of includes: " + circle + file_name + ".");
    }
    scan(file.text, file_name, file.identity, sections);
  }

  ParameterScanner::Item read_override(const std::string &assignment)
  {
    const auto refuse = [&](const std::string &message)
    { throw InputError("--set " + in_quotes(assignment) + ": " + message); };
    const std::size_t equal = assignment.find('=');
    if (equal == std::string::npos)
      refuse("\"=\" is missing. Write --set \"Section/Entry = value\".");
    auto names = Utilities::split_string_list(assignment.substr(0, equal), std::string("/"));
    for (std::string &name : names)
      name = Utilities::trim(name);
    if (names.empty() || std::count(names.begin(), names.end(), "") > 0)
      refuse("a name is missing before \"=\". Write --set \"Section/Entry = value\".");
    const std::string value = Utilities::trim(assignment.substr(equal + 1));
    if (value.find_first_of("#\n\r") != std::string::npos ||
        (!value.empty() && value.back() == '\\'))
      refuse("a value has no \"#\" and no line break and does not end in \"\\\".");
    return {false, joined(names, "/"), value, {"--set", 0, 0}};
  }
} // namespace tombolo
