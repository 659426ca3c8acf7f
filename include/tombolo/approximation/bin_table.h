// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

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
} // namespace tombolo
