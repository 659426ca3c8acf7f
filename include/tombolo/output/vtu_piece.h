// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/unit_labels.h>

#include <cstdint>
#include <iosfwd>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace tombolo
{
  /**
   * An unstructured grid of one kind of cell with data, as one rank sees it, and its files in the
   * XML format of VTK (.vtu, and .pvtu for all ranks): binary, compressed. Not dealii::DataOut,
   * because that has no data on cells, repeats the points of each cell, and writes every number in
   * single precision, which cannot hold identifiers. Every rank adds the same arrays in the same
   * order, also when it has no cells.
   *
   * Components have names: those of 3 are a vector's, those of 9 a tensor's by rows. Arrays of 6
   * are symmetric tensors, added in the order of the state, xx, yy, zz, yz, xz, xy, and written in
   * that which VTK takes six components for: XX, YY, ZZ, XY, YZ, XZ.
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
      void add(const std::string &name, const std::string &unit, unsigned int n_components,
               std::vector<double> values);

      /** Adds whole numbers. */
      template <typename Number>
      void add(const std::string &name, std::vector<Number> values)
      {
        this->push_back({name, 1, std::move(values)});
      }
    };

    /** @p vtk_cell_type: 1 vertex, 3 line, 5 triangle, 9 quadrilateral, 12 hexahedron. Real numbers
     * are written in double precision or in single. */
    VtuPiece(unsigned int vtk_cell_type, unsigned int n_vertices_per_cell, bool double_precision);

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
    void write(std::ostream &out, double time, const UnitLabels &unit_labels = {}) const;

    /** Checks the sizes of all data. */
    void check_sizes() const;

    /** The .pvtu file, which names the files of all ranks. */
    void write_parallel(std::ostream &out, const std::vector<std::string> &piece_files) const;

  private:
    std::string attributes(const Array &array) const;
    void write_array(std::ostream &out, const Array &array) const;
    void write_field_data(std::ostream &out, double time, const UnitLabels &unit_labels) const;
    void check_size(const Array &array, std::size_t n_entities) const;
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

    void write(std::ostream &out) const;
  };

  /** Text as it stands in XML, also within the quotes of an attribute. */
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
} // namespace tombolo
