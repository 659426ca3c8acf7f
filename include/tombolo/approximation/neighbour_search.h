// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tombolo
{
  /** Numbers occupied bins 0, 1, ... by their keys, in a hash table with open addressing. Memory is
   * kept: as many bins after clear() allocate nothing. */
  class BinTable
  {
  public:
    static constexpr unsigned int no_bin = std::numeric_limits<unsigned int>::max();
    static constexpr std::uint64_t no_key = std::numeric_limits<std::uint64_t>::max();

    void clear();

    unsigned int size() const
    {
      return static_cast<unsigned int>(keys.size());
    }

    std::uint64_t key(const unsigned int bin) const
    {
      return keys[bin];
    }

    /** The bin of a key, or no_bin. There must be a bin. */
    unsigned int find(const std::uint64_t key) const
    {
      const std::size_t mask = slots.size() - 1;
      for (std::size_t i = hash(key) & mask;; i = (i + 1) & mask)
      {
        if (slots[i].key == key)
          return slots[i].bin;
        if (slots[i].key == no_key)
          return no_bin;
      }
    }

    /** The bin of a key, which is the next number where the key is new. */
    unsigned int find_or_add(const std::uint64_t key)
    {
      if (2 * (keys.size() + 1) > slots.size())
        enlarge();
      const std::size_t mask = slots.size() - 1;
      std::size_t i = hash(key) & mask;
      while (slots[i].key != key && slots[i].key != no_key)
        i = (i + 1) & mask;
      if (slots[i].key == no_key)
      {
        slots[i] = {key, size()};
        keys.push_back(key);
      }
      return slots[i].bin;
    }

  private:
    struct Slot
    {
      std::uint64_t key;
      unsigned int bin;
    };

    static std::size_t hash(const std::uint64_t key)
    {
      return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15u) >> 20);
    }

    void enlarge();

    std::vector<Slot> slots;         ///< their number is zero or a power of two
    std::vector<std::uint64_t> keys; ///< by bin
  };

  /**
   * Finds the candidate neighbours J of particles I: |x_I - x_J| < a_J (1 + skin) on every axis.
   * Supports belong to J, the column.
   *
   * Bins hold the candidates. A bin is as wide as the largest support it may hold; supports that
   * differ by more than a factor of four go into bins of different levels. Only occupied bins
   * exist, found through a hash table, so that neither empty space nor elongated bodies cost
   * anything. Particles go through in groups of one bin: their common candidates are collected and
   * sorted once, then tested against each. Memory is proportional to the particles and neighbours.
   * Buffers are kept: a second search of the same size allocates nothing.
   */
  template <int dim>
  class NeighbourSearch
  {
  public:
    /**
     * @p position and half widths @p support have node_stride doubles a local node. @p rows are the
     * particles to search for, @p columns all that can be neighbours, both ascending and the rows
     * among the columns. Row i of the result are entries row_start[i] ... row_start[i+1]-1 of
     * @p neighbour: local nodes, ascending, the particle itself included.
     */
    void find(const std::vector<unsigned int> &rows, const std::vector<unsigned int> &columns,
              const double *position, const double *support, double skin,
              std::vector<std::size_t> &row_start, std::vector<unsigned int> &neighbour);

  private:
    static constexpr unsigned int n_levels = 8;

    struct Level
    {
      bool occupied;
      double reach[dim];         ///< largest support of the level, skin included
      double inverse_width[dim]; ///< of its bins
      long lowest[dim];          ///< range of occupied bins
      long highest[dim];
    };

    void find_levels(const std::vector<unsigned int> &columns, const double *position,
                     const double *support, double skin);
    unsigned int level_of(const double *support) const;
    void assign_bins(const std::vector<unsigned int> &columns, const double *position,
                     const double *support);
    void sort_columns(const std::vector<unsigned int> &columns, const double *position,
                      const double *support, double skin);
    void sort_rows(const std::vector<unsigned int> &rows);
    /** Of the sorted rows begin ... end-1, which are of one bin; adds to @p n_found. */
    void find_of_group(const std::vector<unsigned int> &rows, const double *position,
                       unsigned int begin, unsigned int end, std::size_t &n_found);
    void collect_candidates(const double *lowest, const double *highest);
    void collect_from_columns(unsigned int begin, unsigned int end, const double *lowest,
                              const double *highest);
    void sort_candidates();

    Level levels[n_levels];
    double origin[dim];
    double inverse_largest[dim]; ///< of the supports

    BinTable bins;
    std::vector<unsigned int> bin_start;   ///< first column of each bin
    std::vector<unsigned int> bin_of_node; ///< by local node
    std::vector<unsigned int> column_bin;  ///< by column

    // Columns in the order of bins, each bin ascending.
    std::vector<unsigned int> sorted_node;
    dealii::AlignedVector<double> sorted_position[dim];
    dealii::AlignedVector<double> sorted_reach[dim];

    std::vector<unsigned int> row_bin_start, sorted_row; ///< rows in the order of bins

    // The candidates of one group of rows.
    unsigned int n_candidates = 0;
    std::vector<unsigned int> candidate;                     ///< positions in the sorted columns
    std::vector<unsigned int> candidate_key, candidate_rank; ///< local node, and its order
    std::vector<std::uint64_t> sort_buffer;
    std::vector<unsigned int> candidate_node;
    dealii::AlignedVector<double> candidate_position[dim];
    dealii::AlignedVector<double> candidate_reach[dim];

    // Results in the order of groups, before they are put into the order of rows.
    std::vector<unsigned int> found;
    std::vector<std::size_t> found_start;
    std::vector<unsigned int> found_count;
  };
} // namespace tombolo
