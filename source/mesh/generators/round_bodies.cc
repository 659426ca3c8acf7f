// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/generators/axis_segments.h>
#include <tombolo/mesh/image_conditions.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/mesh_source.h>

#include <deal.II/base/numbers.h>
#include <deal.II/base/point.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

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
      // Adding zero removes the sign of a negative zero.
      return {result[0] + 0., result[1] + 0.};
    }

    /** The point of the unit circle beside the position v in [-1, 1] of the edge of the core that
     * crosses the first axis. Mirrored positions have mirrored points, to the last bit. */
    dealii::Point<2> circle_point(const double v)
    {
      if (std::abs(v) == 1)
        return {std::sqrt(0.5), v * std::sqrt(0.5)};
      return {std::cos(PI / 4 * v), std::sin(PI / 4 * v)};
    }

    constexpr dealii::types::boundary_id lower_id = 0, upper_id = 1, side_id = 2, first_cut_id = 3;
  } // namespace

  /**
   * The section of a cylinder or disc in quadrilaterals: a core of n x n cells, a square with round
   * edges, and rings of 4 n cells around it up to the circle.
   *
   * The edges of the core are circular arcs that meet at the corner angle; at 120 degrees the core
   * cell and the two ring cells at a corner are alike. The first segment of rings leads from the
   * core to a circle; the rings of the others are concentric circles. With symmetry planes the
   * section is the part of the full one on their positive sides, with the same vertices to the last
   * bit; vertices on a plane have the coordinate zero.
   */
  class RoundSection
  {
  public:
    /** A vertex of the section. */
    struct Vertex
    {
      dealii::Point<2> position; ///< relative to the centre
      bool is_at_rim = false;
    };

    /** @p axes are the names of the two axes of the section, @p whole the name of the body for
     * messages. Throws InputError where the entries make no section. */
    RoundSection(const Entries &e, const std::array<char, 2> &axes, const std::string &whole)
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
          "The angle between two edges of the core, which are arcs: 90 is a square; at 120 the "
          "core "
          "cell and the two ring cells at a corner share the full angle evenly. Units: degrees");
      e.text(
          "Symmetry planes", "", "",
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
        section.fail("Core cells",
                     as_text("Each section of the ", whole, " would have ", n_in_section,
                             " cells; at most ", most_coarse_cells, " are allowed."));
      make_full_section();
      keep_positive_sides();
    }

    /** The vertices of the cells() in the order of the full section: core, then ring by ring. */
    const std::vector<Vertex> &vertices() const
    {
      return section_vertices;
    }

    /** Vertices of each cell in deal.II's order, turning positively. */
    const std::vector<std::array<unsigned int, 4>> &cells() const
    {
      return section_cells;
    }

    /** Whether the section is cut by the plane through the centre that is normal to this axis. */
    bool is_cut(const unsigned int axis) const
    {
      return cuts[axis];
    }

  private:
    void read_cuts(const Section &section, const std::array<char, 2> &axes,
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
    void read_core_radius(const Section &section, const std::string &whole)
    {
      const double first_circle = rings.front().end;
      // The distance of the corners of the core over that of the middle of its edges.
      const double corner = std::sqrt(2.) / (1 + std::tan(arc / 2));
      if (core_radius == 0)
        core_radius = first_circle /
                      (1 + 2. * rings.front().n_cells / (n_core_cells * std::sqrt(2.))) / corner;
      if (!(core_radius > 0 && core_radius * corner < first_circle))
        section.fail("Core radius", as_text("The corners of the core would be at the radius ",
                                            core_radius * corner,
                                            ". They must be inside of the first circle of the ",
                                            whole, ", which has ", first_circle,
                                            ": give less than ", first_circle / corner, ", or 0."));
      rings.front().begin = core_radius;
    }

    /** A point of the core, (u, v) in [-1, 1]^2. */
    dealii::Point<2> core_point(const double u, const double v) const
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

    void make_full_section()
    {
      const unsigned int n = n_core_cells;
      const auto lattice = [n](const unsigned int i)
      { return (2. * i - static_cast<double>(n)) / static_cast<double>(n); };
      for (unsigned int j = 0; j <= n; ++j)
        for (unsigned int i = 0; i <= n; ++i)
        {
          const auto point = core_point(lattice(i), lattice(j));
          section_vertices.push_back({{point[0] + 0., point[1] + 0.}, false});
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
          dealii::Point<2> point(radii[ring] * circle[p]);
          if (radii[ring] < first_circle)
          {
            const double part = (radii[ring] - core_radius) / (first_circle - core_radius);
            point = (1 - part) * section_vertices[edge_of_core[p]].position +
                    part * first_circle * dealii::Tensor<1, 2>(circle[p]);
          }
          outer.push_back(static_cast<unsigned int>(section_vertices.size()));
          section_vertices.push_back({point, ring + 1 == radii.size()});
        }
        for (unsigned int p = 0; p < circle.size(); ++p)
        {
          const unsigned int next = (p + 1) % static_cast<unsigned int>(circle.size());
          section_cells.push_back({{inner[p], outer[p], inner[next], outer[next]}});
        }
        inner = outer;
      }
    }
    void keep_positive_sides()
    {
      const auto is_kept = [this](const unsigned int vertex)
      {
        const auto &position = section_vertices[vertex].position;
        return !(cuts[0] && position[0] < 0) && !(cuts[1] && position[1] < 0);
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

    unsigned int n_core_cells = 0;
    std::vector<AxisSegment> rings; ///< the first one begins at `core_radius`
    double core_radius = 0;         ///< from the centre to the middle of an edge of the core
    double arc = 0;                 ///< half of the angle of each edge of the core [rad]
    std::array<bool, 2> cuts = {};
    std::vector<Vertex> section_vertices;
    std::vector<std::array<unsigned int, 4>> section_cells;
  };

  /**
   * A cylinder of hexahedra along a coordinate axis, from its foot in the positive direction: the
   * cells of a RoundSection, repeated in layers. Boundaries are called "foot", "rear", "side", and
   * the cuts of a half or quarter model "symmetry x", and so on, by their normal. All cells are
   * coarse, so that all vertices of layers keep their positions.
   */
  class Cylinder : public MeshSource<3>
  {
  public:
    /** The words for what a cylinder and a disc have both, in entries and as boundary names. */
    struct Words
    {
      const char *body;
      const char *length;
      const char *layers;
      const char *position;
      const char *lower_boundary;
      const char *upper_boundary;
    };

    explicit Cylinder(const Entries &e)
        : Cylinder(e, Words{"cylinder", "Length", "Cells along axis", "Foot", "foot", "rear"})
    {}

    void create(Mesh<3> &mesh) const override
    {
      const double n_all = static_cast<double>(round_section->cells().size()) *
                           static_cast<double>(heights.size() - 1);
      refuse_more_than_memory(section, words.layers, n_all, n_all,
                              communicator_of(mesh.triangulation));
      const auto &section_vertices = round_section->vertices();
      const auto n_in_section = static_cast<unsigned int>(section_vertices.size());
      std::vector<dealii::Point<3>> vertices;
      vertices.reserve(heights.size() * n_in_section);
      for (const double height : heights)
        for (const auto &vertex : section_vertices)
        {
          dealii::Point<3> point = foot;
          for (unsigned int d = 0; d < 2; ++d)
            point[across[d]] += vertex.position[d];
          point[axis] += height;
          vertices.push_back(point);
        }

      const auto last_layer = static_cast<unsigned int>(heights.size() - 1);
      std::vector<dealii::CellData<3>> cells =
          cells_of_layers(round_section->cells(), last_layer, n_in_section);
      // p4est needs the directions of common edges to agree.
      dealii::GridTools::consistently_order_cells(cells);

      const auto id_of = [&](const auto &cell, const unsigned int f)
      {
        const auto all = [&](const auto &condition)
        {
          for (unsigned int v = 0; v < 4; ++v)
          {
            const unsigned int vertex = cell->face(f)->vertex_index(v);
            if (!condition(vertex / n_in_section, section_vertices[vertex % n_in_section]))
              return false;
          }
          return true;
        };
        dealii::types::boundary_id id = side_id;
        if (all([](const unsigned int layer, const auto &) { return layer == 0; }))
          id = lower_id;
        else if (all([&](const unsigned int layer, const auto &) { return layer == last_layer; }))
          id = upper_id;
        else if (!all([](unsigned int, const auto &vertex) { return vertex.is_at_rim; }))
          for (unsigned int d = 0; d < 2; ++d)
            if (all([&](unsigned int, const auto &vertex) { return vertex.position[d] == 0; }))
              id = first_cut_id + across[d];
        return id;
      };
      create_coarse_mesh(vertices, cells, id_of, mesh.triangulation);

      mesh.boundary_names[words.lower_boundary] = lower_id;
      mesh.boundary_names[words.upper_boundary] = upper_id;
      mesh.boundary_names["side"] = side_id;
      for (unsigned int d = 0; d < 2; ++d)
        if (round_section->is_cut(d))
          mesh.boundary_names[name_of_cut("xyz"[across[d]])] = first_cut_id + across[d];
    }

  protected:
    Cylinder(const Entries &e, const Words &words) : words(words), section(e.section())
    {
      const std::string body = words.body;
      const std::string lower = words.lower_boundary;
      if (e.declares())
        declare<RoundSection>(e, std::array<char, 2>(), words.body);
      axis =
          static_cast<unsigned int>(e.choice("Axis", "z", "x|y|z",
                                             "The direction from the " + lower + " of the " + body +
                                                 " to its " + words.upper_boundary + ".")[0] -
                                    'x');
      across = {{(axis + 1) % 3, (axis + 2) % 3}};
      const std::vector<double> position = e.numbers(
          words.position, "0, 0, 0", 3, "", "The centre of the " + lower + ". Units: length");
      const double length = e.number(words.length, mandatory, positive(0.), "",
                                     "The extent along the axis. Units: length");
      const std::string text =
          e.text(words.layers, mandatory, "",
                 "The layers of cells from the " + lower + " on: " + segments_syntax +
                     ". Places are heights above the " + lower + ".");
      if (e.declares())
        return;
      std::copy(position.begin(), position.end(), foot.begin_raw());
      const auto layers =
          parse_segments(section, text,
                         {words.layers, " along the axis", words.body,
                          std::string("The layers are ") + segments_syntax, 0, length, true});
      round_section = std::make_unique<RoundSection>(
          section, std::array<char, 2>{{"xyz"[across[0]], "xyz"[across[1]]}}, words.body);

      const double n_all =
          static_cast<double>(round_section->cells().size()) * static_cast<double>(n_cells(layers));
      refuse_too_many_cells(section, words.layers, words.body, n_all);
      heights = segment_coordinates(layers);
    }

  private:
    Words words;
    Section section;
    unsigned int axis;
    std::array<unsigned int, 2> across; ///< the axes of the section; with `axis` right-handed
    std::unique_ptr<RoundSection> round_section;
    dealii::Point<3> foot;
    std::vector<double> heights; ///< of the vertices above the foot
  };

  /** A disc: in two dimensions the RoundSection itself, with the boundaries "side" and perhaps
   * "symmetry x" and "symmetry y"; in three a Cylinder with the words of a disc, whose ends are
   * called "lower face" and "upper face". */
  template <int dim>
  class Disc;

  template <>
  class Disc<2> : public MeshSource<2>
  {
  public:
    explicit Disc(const Entries &e) : section(e.section()), round_section(e, {{'x', 'y'}}, "disc")
    {
      const std::vector<double> position =
          e.numbers("Position", "0, 0", 2, "", "The centre of the disc. Units: length");
      std::copy(position.begin(), position.end(), centre.begin_raw());
    }

    void create(Mesh<2> &mesh) const override
    {
      const auto n_all = static_cast<double>(round_section.cells().size());
      refuse_more_than_memory(section, "Core cells", n_all, n_all,
                              communicator_of(mesh.triangulation));
      std::vector<dealii::Point<2>> vertices;
      for (const auto &vertex : round_section.vertices())
        vertices.push_back(centre + vertex.position);
      std::vector<dealii::CellData<2>> cells;
      for (const auto &quadrilateral : round_section.cells())
      {
        dealii::CellData<2> cell;
        cell.vertices.assign(quadrilateral.begin(), quadrilateral.end());
        cell.material_id = 0;
        cells.push_back(cell);
      }
      // Nodes on a common edge have one order only if it has the same direction in both cells.
      dealii::GridTools::consistently_order_cells(cells);

      const auto id_of = [&](const auto &cell, const unsigned int f)
      {
        const auto &first = round_section.vertices()[cell->face(f)->vertex_index(0)];
        const auto &second = round_section.vertices()[cell->face(f)->vertex_index(1)];
        if (first.is_at_rim && second.is_at_rim)
          return 0u;
        return first.position[0] == 0 && second.position[0] == 0 ? 1u : 2u;
      };
      create_coarse_mesh(vertices, cells, id_of, mesh.triangulation);

      mesh.boundary_names["side"] = 0;
      for (unsigned int d = 0; d < 2; ++d)
        if (round_section.is_cut(d))
          mesh.boundary_names[name_of_cut("xy"[d])] = d + 1;
    }

  private:
    Section section;
    RoundSection round_section;
    dealii::Point<2> centre;
  };

  template <>
  class Disc<3> : public Cylinder
  {
  public:
    explicit Disc(const Entries &e)
        : Cylinder(e, Words{"disc", "Thickness", "Cells through thickness", "Position",
                            "lower face", "upper face"})
    {}
  };

  TOMBOLO_REGISTER(MeshSource<3>, Cylinder, "cylinder",
                   "A cylinder along an axis, or its half or quarter: a core and rings of cells")

  TOMBOLO_REGISTER_FOR_DIMENSIONS(MeshSource, Disc, "disc",
                                  "A disc, or its half or quarter: a core and rings of cells")
} // namespace tombolo
