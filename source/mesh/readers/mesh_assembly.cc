// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/input_file.h>
#include <tombolo/mesh/boundary_names.h>
#include <tombolo/mesh/cell_quality.h>
#include <tombolo/mesh/mesh_source.h>
#include <tombolo/mesh/readers/cell_axes.h>
#include <tombolo/mesh/readers/mesh_file.h>
#include <tombolo/mesh/readers/overlapping_sets.h>

#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>

namespace tombolo
{
  namespace
  {
    constexpr unsigned int no_node = std::numeric_limits<unsigned int>::max();

    /** Indices of deal.II's (lexicographic) corners in the numbering of the files. */
    constexpr std::array<unsigned int, 8> corner_in_file = {{0, 1, 3, 2, 4, 5, 7, 6}};

    /** The nodes of a face in increasing order, by which two cells recognize it. */
    using FaceKey = std::array<unsigned int, 4>;

    FaceKey make_key(FaceKey nodes, const unsigned int n_nodes)
    {
      std::sort(nodes.begin(), nodes.begin() + n_nodes);
      return nodes;
    }

    struct CellFace
    {
      FaceKey key = {};
      unsigned int cell = 0;

      bool operator<(const CellFace &other) const
      {
        return std::tie(key, cell) < std::tie(other.key, other.cell);
      }
    };

    std::string boundary_name(const MeshFileContent &content, const unsigned int id)
    {
      for (const auto &[name, number] : content.boundary_names)
        if (number == id)
          return name;
      return std::to_string(id);
    }

    template <int dim>
    class MeshAssembly
    {
    public:
      MeshAssembly(const MeshFileContent &content, const double scale, Mesh<dim> &mesh)
          : content(content), scale(scale), mesh(mesh)
      {}

      void run()
      {
        if (content.cells.empty())
          throw MeshFileError(std::string("there are no ") + cell_shape(dim) +
                              ". (If physical groups are defined, gmsh saves only what is in one: "
                              "the cells need one too.)");
        collect_vertices();
        collect_cells();
        name_groups();
        collect_faces();
        name_boundaries();
        remark_coincident_vertices();
        remark_sizes();
        triangulate();
        mesh.remarks.insert(mesh.remarks.end(), content.remarks.begin(), content.remarks.end());
      }

    private:
      static constexpr unsigned int n_corners = dealii::GeometryInfo<dim>::vertices_per_cell;
      static constexpr unsigned int n_face_corners = dealii::GeometryInfo<dim>::vertices_per_face;

      void collect_vertices()
      {
        vertex_of_node.assign(content.nodes.size(), no_node);
        for (const auto &cell : content.cells)
          for (unsigned int k = 0; k < n_corners; ++k)
            vertex_of_node[cell.nodes[k]] = 0;

        double lowest = std::numeric_limits<double>::max();
        double highest = std::numeric_limits<double>::lowest();
        double largest = 0;
        for (std::size_t n = 0; n < content.nodes.size(); ++n)
          if (vertex_of_node[n] != no_node)
          {
            const auto &node = content.nodes[n];
            vertex_of_node[n] = static_cast<unsigned int>(vertices.size());
            dealii::Point<dim> vertex;
            for (unsigned int d = 0; d < dim; ++d)
            {
              vertex[d] = scale * node[d];
              largest = std::max(largest, std::abs(node[d]));
              if (!std::isfinite(vertex[d]))
                throw MeshFileError("coordinates are not finite with this scale.");
            }
            vertices.push_back(vertex);
            lowest = std::min(lowest, node[2]);
            highest = std::max(highest, node[2]);
          }
        if (dim == 2 && highest - lowest > 1e-9 * largest)
          throw MeshFileError("the mesh does not lie in the x-y plane: its z go from " +
                              std::to_string(lowest) + " to " + std::to_string(highest) +
                              ". Allowed in two dimensions is a plane mesh of equal z.");
      }

