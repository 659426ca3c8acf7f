// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/archive_rows.h>

#include <deal.II/base/mpi.h>

#include <unordered_map>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    std::uint64_t sum_before(const std::uint64_t value, MPI_Comm communicator)
    {
      std::uint64_t sum = 0;
      MPI_Exscan(&value, &sum, 1, MPI_UINT64_T, MPI_SUM, communicator);
      return Utilities::MPI::this_mpi_process(communicator) == 0 ? 0 : sum;
    }
  } // namespace

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

    const std::uint64_t n_ranks = Utilities::MPI::n_mpi_processes(file.communicator());
    const std::uint64_t rank = Utilities::MPI::this_mpi_process(file.communicator());
    share_begin = n_rows * rank / n_ranks;
    share_end = n_rows * (rank + 1) / n_ranks;
    find_ranks_of_share(file, path, ids);
  }

  std::size_t ArchiveRows::n_own() const
  {
    return n_own_rows;
  }

  void ArchiveRows::find_ranks_of_share(const ArchiveFile &file, const std::string &path,
                                        const std::vector<std::uint64_t> &ids)
  {
    const MPI_Comm communicator = file.communicator();
    const std::uint64_t n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    const std::vector<std::uint64_t> in_share =
        file.read<std::uint64_t>(path, share_begin, share_end - share_begin, 1);

    // Who has an identifier in the file and who owns it meet at a rank that the identifier names.
    const auto meeting_place = [&](const std::uint64_t id)
    { return static_cast<unsigned int>((id * 0x9E3779B97F4A7C15ull >> 32) % n_ranks); };
    Message of_owners, of_readers;
    for (std::size_t row = 0; row < ids.size(); ++row)
    {
      auto &message = of_owners[meeting_place(ids[row])];
      message.insert(message.end(), {ids[row], row});
    }
    for (std::size_t row = 0; row < in_share.size(); ++row)
    {
      auto &message = of_readers[meeting_place(in_share[row])];
      message.insert(message.end(), {in_share[row], row});
    }
    std::unordered_map<std::uint64_t, std::pair<unsigned int, std::uint64_t>> owner;
    for (const auto &[from, message] : Utilities::MPI::some_to_some(communicator, of_owners))
      for (std::size_t i = 0; i < message.size(); i += 2)
        owner[message[i]] = {from, message[i + 1]};
    Message answers; // row in the share, rank, row there
    std::string problem;
    for (const auto &[from, message] : Utilities::MPI::some_to_some(communicator, of_readers))
      for (std::size_t i = 0; i < message.size(); i += 2)
      {
        const auto found = owner.find(message[i]);
        if (found == owner.end())
          problem = "it is of another model: its \"" + path + "\" has number " +
                    std::to_string(message[i]) + ", which this model has not.";
        else
          answers[from].insert(answers[from].end(),
                               {message[i + 1], found->second.first, found->second.second});
      }
    file.throw_on_all_ranks(problem);
    std::vector<std::pair<unsigned int, std::uint64_t>> destination(in_share.size());
    for (const auto &[from, message] : Utilities::MPI::some_to_some(communicator, answers))
      for (std::size_t i = 0; i < message.size(); i += 3)
        destination[message[i]] = {static_cast<unsigned int>(message[i + 1]), message[i + 2]};
    Message rows_there;
    for (std::size_t row = 0; row < destination.size(); ++row)
    {
      send[destination[row].first].push_back(row);
      rows_there[destination[row].first].push_back(destination[row].second);
    }
    std::size_t n_received = 0;
    receive = Utilities::MPI::some_to_some(communicator, rows_there);
    for (const auto &from : receive)
      n_received += from.second.size();
    file.throw_on_all_ranks(n_received == n_own_rows ? ""
                                                     : "it is of another model: its \"" + path +
                                                           "\" are not those of this model.");
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
    const auto [n_in_file, n_columns] = file.extent(path);
    if (n_in_file != n_rows || n_columns != n_components)
      file.fail("it is of another model: \"" + path + "\" has " + std::to_string(n_in_file) +
                " rows of " + std::to_string(n_columns) + " values in it, but " +
                std::to_string(n_rows) + " rows of " + std::to_string(n_components) +
                " in this model.");
    const std::vector<double> share =
        file.read<double>(path, share_begin, share_end - share_begin, n_components);
    std::map<unsigned int, std::vector<double>> to_send;
    for (const auto &[rank, rows] : send)
      for (const std::uint64_t row : rows)
        for (unsigned int c = 0; c < n_components; ++c)
          to_send[rank].push_back(share[row * n_components + c]);
    values.assign(n_own_rows * n_components, 0.);
    for (const auto &[from, message] : Utilities::MPI::some_to_some(file.communicator(), to_send))
    {
      const std::vector<std::uint64_t> &rows = receive.at(from);
      for (std::size_t k = 0; k < rows.size(); ++k)
        for (unsigned int c = 0; c < n_components; ++c)
          values[rows[k] * n_components + c] = message[k * n_components + c];
    }
  }
} // namespace tombolo
