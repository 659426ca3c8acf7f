// SPDX-License-Identifier: LGPL-2.1-or-later
/* Changes the fields of a checkpoint as a file of another version would have them: with the right
 * checksums. faults.py uses it.
 *
 *   edit_checkpoint FILE list               name, offset and bytes of each field, separated by tabs
 *   edit_checkpoint FILE remove NAME
 *   edit_checkpoint FILE resize NAME ROWS COLUMNS   rows and columns more, or fewer (negative)
 *   edit_checkpoint FILE retype NAME        numbers become numbers of another kind
 */
#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <string>
#include <vector>

namespace
{
  struct Field
  {
    std::string name;
    hid_t type = -1;
    hsize_t rows = 0, columns = 0, bytes = 0;
    haddr_t offset = 0;
    std::vector<char> values;
  };

  void fail(const std::string &what)
  {
    std::cerr << "edit_checkpoint: " << what << std::endl;
    std::exit(1);
  }

  Field read(const hid_t file, const std::string &name)
  {
    Field field;
    field.name = name;
    const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
    if (dataset < 0)
      fail("there is no field " + name);
    const hid_t space = H5Dget_space(dataset);
    hsize_t dimensions[2] = {0, 0};
    if (H5Sget_simple_extent_ndims(space) != 2)
      fail(name + " has no rows and columns");
    H5Sget_simple_extent_dims(space, dimensions, nullptr);
    field.type = H5Dget_type(dataset);
    field.rows = dimensions[0];
    field.columns = dimensions[1];
    field.offset = H5Dget_offset(dataset);
    field.bytes = H5Dget_storage_size(dataset);
    field.values.resize(field.rows * field.columns * H5Tget_size(field.type));
    if (!field.values.empty() &&
        H5Dread(dataset, field.type, H5S_ALL, H5S_ALL, H5P_DEFAULT, field.values.data()) < 0)
      fail(name + " cannot be read");
    H5Sclose(space);
    H5Dclose(dataset);
    return field;
  }

  std::uint64_t mix(std::uint64_t bits)
  {
    bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9ull;
    bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBull;
    return bits ^ (bits >> 31);
  }

  /** As StateArchive sums it. */
  std::uint64_t checksum(const Field &field)
  {
    const std::size_t size = H5Tget_size(field.type);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < field.rows * field.columns; ++i)
    {
      std::uint64_t bits = 0;
      std::memcpy(&bits, field.values.data() + i * size, size);
      sum += mix(bits + 0x9E3779B97F4A7C15ull * (i + 1));
    }
    return sum;
  }

  void write(const hid_t file, const Field &field)
  {
    const hsize_t dimensions[2] = {field.rows, field.columns};
    const hid_t space = H5Screate_simple(2, dimensions, nullptr);
    const hid_t dataset = H5Dcreate2(file, field.name.c_str(), field.type, space, H5P_DEFAULT,
                                     H5P_DEFAULT, H5P_DEFAULT);
    const hid_t scalar = H5Screate(H5S_SCALAR);
    const hid_t attribute =
        H5Acreate2(dataset, "checksum", H5T_NATIVE_UINT64, scalar, H5P_DEFAULT, H5P_DEFAULT);
    const std::uint64_t sum = checksum(field);
    if ((field.rows * field.columns > 0 &&
         H5Dwrite(dataset, field.type, H5S_ALL, H5S_ALL, H5P_DEFAULT, field.values.data()) < 0) ||
        H5Awrite(attribute, H5T_NATIVE_UINT64, &sum) < 0)
      fail(field.name + " cannot be written");
    H5Aclose(attribute);
    H5Sclose(scalar);
    H5Dclose(dataset);
    H5Sclose(space);
  }

  /** New rows and columns repeat the last value. */
  Field resized(const Field &field, const long more_rows, const long more_columns)
  {
    Field result = field;
    result.rows = static_cast<hsize_t>(std::max(0l, static_cast<long>(field.rows) + more_rows));
    result.columns =
        static_cast<hsize_t>(std::max(0l, static_cast<long>(field.columns) + more_columns));
    const std::size_t size = H5Tget_size(field.type);
    result.values.assign(result.rows * result.columns * size, 0);
    if (!field.values.empty())
      for (hsize_t row = 0; row < result.rows; ++row)
        for (hsize_t column = 0; column < result.columns; ++column)
          std::memcpy(result.values.data() + (row * result.columns + column) * size,
                      field.values.data() + (std::min(row, field.rows - 1) * field.columns +
                                             std::min(column, field.columns - 1)) *
                                                size,
                      size);
    return result;
  }

  Field retyped(const Field &field)
  {
    Field result = field;
    result.type =
        H5Tequal(field.type, H5T_NATIVE_DOUBLE) > 0 ? H5T_NATIVE_UINT64 : H5T_NATIVE_DOUBLE;
    const std::size_t n = field.rows * field.columns;
    result.values.assign(n * std::max<std::size_t>(8, H5Tget_size(field.type)), 0);
    std::copy(field.values.begin(), field.values.end(), result.values.begin());
    if (n > 0 &&
        H5Tconvert(field.type, result.type, n, result.values.data(), nullptr, H5P_DEFAULT) < 0)
      fail(field.name + " cannot be converted");
    result.values.resize(n * 8);
    return result;
  }

  herr_t collect(hid_t, const char *name, const H5O_info_t *info, void *names)
  {
    if (info->type == H5O_TYPE_DATASET)
      static_cast<std::vector<std::string> *>(names)->push_back(name);
    return 0;
  }
} // namespace

int main(int argc, char **argv)
{
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() < 2)
    fail("FILE list|remove|resize|retype ...");
  const std::string action = arguments[1];
  const hid_t file =
      H5Fopen(arguments[0].c_str(), action == "list" ? H5F_ACC_RDONLY : H5F_ACC_RDWR, H5P_DEFAULT);
  if (file < 0)
    fail(arguments[0] + " cannot be opened");
  if (action == "list")
  {
    std::vector<std::string> names;
    H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, collect, &names);
    for (const std::string &name : names)
    {
      const Field field = read(file, name);
      std::cout << name << '\t' << field.offset << '\t' << field.bytes << '\n';
    }
  }
  else
  {
    if (arguments.size() < 3)
      fail(action + " needs a name");
    const Field field = read(file, arguments[2]);
    if (H5Ldelete(file, arguments[2].c_str(), H5P_DEFAULT) < 0)
      fail(arguments[2] + " cannot be removed");
    if (action == "resize" && arguments.size() == 5)
      write(file, resized(field, std::stol(arguments[3]), std::stol(arguments[4])));
    else if (action == "retype")
      write(file, retyped(field));
    else if (action != "remove")
      fail("unknown: " + action);
  }
  if (H5Fclose(file) < 0)
    fail("the file cannot be closed");
  return 0;
}
