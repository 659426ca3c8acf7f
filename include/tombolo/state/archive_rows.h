// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/archive_file.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /** A row of a table from which this rank makes one of its own, by its identifier. */
  struct RowSource
  {
    std::uint64_t id;
    double weight;
  };

  /** Of each row of this rank the rows that it is the weighted sum of. */
  using RowSources = std::vector<std::vector<RowSource>>;

  /**
   * Rows of tables in a file that is read, by identifiers: any of them, on any rank and on several,
   * and such that are missing. Each rank reads equal shares of a table and sends what is requested
   * of it.
   */
  class ArchiveLookup
  {
  public:
    /** @p ids are those that this rank requests, each once; @p path is the table of those in the
     * file. Collective. */
    ArchiveLookup(const ArchiveFile &file, const std::string &path,
                  const std::vector<std::uint64_t> &ids);

    /** Whether the file has the identifier number @p k of this rank. */
    bool has(std::size_t k) const
    {
      return is_found[k];
    }

    /** The @p n_components values of each requested row, zero where it is missing. Collective. */
    std::vector<double> read(const ArchiveFile &file, const std::string &path,
                             unsigned int n_components) const;

    /** An identifier of the file, in the share of this rank, that no rank requests. */
    std::optional<std::uint64_t> unwanted;

  private:
    using Message = std::map<unsigned int, std::vector<std::uint64_t>>; // by rank

    std::uint64_t share_begin = 0, share_end = 0;
    std::vector<bool> is_found;
    Message send;    // rows of the share, by rank
    Message receive; // requested ones, by the rank that reads them
  };

  /**
   * Rows of this rank with persistent identifiers, and where they are in a file: tables with a row
   * for each are written and read independently of the number of ranks.
   */
  class ArchiveRows
  {
  public:
    /** Writes the identifiers of this rank's rows to a table, or finds them there. Throws the
     * InputError that they are others. Collective. */
    ArchiveRows(ArchiveFile &file, const std::string &path, const std::vector<std::uint64_t> &ids);

    /** Rows that are made of those of a file. Throws the InputError that one is missing.
     * Collective. */
    ArchiveRows(const ArchiveFile &file, const std::string &path, const RowSources &sources);

    /** Whether row @p k of this rank is one of the file. */
    bool is_of_file(const std::size_t k) const
    {
      return first_source.empty() || first_source[k + 1] - first_source[k] == 1;
    }

    /** The number of rows of this rank. */
    std::size_t n_own() const
    {
      return n_own_rows;
    }

    /** Writes or reads @p n_components values of each row, contiguous. On reading the array is
     * sized. Collective. */
    void transfer(ArchiveFile &file, const std::string &path, unsigned int n_components,
                  std::vector<double> &values) const;

  private:
    std::size_t n_own_rows = 0;
    std::uint64_t first_row = 0;
    std::uint64_t n_rows = 0;

    std::unique_ptr<ArchiveLookup> lookup; // for reading
    // For rows that are made of others: number k of the lookup and its weight.
    std::vector<std::size_t> first_source;
    std::vector<std::pair<std::size_t, double>> sources;
  };
} // namespace tombolo