      void collect_cells()
      {
        std::size_t n_turned = 0;
        unsigned int first_turned_line = 0;
        cells.reserve(content.cells.size());
        for (const auto &cell : content.cells)
        {
          dealii::CellData<dim> data(n_corners);
          CellVertices<dim> corners;
          const auto set_corners = [&]()
          {
            for (unsigned int k = 0; k < n_corners; ++k)
              corners[k] = vertices[data.vertices[k]];
          };
          for (unsigned int k = 0; k < n_corners; ++k)
            data.vertices[k] = vertex_of_node[cell.nodes[corner_in_file[k]]];

          const std::set<unsigned int> distinct(data.vertices.begin(), data.vertices.end());
          if (distinct.size() < n_corners)
            fail_at(cell.line, std::string("A cell has the same node twice: it is no "
                                           "whole cell. Allowed are ") +
                                   cell_shape(dim) + " only.");

          set_corners();
          if (mean_corner_volume<dim>(corners) < 0)
          {
            // Mirror the numbering: exchange bottom and top in 3-D, the middle corners in 2-D.
            if (dim == 3)
              std::swap_ranges(data.vertices.begin(), data.vertices.begin() + n_corners / 2,
                               data.vertices.begin() + n_corners / 2);
            else
              std::swap(data.vertices[1], data.vertices[2]);
            set_corners();
            if (n_turned++ == 0)
              first_turned_line = cell.line;
          }
          const double quality = smallest_corner<dim>(corners);
          if (!(quality > smallest_usable_corner))
            fail_at(cell.line, std::string("A cell is ") + (quality < 0 ? "twisted" : "flat") +
                                   ": the determinant of the unit edges at one of its corners is " +
                                   std::to_string(quality) + ", and must be larger than " +
                                   std::to_string(smallest_usable_corner) + ".");
          cells.push_back(data);
        }
        if (n_turned > 0)
          mesh.remarks.push_back(std::to_string(n_turned) + " of " + std::to_string(cells.size()) +
                                 " cells of the mesh file are numbered the wrong way round (the "
                                 "first on " +
                                 content.location(first_turned_line) +
                                 ") and had to be turned round.");
      }

      void name_groups()
      {
        OverlappingSets sets(content.group_names);
        std::vector<unsigned int> combinations(cells.size(), OverlappingSets::none);
        for (std::size_t c = 0; c < cells.size(); ++c)
          if (content.cells[c].id != 0)
            combinations[c] =
                sets.extended(OverlappingSets::none, sets.set_of_id(content.cells[c].id));
        for (const auto &set : content.cell_sets)
        {
          const unsigned int number = sets.set_of_name(set.name);
          for (const unsigned int c : set.members)
            combinations[c] = sets.extended(combinations[c], number);
        }
        sets.assign_ids(combinations);
        for (std::size_t c = 0; c < cells.size(); ++c)
          cells[c].material_id = sets.id_of(combinations[c]);

        const auto ids = sets.ids_of_names();
        split_names(ids, mesh.group_names, mesh.joint_groups);
        for (const auto &[name, id] : content.group_names)
          if (ids.count(name) == 0)
            mesh.group_names.emplace(name, id);
      }

      void collect_faces()
      {
        faces.reserve(cells.size() * dealii::GeometryInfo<dim>::faces_per_cell);
        for (std::size_t c = 0; c < cells.size(); ++c)
          for (unsigned int f = 0; f < dealii::GeometryInfo<dim>::faces_per_cell; ++f)
          {
            CellFace face;
            face.cell = static_cast<unsigned int>(c);
            for (unsigned int k = 0; k < n_face_corners; ++k)
              face.key[k] =
                  cells[c].vertices[dealii::GeometryInfo<dim>::face_to_cell_vertices(f, k)];
            face.key = make_key(face.key, n_face_corners);
            faces.push_back(face);
          }
        std::sort(faces.begin(), faces.end());

        const auto sorted_vertices = [this](const unsigned int cell) {
          return std::set<unsigned int>(cells[cell].vertices.begin(), cells[cell].vertices.end());
        };
        for (std::size_t i = 0; i + 1 < faces.size(); ++i)
          if (faces[i].key == faces[i + 1].key)
          {
            const unsigned int line = content.cells[faces[i].cell].line;
            const unsigned int other_line = content.cells[faces[i + 1].cell].line;
            if (sorted_vertices(faces[i].cell) == sorted_vertices(faces[i + 1].cell))
              fail_at(std::max(line, other_line), "The cell stands on " +
                                                      content.location(std::min(line, other_line)) +
                                                      " already.");
            if (i + 2 < faces.size() && faces[i].key == faces[i + 2].key)
              fail_at(std::max(line, other_line), "More than two cells have a face in common.");
          }
      }

