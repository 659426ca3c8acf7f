// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/readers/mesh_file.h>

#include <unordered_map>
#include <utility>

namespace tombolo
{
  /** The fields of a card of LS-DYNA without the blanks around them: between commas where there are
   * any, otherwise of the @p widths, of which the last is that of all further fields. What stands
   * behind @p n_fields of fixed width is no part of the card. Tabs lead to every eighth column.
   * @p expanded keeps the card without tabs. Throws MeshFileError where a number then lies in two
   * fields. */
  std::vector<std::string_view> keyword_fields(const TextScanner &scanner, std::string_view card,
                                               const std::vector<std::size_t> &widths,
                                               std::size_t n_fields, std::string &expanded);

  /** Names for groups or boundaries: each is given once, and may stand in a list. */
  class KeywordNames
  {
  public:
    /** The title without commas if there is one, otherwise @p default_name; both if the title is
     * taken. Adds to @p remarks where the title changes. */
    std::string usable(const std::string &title, const std::string &default_name,
                       std::vector<std::string> &remarks);

  private:
    std::set<std::string> taken;
  };

  /** What the numbers of a keyword file stand for. */
  struct KeywordNumbers
  {
    std::unordered_map<long long, unsigned int> index_of_node;
    std::unordered_map<long long, unsigned int> cell_of_element;
    std::map<long long, std::string> part_titles;

    /** Throws MeshFileError at @p line where there is no such node. */
    unsigned int node(long long number, unsigned int line) const;
    /** The same for a node that may come later: new ones have the indices after the known ones. */
    unsigned int node_so_far(long long number, unsigned int line);

    /** Lines that first name nodes which have not come yet, by number. */
    std::map<long long, unsigned int> awaited_nodes;
  };

  /** `*SET_NODE`, `*SET_SEGMENT`, `*SET_SOLID`, `*SET_SHELL` and `*SET_PART` of a keyword file. */
  class KeywordSets
  {
  public:
    /** Errors are those of @p scanner, which must outlive it. */
    KeywordSets(const TextScanner &scanner, unsigned int dim);

    /** Begins the sets of a keyword without its star; false if they are not read. */
    bool begin(const std::string &keyword);
    /** Whether the next card is a title, which may be blank. */
    bool is_at_title() const;
    /** @p width is that of the fields. */
    void add_card(std::string_view card, std::size_t width);

    /** Adds boundaries, sets of nodes and sets of cells to the content. */
    void resolve(const KeywordNumbers &numbers, KeywordNames &groups, KeywordNames &boundaries,
                 MeshFileContent &content) const;

  private:
    enum class Kind
    {
      segments,
      nodes,
      elements,
      parts,
      sets_of_nodes
    };

    struct Range
    {
      long long first;
      long long last;
      unsigned int line;
      bool is_generated = false; ///< whether what exists of it is taken
    };

    struct Set
    {
      Kind kind;
      long long number = 0;
      std::string title;
      std::string default_name;
      std::vector<Range> members; ///< of segments: their nodes, one after the other
      bool is_generated = false;  ///< whether the members are ranges
      bool is_column = false;     ///< whether a card has one member and its attributes
    };

    void add_segment(const std::vector<std::string_view> &fields);
    void resolve_segments(const Set &set, const KeywordNumbers &numbers, const std::string &name,
                          MeshFileContent &content) const;
    /** The members of the sets of nodes that a set of sets names, directly or by others. */
    std::vector<Range> members_of_sets(const Set &set, const std::string &name) const;
    /** Nodes or cells of a set. */
    std::vector<unsigned int> members_of(const Set &set, const KeywordNumbers &numbers,
                                         const std::string &name,
                                         const MeshFileContent &content) const;

    const TextScanner &scanner;
    const unsigned int dim;
    std::vector<Set> sets;
    Set next;
    bool has_title = false; ///< whether the next card is a title
    bool has_head = false;  ///< whether the next card is the number of the set
  };
} // namespace tombolo
