// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/joined_meshes.h>

#include <tombolo/base/format.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/mesh/chosen_mesh.h>
#include <tombolo/mesh/communicator_of.h>
#include <tombolo/mesh/joined_ids.h>
#include <tombolo/mesh/level_cells.h>
#include <tombolo/mesh/memory_check.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/mpi.h>
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
    std::vector<LevelCells<dim>> cells;                    ///< of each mesh
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
    std::vector<unsigned int> n_refinements;
    for (unsigned int m = 0; m < members.size(); ++m)
    {
      const Member &member = members[m];
      Mesh<dim> own(communicator);
      member.source->create(own);
      LevelCells<dim> cells(own.triangulation, 0);
      n_refinements.push_back(own.triangulation.n_global_levels() - 1);
      for (Point<dim> &vertex : cells.vertices)
      {
        vertex = member.placement(vertex);
        if (!(Tensor<1, dim>(vertex).norm() <= largest_coordinate))
          member.section.fail("Shift", "the mesh has vertices that are not finite, or farther "
                                       "than 1e90 from the origin, where volumes are not numbers "
                                       "any more.");
      }
      result.boundaries.begin_mesh(member.name);
      for (auto &face : cells.faces)
        face.id = result.boundaries.id(face.id);
      result.boundaries.add_names(own.boundary_names, own.joint_boundaries);

      result.groups.begin_mesh(member.name);
      std::set<unsigned int> of_mesh;
      for (auto &cell : cells.cells)
        of_mesh.insert(cell.material_id = result.groups.id(cell.material_id));
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
      result.cells.push_back(std::move(cells));
    }

    result.n_refinements = *std::min_element(n_refinements.begin(), n_refinements.end());
    double n_coarse_cells = 0;
    for (unsigned int m = 0; m < members.size(); ++m)
      n_coarse_cells += static_cast<double>(result.cells[m].cells.size()) *
                        std::pow(2., dim * (n_refinements[m] - result.n_refinements));
    refuse_more_than_memory(root, list_of_meshes, n_coarse_cells,
                            n_coarse_cells * std::pow(2., dim * result.n_refinements),
                            communicator);
    for (unsigned int m = 0; m < members.size(); ++m)
      if (n_refinements[m] > result.n_refinements)
        result.cells[m] = result.cells[m].refined(n_refinements[m] - result.n_refinements);
    return result;
  }

  template <int dim>
  void JoinedMeshes<dim>::create(Mesh<dim> &mesh) const
  {
    const Pieces pieces = read_pieces(communicator_of(mesh.triangulation));
    LevelCells<dim> all;
    for (const LevelCells<dim> &piece : pieces.cells)
    {
      const auto first_vertex = static_cast<unsigned int>(all.vertices.size());
      const std::size_t first_cell = all.cells.size();
      all.vertices.insert(all.vertices.end(), piece.vertices.begin(), piece.vertices.end());
      for (CellData<dim> cell : piece.cells)
      {
        for (unsigned int &vertex : cell.vertices)
          vertex += first_vertex;
        all.cells.push_back(cell);
      }
      for (const auto &face : piece.faces)
        all.faces.push_back({first_cell + face.cell, face.number, face.id});
    }
    Triangulation<dim> coarse;
    all.fill(coarse);
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
    using Cell = typename Triangulation<dim>::cell_iterator;
    std::vector<std::vector<Cell>> cells(members.size());
    std::vector<std::vector<BoundingBox<dim>>> boxes(members.size());
    for (const Cell &cell : mesh.triangulation.cell_iterators_on_level(0))
    {
      const unsigned int m = pieces.mesh_of_id.at(cell->material_id());
      cells[m].push_back(cell);
      boxes[m].push_back(cell->bounding_box());
    }
    /** A cell whose centre is inside of another mesh. */
    struct Overlap
    {
      unsigned int mesh, other;
      Point<dim> place;
    };
    std::vector<Overlap> found;
    for (unsigned int other = 0; other < members.size(); ++other)
    {
      const auto tree = pack_rtree_of_indices(boxes[other]);
      std::vector<std::size_t> near;
      for (const auto &cell : mesh.triangulation.active_cell_iterators())
      {
        const unsigned int m = pieces.mesh_of_id.at(cell->material_id());
        if (!cell->is_locally_owned() || m == other)
          continue;
        near.clear();
        tree.query(boost::geometry::index::intersects(cell->center()), std::back_inserter(near));
        if (std::any_of(near.begin(), near.end(),
                        [&](const std::size_t k)
                        { return cells[other][k]->point_inside(cell->center()); }))
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
    members[std::max(first.mesh, first.other)].section.fail(
        "", "the meshes " + in_quotes(members[first.mesh].name) + " and " +
                in_quotes(members[first.other].name) + " overlap: the cell of the first one at " +
                place_text(first.place) +
                " has its centre in a cell of the other one. Bodies can touch, but not be in the "
                "same place: move one by `Shift`.");
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
      numbers[m].resize(pieces.cells[m].vertices.size(), no_number);
      result.insert(result.end(), numbers[m].begin(), numbers[m].end());
    }
    return result;
  }

  template class JoinedMeshes<2>;
  template class JoinedMeshes<3>;
} // namespace tombolo
