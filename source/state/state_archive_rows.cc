// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <unordered_map>

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

  std::unique_ptr<StateArchive::RowSet>
  StateArchive::make_row_set(const std::string &name, const std::vector<std::uint64_t> &ids)
  {
    auto set = std::make_unique<RowSet>();
    set->n_own = ids.size();
    set->n_rows = Utilities::MPI::sum(static_cast<unsigned long>(ids.size()), mpi_communicator);
    set->first_row = sum_before(ids.size(), mpi_communicator);
    const std::string id_path = path(name);
    if (mode == Mode::write)
    {
      write_block(id_path, ids, set->n_rows, 1, set->first_row);
      return set;
    }
    const auto [n_in_file, n_columns] = extent(id_path);
    check_size(name, n_in_file * n_columns, n_in_file); // one column
    if (n_in_file != set->n_rows)
      fail("it is of another model: it has " + std::to_string(n_in_file) + " rows of \"" + id_path +
           "\", this model has " + std::to_string(set->n_rows) + ".");

    const std::uint64_t n_ranks = Utilities::MPI::n_mpi_processes(mpi_communicator);
    const std::uint64_t rank = Utilities::MPI::this_mpi_process(mpi_communicator);
    set->share_begin = set->n_rows * rank / n_ranks;
    set->share_end = set->n_rows * (rank + 1) / n_ranks;
    const std::vector<std::uint64_t> in_share =
        read_block<std::uint64_t>(id_path, set->share_begin, set->share_end - set->share_begin, 1);

    // Who has an identifier in the file and who owns it meet at a rank that the identifier names.
    using Message = std::map<unsigned int, std::vector<std::uint64_t>>;
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
    for (const auto &[from, message] : Utilities::MPI::some_to_some(mpi_communicator, of_owners))
      for (std::size_t i = 0; i < message.size(); i += 2)
        owner[message[i]] = {from, message[i + 1]};
    Message answers; // row in the share, rank, row there
    std::string problem;
    for (const auto &[from, message] : Utilities::MPI::some_to_some(mpi_communicator, of_readers))
      for (std::size_t i = 0; i < message.size(); i += 2)
      {
        const auto found = owner.find(message[i]);
        if (found == owner.end())
          problem = "it is of another model: its \"" + id_path + "\" has number " +
                    std::to_string(message[i]) + ", which this model has not.";
        else
          answers[from].insert(answers[from].end(),
                               {message[i + 1], found->second.first, found->second.second});
      }
    throw_on_all_ranks(problem);
    std::vector<std::pair<unsigned int, std::uint64_t>> destination(in_share.size());
    for (const auto &[from, message] : Utilities::MPI::some_to_some(mpi_communicator, answers))
      for (std::size_t i = 0; i < message.size(); i += 3)
        destination[message[i]] = {static_cast<unsigned int>(message[i + 1]), message[i + 2]};
    Message rows_there;
    for (std::size_t row = 0; row < destination.size(); ++row)
    {
      set->send[destination[row].first].push_back(row);
      rows_there[destination[row].first].push_back(destination[row].second);
    }
    std::size_t n_received = 0;
    set->receive = Utilities::MPI::some_to_some(mpi_communicator, rows_there);
    for (const auto &from : set->receive)
      n_received += from.second.size();
    throw_on_all_ranks(n_received == set->n_own ? ""
                                                : "it is of another model: its \"" + id_path +
                                                      "\" are not those of this model.");
    return set;
  }

  void StateArchive::transfer(const RowSet &set, const std::string &path,
                              const unsigned int n_components, std::vector<double> &values)
  {
    if (mode == Mode::write)
    {
      Assert(values.size() == set.n_own * n_components, ExcInternalError());
      write_block(path, values, set.n_rows, n_components, set.first_row);
      return;
    }
    const auto [n_rows, n_columns] = extent(path);
    if (n_rows != set.n_rows || n_columns != n_components)
      fail("it is of another model: \"" + path + "\" has " + std::to_string(n_rows) + " rows of " +
           std::to_string(n_columns) + " values in it, but " + std::to_string(set.n_rows) +
           " rows of " + std::to_string(n_components) + " in this model.");
    const std::vector<double> share =
        read_block<double>(path, set.share_begin, set.share_end - set.share_begin, n_components);
    std::map<unsigned int, std::vector<double>> to_send;
    for (const auto &[rank, rows] : set.send)
      for (const std::uint64_t row : rows)
        for (unsigned int c = 0; c < n_components; ++c)
          to_send[rank].push_back(share[row * n_components + c]);
    values.assign(set.n_own * n_components, 0.);
    for (const auto &[from, message] : Utilities::MPI::some_to_some(mpi_communicator, to_send))
    {
      const std::vector<std::uint64_t> &rows = set.receive.at(from);
      for (std::size_t k = 0; k < rows.size(); ++k)
        for (unsigned int c = 0; c < n_components; ++c)
          values[rows[k] * n_components + c] = message[k * n_components + c];
    }
  }

  void StateArchive::set_nodes(const std::vector<std::uint64_t> &ids)
  {
    nodes = make_row_set("node", ids);
  }

  void StateArchive::set_rows(const std::vector<std::uint64_t> &ids)
  {
    row_set = make_row_set("id", ids);
  }

  void StateArchive::rows(const std::string &name, const unsigned int n_components,
                          std::vector<double> &values)
  {
    transfer(*row_set, path(name), n_components, values);
  }

  void StateArchive::nodal(const std::string &name, const unsigned int n_components,
                           NodalVector &vector)
  {
    const unsigned int n_owned = vector.partition()->n_owned();
    std::vector<double> values;
    values.reserve(std::size_t(n_owned) * n_components);
    for (unsigned int i = 0; i < n_owned; ++i)
      values.insert(values.end(), vector.node(i), vector.node(i) + n_components);
    transfer(*nodes, path(name), n_components, values);
    if (mode == Mode::write)
      return;
    for (unsigned int i = 0; i < n_owned; ++i)
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i) * n_components, n_components,
                  vector.node(i));
    vector.update_ghosts();
  }

  void StateArchive::nodal(const std::string &name, const std::vector<unsigned int> &local_nodes,
                           std::vector<std::array<double, 3>> &entries)
  {
    std::vector<double> values(nodes->n_own * 3, 0.);
    if (mode == Mode::read)
      entries.assign(local_nodes.size(), {});
    // Nothing may have been remembered yet.
    const std::size_t n = std::min(local_nodes.size(), entries.size());
    const auto place = [&](const std::size_t k)
    { return values.begin() + static_cast<std::ptrdiff_t>(local_nodes[k]) * 3; };
    for (std::size_t k = 0; k < n; ++k)
      if (local_nodes[k] < nodes->n_own)
        std::copy_n(entries[k].begin(), 3, place(k));
    transfer(*nodes, path(name), 3, values);
    for (std::size_t k = 0; k < n; ++k)
      if (local_nodes[k] < nodes->n_own)
        std::copy_n(place(k), 3, entries[k].begin());
  }
} // namespace tombolo
