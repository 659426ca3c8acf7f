// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/mesh/boundary_names.h>
#include <tombolo/mesh/cell_quality.h>
#include <tombolo/mesh/mesh_source.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/numbers.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/tria.h>
#include <deal.II/numerics/rtree.h>
#include <deal.II/physics/transformations.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace tombolo
{
  using NamedIds = std::map<std::string, std::set<unsigned int>>;

  /** The ids that faces or cells of all meshes have, and their names. */
  class JoinedIds
  {
  public:
    void begin_mesh(const std::string &name)
    {
      mesh = name;
      new_ids.clear();
    }

    /** The id here of an id of the present mesh: the same where no earlier mesh has it. */
    unsigned int id(const unsigned int own)
    {
      const auto [found, is_new] = new_ids.emplace(own, own);
      if (is_new && !taken.insert(own).second)
        taken.insert(found->second = *taken.rbegin() + 1);
      return found->second;
    }

    /** By ids of the present mesh that are known so far. */
    const std::map<unsigned int, unsigned int> &known() const
    {
      return new_ids;
    }

    void add_names(const std::map<std::string, unsigned int> &single, const NamedIds &joint)
    {
      NamedIds names = joint;
      for (const auto &[name, own] : single)
        names[name].insert(own);
      for (const auto &[name, own_ids] : names)
      {
        std::set<unsigned int> here;
        for (const unsigned int own : own_ids)
          here.insert(id(own));
        add_name(mesh + "." + name, here);
        unqualified[name].push_back(here);
      }
    }

    void add_name(const std::string &name, const std::set<unsigned int> &here)
    {
      all[name].insert(here.begin(), here.end());
    }

    /** The names of all meshes, those with one id and those with several. */
    void collect_names(std::map<std::string, unsigned int> &single, NamedIds &joint) const
    {
      NamedIds names = all;
      for (const auto &[name, mesh_ids] : unqualified)
        if (mesh_ids.size() == 1)
          names.emplace(name, mesh_ids.front());
      split_names(names, single, joint);
    }

  private:
    std::string mesh;
    std::map<unsigned int, unsigned int> new_ids; ///< here, by ids of the present mesh
    std::set<unsigned int> taken;
    NamedIds all;
    std::map<std::string, std::vector<std::set<unsigned int>>> unqualified; ///< of each mesh
  };

  namespace
  {
    const std::string list_of_meshes = "Meshes";

    /** The number of a node that has none. */
    constexpr long long no_number = std::numeric_limits<long long>::min();

    /** Coordinates beyond which volumes are not numbers any more. */
    constexpr double largest_coordinate = 1e90;

    /** Cells that overlap after each corner has moved by this share towards the centre are at the
     * same position. Bodies that touch along curved faces, which flat faces of cells replace,
     * overlap by less: a fifth of a cell where both have cells of one size. */
    constexpr double tolerated_share = 0.2;

    template <int dim, typename Cell>
    CellVertices<dim> corners_of(const Cell &cell)
    {
      CellVertices<dim> result;
      for (const unsigned int v : cell->vertex_indices())
        result[v] = cell->vertex(v);
      return result;
    }

    /** The source of the entry `Type`: declares it and the entries of all sources, or reads. */
    template <int dim>
    std::unique_ptr<MeshSource<dim>> chosen_mesh_source(const Entries &e)
    {
      auto source = e.plugin<MeshSource<dim>>("Type", mandatory, "Where the mesh comes from.");
      e.plugins<MeshSource<dim>>();
      return source;
    }
  } // namespace

  /** Where a mesh is put: turned about a point or an axis through it, then shifted. */
  template <int dim>
  class MeshPlacement
  {
  public:
    explicit MeshPlacement(const Entries &e)
    {
      const std::string origin = dim == 2 ? "0, 0" : "0, 0, 0";
      const double degrees = e.number(
          "Rotation", "0", any_number(), "",
          dim == 2 ? "The angle by which the mesh is turned about `Rotation point`, before "
                     "it is shifted. Units: degrees"
                   : "The angle by which the mesh is turned about `Rotation axis`, before "
                     "it is shifted. Units: degrees");
      dealii::Tensor<1, 3> axis({0., 0., 1.});
      if (dim == 3)
      {
        const std::vector<double> direction =
            e.numbers("Rotation axis", "0, 0, 1", dim, "",
                      "The direction of the axis of the rotation; its length is of no importance.");
        std::copy_n(direction.begin(), dim, axis.begin_raw());
        e.refuse(!std::isfinite(axis.norm()) || axis.norm() == 0., "Rotation axis",
                 "The direction must be finite and not zero.");
      }
      const std::vector<double> point =
          e.numbers("Rotation point", origin, dim, "L",
                    dim == 2 ? "The point that the rotation leaves where it is."
                             : "A point that the axis of the rotation passes through.");
      const std::vector<double> displacement =
          e.numbers("Shift", origin, dim, "L", "By what the mesh is displaced, all of it.");
      if (e.declares())
        return;
      std::copy_n(point.begin(), dim, centre.begin_raw());
      std::copy_n(displacement.begin(), dim, shift.begin_raw());
      is_turned = degrees != 0.;
      const dealii::Tensor<2, 3> matrix =
          dealii::Physics::Transformations::Rotations::rotation_matrix_3d(
              axis / axis.norm(), degrees * dealii::numbers::PI / 180.);
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
        {
          // Quarters of a turn are exact.
          const double nearest = std::round(matrix[i][j]);
          rotation[i][j] = std::abs(matrix[i][j] - nearest) < 1e-15 ? nearest : matrix[i][j];
        }
    }

    dealii::Point<dim> operator()(const dealii::Point<dim> &point) const
    {
      return (is_turned ? centre + rotation * (point - centre) : point) + shift;
    }

  private:
    bool is_turned = false;
    dealii::Tensor<2, dim> rotation;
    dealii::Point<dim> centre;
    dealii::Tensor<1, dim> shift;
  };

  /**
   * Several meshes beside each other, `set Meshes = a, b`, each with a section `Mesh: NAME` that
   * sets its source and its position. They share no nodes, wherever these lie, and may touch but
   * not overlap. Boundaries and groups of cells are called "a.NAME", and "NAME" where only one mesh
   * has it; all cells of a mesh are the group "mesh a". Ids of faces and of cells that an earlier
   * mesh has are counted on. All cells are refined as often as those of each source are at least;
   * cells of a source that refines more often are coarse cells here.
   */
  template <int dim>
  class JoinedMeshes : public MeshSource<dim>
  {
  public:
    /** Declares the entry `Meshes` and the sections of its names. */
    static void declare_parameters(Parameters &parameters)
    {
      const Entries e(parameters.handler());
      e.text(
          list_of_meshes, "", "",
          "Names of meshes of bodies that share no nodes, each with a section `Mesh: NAME`, whose "
          "sources have the sections that they have in `Mesh`; they stand in place of its "
          "`Type`.");
      for (const std::string &name : section_names(parameters, list_of_meshes))
      {
        const Entries mesh_entries = e.subsection("Mesh: " + name);
        chosen_mesh_source<dim>(mesh_entries);
        declare<MeshPlacement<dim>>(mesh_entries);
      }
    }

    /** The meshes that the entry `Meshes` names, nullptr where it is empty. Throws InputError. */
    static std::unique_ptr<JoinedMeshes> read(const Parameters &parameters)
    {
      const Section root = parameters.section("");
      const std::vector<std::string> names = section_names(parameters, list_of_meshes);
      if (names.empty())
        return nullptr;
      if (parameters.section("Mesh").is_set("Type"))
        parameters.fail("Mesh/Type", "the meshes of the entry `" + list_of_meshes +
                                         "` have sections of their own, `Mesh: " + names.front() +
                                         "`: allowed is one of both.");
      std::unique_ptr<JoinedMeshes> result(new JoinedMeshes(root));
      for (const std::string &name : names)
      {
        if (name.find('.') != std::string::npos)
          root.fail(list_of_meshes, "the name " + in_quotes(name) +
                                        " contains \".\", which separates a mesh from its "
                                        "boundaries and groups: allowed are all other characters.");
        parameters.attempt([&]
                           { result->members.emplace_back(parameters.section("Mesh: " + name)); });
      }
      if (result->members.size() < names.size())
        throw KnownMistake("A mesh of the entry `" + list_of_meshes + "` could not be made.");
      return result;
    }

    /** Throws InputError, also where two meshes overlap. */
    void create(Mesh<dim> &mesh) const override
    {
      const Pieces pieces = read_pieces(communicator_of(mesh.triangulation));
      std::vector<Point<dim>> vertices;
      std::vector<CellData<dim>> cells;
      SubCellData faces;
      for (const Triangulation<dim> &piece : pieces.meshes)
      {
        const auto first_vertex = static_cast<unsigned int>(vertices.size());
        const auto append = [first_vertex](const auto &own, auto &all)
        {
          for (auto object : own)
          {
            for (unsigned int &vertex : object.vertices)
              vertex += first_vertex;
            all.push_back(object);
          }
        };
        const auto [own_vertices, own_cells, own_faces] =
            GridTools::get_coarse_mesh_description(piece);
        vertices.insert(vertices.end(), own_vertices.begin(), own_vertices.end());
        append(own_cells, cells);
        append(own_faces.boundary_lines, faces.boundary_lines);
        append(own_faces.boundary_quads, faces.boundary_quads);
      }
      Triangulation<dim> coarse;
      coarse.create_triangulation(vertices, cells, faces);
      mesh.triangulation.copy_triangulation(coarse);
      mesh.triangulation.refine_global(pieces.n_refinements);
      pieces.boundaries.collect_names(mesh.boundary_names, mesh.joint_boundaries);
      pieces.groups.collect_names(mesh.group_names, mesh.joint_groups);
      mesh.remarks = pieces.remarks;
      refuse_overlap(mesh, pieces);
    }

    /** Those of the sources that number their nodes; the smallest integer at nodes of others.
     * Throws the InputError that two meshes have a number in common. */
    std::vector<long long> node_numbers() const override
    {
      std::vector<std::vector<long long>> numbers;
      bool are_any = false;
      for (const Member &member : members)
      {
        numbers.push_back(member.source->node_numbers());
        are_any = are_any || !numbers.back().empty();
      }
      if (!are_any)
        return {};
      const Pieces pieces = read_pieces(root.all().communicator());
      std::vector<long long> result;
      std::map<long long, unsigned int> mesh_of_number;
      for (unsigned int m = 0; m < members.size(); ++m)
      {
        for (const long long number : numbers[m])
          if (const auto [other, is_new] = mesh_of_number.emplace(number, m); !is_new)
            root.fail(list_of_meshes, "the meshes " + in_quotes(members[other->second].name) +
                                          " and " + in_quotes(members[m].name) +
                                          " both have a node of the number " +
                                          std::to_string(number) +
                                          ", so that numbers do not say which is meant; take "
                                          "places in their stead.");
        numbers[m].resize(pieces.meshes[m].n_vertices(), no_number);
        result.insert(result.end(), numbers[m].begin(), numbers[m].end());
      }
      return result;
    }

  private:
    /** One of the meshes. */
    struct Member
    {
      explicit Member(const Section &section)
          : name(section.name()), section(section), source(chosen_mesh_source<dim>(section)),
            placement(section)
      {}

      std::string name;
      Section section;
      std::unique_ptr<MeshSource<dim>> source;
      MeshPlacement<dim> placement;
    };

    struct Pieces
    {
      std::vector<Triangulation<dim>> meshes;                ///< of one level each
      unsigned int n_refinements = 0;                        ///< of all
      std::map<types::material_id, unsigned int> mesh_of_id; ///< of cells
      JoinedIds boundaries, groups;
      std::vector<std::string> remarks;
    };

    explicit JoinedMeshes(const Section &root) : root(root) {}

    /** The cells and names of all meshes. Collective. */
    Pieces read_pieces(const MPI_Comm communicator) const
    {
      Pieces result;
      result.meshes.resize(members.size());
      std::vector<unsigned int> n_refinements;
      for (unsigned int m = 0; m < members.size(); ++m)
      {
        const Member &member = members[m];
        Mesh<dim> own(communicator);
        member.source->create(own);
        n_refinements.push_back(own.triangulation.n_global_levels() - 1);
        auto [vertices, cells, faces] = GridTools::get_coarse_mesh_description(own.triangulation);
        for (Point<dim> &vertex : vertices)
        {
          vertex = member.placement(vertex);
          if (!(Tensor<1, dim>(vertex).norm() <= largest_coordinate))
            member.section.fail("Shift", "the mesh has vertices that are not finite, or farther "
                                         "than 1e90 from the origin, where volumes are not numbers "
                                         "any more.");
        }
        Triangulation<dim> &coarse = result.meshes[m];
        coarse.create_triangulation(vertices, cells, faces);
        result.boundaries.begin_mesh(member.name);
        for (const auto &cell : coarse.active_cell_iterators())
          for (const auto &face : cell->face_iterators())
            if (face->at_boundary())
              face->set_boundary_id(result.boundaries.id(face->boundary_id()));
        result.boundaries.add_names(own.boundary_names, own.joint_boundaries);

        result.groups.begin_mesh(member.name);
        std::set<unsigned int> mesh_ids;
        for (const auto &cell : coarse.active_cell_iterators())
        {
          cell->set_material_id(result.groups.id(cell->material_id()));
          mesh_ids.insert(cell->material_id());
        }
        for (const unsigned int id : mesh_ids)
          result.mesh_of_id[id] = m;
        result.groups.add_name("mesh " + member.name, mesh_ids);
        for (const auto &[number, id] : result.groups.known())
        {
          if (mesh_ids.size() < 2)
            continue;
          result.groups.add_name(member.name + ".material " + std::to_string(number), {id});
          if (number != id)
            result.remarks.push_back("Cells of material " + std::to_string(number) +
                                     " of the mesh " + in_quotes(member.name) +
                                     " have the number " + std::to_string(id) +
                                     " here: an earlier mesh has that one.");
        }
        result.groups.add_names(own.group_names, own.joint_groups);
        for (const std::string &remark : own.remarks)
          result.remarks.push_back("Mesh " + in_quotes(member.name) + ": " + remark);
      }

      result.n_refinements = *std::min_element(n_refinements.begin(), n_refinements.end());
      double n_coarse_cells = 0;
      for (unsigned int m = 0; m < members.size(); ++m)
        n_coarse_cells += static_cast<double>(result.meshes[m].n_active_cells()) *
                          std::pow(2., dim * (n_refinements[m] - result.n_refinements));
      refuse_more_than_memory(root, list_of_meshes, n_coarse_cells,
                              n_coarse_cells * std::pow(2., dim * result.n_refinements),
                              communicator);
      for (unsigned int m = 0; m < members.size(); ++m)
        if (n_refinements[m] > result.n_refinements)
        {
          Triangulation<dim> flat;
          result.meshes[m].refine_global(n_refinements[m] - result.n_refinements);
          GridGenerator::flatten_triangulation(result.meshes[m], flat);
          result.meshes[m] = std::move(flat);
        }
      return result;
    }

    /** Refuses meshes of which two cells have more than a fringe in common. Collective. */
    void refuse_overlap(const Mesh<dim> &mesh, const Pieces &pieces) const
    {
      // Level 0 has all cells on all ranks, each as large as 2^n of those that are compared with
      // it.
      const double share_of_coarse =
          std::ldexp(tolerated_share, -static_cast<int>(pieces.n_refinements));
      std::vector<std::vector<CellVertices<dim>>> cells(members.size());
      std::vector<std::vector<BoundingBox<dim>>> boxes(members.size());
      for (const auto &cell : mesh.triangulation.cell_iterators_on_level(0))
      {
        const unsigned int m = pieces.mesh_of_id.at(cell->material_id());
        cells[m].push_back(shrunk_corners<dim>(corners_of<dim>(cell), share_of_coarse));
        boxes[m].push_back(cell->bounding_box());
      }
      /** A cell of one mesh that has a part in common with one of another. */
      struct Overlap
      {
        unsigned int mesh, other;
        Point<dim> position;
      };
      std::vector<Overlap> found;
      for (unsigned int other = 1; other < members.size(); ++other)
      {
        const auto tree = pack_rtree_of_indices(boxes[other]);
        std::vector<std::size_t> near;
        for (const auto &cell : mesh.triangulation.active_cell_iterators())
        {
          const unsigned int m = pieces.mesh_of_id.at(cell->material_id());
          if (!cell->is_locally_owned() || m >= other)
            continue;
          near.clear();
          tree.query(boost::geometry::index::intersects(cell->bounding_box()),
                     std::back_inserter(near));
          if (near.empty())
            continue;
          const auto corners = shrunk_corners<dim>(corners_of<dim>(cell), tolerated_share);
          if (std::any_of(near.begin(), near.end(),
                          [&](const std::size_t k)
                          { return have_points_in_common<dim>(corners, cells[other][k]); }))
            found.push_back({m, other, cell->center()});
        }
      }
      found = from_all_ranks(found, communicator_of(mesh.triangulation));
      if (found.empty())
        return;
      const auto key = [](const Overlap &overlap)
      {
        std::array<double, dim> coordinates;
        std::copy_n(overlap.position.begin_raw(), dim, coordinates.begin());
        return std::make_tuple(overlap.mesh, overlap.other, coordinates);
      };
      const Overlap first =
          *std::min_element(found.begin(), found.end(),
                            [&](const Overlap &a, const Overlap &b) { return key(a) < key(b); });
      members[first.other].section.fail(
          "",
          "the meshes " + in_quotes(members[first.mesh].name) + " and " +
              in_quotes(members[first.other].name) + " overlap: the cell of the first one at " +
              position_text(first.position) +
              " goes into a cell of the other one. Bodies can touch, but not be in the same place: "
              "move one by `Shift`.");
    }

    Section root;
    std::vector<Member> members;
  };

  template <int dim>
  void declare_mesh_sources(Parameters &parameters)
  {
    chosen_mesh_source<dim>(Entries(parameters.handler()).subsection("Mesh"));
    JoinedMeshes<dim>::declare_parameters(parameters);
  }

  template <int dim>
  std::unique_ptr<MeshSource<dim>> mesh_source(const Parameters &parameters)
  {
    if (auto joined = JoinedMeshes<dim>::read(parameters))
      return joined;
    return chosen_mesh_source<dim>(parameters.section("Mesh"));
  }

  template void declare_mesh_sources<2>(Parameters &);
  template void declare_mesh_sources<3>(Parameters &);
  template std::unique_ptr<MeshSource<2>> mesh_source<2>(const Parameters &);
  template std::unique_ptr<MeshSource<3>> mesh_source<3>(const Parameters &);

  namespace
  {
    template <int dim>
    bool is_separated_along(const Tensor<1, dim> &direction, const CellVertices<dim> &a,
                            const CellVertices<dim> &b)
    {
      const auto extent = [&](const CellVertices<dim> &cell)
      {
        double begin = std::numeric_limits<double>::max(), end = -begin;
        for (const Point<dim> &corner : cell)
        {
          const double projection = direction * corner;
          begin = std::min(begin, projection);
          end = std::max(end, projection);
        }
        return std::make_pair(begin, end);
      };
      const auto [begin_of_a, end_of_a] = extent(a);
      const auto [begin_of_b, end_of_b] = extent(b);
      return end_of_a < begin_of_b || end_of_b < begin_of_a;
    }

    template <int dim>
    Tensor<1, dim> edge_of(const CellVertices<dim> &cell, const unsigned int line)
    {
      using Geometry = GeometryInfo<dim>;
      return cell[Geometry::line_to_cell_vertices(line, 1)] -
             cell[Geometry::line_to_cell_vertices(line, 0)];
    }

    template <int dim>
    Tensor<1, dim> normal_of_face(const CellVertices<dim> &cell, const unsigned int face)
    {
      const auto corner = [&](const unsigned int k)
      { return cell[GeometryInfo<dim>::face_to_cell_vertices(face, k)]; };
      if constexpr (dim == 2)
        return cross_product_2d(corner(1) - corner(0));
      else
        return cross_product_3d(corner(3) - corner(0), corner(2) - corner(1));
    }
  } // namespace

  template <int dim>
  CellVertices<dim> shrunk_corners(const CellVertices<dim> &cell, const double share)
  {
    Tensor<1, dim> centre;
    for (const Point<dim> &corner : cell)
      centre += corner / static_cast<double>(cell.size());
    CellVertices<dim> result = cell;
    for (Point<dim> &corner : result)
      corner += share * (centre - corner);
    return result;
  }

  template <int dim>
  bool have_points_in_common(const CellVertices<dim> &a, const CellVertices<dim> &b)
  {
    for (const CellVertices<dim> *const cell : {&a, &b})
      for (const unsigned int f : GeometryInfo<dim>::face_indices())
        if (is_separated_along(normal_of_face(*cell, f), a, b))
          return false;
    if constexpr (dim == 3)
      for (unsigned int k = 0; k < GeometryInfo<dim>::lines_per_cell; ++k)
        for (unsigned int l = 0; l < GeometryInfo<dim>::lines_per_cell; ++l)
          if (is_separated_along(cross_product_3d(edge_of(a, k), edge_of(b, l)), a, b))
            return false;
    return true;
  }

  template CellVertices<2> shrunk_corners<2>(const CellVertices<2> &, double);
  template CellVertices<3> shrunk_corners<3>(const CellVertices<3> &, double);
  template bool have_points_in_common<2>(const CellVertices<2> &, const CellVertices<2> &);
  template bool have_points_in_common<3>(const CellVertices<3> &, const CellVertices<3> &);
} // namespace tombolo
