// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/archive_rows.h>

#include <tombolo/base/on_ranks.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace tombolo
{
  namespace
  {
    std::uint64_t sum_before(const std::uint64_t value, MPI_Comm communicator)
    {
      std::uint64_t sum = 0;
      MPI_Exscan(&value, &sum, 1, MPI_UINT64_T, MPI_SUM, communicator);
      return Utilities::MPI::this_mpi_process(communicator) == 0 ? 0 : sum;
    }

    /** The rank that matches the ranks that read an identifier in the file with those that need it.
     */
    unsigned int meeting_rank(const std::uint64_t id, const std::uint64_t n_ranks)
    {
      return static_cast<unsigned int>((id * 0x9E3779B97F4A7C15ull >> 32) % n_ranks);
    }
  } // namespace

  ArchiveLookup::ArchiveLookup(const ArchiveFile &file, const std::string &path,
                               const std::vector<std::uint64_t> &ids)
      : is_found(ids.size(), false)
  {
    const MPI_Comm communicator = file.communicator();
    const std::uint64_t n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    const std::uint64_t rank = Utilities::MPI::this_mpi_process(communicator);
    const auto [n_rows, n_columns] = file.extent(path);
    file.check_size(path, n_rows * n_columns, n_rows); // one column
    share_begin = n_rows * rank / n_ranks;
    share_end = n_rows * (rank + 1) / n_ranks;
    const std::vector<std::uint64_t> in_share =
        file.read<std::uint64_t>(path, share_begin, share_end - share_begin, 1);

    Message reader_rows, requested_ids, request_indices;
    for (std::size_t row = 0; row < in_share.size(); ++row)
    {
      auto &message = reader_rows[meeting_rank(in_share[row], n_ranks)];
      message.insert(message.end(), {in_share[row], row});
    }
    for (std::size_t k = 0; k < ids.size(); ++k)
    {
      const unsigned int there = meeting_rank(ids[k], n_ranks);
      requested_ids[there].push_back(ids[k]);
      request_indices[there].push_back(k);
    }
    std::unordered_map<std::uint64_t, std::pair<unsigned int, std::uint64_t>> reader;
    for (const auto &[from, message] : exchange_by_rank(std::move(reader_rows), communicator))
      for (std::size_t i = 0; i < message.size(); i += 2)
        reader[message[i]] = {from, message[i + 1]};
    Message answers; // reader and row there, or no rank
    for (const auto &[from, message] : exchange_by_rank(std::move(requested_ids), communicator))
      for (const std::uint64_t id : message)
      {
        const auto found = reader.find(id);
        if (found == reader.end())
          answers[from].insert(answers[from].end(), {n_ranks, 0});
        else
          answers[from].insert(answers[from].end(), {found->second.first, found->second.second});
      }
    Message requests;
    for (const auto &[from, message] : exchange_by_rank(std::move(answers), communicator))
      for (std::size_t i = 0; i < message.size(); i += 2)
      {
        if (message[i] == n_ranks)
          continue;
        const std::uint64_t k = request_indices.at(from)[i / 2];
        is_found[k] = true;
        requests[static_cast<unsigned int>(message[i])].push_back(message[i + 1]);
        receive[static_cast<unsigned int>(message[i])].push_back(k);
      }
    send = exchange_by_rank(std::move(requests), communicator);
    std::vector<bool> is_requested(in_share.size(), false);
    for (const auto &[to, rows] : send)
      for (const std::uint64_t row : rows)
        is_requested[row] = true;
    for (std::size_t row = 0; row < in_share.size(); ++row)
      if (!is_requested[row])
        unwanted = in_share[row];
  }

  std::vector<double> ArchiveLookup::read(const ArchiveFile &file, const std::string &path,
                                          const unsigned int n_components) const
  {
    const auto [n_in_file, n_columns] = file.extent(path);
    file.check_size(path, n_columns, n_components);
    const std::vector<double> share =
        file.read<double>(path, share_begin, share_end - share_begin, n_components);
    std::map<unsigned int, std::vector<double>> to_send;
    for (const auto &[rank, rows] : send)
      for (const std::uint64_t row : rows)
        to_send[rank].insert(to_send[rank].end(), share.data() + row * n_components,
                             share.data() + (row + 1) * n_components);
    std::vector<double> values(is_found.size() * n_components, 0.);
    for (const auto &[from, message] : exchange_by_rank(std::move(to_send), file.communicator()))
    {
      const std::vector<std::uint64_t> &rows = receive.at(from);
      for (std::size_t k = 0; k < rows.size(); ++k)
        for (unsigned int c = 0; c < n_components; ++c)
          values[rows[k] * n_components + c] = message[k * n_components + c];
    }
    return values;
  }

  ArchiveRows::ArchiveRows(const ArchiveFile &file, const std::string &path,
                           const RowSources &sources_of_rows)
      : n_own_rows(sources_of_rows.size())
  {
    std::vector<std::uint64_t> ids;
    for (const auto &row_sources : sources_of_rows)
      for (const RowSource &source : row_sources)
        ids.push_back(source.id);
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    first_source.push_back(0);
    for (const auto &row_sources : sources_of_rows)
    {
      for (const RowSource &source : row_sources)
        sources.emplace_back(std::lower_bound(ids.begin(), ids.end(), source.id) - ids.begin(),
                             source.weight);
      first_source.push_back(sources.size());
    }
    lookup = std::make_unique<ArchiveLookup>(file, path, ids);
    std::string problem;
    for (std::size_t k = 0; k < ids.size(); ++k)
      if (!lookup->has(k))
        problem = "its \"" + path + "\" has not number " + std::to_string(ids[k]) + ".";
    file.throw_on_all_ranks(problem);
  }

  ArchiveRows::ArchiveRows(ArchiveFile &file, const std::string &path,
                           const std::vector<std::uint64_t> &ids)
      : n_own_rows(ids.size()), first_row(sum_before(ids.size(), file.communicator())),
        n_rows(Utilities::MPI::sum(static_cast<unsigned long>(ids.size()), file.communicator()))
  {
    if (!file.is_reading())
    {
      file.write(path, ids, n_rows, 1, first_row);
      return;
    }
    const auto [n_in_file, n_columns] = file.extent(path);
    file.check_size(path, n_in_file * n_columns, n_in_file); // one column
    if (n_in_file != n_rows)
      file.fail("it is of another model: it has " + std::to_string(n_in_file) + " rows of \"" +
                path + "\", this model has " + std::to_string(n_rows) + ".");

    lookup = std::make_unique<ArchiveLookup>(file, path, ids);
    std::string problem;
    if (lookup->unwanted)
      problem = "it is of another model: its \"" + path + "\" has number " +
                std::to_string(*lookup->unwanted) + ", which this model has not.";
    for (std::size_t k = 0; k < ids.size() && problem.empty(); ++k)
      if (!lookup->has(k))
        problem = "it is of another model: its \"" + path + "\" are not those of this model.";
    file.throw_on_all_ranks(problem);
  }

  void ArchiveRows::transfer(ArchiveFile &file, const std::string &path,
                             const unsigned int n_components, std::vector<double> &values) const
  {
    if (!file.is_reading())
    {
      Assert(values.size() == n_own_rows * n_components, ExcInternalError());
      file.write(path, values, n_rows, n_components, first_row);
      return;
    }
    if (!first_source.empty())
    {
      const std::vector<double> found = lookup->read(file, path, n_components);
      values.assign(n_own_rows * n_components, 0.);
      for (std::size_t row = 0; row < n_own_rows; ++row)
        for (std::size_t i = first_source[row]; i < first_source[row + 1]; ++i)
          for (unsigned int c = 0; c < n_components; ++c)
          {
            const double part = sources[i].second * found[sources[i].first * n_components + c];
            double &value = values[row * n_components + c];
            value = i == first_source[row] ? part : value + part; // which keeps all bits of one
          }
      return;
    }
    const auto [n_in_file, n_columns] = file.extent(path);
    if (n_in_file != n_rows || n_columns != n_components)
      file.fail("it is of another model: \"" + path + "\" has " + std::to_string(n_in_file) +
                " rows of " + std::to_string(n_columns) + " values in it, but " +
                std::to_string(n_rows) + " rows of " + std::to_string(n_components) +
                " in this model.");
    values = lookup->read(file, path, n_components);
  }
} // namespace tombolo