      void name_boundaries()
      {
        OverlappingSets sets(content.boundary_names);
        for (const auto &named : content.faces)
          if (named.id != 0)
            add_named_face(named, sets);
        add_boundaries_of_nodes(sets);

        std::vector<unsigned int> combinations;
        for (const auto &face : boundaries_of_face)
          combinations.push_back(face.second);
        sets.assign_ids(combinations);
        for (const auto &[key, combination] : boundaries_of_face)
          id_of_face[key] = sets.id_of(combination);
        split_names(sets.ids_of_names(), mesh.boundary_names, mesh.joint_boundaries);
        remark_inner_and_empty_boundaries();
      }

      /** Adds the face to a boundary, or counts it in n_inner if two cells have it. */
      void add_named_face(const MeshFileElement &named, OverlappingSets &sets)
      {
        CellFace face;
        bool has_vertices = true;
        for (unsigned int k = 0; k < n_face_corners; ++k)
        {
          face.key[k] = vertex_of_node[named.nodes[k]];
          has_vertices = has_vertices && face.key[k] != no_node;
        }
        face.key = make_key(face.key, n_face_corners);
        const auto found = std::lower_bound(faces.begin(), faces.end(), face);
        if (!has_vertices || found == faces.end() || found->key != face.key)
          fail_at(named.line,
                  "A face of \"" + boundary_name(content, named.id) + "\" is no face of a cell.");
        if (std::next(found) != faces.end() && std::next(found)->key == face.key)
        {
          ++n_inner[named.id];
          return;
        }
        unsigned int &combination = boundaries_of_face[face.key];
        combination = sets.extended(combination, sets.set_of_id(named.id));
      }

      void add_boundaries_of_nodes(OverlappingSets &sets)
      {
        if (content.node_sets.empty())
          return;
        std::vector<FaceKey> boundary_faces;
        for (std::size_t i = 0; i < faces.size(); ++i)
          if (i + 1 < faces.size() && faces[i].key == faces[i + 1].key)
            ++i;
          else
            boundary_faces.push_back(faces[i].key);

        std::string without_faces, with_loose_nodes;
        for (const auto &set : content.node_sets)
        {
          std::set<unsigned int> in_set;
          for (const unsigned int node : set.members)
            if (vertex_of_node[node] != no_node)
              in_set.insert(vertex_of_node[node]);
          std::set<unsigned int> on_faces;
          const unsigned int number = sets.set_of_name(set.name);
          for (const FaceKey &key : boundary_faces)
            if (std::all_of(key.begin(), key.begin() + n_face_corners,
                            [&](const unsigned int vertex) { return in_set.count(vertex) > 0; }))
            {
              unsigned int &combination = boundaries_of_face[key];
              combination = sets.extended(combination, number);
              on_faces.insert(key.begin(), key.begin() + n_face_corners);
            }
          std::string &list = on_faces.empty() ? without_faces : with_loose_nodes;
          if (on_faces.size() < in_set.size() || on_faces.empty())
            list += (list.empty() ? "\"" : ", \"") + set.name + "\" (" +
                    std::to_string(in_set.size() - on_faces.size()) + " of " +
                    std::to_string(in_set.size()) + " nodes)";
        }
        const std::string begin =
            "A set of nodes names the faces of the boundary of which it has all "
            "nodes. ";
        if (!without_faces.empty())
          mesh.remarks.push_back(begin + "There is no such face, and so no boundary, for " +
                                 without_faces + ".");
        if (!with_loose_nodes.empty())
          mesh.remarks.push_back(begin + "Nodes that are on none of these faces are left out of " +
                                 with_loose_nodes + ".");
      }

      void remark_inner_and_empty_boundaries()
      {
        for (const auto &[name, id] : content.boundary_names)
        {
          const bool is_boundary =
              mesh.boundary_names.count(name) > 0 || mesh.joint_boundaries.count(name) > 0;
          const auto inner = n_inner.find(id);
          if (inner != n_inner.end())
            mesh.remarks.push_back(
                "The surface \"" + name + "\" of the mesh file lies inside the body with " +
                std::to_string(inner->second) +
                (is_boundary ? " of its faces; only the others are a boundary."
                             : " faces: it is no boundary. Parts that meet there share its nodes "
                               "without more ado."));
          else if (!is_boundary)
            mesh.remarks.push_back("The surface \"" + name + "\" of the mesh file has no faces.");
        }
      }

