// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/output/unit_labels.h>

#include <deal.II/base/config.h>
#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <ostream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#ifdef DEAL_II_WITH_ZLIB
#  include <zlib.h>
#endif

namespace tombolo
{
  /** Text as it is in XML, also within the quotes of an attribute. */
  inline std::string xml_escaped(const std::string &text)
  {
    std::string result;
    for (const char character : text)
      switch (character)
      {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += character;
      }
    return result;
  }

  /**
   * An unstructured grid of one kind of cell with data, that of one rank, and its files in the
   * XML format of VTK (.vtu, and .pvtu for all ranks): binary, compressed. Not dealii::DataOut,
   * because that has no data on cells, repeats the points of each cell, and writes every number in
   * single precision, which cannot hold identifiers. Every rank adds the same arrays in the same
   * order, also when it has no cells.
   *
   * Components have names: those of 3 are a vector's, those of 9 a tensor's by rows. Arrays of 6
   * are symmetric tensors, added in the order of the state, xx, yy, zz, yz, xz, xy, and written in
   * that of VTK for six components: XX, YY, ZZ, XY, YZ, XZ.
   */
  class VtuPiece
  {
  public:
    using Values =
        std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::uint64_t>>;

    struct Array
    {
      std::string name;
      unsigned int n_components = 1;
      Values values;
      std::string unit = "1";
    };

    /** Data at points or on cells. */
    class Arrays : public std::vector<Array>
    {
    public:
      /** Adds real numbers, @p n_components each, contiguous; @p unit in terms of L, M, T and K,
       * "1" for none. The sizes are checked by write(). */
      void add(const std::string &name, const std::string &unit, const unsigned int n_components,
               std::vector<double> values)
      {
        if (n_components == 6) // yz, xz, xy become xy, yz, xz
          for (std::size_t first = 3; first + 3 <= values.size(); first += 6)
            std::rotate(values.begin() + std::ptrdiff_t(first),
                        values.begin() + std::ptrdiff_t(first) + 2,
                        values.begin() + std::ptrdiff_t(first) + 3);
        push_back({name, n_components, std::move(values), unit});
      }

      /** Adds whole numbers. */
      template <typename Number>
      void add(const std::string &name, std::vector<Number> values)
      {
        this->push_back({name, 1, std::move(values)});
      }
    };

    /** @p vtk_cell_type: 1 vertex, 3 line, 5 triangle, 9 quadrilateral, 12 hexahedron. Real numbers
     * are written in double precision or in single. */
    VtuPiece(const unsigned int vtk_cell_type, const unsigned int n_vertices_per_cell,
             const bool double_precision)
        : vtk_cell_type(vtk_cell_type), n_vertices_per_cell(n_vertices_per_cell),
          double_precision(double_precision)
    {}

    unsigned int vtk_cell_type, n_vertices_per_cell;
    bool double_precision;
    std::vector<double> points;             ///< 3 a point
    std::vector<std::int64_t> connectivity; ///< points of the cells, in the order of VTK
    Arrays point_data, cell_data;           ///< Array::values are in the order of VTK
    /** Lists of names for the whole grid, for example those of the parts, by number. */
    std::vector<std::pair<std::string, std::vector<std::string>>> names;

    std::size_t n_points() const
    {
      return points.size() / 3;
    }

    std::size_t n_cells() const
    {
      return connectivity.size() / n_vertices_per_cell;
    }

