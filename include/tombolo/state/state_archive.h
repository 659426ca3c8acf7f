// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/state/archive_file.h>
#include <tombolo/state/archive_rows.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/tensor.h>

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * A checkpoint: an HDF5 file of named datasets, to be written or to be read. Functions are
   * the same for both directions. What objects keep is listed in their Records, which call these.
   *
   * Values that are the same on all ranks are passed to operator(); rank 0 writes them and all
   * ranks read them. Values of owned nodes, of cells and of particles are rows with a persistent
   * identifier, so that a file does not depend on the number of ranks that wrote it; ghosts are
   * never written. This rank's shares of sums over ranks come back to the same ranks bit by bit,
   * and to rank 0 on another number of ranks.
   *
   * Reading another model throws an InputError that names the dataset, on all ranks. All functions
   * are collective.
   */
  class StateArchive : private ArchiveFile
  {
  public:
    using ArchiveFile::close;
    using ArchiveFile::communicator;
    using ArchiveFile::fail;
    using ArchiveFile::is_reading;
    using ArchiveFile::Mode;
    using ArchiveFile::name;
    using ArchiveFile::verify;

    StateArchive(const std::string &file, const Mode mode, const MPI_Comm communicator)
        : ArchiveFile(file, mode, communicator)
    {}

    /** Goes back to the group that was current before. */
    class Group
    {
    public:
      Group(std::string &prefix, const std::string &added)
          : prefix(prefix), previous_length(prefix.size())
      {
        prefix += added;
      }
      ~Group()
      {
        prefix.resize(previous_length);
      }
      Group(const Group &) = delete;

    private:
      std::string &prefix;
      std::size_t previous_length;
    };

    /** All names belong to the group called @p name within the present one, as long as the result
     * exists. */
    [[nodiscard]] Group group(const std::string &name);

    /** Whether there is a dataset or a group of this name; true when writing. */
    bool has(const std::string &name)
    {
      return ArchiveFile::has(path(name));
    }

    void operator()(const std::string &name, std::vector<double> &values);
    void operator()(const std::string &name, std::vector<std::uint64_t> &values);
    void operator()(const std::string &name, std::string &value);
    void operator()(const std::string &name, std::vector<std::string> &values); ///< lines

    /** A double, a truth value or an unsigned number. */
    template <typename Number, typename = std::enable_if_t<std::is_arithmetic_v<Number>>>
    void operator()(const std::string &name, Number &value)
    {
      static_assert(std::is_unsigned_v<Number> || std::is_same_v<Number, double>);
      using Stored = std::conditional_t<std::is_unsigned_v<Number>, std::uint64_t, double>;
      std::vector<Stored> one(1, value);
      (*this)(name, one);
      check_size(name, one.size(), 1);
      value = static_cast<Number>(one[0]);
    }

    template <std::size_t n>
    void operator()(const std::string &name, std::array<double, n> &values)
    {
      std::vector<double> all(values.begin(), values.end());
      (*this)(name, all);
      check_size(name, all.size(), n);
      std::copy(all.begin(), all.end(), values.begin());
    }

    template <int dim>
    void operator()(const std::string &name, dealii::Tensor<1, dim> &vector)
    {
      std::array<double, dim> components;
      std::copy_n(&vector[0], dim, components.begin());
      (*this)(name, components);
      std::copy_n(components.begin(), dim, &vector[0]);
    }

    /** This rank's shares of sums over all ranks. */
    void sums(const std::string &name, const std::vector<double *> &shares);

    /** The identifiers of the owned nodes, before any nodal field, or RowSources where nodes are
     * made of those of the file. */
    template <typename Rows>
    void set_nodes(const Rows &rows_of_nodes)
    {
      nodes = std::make_unique<ArchiveRows>(static_cast<ArchiveFile &>(*this), path("node"),
                                            rows_of_nodes);
    }

    std::size_t n_owned_nodes() const
    {
      return nodes->n_own();
    }

    /** The partition of vectors without nodes on reading. */
    void set_partition(std::shared_ptr<const NodePartition> nodes_to_read)
    {
      partition = std::move(nodes_to_read);
    }

    /** The first @p n_components of owned nodes; ghosts are updated after reading. */
    void nodal(const std::string &name, unsigned int n_components, NodalVector &vector);

    /** Values at some owned nodes, zero at the others: entry k is at local node nodes[k], where
     * ghosts are left alone. On reading the values are sized as the nodes; those of nodes that the
     * file does not have are zero. With a division(), and the values @p elsewhere at the other
     * nodes, these have the mean of those between which they lie. */
    void nodal(const std::string &name, const std::vector<unsigned int> &nodes,
               std::vector<std::array<double, 3>> &values, const NodalVector *elsewhere = nullptr);

    /** The identifiers of this rank's rows for rows() in the present group. */
    void set_rows(const std::vector<std::uint64_t> &ids);

    /** @p n_components values of each row of the innermost set_rows(), contiguous. On reading the
     * array is sized. */
    void rows(const std::string &name, unsigned int n_components, std::vector<double> &values);

    /** Rows of the present group by identifiers, of which some may be missing. Only on reading. */
    ArchiveLookup find_rows(const std::vector<std::uint64_t> &ids)
    {
      return {*this, path("id"), ids};
    }
    std::vector<double> rows(const ArchiveLookup &lookup, const std::string &name,
                             const unsigned int n_components)
    {
      return lookup.read(*this, path(name), n_components);
    }

    /** The transfer from a mesh that is divided in the run to the next one. */
    struct Division
    {
      Clock clock;
      NodalVector mass; ///< of nodes before (scalar), of a new one the mean of those around
    };
    /** Where the archive is written on one mesh and read on another; else null. */
    Division *division()
    {
      return division_data.get();
    }
    void divide(const Clock &clock)
    {
      division_data = std::make_unique<Division>();
      division_data->clock = clock;
    }

  private:
    std::string path(const std::string &name) const
    {
      return prefix + name;
    }

    void check_size(const std::string &name, const std::size_t given,
                    const std::size_t expected) const
    {
      ArchiveFile::check_size(path(name), given, expected);
    }
    template <typename Value>
    void global(const std::string &name, std::vector<Value> &values);

    std::string prefix; // of the present group, with its slash
    std::unique_ptr<ArchiveRows> nodes, row_set;
    std::shared_ptr<const NodePartition> partition;
    std::unique_ptr<Division> division_data;
  };
} // namespace tombolo