      void remark_sizes()
      {
        // A millimetre taken for a metre makes a factor of a thousand; no mesh needs half of it.
        constexpr double largest_ratio = 500;
        std::map<dealii::types::material_id, std::pair<double, double>> sums;
        for (const auto &cell : cells)
        {
          auto &[length, n_cells] = sums[cell.material_id];
          length += vertices[cell.vertices[0]].distance(vertices[cell.vertices[1]]);
          ++n_cells;
        }
        const auto mean = [](const auto &entry)
        { return entry.second.first / entry.second.second; };
        const auto [small, large] = std::minmax_element(sums.begin(), sums.end(),
                                                        [&mean](const auto &a, const auto &b)
                                                        { return mean(a) < mean(b); });
        if (mean(*large) > largest_ratio * mean(*small))
        {
          std::ostringstream text;
          text << "Cells of material " << large->first << " have edges of " << mean(*large)
               << " on average, those of material " << small->first << " of " << mean(*small)
               << ": the units of the mesh file are probably mixed (m and mm make a factor of "
                  "1000). "
                  "All coordinates must be in one unit.";
          mesh.remarks.push_back(text.str());
        }
      }

      [[noreturn]] void fail_at(const unsigned int line, const std::string &message) const
      {
        throw MeshFileError(content.location(line) + ": " + message);
      }

      void remark_coincident_vertices()
      {
        double largest = 0;
        for (const auto &vertex : vertices)
          for (unsigned int d = 0; d < dim; ++d)
            largest = std::max(largest, std::abs(vertex[d]));
        std::vector<std::array<long long, dim>> raster_points(vertices.size());
        for (std::size_t v = 0; v < vertices.size(); ++v)
          for (unsigned int d = 0; d < dim; ++d)
            // An offset that round coordinates do not have keeps them off the edges of the raster.
            raster_points[v][d] = std::llround(vertices[v][d] / (1e-10 * largest) + 0.237);
        std::sort(raster_points.begin(), raster_points.end());
        std::size_t n_coincident = 0;
        for (std::size_t v = 0; v + 1 < raster_points.size(); ++v)
          if (raster_points[v] == raster_points[v + 1])
            ++n_coincident;
        if (n_coincident > 0)
          mesh.remarks.push_back(
              std::to_string(n_coincident) +
              " nodes of the mesh file lie where another one lies: the cells on the two sides are "
              "not joined there. If they should be, merge the nodes in the mesh generator.");
      }

      void triangulate()
      {
        dealii::Triangulation<dim> coarse;
        try
        {
          dealii::GridTools::consistently_order_cells(cells);
          if constexpr (dim == 3)
            turn_axes_by_position(vertices, cells);
          coarse.create_triangulation(vertices, cells, dealii::SubCellData());
        }
        catch (const dealii::ExceptionBase &)
        {
          throw MeshFileError(
              "the cells do not fit together: neighbours must share whole faces, and "
              "edges only where they share all nodes of them.");
        }
        Assert(coarse.all_reference_cells_are_hyper_cube(), dealii::ExcInternalError());
        for (const auto &cell : coarse.active_cell_iterators())
          for (const unsigned int f : cell->face_indices())
            if (cell->face(f)->at_boundary())
            {
              FaceKey key = {};
              for (unsigned int k = 0; k < n_face_corners; ++k)
                key[k] = cell->face(f)->vertex_index(k);
              const auto found = id_of_face.find(make_key(key, n_face_corners));
              if (found != id_of_face.end())
                cell->face(f)->set_boundary_id(found->second);
            }
        mesh.triangulation.copy_triangulation(coarse);
      }

      const MeshFileContent &content;
      const double scale;
      Mesh<dim> &mesh;
      std::vector<dealii::Point<dim>> vertices;
      /** Of each node of the file, no_node for those that no cell uses. */
      std::vector<unsigned int> vertex_of_node;
      std::vector<dealii::CellData<dim>> cells;
      /** Two entries for each inner face, one for each boundary face; sorted. */
      std::vector<CellFace> faces;
      /** The combination of boundaries that a face is in. */
      std::map<FaceKey, unsigned int> boundaries_of_face;
      std::map<FaceKey, dealii::types::boundary_id> id_of_face;
      std::map<unsigned int, std::size_t> n_inner; ///< faces between two cells, by boundary
    };
  } // namespace