    /** The .vtu file of this rank. Its field data "units" names the arrays that have a unit, as
     * headings of tables do: "stress [MPa]". */
    void write(std::ostream &out, double time, const UnitLabels &unit_labels = {}) const
    {
      check_sizes();
      write_head(out, "UnstructuredGrid");
      out << "<UnstructuredGrid>\n";
      write_field_data(out, time, unit_labels);
      out << "<Piece NumberOfPoints=\"" << n_points() << "\" NumberOfCells=\"" << n_cells()
          << "\">\n<Points>\n";
      write_array(out, {"Points", 3, points});
      out << "</Points>\n<Cells>\n";

      write_array(out, {"connectivity", 1, connectivity});
      std::vector<std::int64_t> offsets(n_cells());
      for (std::size_t i = 0; i < offsets.size(); ++i)
        offsets[i] = static_cast<std::int64_t>((i + 1) * n_vertices_per_cell);
      write_array(out, {"offsets", 1, offsets});
      out << "<DataArray type=\"UInt8\" Name=\"types\" NumberOfComponents=\"1\" format=\"binary\">";
      write_binary(
          out, std::vector<unsigned char>(n_cells(), static_cast<unsigned char>(vtk_cell_type)));
      out << "</DataArray>\n</Cells>\n<PointData>\n";
      for (const Array &array : point_data)
        write_array(out, array);
      out << "</PointData>\n<CellData>\n";
      for (const Array &array : cell_data)
        write_array(out, array);
      out << "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    }

    /** Checks the sizes of all data. */
    void check_sizes() const
    {
      for (const Array &array : point_data)
        check_size(array, n_points());
      for (const Array &array : cell_data)
        check_size(array, n_cells());
    }

    /** The .pvtu file, which names the files of all ranks. */
    void write_parallel(std::ostream &out, const std::vector<std::string> &piece_files) const
    {
      write_head(out, "PUnstructuredGrid");
      out << "<PUnstructuredGrid GhostLevel=\"0\">\n<PPoints>\n<PDataArray "
          << attributes({"Points", 3, points}) << "/>\n</PPoints>\n<PPointData>\n";
      for (const Array &array : point_data)
        out << "<PDataArray " << attributes(array) << "/>\n";
      out << "</PPointData>\n<PCellData>\n";
      for (const Array &array : cell_data)
        out << "<PDataArray " << attributes(array) << "/>\n";
      out << "</PCellData>\n";
      for (const std::string &file : piece_files)
        out << "<Piece Source=\"" << xml_escaped(file) << "\"/>\n";
      out << "</PUnstructuredGrid>\n</VTKFile>\n";
    }

  private:
    static void append_number(std::vector<unsigned char> &bytes, const std::uint64_t number)
    {
      const auto *const begin = reinterpret_cast<const unsigned char *>(&number);
      bytes.insert(bytes.end(), begin, begin + sizeof(number));
    }

    /** Compressed data of VTK: number of blocks, size of a block, size of the last one if it is
     * smaller, compressed size of each; then the blocks. Both parts in base 64. Without zlib, the
     * number of bytes and the bytes. */
    static void write_binary(std::ostream &out, const void *const data, const std::size_t n_bytes)
    {
      const auto *const bytes = static_cast<const unsigned char *>(data);
      std::vector<unsigned char> header, body;
#ifdef DEAL_II_WITH_ZLIB
      constexpr std::size_t block_size = std::size_t(1) << 20;
      const std::size_t n_blocks = (n_bytes + block_size - 1) / block_size;
      append_number(header, n_blocks);
      append_number(header, block_size);
      append_number(header, n_bytes % block_size);
      for (std::size_t block = 0; block < n_blocks; ++block)
      {
        const std::size_t size = std::min(block_size, n_bytes - block * block_size);
        uLongf compressed_size = compressBound(static_cast<uLong>(size));
        const std::size_t start = body.size();
        body.resize(start + compressed_size);
        const int status =
            compress2(body.data() + start, &compressed_size, bytes + block * block_size,
                      static_cast<uLong>(size), Z_BEST_SPEED);
        AssertThrow(status == Z_OK,
                    dealii::ExcMessage("zlib cannot compress the data of an output."));
        body.resize(start + compressed_size);
        append_number(header, compressed_size);
      }
      out << dealii::Utilities::encode_base64(header) << dealii::Utilities::encode_base64(body);
#else
      append_number(header, n_bytes);
      header.insert(header.end(), bytes, bytes + n_bytes);
      out << dealii::Utilities::encode_base64(header);
#endif
    }

    template <typename Number>
    static void write_binary(std::ostream &out, const std::vector<Number> &values)
    {
      write_binary(out, values.data(), values.size() * sizeof(Number));
    }

    static void write_head(std::ostream &out, const std::string &type)
    {
      const std::uint16_t one = 1;
      unsigned char first_byte;
      std::memcpy(&first_byte, &one, 1);
      out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"" << type
          << "\" version=\"1.0\" byte_order=\"" << (first_byte == 1 ? "Little" : "Big")
          << "Endian\" header_type=\"UInt64\""
#ifdef DEAL_II_WITH_ZLIB
          << " compressor=\"vtkZLibDataCompressor\""
#endif
          << ">\n";
    }

    static std::vector<std::string> component_names(const unsigned int n_components)
    {
      switch (n_components)
      {
      case 3:
        return {"x", "y", "z"};
      case 6:
        return {"xx", "yy", "zz", "xy", "yz", "xz"};
      case 9:
        return {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
      default:
        return {};
      }
    }

    static void write_strings(std::ostream &out, const std::string &name,
                              const std::vector<std::string> &strings)
    {
      out << "<DataArray type=\"String\" Name=\"" << xml_escaped(name) << "\" NumberOfTuples=\""
          << strings.size() << "\" format=\"ascii\">";
      for (const std::string &text : strings)
      {
        for (const char character : text)
          out << static_cast<unsigned int>(static_cast<unsigned char>(character)) << ' ';
        out << "0 ";
      }
      out << "</DataArray>\n";
    }

    std::string attributes(const Array &array) const
    {
      const char *const type =
          std::holds_alternative<std::vector<std::int64_t>>(array.values)    ? "Int64"
          : std::holds_alternative<std::vector<std::uint64_t>>(array.values) ? "UInt64"
          : double_precision                                                 ? "Float64"
                                                                             : "Float32";
      std::string result = std::string("type=\"") + type + "\" Name=\"" + xml_escaped(array.name) +
                           "\" NumberOfComponents=\"" + std::to_string(array.n_components) + "\"";
      const std::vector<std::string> components = component_names(array.n_components);
      for (std::size_t c = 0; c < components.size(); ++c)
        result += " ComponentName" + std::to_string(c) + "=\"" + components[c] + "\"";
      return result;
    }

    void write_array(std::ostream &out, const Array &array) const
    {
      out << "<DataArray " << attributes(array) << " format=\"binary\">";
      std::visit(
          [&](const auto &values)
          {
            using Number = typename std::decay_t<decltype(values)>::value_type;
            if (std::is_integral_v<Number> || double_precision)
              write_binary(out, values);
            else
              write_binary(out, std::vector<float>(values.begin(), values.end()));
          },
          array.values);
      out << "</DataArray>\n";
    }

    void write_field_data(std::ostream &out, const double time, const UnitLabels &unit_labels) const
    {
      out << "<FieldData>\n"
          << "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">"
          << format_number(time) << "</DataArray>\n";
      for (const auto &[name, list] : names)
        write_strings(out, name, list);
      std::vector<std::string> units = {unit_labels.heading("Points", "L"),
                                        unit_labels.heading("TimeValue", "T")};
      for (const auto *const data : {&point_data, &cell_data})
        for (const Array &array : *data)
          if (array.unit != "1")
            units.push_back(unit_labels.heading(array.name, array.unit));
      write_strings(out, "units", units);
      out << "</FieldData>\n";
    }

    void check_size(const Array &array, const std::size_t n_entities) const
    {
      const std::size_t size =
          std::visit([](const auto &values) { return values.size(); }, array.values);
      AssertThrow(size == n_entities * array.n_components,
                  dealii::ExcMessage("The output array \"" + array.name + "\" has " +
                                     std::to_string(size) + " values for " +
                                     std::to_string(n_entities) + " entities of " +
                                     std::to_string(array.n_components) + " components."));
    }
  };

  /** The .pvd file: which file belongs to which time. */
  struct VtuSeries
  {
    struct Entry
    {
      double time;
      std::string file;
      std::string name;  ///< "cells", "particles"
      unsigned int part; ///< files of one time have different numbers
    };
    std::vector<Entry> entries;

    void write(std::ostream &out) const
    {
      out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n"
             "<Collection>\n";
      for (const Entry &entry : entries)
        out << "<DataSet timestep=\"" << format_number(entry.time) << "\" group=\"\" part=\""
            << entry.part << "\" name=\"" << xml_escaped(entry.name) << "\" file=\""
            << xml_escaped(entry.file) << "\"/>\n";
      out << "</Collection>\n</VTKFile>\n";
    }
  };
} // namespace tombolo
