// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/time_table.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/file_stream.h>
#include <tombolo/base/hdf5_handle.h>
#include <tombolo/base/on_ranks.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <system_error>

namespace tombolo
{
  namespace
  {
    const char *const full_disk = "HDF5 fails. Is the disk full?";

    /** How files of tables are opened. */
    class TablesAccess
    {
    public:
      TablesAccess() : list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose)
      {
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); // errors are reported by return values
        H5Pset_libver_bounds(list, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
#if H5_VERSION_GE(1, 12, 1) || (H5_VERSION_GE(1, 10, 7) && !H5_VERSION_GE(1, 12, 0))
        // A reader of the file must not stop the run.
        H5Pset_file_locking(list, false, true);
#endif
      }

      /** Accepts a file of a run that was killed while it added rows. */
      void allow_open_file()
      {
        const hbool_t yes = true;
        H5Pset(list, "clear_status_flags", &yes);
      }

      operator hid_t() const
      {
        return list;
      }

    private:
      Hdf5Handle list;
    };

    /** Writes a list of texts as an attribute. */
    bool write_texts(const hid_t dataset, const char *const name,
                     const std::vector<std::string> &texts)
    {
      const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
      H5Tset_size(type, H5T_VARIABLE);
      H5Tset_cset(type, H5T_CSET_UTF8);
      const hsize_t n = texts.size();
      const Hdf5Handle space(H5Screate_simple(1, &n, nullptr), H5Sclose);
      const Hdf5Handle attribute(H5Acreate2(dataset, name, type, space, H5P_DEFAULT, H5P_DEFAULT),
                                 H5Aclose);
      std::vector<const char *> begins;
      for (const std::string &text : texts)
        begins.push_back(text.c_str());
      return attribute >= 0 && H5Awrite(attribute, type, begins.data()) >= 0;
    }

