// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/cell_quality.h>
#include <tombolo/mesh/generators/axis_segments.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/mesh_source.h>

#include <deal.II/base/numbers.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>
#include <deal.II/base/utilities.h>
#include <deal.II/grid/tria.h>
#include <deal.II/grid/tria_description.h>
#include <deal.II/physics/transformations.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace tombolo
{
  namespace
  {
    constexpr const char *axis_names = "xyz";

    const char *const cells_syntax =
        "The cells along each axis are a count, axes separated by commas (\"50, 6, 6\"), or, with "
        "axes separated by semicolons, segments of their own spacing, each a count and the "
        "coordinate where it ends (\"25 to 5 | 75 to 10; 6; 6\")";

    /** A number in [-1, 1] that is a function of its arguments only (splitmix64). */
    double scatter(const std::uint64_t seed, const std::uint64_t index, const std::uint64_t axis)
    {
      std::uint64_t z = seed * 0xd1342543de82ef95ull + index * 4 + axis;
      for (unsigned int round = 0; round < 2; ++round)
      {
        z += 0x9e3779b97f4a7c15ull;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        z ^= z >> 31;
      }
      return 2. * static_cast<double>(z >> 11) / 9007199254740992. - 1.;
    }

    /** The index along each axis of a lattice vertex, or with @p n_less = 1 of a cell. */
    template <std::size_t dim>
    std::array<std::size_t, dim>
    lattice_index(std::size_t number, const std::array<std::vector<double>, dim> &coordinates,
                  const std::size_t n_less)
    {
      std::array<std::size_t, dim> index;
      for (std::size_t d = 0; d < dim; ++d)
      {
        index[d] = number % (coordinates[d].size() - n_less);
        number /= coordinates[d].size() - n_less;
      }
      return index;
    }
  } // namespace

  /**
   * A box of hexahedra (quadrilaterals), each axis divided into one or several segments of equal
   * cells. The mesh is refined from the coarsest box whose cells the counts allow: if all counts
   * are multiples of 2^k, k times. Boundaries are called "x min", "x max", "y min", and so on.
   * With disorder, nodes are displaced at random, by numbers that depend on the index in the
   * lattice only, and the mesh is not refined, since only coarse vertices keep their positions when
   * cells move between ranks.
   */
  template <int dim>
  class Box : public MeshSource<dim>
  {
  public:
    explicit Box(const Entries &e) : section(e.section())
    {
      const std::vector<double> lower =
          e.numbers("Lower corner", dim == 2 ? "0, 0" : "0, 0, 0", dim, "",
                    "The corner with the smallest coordinates. Units: length");
      const std::vector<double> upper =
          e.numbers("Upper corner", mandatory, dim, "",
                    "The corner with the largest coordinates. Units: length");
      const std::string text = e.text(
          "Cells", mandatory, "",
          std::string(cells_syntax) +
              ". The last segment may leave its end out. If all counts are multiples of a "
              "power of two, the mesh is refined from a coarser box, which saves memory: each "
              "coarse cell takes about 2 kB on every rank.");
      disorder = e.number(
          "Disorder", "0", between(0., 0.5), "",
          "Displaces each node at random, along each axis by at most this fraction of the smaller "
          "of "
          "the spacings on its two sides. The displacement depends on the place of the node and on "
          "`Seed` only. A mesh with disorder is not refined from a coarse one.");
      e.refuse(disorder == 0.5, "Disorder",
               "It must be a fraction of the spacing, at least 0 and below 0.5.");
      surface_nodes_slide = e.choice("Surface nodes", "fixed", "fixed|slide",
                                     "What disorder does to nodes on the surface of the box: they "
                                     "stay, or they slide in it (on edges along them).") == "slide";
      seed = e.integer("Seed", "0", at_least(0), "Chooses one of the disordered meshes.");
      const double degrees =
          e.number("Rotation", "0", any_number(), "",
                   "The angle by which the box is turned about the origin, about the axis z or "
                   "`Rotation axis`, after everything else. Units: degrees");
      std::vector<double> direction = {0., 0., 1.};
      if (dim == 3)
        direction =
            e.numbers("Rotation axis", "0, 0, 1", dim, "",
                      "The direction of the axis of the rotation; its length is of no importance.");
      if (e.declares())
        return;
      for (int d = 0; d < dim; ++d)
        if (!(upper[d] > lower[d]))
          section.fail(
              "Upper corner",
              as_text("The extent along ", axis_names[d], " is ", upper[d] - lower[d],
                      ". It must be positive: the upper corner must be larger than the lower "
                      "one, ",
                      lower[d], "."));

      const bool has_segments = text.find_first_of(";|") != std::string::npos;
      const auto axes = dealii::Utilities::split_string_list(text, has_segments ? ';' : ',');
      if (axes.size() != dim)
        section.fail("Cells", "This is for " + std::to_string(axes.size()) +
                                  " axes, and the scene has " + std::to_string(dim) + ". " +
                                  cells_syntax + ".");
      for (int d = 0; d < dim; ++d)
        segments[d] = parse_segments(section, axes[d],
                                     {"Cells", std::string(" along ") + axis_names[d], "box",
                                      cells_syntax, lower[d], upper[d], false});

      if (disorder == 0)
      {
        const auto all_counts_are_multiples_of = [this](const unsigned int divisor)
        {
          for (const auto &axis : segments)
            for (const auto &segment : axis)
              if (segment.n_cells % divisor != 0)
                return false;
          return true;
        };
        while (all_counts_are_multiples_of(2u << refinements))
          ++refinements;
      }
      check_counts();
      set_rotation(degrees, direction);
    }

    void create(Mesh<dim> &mesh) const override
    {
      const double n_coarse_cells = number_of_coarse_cells();
      refuse_more_than_memory(section, "Cells", n_coarse_cells,
                              n_coarse_cells * std::pow(2., dim * static_cast<double>(refinements)),
                              communicator_of(mesh.triangulation));
      const auto coordinates = coarse_coordinates();
      std::size_t n_vertices = 1;
      std::size_t n_cells = 1;
      for (int d = 0; d < dim; ++d)
      {
        n_vertices *= coordinates[d].size();
        n_cells *= coordinates[d].size() - 1;
      }

      std::vector<dealii::Point<dim>> vertices(n_vertices);
      for (std::size_t v = 0; v < n_vertices; ++v)
      {
        const auto index = lattice_index(v, coordinates, 0);
        for (int d = 0; d < dim; ++d)
          vertices[v][d] = coordinates[d][index[d]];
      }
      if (disorder > 0)
        displace(coordinates, vertices);

      constexpr unsigned int n_corners = dealii::GeometryInfo<dim>::vertices_per_cell;
      std::vector<dealii::CellData<dim>> cells(n_cells, dealii::CellData<dim>(n_corners));
      for (std::size_t c = 0; c < n_cells; ++c)
      {
        const auto index = lattice_index(c, coordinates, 1);
        CellVertices<dim> corners;
        for (unsigned int corner = 0; corner < n_corners; ++corner)
        {
          std::size_t vertex = 0;
          for (int d = dim - 1; d >= 0; --d)
            vertex = vertex * coordinates[d].size() + index[d] + ((corner >> d) & 1u);
          cells[c].vertices[corner] = static_cast<unsigned int>(vertex);
          corners[corner] = vertices[vertex];
        }
        cells[c].material_id = 0;
        if (disorder > 0 && smallest_corner<dim>(corners) < smallest_usable_corner)
          section.fail(
              "Disorder",
              as_text("The cell around ", corners[0],
                      " is turned inside out by this disorder. Choose a smaller one (below ",
                      1. / (2 * dim), " no cell of equal spacings can be), or another `Seed`."));
      }

      for (auto &vertex : vertices)
        vertex = dealii::Point<dim>(rotation * vertex);

      create_coarse_mesh(
          vertices, cells, [](const auto &, const unsigned int face) { return face; },
          mesh.triangulation);
      mesh.triangulation.refine_global(refinements);

      for (unsigned int d = 0; d < dim; ++d)
      {
        mesh.boundary_names[std::string(1, axis_names[d]) + " min"] = 2 * d;
        mesh.boundary_names[std::string(1, axis_names[d]) + " max"] = 2 * d + 1;
      }
    }

  private:
    double number_of_coarse_cells() const
    {
      double product = 1;
      for (const auto &axis : segments)
        product *= static_cast<double>(tombolo::n_cells(axis)) / (1u << refinements);
      return product;
    }

    void check_counts() const
    {
      // In floating point, since the product may be beyond any integer.
      const double n_coarse_cells = number_of_coarse_cells();
      double n_vertices = 1;
      for (const auto &axis : segments)
        n_vertices *= static_cast<double>(tombolo::n_cells(axis)) + 1;
      constexpr auto most_vertices =
          std::numeric_limits<dealii::types::global_dof_index>::max() - 1;
      if (n_vertices > static_cast<double>(most_vertices))
        section.fail("Cells", as_text("The box would have ", n_vertices, " nodes. At most ",
                                      most_vertices, " are possible with this deal.II."));
      if (n_coarse_cells > static_cast<double>(most_coarse_cells))
        section.fail("Cells",
                     as_text("The box would have ", n_coarse_cells,
                             " coarse cells of about 2 kB each on every rank; at most ",
                             most_coarse_cells, " are allowed. ",
                             disorder > 0
                                 ? "A mesh with disorder is not refined: choose fewer cells."
                                 : "Choose counts that are all multiples of a larger power of two, "
                                   "so that the mesh is refined from fewer cells."));
    }

    void set_rotation(const double degrees, const std::vector<double> &direction)
    {
      dealii::Tensor<1, 3> axis({direction[0], direction[1], direction[2]});
      if (!std::isfinite(axis.norm()) || axis.norm() == 0)
        section.fail("Rotation axis", "The direction must be finite and not zero.");
      axis /= axis.norm();
      const auto matrix = dealii::Physics::Transformations::Rotations::rotation_matrix_3d(
          axis, degrees * dealii::numbers::PI / 180.);
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          rotation[i][j] = degrees == 0 ? (i == j ? 1. : 0.) : matrix[i][j];
    }

    /** The coordinates of the coarse vertices along each axis. */
    std::array<std::vector<double>, dim> coarse_coordinates() const
    {
      std::array<std::vector<double>, dim> coordinates;
      for (int d = 0; d < dim; ++d)
      {
        std::vector<AxisSegment> coarse = segments[d];
        for (auto &segment : coarse)
          segment.n_cells >>= refinements;
        coordinates[d] = segment_coordinates(coarse);
      }
      return coordinates;
    }

    /** Displaces the vertices, lexicographic on the lattice of these coordinates. */
    void displace(const std::array<std::vector<double>, dim> &coordinates,
                  std::vector<dealii::Point<dim>> &vertices) const
    {
      for (std::size_t v = 0; v < vertices.size(); ++v)
      {
        const auto index = lattice_index(v, coordinates, 0);
        bool on_surface = false;
        for (int d = 0; d < dim; ++d)
          on_surface = on_surface || index[d] == 0 || index[d] + 1 == coordinates[d].size();
        if (on_surface && !surface_nodes_slide)
          continue;
        for (int d = 0; d < dim; ++d)
          if (index[d] > 0 && index[d] + 1 < coordinates[d].size())
          {
            const double *x = &coordinates[d][index[d]];
            const double spacing = std::min(x[1] - x[0], x[0] - x[-1]);
            vertices[v][d] += disorder * spacing * scatter(seed, v, d);
          }
      }
    }

    Section section;
    std::array<std::vector<AxisSegment>, dim> segments;
    unsigned int refinements = 0;
    double disorder = 0;
    unsigned int seed = 0;
    bool surface_nodes_slide = false;
    Tensor<2, dim> rotation;
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(MeshSource, Box, "box",
                                  "A box of cells, each axis divided evenly or in segments")
} // namespace tombolo
