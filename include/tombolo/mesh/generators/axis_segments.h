// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/grid/tria_description.h>

#include <tombolo/base/input/parameters.h>

#include <array>
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
  extern const char *const segments_syntax;

  /** Parses segments that fill the axis: counts, each with the coordinate where it ends (the last
   * one may leave it out) and, where allowed, a ratio. Throws InputError. */
  std::vector<AxisSegment> parse_segments(const Section &section, const std::string &text,
                                          const SegmentedAxis &axis);

  /** The number of cells of all segments. */
  std::uint64_t n_cells(const std::vector<AxisSegment> &segments);

  /** Refuses, at @p entry, a body called @p whole of more than most_coarse_cells cells. */
  void refuse_too_many_cells(const Section &section, const std::string &entry,
                             const std::string &whole, double n_all);

  /** Hexahedra between layers of the same quadrilaterals: vertex v of a quadrilateral is number
   * layer · @p n_in_layer + v. Layer by layer, all of material 0. */
  std::vector<dealii::CellData<3>>
  cells_of_layers(const std::vector<std::array<unsigned int, 4>> &quadrilaterals,
                  unsigned int n_layers, unsigned int n_in_layer);

  /** The coordinates between the cells, from the begin of the first segment to the end of the
   * last; ends of segments are met exactly. */
  std::vector<double> segment_coordinates(const std::vector<AxisSegment> &segments);
} // namespace tombolo
