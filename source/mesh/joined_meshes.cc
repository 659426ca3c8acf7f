// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/joined_meshes.h>

#include <tombolo/base/format.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/mesh/chosen_mesh.h>
#include <tombolo/mesh/communicator_of.h>
#include <tombolo/mesh/convex_hulls.h>
#include <tombolo/mesh/joined_ids.h>
#include <tombolo/mesh/memory_check.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/mpi.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/tria.h>
#include <deal.II/numerics/rtree.h>

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
  namespace
  {
    const std::string list_of_meshes = "Meshes";

    /** The number of a node that has none. */
    constexpr long long no_number = std::numeric_limits<long long>::min();

    /** Coordinates beyond which volumes are not numbers any more. */
    constexpr double largest_coordinate = 1e90;

    /** Cells that overlap after each corner has moved by this share towards the centre are in the
     * same place. Bodies that touch along curved faces, which flat faces of cells replace, overlap
     * by less: a fifth of a cell where both have cells of one size. */
    constexpr double tolerated_share = 0.2;

    template <int dim, typename Cell>
    CellCorners<dim> corners_of(const Cell &cell)
    {
      CellCorners<dim> result;
      for (const unsigned int v : cell->vertex_indices())
        result[v] = cell->vertex(v);
      return result;
    }
  } // namespace

  template <int dim>
  JoinedMeshes<dim>::Member::Member(const Section &section)
      : name(section.name()), section(section), source(chosen_mesh_source<dim>(section)),
        placement(section)
  {}

  template <int dim>
  void JoinedMeshes<dim>::declare_parameters(Parameters &parameters)
  {
    const Entries e(parameters.handler());
    e.text(list_of_meshes, "", "",
           "Names of meshes of bodies that share no nodes, each with a section `Mesh: NAME`, whose "
           "sources have the sections that they have in `Mesh`; they stand in place of its "
           "`Type`.");
    for (const std::string &name : section_names(parameters, list_of_meshes))
    {
      const Entries of_mesh = e.subsection("Mesh: " + name);
      chosen_mesh_source<dim>(of_mesh);
      declare<MeshPlacement<dim>>(of_mesh);
    }
  }

  template <int dim>
  std::unique_ptr<JoinedMeshes<dim>> JoinedMeshes<dim>::read(const Parameters &parameters)
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

  template <int dim>
  struct JoinedMeshes<dim>::Pieces
  {
    std::vector<Triangulation<dim>> meshes;                ///< of one level each
    unsigned int n_refinements = 0;                        ///< of all
    std::map<types::material_id, unsigned int> mesh_of_id; ///< of cells
    JoinedIds boundaries, groups;
    std::vector<std::string> remarks;
  };

  template <int dim>
  typename JoinedMeshes<dim>::Pieces
  JoinedMeshes<dim>::read_pieces(const MPI_Comm communicator) const
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
      std::set<unsigned int> of_mesh;
      for (const auto &cell : coarse.active_cell_iterators())
      {
        cell->set_material_id(result.groups.id(cell->material_id()));
        of_mesh.insert(cell->material_id());
      }
      for (const unsigned int id : of_mesh)
        result.mesh_of_id[id] = m;
      result.groups.add_name("mesh " + member.name, of_mesh);
      for (const auto &[number, id] : result.groups.known())
      {
        if (of_mesh.size() < 2)
          continue;
        result.groups.add_name(member.name + ".material " + std::to_string(number), {id});
        if (number != id)
          result.remarks.push_back("Cells of material " + std::to_string(number) + " of the mesh " +
                                   in_quotes(member.name) + " have the number " +
                                   std::to_string(id) + " here: an earlier mesh has that one.");
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

  template <int dim>
  void JoinedMeshes<dim>::create(Mesh<dim> &mesh) const
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
    pieces.boundaries.give_names(mesh.boundary_names, mesh.joint_boundaries);
    pieces.groups.give_names(mesh.group_names, mesh.joint_groups);
    mesh.remarks = pieces.remarks;
    refuse_overlap(mesh, pieces);
  }

  template <int dim>
  void JoinedMeshes<dim>::refuse_overlap(const Mesh<dim> &mesh, const Pieces &pieces) const
  {
    // Level 0 has all cells on all ranks, each as large as 2^n of those that are compared with it.
    const double share_of_coarse =
        std::ldexp(tolerated_share, -static_cast<int>(pieces.n_refinements));
    std::vector<std::vector<CellCorners<dim>>> cells(members.size());
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
      Point<dim> place;
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
    found = of_all_ranks(found, communicator_of(mesh.triangulation));
    if (found.empty())
      return;
    const auto key = [](const Overlap &overlap)
    {
      std::array<double, dim> place;
      std::copy_n(overlap.place.begin_raw(), dim, place.begin());
      return std::make_tuple(overlap.mesh, overlap.other, place);
    };
    const Overlap first =
        *std::min_element(found.begin(), found.end(),
                          [&](const Overlap &a, const Overlap &b) { return key(a) < key(b); });
    members[first.other].section.fail(
        "",
        "the meshes " + in_quotes(members[first.mesh].name) + " and " +
            in_quotes(members[first.other].name) + " overlap: the cell of the first one at " +
            place_text(first.place) +
            " goes into a cell of the other one. Bodies can touch, but not be in the same place: "
            "move one by `Shift`.");
  }

  template <int dim>
  std::vector<long long> JoinedMeshes<dim>::node_numbers() const
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

  template class JoinedMeshes<2>;
  template class JoinedMeshes<3>;
} // namespace tombolo
