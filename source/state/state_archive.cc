// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <boost/algorithm/string/replace.hpp>

namespace tombolo
{
  StateArchive::Group StateArchive::group(const std::string &name)
  {
    return {prefix, boost::replace_all_copy(name, "/", "_") + "/"};
  }

  template <typename Value>
  void StateArchive::global(const std::string &name, std::vector<Value> &values)
  {
    if (!is_reading())
    {
      const std::uint64_t n = values.size();
      write(path(name),
            Utilities::MPI::this_mpi_process(communicator()) == 0 ? values : std::vector<Value>(),
            n, 1, 0);
    }
    else
    {
      const auto [n_rows, n_columns] = extent(path(name));
      check_size(name, n_rows * n_columns, n_rows); // one column
      values = read<Value>(path(name), 0, n_rows, 1);
    }
  }

  void StateArchive::operator()(const std::string &name, std::vector<double> &values)
  {
    global(name, values);
  }

  void StateArchive::operator()(const std::string &name, std::vector<std::uint64_t> &values)
  {
    global(name, values);
  }

  void StateArchive::operator()(const std::string &name, std::string &value)
  {
    // One end mark, so that a text that was cut or has more behind it is known.
    std::vector<char> text(value.begin(), value.end());
    text.push_back('\0');
    global(name, text);
    if (text.empty() || std::find(text.begin(), text.end(), '\0') != text.end() - 1)
      fail("\"" + path(name) + "\" is not a whole text.");
    value.assign(text.begin(), text.end() - 1);
  }

  void StateArchive::operator()(const std::string &name, std::vector<std::string> &values)
  {
    std::string text;
    for (const std::string &value : values)
      text += value + "\n";
    (*this)(name, text);
    values.clear();
    for (std::size_t begin = 0, end; (end = text.find('\n', begin)) != std::string::npos;
         begin = end + 1)
      values.push_back(text.substr(begin, end - begin));
  }

  void StateArchive::sums(const std::string &name, const std::vector<double *> &shares)
  {
    const unsigned int rank = Utilities::MPI::this_mpi_process(communicator());
    const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(communicator());
    // The number of rows is that of the ranks that wrote; each row begins with it.
    const std::size_t n = shares.size() + 1;
    if (!is_reading())
    {
      std::vector<double> values{static_cast<double>(n_ranks)};
      for (const double *const share : shares)
        values.push_back(*share);
      write(path(name), values, n_ranks, n, rank);
      return;
    }
    const auto [n_writers, n_values] = extent(path(name));
    check_size(name, n_values, n);
    if (n_writers == 0)
      fail("\"" + path(name) + "\" has no rows.");
    const std::vector<double> all = read<double>(path(name), 0, n_writers, n);
    for (std::size_t writer = 0; writer < n_writers; ++writer)
      if (all[writer * n] != static_cast<double>(n_writers))
        fail("\"" + path(name) + "\" has the rows of another number of ranks.");
    for (std::size_t k = 1; k < n; ++k)
    {
      double &share = *shares[k - 1];
      share = 0;
      if (n_writers == n_ranks)
        share = all[rank * n + k];
      else if (rank == 0)
        for (std::size_t writer = 0; writer < n_writers; ++writer)
          share += all[writer * n + k];
    }
  }

  void StateArchive::set_rows(const std::vector<std::uint64_t> &ids)
  {
    row_set = std::make_unique<ArchiveRows>(static_cast<ArchiveFile &>(*this), path("id"), ids);
  }

  void StateArchive::rows(const std::string &name, const unsigned int n_components,
                          std::vector<double> &values)
  {
    row_set->transfer(*this, path(name), n_components, values);
  }

  void StateArchive::nodal(const std::string &name, const unsigned int n_components,
                           NodalVector &vector)
  {
    if (vector.partition() == nullptr)
      vector.reinit(partition, n_components == 1 ? Quantity::scalar : Quantity::vector);
    const unsigned int n_owned = vector.partition()->n_owned();
    std::vector<double> values;
    values.reserve(std::size_t(n_owned) * n_components);
    for (unsigned int i = 0; i < n_owned; ++i)
      values.insert(values.end(), vector.node(i), vector.node(i) + n_components);
    nodes->transfer(*this, path(name), n_components, values);
    if (!is_reading())
      return;
    for (unsigned int i = 0; i < n_owned; ++i)
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i) * n_components, n_components,
                  vector.node(i));
    vector.update_ghosts();
  }

  void StateArchive::nodal(const std::string &name, const std::vector<unsigned int> &local_nodes,
                           std::vector<std::array<double, 3>> &entries,
                           const NodalVector *const elsewhere)
  {
    std::vector<double> values(nodes->n_own() * 3, 0.);
    const bool is_field = elsewhere != nullptr && division_data != nullptr;
    for (unsigned int i = 0; is_field && i < nodes->n_own(); ++i)
      std::copy_n(elsewhere->node(i), 3, values.begin() + 3 * static_cast<std::ptrdiff_t>(i));
    if (is_reading())
      entries.assign(local_nodes.size(), {});
    // Nothing may have been stored yet.
    const std::size_t n = std::min(local_nodes.size(), entries.size());
    const auto node_values = [&](const std::size_t k)
    { return values.begin() + static_cast<std::ptrdiff_t>(local_nodes[k]) * 3; };
    for (std::size_t k = 0; k < n; ++k)
      if (local_nodes[k] < nodes->n_own())
        std::copy_n(entries[k].begin(), 3, node_values(k));
    nodes->transfer(*this, path(name), 3, values);
    for (std::size_t k = 0; k < n; ++k)
      if (local_nodes[k] < nodes->n_own() && (is_field || nodes->is_of_file(local_nodes[k])))
        std::copy_n(node_values(k), 3, entries[k].begin());
  }
} // namespace tombolo
