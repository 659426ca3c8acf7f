// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/numbers.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/generators/round_section.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace tombolo
{
  namespace
  {
    using dealii::numbers::PI;

    /** A quarter turn, any number of times, without rounding. */
    dealii::Point<2> turned(const dealii::Point<2> &point, const unsigned int quarters)
    {
      dealii::Point<2> result = point;
      for (unsigned int i = 0; i < quarters; ++i)
        result = dealii::Point<2>(-result[1], result[0]);
      // Adding zero takes the sign from a negative zero.
      return {result[0] + 0., result[1] + 0.};
    }

    /** The point of the unit circle beside the place v in [-1, 1] of the edge of the core that
     * crosses the first axis. Mirrored places have mirrored points, to the last bit. */
    dealii::Point<2> circle_point(const double v)
    {
      if (std::abs(v) == 1)
        return {std::sqrt(0.5), v * std::sqrt(0.5)};
      return {std::cos(PI / 4 * v), std::sin(PI / 4 * v)};
    }
  } // namespace

  RoundSection::RoundSection(const Entries &e, const std::array<char, 2> &axes,
                             const std::string &whole)
  {
    const double radius = e.number("Radius", mandatory, positive(0.), "",
                                   "The radius of the circumference. Units: length");
    n_core_cells =
        e.integer("Core cells", mandatory, at_least(1),
                  "The number of cells along each edge of the square core; the circumference has "
                  "four times as many. With symmetry planes it must be even.");
    const std::string text = e.text(
        "Rings", mandatory, "",
        std::string("The rings of cells from the core to the circumference: ") + segments_syntax +
            ". Places are radii. The rings of the first segment lead from the core to a circle, "
            "those of the others are concentric circles.");
    core_radius = e.number(
        "Core radius", "0", at_least(0.), "",
        "The distance from the axis to the middle of each edge of the core. 0: such that the "
        "smallest cells of the core and of the first segment of rings are alike. Units: length");
    const double angle = e.number(
        "Core corner angle", "120", between(90., 150.), "",
        "The angle between two edges of the core, which are arcs: 90 is a square; at 120 the core "
        "cell and the two ring cells at a corner share the full angle evenly. Units: degrees");
    e.text("Symmetry planes", "", "",
           "Axes across the body: for each, the body is cut by the plane through its axis that is "
           "normal to it, and the positive side is kept (\"x\" a half, \"x, y\" a quarter). The "
           "cut is called \"symmetry x\", and so on. The nodes are those of the full mesh.");
    if (e.declares())
      return;
    const Section &section = e.section();
    rings = parse_segments(section, text,
                           {"Rings", " in the rings", whole,
                            std::string("The rings are ") + segments_syntax, 0, radius, true});
    arc = (angle - 90) / 2 * PI / 180;
    read_core_radius(section, whole);
    read_cuts(section, axes, whole);

    const double n = n_core_cells;
    const double n_in_section = n * n + 4 * n * static_cast<double>(n_cells(rings));
    if (n_in_section > static_cast<double>(most_coarse_cells))
    {
      std::ostringstream message;
      message << "Each section of the " << whole << " would have " << n_in_section
              << " cells; at most " << most_coarse_cells << " are allowed.";
      section.fail("Core cells", message.str());
    }
    make_full_section();
    keep_positive_sides();
  }

  void RoundSection::read_core_radius(const Section &section, const std::string &whole)
  {
    const double first_circle = rings.front().end;
    // The distance of the corners of the core over that of the middle of its edges.
    const double corner = std::sqrt(2.) / (1 + std::tan(arc / 2));
    if (core_radius == 0)
      core_radius =
          first_circle / (1 + 2. * rings.front().n_cells / (n_core_cells * std::sqrt(2.))) / corner;
    if (!(core_radius > 0 && core_radius * corner < first_circle))
    {
      std::ostringstream message;
      message << "The corners of the core would be at the radius " << core_radius * corner
              << ". They must be inside of the first circle of the " << whole << ", which has "
              << first_circle << ": give less than " << first_circle / corner << ", or 0.";
      section.fail("Core radius", message.str());
    }
    rings.front().begin = core_radius;
  }

  void RoundSection::read_cuts(const Section &section, const std::array<char, 2> &axes,
                               const std::string &whole)
  {
    const auto fail = [&](const std::string &message)
    {
      section.fail("Symmetry planes", message + " Give \"" + axes[0] + "\", \"" + axes[1] +
                                          "\", or \"" + axes[0] + ", " + axes[1] +
                                          "\": the axes across the " + whole + ".");
    };
    for (const std::string &name : section.get_list("Symmetry planes"))
    {
      const auto found =
          name.size() == 1 ? std::find(axes.begin(), axes.end(), name[0]) : axes.end();
      if (found == axes.end())
        fail("\"" + name + "\" is not an axis across the " + whole + ".");
      bool &is_cut = cuts[static_cast<std::size_t>(found - axes.begin())];
      if (is_cut)
        fail("\"" + name + "\" stands twice.");
      is_cut = true;
    }
    if ((cuts[0] || cuts[1]) && n_core_cells % 2 != 0)
      section.fail("Core cells", "A symmetry plane would cut the cells in the middle. The number "
                                 "must be even with `Symmetry planes`.");
  }

  dealii::Point<2> RoundSection::core_point(const double u, const double v) const
  {
    // Half of the chord from corner to corner. Each edge is an arc over it, and the inside their
    // transfinite interpolation, which for these four reads as below.
    const double half = core_radius / (1 + std::tan(arc / 2));
    const auto bulge = [&](const double w)
    { return arc == 0 ? 0 : half * (std::cos(arc * w) - std::cos(arc)) / std::sin(arc); };
    const auto along = [&](const double w)
    { return arc == 0 ? half * w : half * std::sin(arc * w) / std::sin(arc); };
    if (std::abs(u) == 1 && std::abs(v) == 1)
      return {u * half, v * half};
    return {u * bulge(v) + along(u), v * bulge(u) + along(v)};
  }

  void RoundSection::make_full_section()
  {
    const unsigned int n = n_core_cells;
    const auto lattice = [n](const unsigned int i)
    { return (2. * i - static_cast<double>(n)) / static_cast<double>(n); };
    for (unsigned int j = 0; j <= n; ++j)
      for (unsigned int i = 0; i <= n; ++i)
      {
        const auto place = core_point(lattice(i), lattice(j));
        section_vertices.push_back({{place[0] + 0., place[1] + 0.}, false});
      }
    for (unsigned int j = 0; j < n; ++j)
      for (unsigned int i = 0; i < n; ++i)
      {
        const unsigned int first = j * (n + 1) + i;
        section_cells.push_back({{first, first + 1, first + n + 1, first + n + 2}});
      }

    // Around the core, from the corner below the first axis, positively.
    std::vector<unsigned int> inner;
    std::vector<dealii::Point<2>> circle;
    for (unsigned int side = 0; side < 4; ++side)
      for (unsigned int q = 0; q < n; ++q)
      {
        const unsigned int i[] = {n, n - q, 0, q};
        const unsigned int j[] = {q, n, n - q, 0};
        inner.push_back(j[side] * (n + 1) + i[side]);
        circle.push_back(turned(circle_point(lattice(q)), side));
      }
    const std::vector<unsigned int> edge_of_core = inner;

    const std::vector<double> radii = segment_coordinates(rings);
    const double first_circle = rings.front().end;
    for (unsigned int ring = 1; ring < radii.size(); ++ring)
    {
      std::vector<unsigned int> outer;
      for (unsigned int p = 0; p < circle.size(); ++p)
      {
        dealii::Point<2> place(radii[ring] * circle[p]);
        if (radii[ring] < first_circle)
        {
          const double part = (radii[ring] - core_radius) / (first_circle - core_radius);
          place = (1 - part) * section_vertices[edge_of_core[p]].place +
                  part * first_circle * dealii::Tensor<1, 2>(circle[p]);
        }
        outer.push_back(static_cast<unsigned int>(section_vertices.size()));
        section_vertices.push_back({place, ring + 1 == radii.size()});
      }
      for (unsigned int p = 0; p < circle.size(); ++p)
      {
        const unsigned int next = (p + 1) % static_cast<unsigned int>(circle.size());
        section_cells.push_back({{inner[p], outer[p], inner[next], outer[next]}});
      }
      inner = outer;
    }
  }

  void RoundSection::keep_positive_sides()
  {
    const auto is_kept = [this](const unsigned int vertex)
    {
      const auto &place = section_vertices[vertex].place;
      return !(cuts[0] && place[0] < 0) && !(cuts[1] && place[1] < 0);
    };
    constexpr unsigned int none = std::numeric_limits<unsigned int>::max();
    std::vector<unsigned int> new_number(section_vertices.size(), none);
    std::vector<Vertex> kept_vertices;
    for (unsigned int vertex = 0; vertex < section_vertices.size(); ++vertex)
      if (is_kept(vertex))
      {
        new_number[vertex] = static_cast<unsigned int>(kept_vertices.size());
        kept_vertices.push_back(section_vertices[vertex]);
      }
    std::vector<std::array<unsigned int, 4>> kept_cells;
    for (auto cell : section_cells)
      if (std::all_of(cell.begin(), cell.end(), is_kept))
      {
        for (auto &vertex : cell)
          vertex = new_number[vertex];
        kept_cells.push_back(cell);
      }
    section_vertices = std::move(kept_vertices);
    section_cells = std::move(kept_cells);
  }

  const std::vector<RoundSection::Vertex> &RoundSection::vertices() const
  {
    return section_vertices;
  }

  const std::vector<std::array<unsigned int, 4>> &RoundSection::cells() const
  {
    return section_cells;
  }

  bool RoundSection::is_cut(const unsigned int axis) const
  {
    return cuts[axis];
  }

  double RoundSection::radius() const
  {
    return rings.back().end;
  }
} // namespace tombolo