    bool create_table(const hid_t file, const std::string &name,
                      const std::vector<Hdf5Table::Column> &columns)
    {
      const hsize_t bytes_of_chunk = 1 << 16;
      const hsize_t n_columns = columns.size(), size[2] = {0, n_columns},
                    largest[2] = {H5S_UNLIMITED, n_columns},
                    chunk[2] = {std::max(hsize_t(1), bytes_of_chunk / (8 * n_columns)), n_columns};
      const double missing = std::numeric_limits<double>::quiet_NaN();
      const Hdf5Handle space(H5Screate_simple(2, size, largest), H5Sclose);
      const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
      H5Pset_chunk(creation, 2, chunk);
      H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &missing);
      const Hdf5Handle dataset(H5Dcreate2(file, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT,
                                          creation, H5P_DEFAULT),
                               H5Dclose);
      std::vector<std::string> names, units;
      for (const Hdf5Table::Column &column : columns)
      {
        names.push_back(column.name);
        units.push_back(column.unit);
      }
      return dataset >= 0 && write_texts(dataset, "columns", names) &&
             write_texts(dataset, "units", units);
    }

    /** Cuts a table to its first rows. Returns what is wrong, or nothing. */
    std::string cut_table(const hid_t file, const std::string &name, const hsize_t n_columns,
                          const hsize_t n_rows)
    {
      const Hdf5Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
      const Hdf5Handle space(dataset < 0 ? -1 : H5Dget_space(dataset), H5Sclose);
      hsize_t size[2] = {0, 0};
      if (space >= 0 && H5Sget_simple_extent_ndims(space) == 2)
        H5Sget_simple_extent_dims(space, size, nullptr);
      if (size[0] < n_rows || size[1] != n_columns)
        return "its table \"" + name + "\" has " + std::to_string(size[0]) + " rows of " +
               std::to_string(size[1]) + " columns, not the " + std::to_string(n_rows) + " of " +
               std::to_string(n_columns) +
               " at the checkpoint: it cannot be continued. Resume into another output directory.";
      size[0] = n_rows;
      return H5Dset_extent(dataset, size) >= 0 ? "" : full_disk;
    }

    /** Changes a copy of a file, or a new one where there is none, which then replaces it.
     * Returns what is wrong, or nothing. */
    std::string replace_tables(const std::string &path,
                               const std::function<std::string(hid_t)> &change)
    {
      namespace fs = std::filesystem;
      const std::string temporary = path + ".tmp";
      const bool is_new = !reason_not_a_file(path).empty();
      std::string problem;
      const int descriptor = open_new_file(temporary, problem);
      if (descriptor < 0)
        return problem;
      ::close(descriptor);
      std::error_code code;
      TablesAccess access;
      if (!is_new)
      {
        fs::copy_file(path, temporary, fs::copy_options::overwrite_existing, code);
        access.allow_open_file();
      }
      if (!code)
      {
        Hdf5Handle file(is_new ? H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access)
                               : H5Fopen(temporary.c_str(), H5F_ACC_RDWR, access),
                        H5Fclose);
        problem = file >= 0 ? change(file)
                  : is_new  ? full_disk
                            : "it is damaged. Resume into another output directory.";
        const bool is_written = file >= 0 && H5Fflush(file, H5F_SCOPE_LOCAL) >= 0;
        if (!(file.close_now() && is_written) && problem.empty())
          problem = full_disk;
        if (problem.empty())
          fs::rename(temporary, path, code);
      }
      if (!problem.empty() || code)
      {
        std::error_code ignored;
        fs::remove(temporary, ignored);
      }
      return code ? code.message() + "." : problem;
    }

    /** Adds rows behind the first ones. Returns what is wrong, or nothing. */
    std::string append_rows(const std::string &path, const std::string &name,
                            const hsize_t first_rows, const hsize_t n_columns,
                            const std::vector<double> &values)
    {
      if (const std::string reason = reason_not_a_file(path); !reason.empty())
        return reason + ".";
      Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, TablesAccess()),
                      H5Fclose);
      if (file < 0)
        return "HDF5 does not open it. Is it in use by another program?";
      const hsize_t start[2] = {first_rows, 0}, count[2] = {values.size() / n_columns, n_columns},
                    size[2] = {first_rows + count[0], n_columns};
      bool is_written = false;
      {
        Hdf5Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
        if (dataset >= 0 && H5Dset_extent(dataset, size) >= 0)
        {
          const Hdf5Handle in_file(H5Dget_space(dataset), H5Sclose);
          const Hdf5Handle in_memory(H5Screate_simple(2, count, nullptr), H5Sclose);
          H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start, nullptr, count, nullptr);
          // Values may wait in memory until then, and closing does not report all failures.
          is_written = H5Dwrite(dataset, H5T_NATIVE_DOUBLE, in_memory, in_file, H5P_DEFAULT,
                                values.data()) >= 0 &&
                       H5Fflush(file, H5F_SCOPE_LOCAL) >= 0;
        }
        is_written = dataset.close_now() && is_written;
      }
      is_written = file.close_now() && is_written;
      return is_written ? "" : full_disk;
    }

    void throw_on_all(const OutputDirectory &directory, const std::string &problem)
    {
      if (!problem.empty())
        throw RunError("Cannot write " + directory.file(Hdf5Table::file_name) + ": " + problem);
    }
  } // namespace

  const char *const Hdf5Table::file_name = "histories.h5";

  void Hdf5Table::begin(const OutputDirectory &directory, const std::vector<Column> &columns,
                        const std::uint64_t first_rows)
  {
    n_columns = columns.size();
    n_written = first_rows;
    const auto change = [&](const hid_t file)
    {
      if (first_rows > 0)
        return cut_table(file, name, n_columns, first_rows);
      if (H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0)
        H5Ldelete(file, name.c_str(), H5P_DEFAULT);
      return std::string(create_table(file, name, columns) ? "" : full_disk);
    };
    throw_on_all(directory,
                 from_first_rank(directory.communicator(), [&]
                                 { return replace_tables(directory.file(file_name), change); }));
  }

  void Hdf5Table::append(const OutputDirectory &directory, const std::vector<double> &values)
  {
    throw_on_all(directory, from_first_rank(directory.communicator(),
                                            [&] {
                                              return append_rows(directory.file(file_name), name,
                                                                 n_written, n_columns, values);
                                            }));
    n_written += values.size() / n_columns;
  }
} // namespace tombolo