  template <int dim>
  void assemble_mesh(const MeshFileContent &content, const double scale, Mesh<dim> &mesh)
  {
    MeshAssembly<dim>(content, scale, mesh).run();
  }

  template <int dim>
  std::vector<long long> numbers_of_vertices(const MeshFileContent &content)
  {
    std::vector<bool> is_corner(content.nodes.size(), false);
    for (const auto &cell : content.cells)
      for (unsigned int k = 0; k < dealii::GeometryInfo<dim>::vertices_per_cell; ++k)
        is_corner[cell.nodes[k]] = true;
    std::vector<long long> result;
    for (std::size_t n = 0; n < content.nodes.size(); ++n)
      if (is_corner[n])
        result.push_back(content.node_numbers[n]);
    return result;
  }

  template std::vector<long long> numbers_of_vertices<2>(const MeshFileContent &);
  template std::vector<long long> numbers_of_vertices<3>(const MeshFileContent &);
  template void assemble_mesh(const MeshFileContent &, double, Mesh<2> &);
  template void assemble_mesh(const MeshFileContent &, double, Mesh<3> &);

  /**
   * A mesh from a file of gmsh (.msh) or VTK (.vtk), of hexahedra (quadrilaterals in 2-D). Named
   * groups of cells and named boundaries keep their names. Cells that are numbered the wrong way
   * round are turned, and named surfaces inside the body are no boundaries; both are remarked.
   * Rank 0 reads the file and sends it to the others.
   */
  template <int dim>
  class FileMesh : public MeshSource<dim>
  {
  public:
    explicit FileMesh(const Entries &e) : section(e.section())
    {
      file = e.text(
          "File", mandatory, "",
          "The mesh: a .msh of gmsh (2.2 or 4.1, text or binary; physical groups name groups "
          "of cells, boundaries and sets of nodes), or a legacy .vtk 3.0 (\"SCALARS MaterialID "
          "int\"). scripts/import makes one of a deck of Abaqus or LS-DYNA. It is looked for in "
          "the directory of the parameter file and then in the working directory.");
      e.refuse(file.empty(), "File", "The name of the mesh file is empty.");
      const std::string kind = extension_of(file);
      e.refuse(kind == ".inp" || kind == ".k" || kind == ".key" || kind == ".dyn", "File",
               "This is a deck. scripts/import " + file +
                   " makes a mesh of it (.msh), and a parameter file.");
      is_of_gmsh = kind == ".msh";
      e.refuse(!is_of_gmsh && kind != ".vtk", "File",
               "The kind of the file is told from the end of its name. Allowed are .msh (gmsh) and "
               ".vtk (VTK, legacy).");
      scale = e.number("Scale", "1", positive(), "",
                       "Coordinates are multiplied by this, for example 0.001 for a file in "
                       "millimetres in a scene in metres.");
    }

    void create(Mesh<dim> &mesh) const override
    {
      const MPI_Comm communicator = communicator_of(mesh.triangulation);
      try
      {
        const MeshFileContent content = read(communicator);
        const auto n_cells = static_cast<double>(content.cells.size());
        refuse_more_than_memory(section, "File", n_cells, n_cells, communicator);
        assemble_mesh<dim>(content, scale, mesh);
      }
      catch (const MeshFileError &error)
      {
        section.fail("File", "In \"" + file + "\", " + error.what());
      }
    }

    std::vector<long long> node_numbers() const override
    {
      try
      {
        return numbers_of_vertices<dim>(read(section.all().communicator()));
      }
      catch (const MeshFileError &error)
      {
        section.fail("File", "In \"" + file + "\", " + error.what());
      }
    }

  private:
    MeshFileContent read(const MPI_Comm communicator) const
    {
      const std::string text = decoded_text(read_input_file(section, "File", communicator));
      return is_of_gmsh ? read_gmsh(text, dim) : read_vtk(text, dim);
    }

    Section section;
    std::string file;
    bool is_of_gmsh;
    double scale;
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(MeshSource, FileMesh, "file",
                                  "A mesh of gmsh (.msh) or VTK (.vtk)")
} // namespace tombolo
