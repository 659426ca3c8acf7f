// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/keyword_sets.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    std::string_view without_blanks(const std::string_view text)
    {
      const std::size_t begin = text.find_first_not_of(" \t");
      if (begin == text.npos)
        return {};
      return text.substr(begin, text.find_last_not_of(" \t") + 1 - begin);
    }
  } // namespace

  std::vector<std::string_view> keyword_fields(const TextScanner &scanner, std::string_view card,
                                               const std::vector<std::size_t> &widths,
                                               const std::size_t n_fields, std::string &expanded)
  {
    std::vector<std::string_view> fields;
    const auto width_of = [&](const std::size_t field)
    { return widths[std::min(field, widths.size() - 1)]; };
    std::size_t n_columns = 0;
    for (std::size_t field = 0; field < n_fields; ++field)
      n_columns += width_of(field);
    const bool has_commas = card.substr(0, n_columns).find(',') != card.npos;
    if (!has_commas && card.find('\t') != card.npos)
    {
      expanded.clear();
      for (const char character : card)
        if (character == '\t')
          expanded.append(8 - expanded.size() % 8, ' ');
        else
          expanded += character;
      card = expanded;
      std::size_t end = 0;
      for (std::size_t field = 0; field < n_fields; ++field)
      {
        end += width_of(field);
        if (end < card.size() && card[end - 1] != ' ' && card[end] != ' ')
          scanner.fail("The card has tabs, by which a field does not begin in its columns. Write "
                       "blanks, or commas between the fields.");
      }
    }
    if (!has_commas)
      card = card.substr(0, n_columns);
    for (std::size_t begin = 0; begin < card.size();)
    {
      const std::size_t width = has_commas ? std::min(card.find(',', begin), card.size()) - begin
                                           : width_of(fields.size());
      fields.push_back(without_blanks(card.substr(begin, width)));
      begin += width + (has_commas ? 1 : 0);
    }
    while (!fields.empty() && fields.back().empty())
      fields.pop_back();
    return fields;
  }

  std::string KeywordNames::usable(const std::string &title, const std::string &default_name,
                                   std::vector<std::string> &remarks)
  {
    // A comma separates the names of a list of boundaries, and # begins a comment.
    std::string name;
    for (const char character : title)
      if (std::string(",#\\ ").find(character) == std::string::npos)
        name += character;
      else if (!name.empty() && name.back() != ' ')
        name += ' ';
    name.erase(name.find_last_not_of(' ') + 1);
    if (name != title && !name.empty())
      remarks.push_back("The name \"" + title +
                        "\" of the mesh file cannot stand in a parameter file: it is called \"" +
                        name + "\" here.");
    if (name.empty())
      name = default_name;
    if (!taken.insert(name).second)
    {
      name += " (" + default_name + ")";
      taken.insert(name);
    }
    return name;
  }

  unsigned int KeywordNumbers::node(const long long number, const unsigned int line) const
  {
    const auto found = index_of_node.find(number);
    if (found == index_of_node.end())
      TextScanner::fail_at(line, "There is no node of number " + std::to_string(number) + ".");
    return found->second;
  }

  unsigned int KeywordNumbers::node_so_far(const long long number, const unsigned int line)
  {
    const auto entry =
        index_of_node.emplace(number, static_cast<unsigned int>(index_of_node.size()));
    if (entry.second)
      awaited_nodes.emplace(number, line);
    return entry.first->second;
  }

  KeywordSets::KeywordSets(const TextScanner &scanner, const unsigned int dim)
      : scanner(scanner), dim(dim)
  {}

  bool KeywordSets::begin(const std::string &keyword)
  {
    static const std::set<std::string> allowed = {
        "",          "_LIST",          "_TITLE",          "_LIST_TITLE",
        "_GENERATE", "_LIST_GENERATE", "_GENERATE_TITLE", "_LIST_GENERATE_TITLE"};
    static const std::set<std::string> allowed_of_nodes = {"_ADD", "_ADD_TITLE", "_COLUMN",
                                                           "_COLUMN_TITLE"};
    struct Words
    {
      const char *keyword;
      Kind kind;
      const char *default_name;
    };
    static const std::vector<Words> kinds = {{"SET_SEGMENT", Kind::segments, "segment set "},
                                             {"SET_NODE", Kind::nodes, "node set "},
                                             {"SET_SOLID", Kind::elements, "solid set "},
                                             {"SET_SHELL", Kind::elements, "shell set "},
                                             {"SET_PART", Kind::parts, "part set "}};
    for (const auto &words : kinds)
    {
      const std::string begin = words.keyword;
      if (keyword.compare(0, begin.size(), begin) != 0 || (begin == "SET_SHELL" && dim == 3))
        continue;
      const std::string form = keyword.substr(begin.size());
      const bool is_of_nodes = words.kind == Kind::nodes && allowed_of_nodes.count(form) > 0;
      if (!is_of_nodes && allowed.count(form) == 0)
        continue;
      next = Set();
      next.kind = form.compare(0, 4, "_ADD") == 0 ? Kind::sets_of_nodes : words.kind;
      next.is_column = form.compare(0, 7, "_COLUMN") == 0;
      next.default_name = words.default_name;
      next.is_generated = keyword.find("_GENERATE") != keyword.npos;
      has_title = keyword.find("_TITLE") != keyword.npos;
      has_head = true;
      return true;
    }
    return false;
  }

  bool KeywordSets::is_at_title() const
  {
    return has_title;
  }

  void KeywordSets::add_card(const std::string_view card, const std::size_t width)
  {
    if (has_title)
    {
      next.title = std::string(without_blanks(card));
      has_title = false;
      return;
    }
    std::string expanded;
    auto fields = keyword_fields(scanner, card, {width}, 8, expanded);
    if (has_head)
    {
      has_head = false;
      next.number = scanner.to_integer(fields.empty() ? std::string_view() : fields[0],
                                       "the number of a set");
      next.default_name += std::to_string(next.number);
      sets.push_back(std::move(next));
      return;
    }
    if (sets.back().kind == Kind::segments)
    {
      add_segment(fields);
      return;
    }
    if (sets.back().is_column && !fields.empty())
      fields.resize(1);
    std::vector<long long> numbers;
    for (const auto &field : fields)
      numbers.push_back(field.empty() ? 0 : scanner.to_integer(field, "a number of a set"));
    auto &members = sets.back().members;
    if (sets.back().is_generated)
      for (std::size_t k = 0; k + 1 < numbers.size(); k += 2)
        members.push_back({numbers[k], numbers[k + 1], scanner.line_number(), true});
    else
      for (const long long number : numbers)
        if (number != 0)
          members.push_back({number, number, scanner.line_number()});
  }

  void KeywordSets::add_segment(const std::vector<std::string_view> &fields)
  {
    const std::size_t n_nodes = dim == 3 ? 4 : 2;
    std::set<long long> distinct;
    for (std::size_t k = 0; k < n_nodes; ++k)
    {
      const long long number = scanner.to_integer(
          k < fields.size() ? fields[k] : std::string_view(), "the number of a node of a segment");
      distinct.insert(number);
      sets.back().members.push_back({number, number, scanner.line_number()});
    }
    if (distinct.size() < n_nodes)
      scanner.fail(dim == 3 ? "A segment is a triangle. Allowed are faces of hexahedra only."
                            : "A segment has the same node twice.");
  }

  void KeywordSets::resolve_segments(const Set &set, const KeywordNumbers &numbers,
                                     const std::string &name, MeshFileContent &content) const
  {
    const std::size_t n_nodes = dim == 3 ? 4 : 2;
    const auto id = static_cast<unsigned int>(content.boundary_names.size()) + 1;
    content.boundary_names.emplace(name, id);
    content.surfaces_off_the_body.insert(id);
    for (std::size_t k = 0; k < set.members.size(); k += n_nodes)
    {
      MeshFileElement face;
      face.line = set.members[k].line;
      face.id = id;
      for (std::size_t n = 0; n < n_nodes; ++n)
        face.nodes[n] = numbers.node(set.members[k + n].first, face.line);
      content.faces.push_back(face);
    }
  }

  std::vector<unsigned int> KeywordSets::members_of(const Set &set, const KeywordNumbers &numbers,
                                                    const std::string &name,
                                                    const MeshFileContent &content) const
  {
    std::vector<unsigned int> members;
    // Of a range LS-DYNA takes what exists.
    const auto take = [&](const auto &known, const Range &range)
    {
      for (const auto &entry : known)
        if (entry.first >= range.first && entry.first <= range.last)
          members.push_back(entry.second);
    };
    const bool is_of_sets = set.kind == Kind::sets_of_nodes;
    const bool is_of_nodes = set.kind == Kind::nodes || is_of_sets;
    for (const Range &range : is_of_sets ? members_of_sets(set, name) : set.members)
      if (set.kind == Kind::parts)
      {
        for (std::size_t c = 0; c < content.cells.size(); ++c)
          if (content.cells[c].id >= range.first && content.cells[c].id <= range.last)
            members.push_back(static_cast<unsigned int>(c));
      }
      else if (range.is_generated)
        take(is_of_nodes ? numbers.index_of_node : numbers.cell_of_element, range);
      else if (is_of_nodes)
        members.push_back(numbers.node(range.first, range.line));
      else
      {
        const auto found = numbers.cell_of_element.find(range.first);
        if (found == numbers.cell_of_element.end())
          TextScanner::fail_at(range.line, "There is no element of number " +
                                               std::to_string(range.first) + ", which the set \"" +
                                               name + "\" names.");
        members.push_back(found->second);
      }
    std::sort(members.begin(), members.end());
    return members;
  }

  std::vector<KeywordSets::Range> KeywordSets::members_of_sets(const Set &set,
                                                               const std::string &name) const
  {
    std::vector<Range> members, awaited = set.members;
    std::set<long long> known;
    while (!awaited.empty())
    {
      const Range range = awaited.back();
      awaited.pop_back();
      if (!known.insert(range.first).second)
        continue;
      const auto found =
          std::find_if(sets.begin(), sets.end(),
                       [&](const Set &other)
                       {
                         return other.number == range.first &&
                                (other.kind == Kind::nodes || other.kind == Kind::sets_of_nodes);
                       });
      if (found == sets.end())
        TextScanner::fail_at(range.line, "There is no set of nodes of number " +
                                             std::to_string(range.first) + ", which the set \"" +
                                             name + "\" names.");
      auto &list = found->kind == Kind::nodes ? members : awaited;
      list.insert(list.end(), found->members.begin(), found->members.end());
    }
    return members;
  }

  void KeywordSets::resolve(const KeywordNumbers &numbers, KeywordNames &groups,
                            KeywordNames &boundaries, MeshFileContent &content) const
  {
    for (const Set &set : sets)
    {
      const bool is_boundary =
          set.kind == Kind::segments || set.kind == Kind::nodes || set.kind == Kind::sets_of_nodes;
      const std::string name =
          (is_boundary ? boundaries : groups).usable(set.title, set.default_name, content.remarks);
      if (set.kind == Kind::segments)
        resolve_segments(set, numbers, name, content);
      else
        (is_boundary ? content.node_sets : content.cell_sets)
            .push_back({name, members_of(set, numbers, name, content)});
    }
  }
} // namespace tombolo
