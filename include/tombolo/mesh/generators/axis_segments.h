// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/base/input/parameters.h>

#include <deal.II/base/point.h>
#include <deal.II/base/utilities.h>
#include <deal.II/grid/tria.h>
#include <deal.II/grid/tria_description.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace tombolo
{
  /** Coarse cells that a mesh may have: each takes about 2 kB on every rank. */
  constexpr std::uint64_t most_coarse_cells = 4000000;

  /** A stretch of an axis that is divided into cells, equal ones or in geometric progression. */
  struct AxisSegment
  {
    unsigned int n_cells = 0;
    double begin = 0;
    double end = 0;
    double ratio = 1; ///< size of the last cell over that of the first
  };

  /** What the text of an entry, or a part of it, divides into segments. */
  struct SegmentedAxis
  {
    std::string entry;  ///< that messages name
    std::string along;  ///< for example " along x"
    std::string whole;  ///< what ends at `end`, for example "box"
    std::string syntax; ///< how the entry is written, for messages; ends without a period
    double begin = 0;
    double end = 0;
    bool may_have_ratio = false; ///< whether segments may have a ratio
  };

  /** How to write segments, for the documentation of entries: "60", "25 to 5 | 75 to 10",
   * "40 to 10 | 20 to 25 ratio 3". */
  constexpr const char *segments_syntax =
      "a count, or segments, each a count and the place where it ends (\"25 to 5 | 75 to 10\"; the "
      "last one may leave its end out), with equal cells or with \"ratio\" and the size of its "
      "last cell over that of its first (\"40 to 10 | 20 to 25 ratio 3\")";

  /** Cuts @p text at @p word; returns what follows, trimmed. */
  inline std::string cut_at(std::string &text, const std::string &word)
  {
    const auto position = text.find(word);
    if (position == std::string::npos)
      return "";
    const std::string rest = dealii::Utilities::trim(text.substr(position + word.size()));
    text = dealii::Utilities::trim(text.substr(0, position));
    return rest;
  }

  /** Parses segments that fill the axis: counts, each with the coordinate where it ends (the last
   * one may leave it out) and, where allowed, a ratio. Throws InputError. */
  inline std::vector<AxisSegment> parse_segments(const Section &section, const std::string &text,
                                                 const SegmentedAxis &axis)
  {
    const auto fail = [&](const std::string &message) { section.fail(axis.entry, message); };
    const std::string &along = axis.along;
    std::vector<AxisSegment> result;
    const auto parts = dealii::Utilities::split_string_list(text, '|');
    if (parts.empty())
      fail("There is no number of cells" + along + ". " + axis.syntax + ".");
    double from = axis.begin;
    for (unsigned int i = 0; i < parts.size(); ++i)
    {
      const std::string &part = parts[i];
      std::string count = part;
      AxisSegment segment;
      const bool has_ratio = axis.may_have_ratio && count.find("ratio") != std::string::npos;
      const std::string ratio = has_ratio ? cut_at(count, "ratio") : "";
      const bool has_end = count.find("to") != std::string::npos;
      const std::string limit = cut_at(count, "to");

      if (count.empty() || count.find_first_not_of("0123456789") != std::string::npos)
        fail("\"" + count + "\" is not a number of cells" + along +
             ". It must be a positive whole number. " + axis.syntax + ".");
      if (count.size() > 9)
        fail(count + " cells" + along + " are too many.");
      segment.n_cells = static_cast<unsigned int>(std::stoul(count));
      if (segment.n_cells == 0)
        fail("There are 0 cells" + along + ". At least one is needed.");

      if (has_ratio &&
          !(is_number(ratio, segment.ratio) && segment.ratio >= 1e-3 && segment.ratio <= 1e3))
        fail("\"" + ratio + "\" is not a ratio of the last to the first cell" + along +
             ". It must be a number from 0.001 to 1000.");
      if (has_ratio && segment.n_cells == 1)
        fail("The segment \"" + part + "\"" + along +
             " has a ratio of its last to its first cell, and only one cell.");

      segment.begin = from;
      const bool is_last = i + 1 == parts.size();
      if (!has_end)
      {
        if (!is_last)
          fail("The segment \"" + part + "\"" + along + " does not say where it ends. " +
               axis.syntax + ".");
        segment.end = axis.end;
      }
      else if (!is_number(limit, segment.end) || !std::isfinite(segment.end))
        fail("\"" + limit + "\" is not a coordinate" + along + ". It must be a finite number. " +
             axis.syntax + ".");

      const double tolerance =
          1e-12 * std::max({std::abs(axis.begin), std::abs(axis.end), axis.end - axis.begin});
      if (std::abs(segment.end - axis.end) <= tolerance)
        segment.end = axis.end;
      if (!(segment.end > from + tolerance))
        fail(as_text("The segment \"", part, "\"", along, " ends at ", segment.end,
                     " and begins at ", from, ". Ends must increase."));
      if (segment.end > axis.end)
        fail(as_text("The segment \"", part, "\"", along, " ends at ", segment.end,
                     ", outside the ", axis.whole, ", which ends at ", axis.end, "."));
      if (is_last && segment.end != axis.end)
        fail(as_text("The segments", along, " end at ", segment.end, ", and the ", axis.whole,
                     " at ", axis.end, ". The last segment must end there, or leave its end out."));
      from = segment.end;
      result.push_back(segment);
    }
    return result;
  }

  /** The number of cells of all segments. */
  inline std::uint64_t n_cells(const std::vector<AxisSegment> &segments)
  {
    std::uint64_t result = 0;
    for (const auto &segment : segments)
      result += segment.n_cells;
    return result;
  }

  /** Refuses, at @p entry, a body called @p whole of more than most_coarse_cells cells. */
  inline void refuse_too_many_cells(const Section &section, const std::string &entry,
                                    const std::string &whole, const double n_all)
  {
    if (n_all > static_cast<double>(most_coarse_cells))
      section.fail(entry,
                   as_text("The ", whole, " would have ", n_all,
                           " cells, all of them coarse, of about 2 kB each on every rank; at "
                           "most ",
                           most_coarse_cells, " are allowed."));
  }

  /** Hexahedra between layers of the same quadrilaterals: vertex v of a quadrilateral is number
   * layer · @p n_in_layer + v. Layer by layer, all of material 0. */
  inline std::vector<dealii::CellData<3>>
  cells_of_layers(const std::vector<std::array<unsigned int, 4>> &quadrilaterals,
                  const unsigned int n_layers, const unsigned int n_in_layer)
  {
    std::vector<dealii::CellData<3>> cells;
    cells.reserve(std::size_t(n_layers) * quadrilaterals.size());
    for (unsigned int layer = 0; layer < n_layers; ++layer)
      for (const auto &quadrilateral : quadrilaterals)
      {
        dealii::CellData<3> cell;
        for (unsigned int corner = 0; corner < 8; ++corner)
          cell.vertices[corner] = (layer + corner / 4) * n_in_layer + quadrilateral[corner % 4];
        cell.material_id = 0;
        cells.push_back(cell);
      }
    return cells;
  }

  /** Makes the coarse mesh of these cells; a face on its boundary is of that with the number that
   * @p id_of returns for the cell and the number of the face. */
  template <int dim, typename IdOf>
  void create_coarse_mesh(const std::vector<dealii::Point<dim>> &vertices,
                          const std::vector<dealii::CellData<dim>> &cells, const IdOf &id_of,
                          dealii::Triangulation<dim> &triangulation)
  {
    // A serial triangulation first: the numbers of its cells and faces are those of the lists.
    dealii::Triangulation<dim> coarse;
    coarse.create_triangulation(vertices, cells, dealii::SubCellData());
    for (const auto &cell : coarse.active_cell_iterators())
      for (const unsigned int f : cell->face_indices())
        if (cell->face(f)->at_boundary())
          cell->face(f)->set_boundary_id(id_of(cell, f));
    triangulation.copy_triangulation(coarse);
  }

  /** The coordinates between the cells, from the begin of the first segment to the end of the
   * last; ends of segments are met exactly. */
  inline std::vector<double> segment_coordinates(const std::vector<AxisSegment> &segments)
  {
    std::vector<double> coordinates = {segments.front().begin};
    for (const auto &segment : segments)
    {
      const unsigned int n = segment.n_cells;
      // The size of a cell over that of the one before it.
      const double growth = segment.ratio == 1 ? 1 : std::pow(segment.ratio, 1. / (n - 1));
      for (unsigned int i = 1; i < n; ++i)
      {
        const double part =
            growth == 1 ? 0 : std::expm1(i * std::log(growth)) / std::expm1(n * std::log(growth));
        coordinates.push_back(growth == 1 ? (segment.begin * (n - i) + segment.end * i) / n
                                          : segment.begin + (segment.end - segment.begin) * part);
      }
      coordinates.push_back(segment.end);
    }
    return coordinates;
  }
} // namespace tombolo
