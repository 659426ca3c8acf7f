// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/selected_lanes.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/aligned_vector.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tombolo
{
  /** Numbers occupied bins 0, 1, ... by their keys, by open addressing. clear() keeps memory. */
  class BinTable
  {
  public:
    static constexpr unsigned int no_bin = std::numeric_limits<unsigned int>::max();
    static constexpr std::uint64_t no_key = std::numeric_limits<std::uint64_t>::max();

    void clear()
    {
      keys.clear();
      std::fill(slots.begin(), slots.end(), Slot{no_key, no_bin});
    }

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

    void enlarge()
    {
      slots.assign(std::max<std::size_t>(2 * slots.size(), 1024), {no_key, no_bin});
      const std::size_t mask = slots.size() - 1;
      for (unsigned int bin = 0; bin < keys.size(); ++bin)
      {
        std::size_t i = hash(keys[bin]) & mask;
        while (slots[i].key != no_key)
          i = (i + 1) & mask;
        slots[i] = {keys[bin], bin};
      }
    }

    std::vector<Slot> slots;         ///< their number is zero or a power of two
    std::vector<std::uint64_t> keys; ///< by bin
  };

  /**
   * Finds the candidate neighbours J of particles I: |x_I - x_J| < a_J (1 + skin) on every axis.
   * Supports belong to J, the column.
   *
   * Bins hold the candidates; supports that differ by more than a factor of four go into bins of
   * different levels. Only occupied bins exist: memory is proportional to the particles and
   * neighbours. Buffers are kept: a second search of the same size allocates nothing.
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
              const double *const position, const double *const support, const double skin,
              std::vector<std::size_t> &row_start, std::vector<unsigned int> &neighbour)
    {
      Assert(std::is_sorted(rows.begin(), rows.end()), dealii::ExcInternalError());
      Assert(std::is_sorted(columns.begin(), columns.end()), dealii::ExcInternalError());
      Assert(std::includes(columns.begin(), columns.end(), rows.begin(), rows.end()),
             dealii::ExcInternalError());
      find_levels(columns, position, support, skin);
      assign_bins(columns, position, support);
      sort_columns(columns, position, support, skin);
      sort_rows(rows);

      found_start.resize(rows.size());
      found_count.resize(rows.size());
      std::size_t n_found = 0;
      unsigned int bin_begin = 0;
      for (std::size_t b = 0; b < bins.size(); ++b)
      {
        const unsigned int bin_end = row_bin_start[b];
        for (unsigned int begin = bin_begin; begin < bin_end; begin += group_size)
          find_of_group(rows, position, begin, std::min(begin + group_size, bin_end), n_found);
        bin_begin = bin_end;
      }

      row_start.resize(rows.size() + 1);
      row_start[0] = 0;
      for (std::size_t i = 0; i < rows.size(); ++i)
        row_start[i + 1] = row_start[i] + found_count[i];
      neighbour.resize(n_found);
      for (std::size_t i = 0; i < rows.size(); ++i)
        std::copy_n(found.data() + found_start[i], found_count[i], neighbour.data() + row_start[i]);
    }

  private:
    /** Bins along one axis: distant ones beyond share a number, which only adds candidates. */
    static constexpr double n_bins_per_axis = 1 << 20;

    /** Rows that share one list of candidates. */
    static constexpr unsigned int group_size = 16;

    static long bin_coordinate(const double x, const double origin, const double inverse_width)
    {
      const double t = (x - origin) * inverse_width;
      return t > 0. ? static_cast<long>(std::min(t, n_bins_per_axis - 1.)) : 0;
    }

    static std::uint64_t bin_key_of(const unsigned int level, const long x, const long y,
                                    const long z)
    {
      return (std::uint64_t(level) << 60) | (std::uint64_t(z) << 40) | (std::uint64_t(y) << 20) |
             std::uint64_t(x);
    }

    template <typename Vector>
    static void grow(Vector &vector, const std::size_t size)
    {
      if (vector.size() < size)
        vector.resize(size + size / 4);
    }

    /** Entries of @p node, n of them in whole Lanes, whose supports reach @p x: appended at @p out.
     * Returns their number. */
    static inline unsigned int append_reaching(const double *const x,
                                               const dealii::AlignedVector<double> (&position)[dim],
                                               const dealii::AlignedVector<double> (&reach)[dim],
                                               const unsigned int *const node, const unsigned int n,
                                               unsigned int *const out)
    {
      const double *candidate_x[dim], *candidate_a[dim];
      Lanes center[dim];
      for (unsigned int d = 0; d < dim; ++d)
      {
        candidate_x[d] = position[d].data();
        candidate_a[d] = reach[d].data();
        center[d] = x[d];
      }
      unsigned int count = 0;
      for (unsigned int j = 0; j < n; j += n_lanes)
      {
        LaneMask reaches(true);
        for (unsigned int d = 0; d < dim; ++d)
        {
          const Lanes difference = center[d] - load_lanes(candidate_x[d] + j);
          const Lanes limit = load_lanes(candidate_a[d] + j);
          reaches &= (difference < limit) & (-difference < limit);
        }
        SelectedLanes(reaches, n - j).append(node + j, out, count);
      }
      return count;
    }

    static constexpr unsigned int n_levels = 8;

    struct Level
    {
      bool occupied;
      double reach[dim];         ///< largest support of the level, skin included
      double inverse_width[dim]; ///< of its bins
      long lowest[dim];          ///< range of occupied bins
      long highest[dim];
    };

    void find_levels(const std::vector<unsigned int> &columns, const double *const position,
                     const double *const support, const double skin)
    {
      double largest[dim] = {};
      for (unsigned int d = 0; d < dim; ++d)
        origin[d] = std::numeric_limits<double>::max();
      for (const unsigned int node : columns)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const std::size_t slot = std::size_t(node) * node_stride + d;
          largest[d] = std::max(largest[d], support[slot]);
          origin[d] = std::min(origin[d], position[slot]);
        }
      for (unsigned int l = 0; l < n_levels; ++l)
      {
        Level &level = levels[l];
        level.occupied = false;
        for (unsigned int d = 0; d < dim; ++d)
        {
          level.reach[d] = largest[d] * (1. + skin) * std::pow(0.25, l);
          level.inverse_width[d] = 1. / level.reach[d];
          level.lowest[d] = std::numeric_limits<long>::max();
          level.highest[d] = 0;
        }
      }
      for (unsigned int d = 0; d < dim; ++d)
        inverse_largest[d] = 1. / largest[d];
    }
    unsigned int level_of(const double *const support) const
    {
      double ratio = 0;
      for (unsigned int d = 0; d < dim; ++d)
        ratio = std::max(ratio, support[d] * inverse_largest[d]);
      unsigned int l = 0;
      for (double limit = 0.25; l + 1 < n_levels && ratio < 0.999 * limit; limit *= 0.25)
        ++l;
      return l;
    }
    void assign_bins(const std::vector<unsigned int> &columns, const double *const position,
                     const double *const support)
    {
      bins.clear();
      column_bin.resize(columns.size());
      grow(bin_of_node, columns.empty() ? 0 : columns.back() + std::size_t(1));
      std::uint64_t last_key = BinTable::no_key;
      unsigned int bin = BinTable::no_bin;
      for (std::size_t c = 0; c < columns.size(); ++c)
      {
        const double *const x = position + std::size_t(columns[c]) * node_stride;
        const unsigned int l = level_of(support + std::size_t(columns[c]) * node_stride);
        Level &level = levels[l];
        level.occupied = true;
        long coordinates[3] = {};
        for (unsigned int d = 0; d < dim; ++d)
        {
          coordinates[d] = bin_coordinate(x[d], origin[d], level.inverse_width[d]);
          level.lowest[d] = std::min(level.lowest[d], coordinates[d]);
          level.highest[d] = std::max(level.highest[d], coordinates[d]);
        }
        const std::uint64_t key = bin_key_of(l, coordinates[0], coordinates[1], coordinates[2]);
        if (key != last_key)
        {
          bin = bins.find_or_add(key);
          last_key = key;
        }
        column_bin[c] = bin_of_node[columns[c]] = bin;
      }
    }
    void sort_columns(const std::vector<unsigned int> &columns, const double *const position,
                      const double *const support, const double skin)
    {
      // A counting sort keeps the columns of a bin ascending.
      bin_start.assign(bins.size() + std::size_t(1), 0);
      for (const unsigned int b : column_bin)
        ++bin_start[b + 1];
      for (std::size_t b = 0; b < bins.size(); ++b)
        bin_start[b + 1] += bin_start[b];
      // Whole Lanes are read beyond the end of a bin.
      grow(sorted_node, columns.size());
      for (unsigned int d = 0; d < dim; ++d)
      {
        grow(sorted_position[d], columns.size() + n_lanes);
        grow(sorted_reach[d], columns.size() + n_lanes);
      }
      for (std::size_t c = 0; c < columns.size(); ++c)
      {
        const unsigned int index = bin_start[column_bin[c]]++;
        sorted_node[index] = columns[c];
        for (unsigned int d = 0; d < dim; ++d)
        {
          const std::size_t slot = std::size_t(columns[c]) * node_stride + d;
          sorted_position[d][index] = position[slot];
          sorted_reach[d][index] = support[slot] * (1. + skin);
        }
      }
      for (std::size_t b = bins.size(); b > 0; --b)
        bin_start[b] = bin_start[b - 1];
      bin_start[0] = 0;
    }
    void sort_rows(const std::vector<unsigned int> &rows)
    {
      row_bin_start.assign(bins.size() + std::size_t(1), 0);
      for (const unsigned int node : rows)
        ++row_bin_start[bin_of_node[node] + 1];
      for (std::size_t b = 0; b < bins.size(); ++b)
        row_bin_start[b + 1] += row_bin_start[b];
      sorted_row.resize(rows.size());
      for (unsigned int i = 0; i < rows.size(); ++i)
        sorted_row[row_bin_start[bin_of_node[rows[i]]]++] = i;
    }
    /** Of the sorted rows begin ... end-1, which are of one bin; adds to @p n_found. */
    void find_of_group(const std::vector<unsigned int> &rows, const double *const position,
                       const unsigned int begin, const unsigned int end, std::size_t &n_found)
    {
      double lowest[dim], highest[dim];
      for (unsigned int d = 0; d < dim; ++d)
      {
        lowest[d] = std::numeric_limits<double>::max();
        highest[d] = std::numeric_limits<double>::lowest();
      }
      for (unsigned int i = begin; i < end; ++i)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double x = position[std::size_t(rows[sorted_row[i]]) * node_stride + d];
          lowest[d] = std::min(lowest[d], x);
          highest[d] = std::max(highest[d], x);
        }
      collect_candidates(lowest, highest);
      grow(found, n_found + std::size_t(end - begin) * n_candidates + n_lanes);
      for (unsigned int i = begin; i < end; ++i)
      {
        const unsigned int row = sorted_row[i];
        const double *const x = position + std::size_t(rows[row]) * node_stride;
        const unsigned int count =
            append_reaching(x, candidate_position, candidate_reach, candidate_node.data(),
                            n_candidates, found.data() + n_found);
        found_start[row] = n_found;
        found_count[row] = count;
        n_found += count;
      }
    }
    void collect_candidates(const double *const lowest, const double *const highest)
    {
      // A bin more for rounding: the position of a bin is found from differences and products.
      constexpr double margin = 1e-6;
      n_candidates = 0;
      for (unsigned int l = 0; l < n_levels; ++l)
      {
        const Level &level = levels[l];
        if (!level.occupied)
          continue;
        long begin[3] = {}, end[3] = {};
        double n_bins = 1;
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double reach = (1. + margin) * level.reach[d];
          begin[d] = std::max(level.lowest[d],
                              bin_coordinate(lowest[d] - reach, origin[d], level.inverse_width[d]));
          end[d] = std::min(level.highest[d],
                            bin_coordinate(highest[d] + reach, origin[d], level.inverse_width[d]));
          n_bins *= static_cast<double>(std::max(end[d] - begin[d] + 1, 0l));
        }
        if (n_bins > static_cast<double>(bins.size()))
        {
          for (unsigned int bin = 0; bin < bins.size(); ++bin)
            if (bins.key(bin) >> 60 == l)
              collect_from_columns(bin_start[bin], bin_start[bin + 1], lowest, highest);
          continue;
        }
        for (long z = begin[2]; z <= end[2]; ++z)
          for (long y = begin[1]; y <= end[1]; ++y)
            for (long x = begin[0]; x <= end[0]; ++x)
            {
              std::uint64_t key = bin_key_of(l, x, y, z);
              const unsigned int first = bins.find(key);
              if (first == BinTable::no_bin)
                continue;
              // Bins that follow each other along x often do so in memory.
              unsigned int last = first;
              while (x < end[0] && last + 1 < bins.size() && bins.key(last + 1) == key + 1)
              {
                ++last;
                ++key;
                ++x;
              }
              collect_from_columns(bin_start[first], bin_start[last + 1], lowest, highest);
            }
      }
      sort_candidates();
    }
    void collect_from_columns(const unsigned int begin, const unsigned int end,
                              const double *const lowest, const double *const highest)
    {
      const unsigned int n = end - begin;
      grow(candidate, n_candidates + n + n_lanes);
      const double *x[dim], *reach[dim];
      Lanes low[dim], high[dim];
      for (unsigned int d = 0; d < dim; ++d)
      {
        x[d] = &sorted_position[d][begin];
        reach[d] = &sorted_reach[d][begin];
        low[d] = lowest[d];
        high[d] = highest[d];
      }
      unsigned int *const out = candidate.data();
      unsigned int count = n_candidates;
      for (unsigned int i = 0; i < n; i += n_lanes)
      {
        LaneMask near(true);
        for (unsigned int d = 0; d < dim; ++d)
        {
          const Lanes position = load_lanes(x[d] + i), limit = load_lanes(reach[d] + i);
          near &= (low[d] - position < limit) & (position - high[d] < limit);
        }
        unsigned int index[n_lanes];
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          index[lane] = begin + i + lane;
        SelectedLanes(near, n - i).append(index, out, count);
      }
      n_candidates = count;
    }
    void sort_candidates()
    {
      using Keys = std::experimental::native_simd<unsigned int>;
      grow(candidate_key, n_candidates + Keys::size());
      grow(candidate_rank, n_candidates + Keys::size());
      grow(candidate_node, n_candidates + n_lanes);
      grow(sort_buffer, n_candidates);
      for (unsigned int d = 0; d < dim; ++d)
      {
        grow(candidate_position[d], n_candidates + n_lanes);
        grow(candidate_reach[d], n_candidates + n_lanes);
      }
      const unsigned int n = n_candidates;
      unsigned int *const key = candidate_key.data();
      unsigned int *const rank = candidate_rank.data();
      bool is_sorted = true;
      for (unsigned int i = 0; i < n; ++i)
      {
        key[i] = sorted_node[candidate[i]];
        is_sorted &= i == 0 || key[i - 1] < key[i];
      }
      // Counting the smaller keys takes n² / 16 instructions, without the mispredicted branches of
      // a sort.
      constexpr unsigned int largest_counted = 192;
      if (is_sorted)
        for (unsigned int i = 0; i < n; ++i)
          rank[i] = i;
      else if (n <= largest_counted)
      {
        // Whole vectors; the padding counts for nothing.
        constexpr unsigned int width = Keys::size();
        std::fill_n(key + n, width, std::numeric_limits<unsigned int>::max());
        for (unsigned int i = 0; i < n; i += width)
        {
          const Keys keys(key + i, std::experimental::element_aligned);
          Keys smaller = 0u;
          for (unsigned int j = 0; j < n; ++j)
            ++where(Keys(key[j]) < keys, smaller);
          smaller.copy_to(rank + i, std::experimental::element_aligned);
        }
      }
      else
      {
        for (unsigned int i = 0; i < n; ++i)
          sort_buffer[i] = (std::uint64_t(key[i]) << 32) | i;
        std::sort(sort_buffer.begin(), sort_buffer.begin() + n);
        for (unsigned int i = 0; i < n; ++i)
          rank[static_cast<unsigned int>(sort_buffer[i])] = i;
      }
      for (unsigned int i = 0; i < n; ++i)
        candidate_node[rank[i]] = key[i];
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double *const from_position = sorted_position[d].data();
        const double *const from_reach = sorted_reach[d].data();
        double *const position = candidate_position[d].data();
        double *const reach = candidate_reach[d].data();
        for (unsigned int i = 0; i < n; ++i)
        {
          position[rank[i]] = from_position[candidate[i]];
          reach[rank[i]] = from_reach[candidate[i]];
        }
      }
    }

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

    // Results in the order of groups, before they are sorted into the order of rows.
    std::vector<unsigned int> found;
    std::vector<std::size_t> found_start;
    std::vector<unsigned int> found_count;
  };

  extern template class NeighbourSearch<2>;
  extern template class NeighbourSearch<3>;
} // namespace tombolo
