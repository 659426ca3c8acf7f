// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/archive_file.h>

#include <deal.II/base/mpi.h>
#include <tombolo/base/file_stream.h>
#include <tombolo/base/hdf5_handle.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace tombolo
{
  namespace
  {
    const char *const checksum_name = "checksum";

    /** Groups keep their links with what else describes them, where a checksum guards them: tables
     * of links on their own make the library free what it never allocated when they are damaged. */
    void keep_links_in_header(const hid_t creation)
    {
      H5Pset_link_phase_change(creation, 65535, 0);
    }

    /** Makes the groups on the way to @p path where they do not exist. */
    bool create_groups(const hid_t file, const std::string &path)
    {
      const Hdf5Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
      keep_links_in_header(creation);
      for (std::size_t slash = path.find('/'); slash != std::string::npos;
           slash = path.find('/', slash + 1))
      {
        const std::string name = path.substr(0, slash);
        if (H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0)
          continue;
        const Hdf5Handle group(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT),
                               H5Gclose);
        if (group < 0)
          return false;
      }
      return true;
    }

    std::uint64_t mix(std::uint64_t bits)
    {
      bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9ull;
      bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBull;
      return bits ^ (bits >> 31);
    }

    /** A sum over elements, so that it can be taken in pieces: bits and index of each. */
    std::uint64_t checksum(const void *const values, const std::size_t n, const std::size_t size,
                           const std::uint64_t first)
    {
      std::uint64_t sum = 0;
      for (std::size_t i = 0; i < n; ++i)
      {
        std::uint64_t bits = 0;
        std::memcpy(&bits, static_cast<const char *>(values) + i * size, size);
        sum += mix(bits + 0x9E3779B97F4A7C15ull * (first + i + 1));
      }
      return sum;
    }

    std::uint64_t sum_of_ranks(const std::uint64_t value, MPI_Comm communicator)
    {
      std::uint64_t sum = 0;
      MPI_Allreduce(&value, &sum, 1, MPI_UINT64_T, MPI_SUM, communicator);
      return sum;
    }

    /** Errors are reported by return values; the library prints stacks otherwise. */
    void silence()
    {
      H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }

    herr_t collect_dataset(hid_t, const char *name, const H5O_info_t *info, void *names)
    {
      if (info->type == H5O_TYPE_DATASET)
        static_cast<std::vector<std::string> *>(names)->push_back(name);
      return 0;
    }

    std::string reason_not_opened(const std::string &file)
    {
      const int descriptor = open(file.c_str(), O_RDONLY);
      if (descriptor < 0)
        return std::string("it cannot be opened: ") + std::strerror(errno) + ".";
      const auto size = lseek(descriptor, 0, SEEK_END);
      close(descriptor);
      return "it is truncated, damaged or no checkpoint (" + std::to_string(size) +
             " bytes that are not a whole HDF5 file).";
    }
  } // namespace

  ArchiveFile::ArchiveFile(const std::string &name, const Mode mode, MPI_Comm communicator)
      : file_name(name), mode(mode), mpi_communicator(communicator)
  {
    silence();
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    if (mode == Mode::write)
    {
      // Not written by all ranks: where one of them fails, the others would wait for it for ever.
      std::string problem;
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
      {
        // The library does not report why it fails.
        const int descriptor = open_new_file(name, problem);
        if (descriptor >= 0)
          ::close(descriptor);
        // The newest format has checksums of its own in what describes the datasets.
        H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
        const Hdf5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
        keep_links_in_header(creation);
        if (problem.empty())
          handle = H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation, access);
        if (handle < 0 && problem.empty())
          problem = "is the disk full?";
      }
      tombolo::throw_on_all_ranks<RunError>(
          problem.empty() ? "" : "The checkpoint " + name + " cannot be created: " + problem + ".",
          communicator);
    }
    else
    {
      handle = H5Fopen(name.c_str(), H5F_ACC_RDONLY, access);
      tombolo::throw_on_all_ranks<DamagedCheckpoint>(
          handle < 0 ? "The checkpoint " + name + " cannot be used: " + reason_not_opened(name)
                     : "",
          communicator);
    }
  }

  ArchiveFile::~ArchiveFile()
  {
    if (handle >= 0)
      H5Fclose(handle);
  }

  void ArchiveFile::close()
  {
    if (handle >= 0 && H5Fclose(handle) < 0 && write_failure.empty())
      write_failure = "the file";
    handle = -1;
    if (mode == Mode::write && Utilities::MPI::this_mpi_process(mpi_communicator) == 0)
    {
      const int descriptor = open(file_name.c_str(), O_RDONLY);
      if ((descriptor < 0 || fsync(descriptor) != 0) && write_failure.empty())
        write_failure = "the file";
      if (descriptor >= 0)
        ::close(descriptor);
    }
    tombolo::throw_on_all_ranks<RunError>(
        write_failure.empty() ? ""
                              : "The checkpoint " + file_name + " cannot be written (" +
                                    write_failure + "). Is the disk full?",
        mpi_communicator);
  }

  void ArchiveFile::fail(const std::string &message) const
  {
    throw InputError("The checkpoint " + file_name + " does not fit: " + message);
  }

  void ArchiveFile::throw_on_all_ranks(const std::string &message) const
  {
    if (const std::string text = first_text(mpi_communicator, message); !text.empty())
      fail(text);
  }

  void ArchiveFile::check_size(const std::string &path, const std::size_t given,
                               const std::size_t expected) const
  {
    if (given != expected)
      fail("\"" + path + "\" has " + std::to_string(given) + " values in it, but " +
           std::to_string(expected) + " in this model.");
  }

  bool ArchiveFile::has(const std::string &path) const
  {
    if (mode == Mode::write)
      return true;
    // All links on the way must exist before the last can be queried.
    for (std::size_t slash = path.find('/'); slash != std::string::npos;
         slash = path.find('/', slash + 1))
      if (H5Lexists(handle, path.substr(0, slash).c_str(), H5P_DEFAULT) <= 0)
        return false;
    return H5Lexists(handle, path.c_str(), H5P_DEFAULT) > 0;
  }

  std::array<std::uint64_t, 2> ArchiveFile::extent(const std::string &path) const
  {
    hsize_t dimensions[2] = {0, 0};
    bool is_found = false;
    {
      const Hdf5Handle dataset(H5Dopen2(handle, path.c_str(), H5P_DEFAULT), H5Dclose);
      if (dataset >= 0)
      {
        const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
        is_found = H5Sget_simple_extent_ndims(space) == 2 &&
                   H5Sget_simple_extent_dims(space, dimensions, nullptr) == 2;
      }
    }
    throw_on_all_ranks(is_found ? ""
                                : "it has no \"" + path + "\"; it is of another model or version.");
    return {{dimensions[0], dimensions[1]}};
  }

  template <typename Value>
  void ArchiveFile::write(const std::string &path, const std::vector<Value> &values,
                          const std::uint64_t n_rows, const std::uint64_t n_columns,
                          const std::uint64_t first_row)
  {
    const std::uint64_t sum =
        sum_of_ranks(checksum(values.data(), values.size(), sizeof(Value), first_row * n_columns),
                     mpi_communicator);
    const unsigned int rank = Utilities::MPI::this_mpi_process(mpi_communicator);
    const std::array<std::uint64_t, 2> own = {{first_row, values.size()}};
    std::vector<std::array<std::uint64_t, 2>> shares(
        rank == 0 ? Utilities::MPI::n_mpi_processes(mpi_communicator) : 0);
    MPI_Gather(own.data(), 2, MPI_UINT64_T, shares.data(), 2, MPI_UINT64_T, 0, mpi_communicator);
    if (rank != 0)
    {
      if (!values.empty())
        MPI_Send(values.data(), 1,
                 *Utilities::MPI::create_mpi_data_type_n_bytes(values.size() * sizeof(Value)), 0, 0,
                 mpi_communicator);
      return;
    }

    const hid_t type = hdf5_type_of(values.data());
    const hsize_t dimensions[2] = {n_rows, n_columns};
    const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
    if (n_rows * n_columns > 0) // the library refuses to write nothing
      H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
    const Hdf5Handle in_file(H5Screate_simple(2, dimensions, nullptr), H5Sclose);
    const bool has_groups = create_groups(handle, path);
    const Hdf5Handle dataset(
        H5Dcreate2(handle, path.c_str(), type, in_file, H5P_DEFAULT, creation, H5P_DEFAULT),
        H5Dclose);
    bool is_written = has_groups && dataset >= 0;
    std::vector<Value> received;
    for (std::size_t from = 0; from < shares.size(); ++from)
    {
      const auto [first_row_of_share, n] = shares[from];
      if (n == 0)
        continue;
      // What is sent is received also where it cannot be written any more.
      received.resize(from == 0 ? 0 : n);
      if (from != 0)
        MPI_Recv(received.data(), 1,
                 *Utilities::MPI::create_mpi_data_type_n_bytes(n * sizeof(Value)),
                 static_cast<int>(from), 0, mpi_communicator, MPI_STATUS_IGNORE);
      const hsize_t start[2] = {first_row_of_share, 0};
      const hsize_t count[2] = {n / n_columns, n_columns};
      const Hdf5Handle in_memory(H5Screate_simple(2, count, nullptr), H5Sclose);
      H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start, nullptr, count, nullptr);
      is_written = is_written && H5Dwrite(dataset, type, in_memory, in_file, H5P_DEFAULT,
                                          from == 0 ? values.data() : received.data()) >= 0;
    }
    const Hdf5Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Handle attribute(
        H5Acreate2(dataset, checksum_name, H5T_NATIVE_UINT64, scalar, H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    is_written = is_written && attribute >= 0 && H5Awrite(attribute, H5T_NATIVE_UINT64, &sum) >= 0;
    if (!is_written && write_failure.empty())
      write_failure = "\"" + path + "\"";
  }

  template <typename Value>
  std::vector<Value> ArchiveFile::read(const std::string &path, const std::uint64_t first_row,
                                       const std::uint64_t n_rows,
                                       const std::uint64_t n_columns) const
  {
    std::vector<Value> values(n_rows * n_columns);
    bool is_read = true, is_of_this_kind = true;
    if (!values.empty())
    {
      const hsize_t start[2] = {first_row, 0}, count[2] = {n_rows, n_columns};
      const Hdf5Handle dataset(H5Dopen2(handle, path.c_str(), H5P_DEFAULT), H5Dclose);
      const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
      is_of_this_kind = H5Tequal(type, hdf5_type_of(values.data())) > 0;
      const Hdf5Handle in_file(H5Dget_space(dataset), H5Sclose);
      const Hdf5Handle in_memory(H5Screate_simple(2, count, nullptr), H5Sclose);
      H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start, nullptr, count, nullptr);
      is_read = H5Dread(dataset, hdf5_type_of(values.data()), in_memory, in_file, H5P_DEFAULT,
                        values.data()) >= 0;
    }
    throw_on_all_ranks(is_of_this_kind ? "" : "\"" + path + "\" holds another kind of numbers.");
    throw_on_all_ranks(is_read ? "" : "\"" + path + "\" cannot be read.");
    return values;
  }

  void ArchiveFile::verify(const std::string &name, MPI_Comm communicator)
  {
    ArchiveFile file(name, Mode::read, communicator);
    std::vector<std::string> tables;
    const auto refuse = [&](const std::string &problem)
    {
      tombolo::throw_on_all_ranks<DamagedCheckpoint>(
          problem.empty() ? "" : "The checkpoint " + name + " is damaged: " + problem,
          communicator);
    };
    std::string problem;
    if (H5Ovisit_by_name(file.handle, "/", H5_INDEX_NAME, H5_ITER_INC, collect_dataset, &tables,
                         H5P_DEFAULT) < 0)
      problem = "its list of fields cannot be read.";
    refuse(problem);
    const std::uint64_t n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    const std::uint64_t rank = Utilities::MPI::this_mpi_process(communicator);
    for (const std::string &table : tables)
    {
      std::uint64_t stored = 0, sum = 0;
      bool is_readable = false;
      const Hdf5Handle dataset(H5Dopen2(file.handle, table.c_str(), H5P_DEFAULT), H5Dclose);
      const Hdf5Handle attribute(H5Aopen(dataset, checksum_name, H5P_DEFAULT), H5Aclose);
      const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
      const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
      hsize_t dimensions[2] = {0, 0};
      if (dataset >= 0 && attribute >= 0 && H5Aread(attribute, H5T_NATIVE_UINT64, &stored) >= 0 &&
          H5Sget_simple_extent_ndims(space) == 2 &&
          H5Sget_simple_extent_dims(space, dimensions, nullptr) == 2 && H5Tget_size(type) <= 8)
      {
        const hsize_t begin = dimensions[0] * rank / n_ranks;
        const hsize_t end = dimensions[0] * (rank + 1) / n_ranks;
        const hsize_t start[2] = {begin, 0}, count[2] = {end - begin, dimensions[1]};
        const std::size_t n = count[0] * count[1];
        std::vector<char> bytes(n * H5Tget_size(type));
        is_readable = true;
        if (n > 0)
        {
          const Hdf5Handle in_memory(H5Screate_simple(2, count, nullptr), H5Sclose);
          H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr);
          is_readable = H5Dread(dataset, type, in_memory, space, H5P_DEFAULT, bytes.data()) >= 0;
        }
        sum = checksum(bytes.data(), n, H5Tget_size(type), begin * dimensions[1]);
      }
      sum = sum_of_ranks(sum, communicator);
      if (!is_readable)
        problem = "its field \"" + table + "\" cannot be read.";
      else if (sum != stored)
        problem = "its field \"" + table + "\" does not have its checksum.";
      refuse(problem);
    }
  }

  template void ArchiveFile::write(const std::string &, const std::vector<double> &, std::uint64_t,
                                   std::uint64_t, std::uint64_t);
  template void ArchiveFile::write(const std::string &, const std::vector<std::uint64_t> &,
                                   std::uint64_t, std::uint64_t, std::uint64_t);
  template void ArchiveFile::write(const std::string &, const std::vector<char> &, std::uint64_t,
                                   std::uint64_t, std::uint64_t);
  template std::vector<double> ArchiveFile::read(const std::string &, std::uint64_t, std::uint64_t,
                                                 std::uint64_t) const;
  template std::vector<std::uint64_t> ArchiveFile::read(const std::string &, std::uint64_t,
                                                        std::uint64_t, std::uint64_t) const;
  template std::vector<char> ArchiveFile::read(const std::string &, std::uint64_t, std::uint64_t,
                                               std::uint64_t) const;
} // namespace tombolo
