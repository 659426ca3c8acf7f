// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/archive_file.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Rows of this rank with persistent identifiers, and where they are in a file: tables with a row
   * for each are written and read independently of the number of ranks. For reading, each rank
   * reads equal shares of a table and sends its rows to their ranks.
   */
  class ArchiveRows
  {
  public:
    /** Writes the identifiers of this rank's rows to a table, or finds them there. Throws the
     * InputError that they are others. Collective. */
    ArchiveRows(ArchiveFile &file, const std::string &path, const std::vector<std::uint64_t> &ids);

    /** The number of rows of this rank. */
    std::size_t n_own() const;

    /** Writes or reads @p n_components values of each row, contiguous. On reading the array is
     * sized. Collective. */
    void transfer(ArchiveFile &file, const std::string &path, unsigned int n_components,
                  std::vector<double> &values) const;

  private:
    using Message = std::map<unsigned int, std::vector<std::uint64_t>>; // by rank

    /** Which rank owns each row of the share, and which rows come from which rank. Collective. */
    void find_ranks_of_share(const ArchiveFile &file, const std::string &path,
                             const std::vector<std::uint64_t> &ids);

    std::size_t n_own_rows = 0;
    std::uint64_t first_row = 0;
    std::uint64_t n_rows = 0;

    // For reading.
    std::uint64_t share_begin = 0, share_end = 0;
    Message send;    // rows of the share, by rank
    Message receive; // own rows, by rank they are from
  };
} // namespace tombolo
