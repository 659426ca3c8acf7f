// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_cell.h>

#include <tombolo/formulations/smoothed/refilled_cells.h>
#include <tombolo/mesh/nodes.h>

#include <deal.II/base/quadrature_lib.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace tombolo
{
  namespace
  {
    template <int dim>
    using VertexOf = typename CellFacet<dim>::Vertex;

    /** Which corner of the cell a vertex of the mesh is. */
    template <int dim>
    unsigned int corner_of(const typename Nodes<dim>::Cell &cell, const unsigned int vertex)
    {
      unsigned int corner = 0;
      while (corner < GeometryInfo<dim>::vertices_per_cell && cell->vertex_index(corner) != vertex)
        ++corner;
      return corner;
    }

    /** Of the faces of an active cell of this rank that are beside smaller cells. */
    template <int dim>
    std::vector<FaceNodes<dim>> face_nodes_of(const typename Nodes<dim>::Cell &cell)
    {
      constexpr unsigned int n = FaceNodes<dim>::n_parts;
      std::vector<FaceNodes<dim>> result;
      for (const unsigned int f : cell->face_indices())
      {
        const auto face = cell->face(f);
        if (!face->has_children())
          continue;
        FaceNodes<dim> found;
        found.face = f;
        std::array<std::array<unsigned int, n>, n> vertices; // as the nodes of the parts
        for (unsigned int child = 0; child < n; ++child)
        {
          const auto fine = face->child(child);
          // Opposite vertices of a face have numbers whose sum is n - 1.
          unsigned int first = 0;
          while (corner_of<dim>(cell, fine->vertex_index(first)) == SubCells<dim>::n_corners)
            ++first;
          typename FaceNodes<dim>::Part &part = found.parts[child];
          part.corner = corner_of<dim>(cell, fine->vertex_index(first));
          for (unsigned int k = 0; k < n; ++k)
          {
            vertices[child][k] = fine->vertex_index(first ^ k);
            part.nodes[k] = fine->vertex_dof_index(first ^ k, 0);
            part.points[k] = fine->vertex(first ^ k);
          }
        }
        if constexpr (dim == 3)
          for (unsigned int child = 0; child < n; ++child)
            for (unsigned int other = 0; other < n; ++other)
              for (const unsigned int edge : {0u, 1u})
                if (other != child && (vertices[other][1] == vertices[child][1 + edge] ||
                                       vertices[other][2] == vertices[child][1 + edge]))
                  found.parts[child].neighbours[edge] = found.parts[other].corner;
        result.push_back(found);
      }
      return result;
    }

    /** Of the edges of such a cell; none in the plane, where edges are faces. */
    template <int dim>
    std::vector<EdgeNode<dim>> edge_nodes_of([[maybe_unused]] const typename Nodes<dim>::Cell &cell)
    {
      std::vector<EdgeNode<dim>> result;
      if constexpr (dim == 3)
        for (const unsigned int l : cell->line_indices())
        {
          const auto line = cell->line(l);
          if (!line->has_children())
            continue;
          EdgeNode<dim> edge;
          for (unsigned int end = 0; end < 2; ++end)
            edge.corners[end] = corner_of<dim>(cell, line->vertex_index(end));
          // The middle is the vertex that both halves have.
          const auto half = line->child(0);
          const unsigned int middle = half->vertex_index(0) == line->vertex_index(0) ||
                                              half->vertex_index(0) == line->vertex_index(1)
                                          ? 1
                                          : 0;
          edge.node = half->vertex_dof_index(middle, 0);
          edge.point = half->vertex(middle);
          result.push_back(edge);
        }
      return result;
    }

    template <int dim>
    VertexOf<dim> vertex_of_corners(const typename SubCells<dim>::Shares &shares,
                                    const SmoothedCell<dim> &cell)
    {
      VertexOf<dim> result{SubCells<dim>::point_at(shares, cell.corners), {}};
      for (unsigned int k = 0; k < shares.size(); ++k)
        if (shares[k] != 0.)
          result.row.emplace_back(cell.nodes[k], shares[k]);
      return result;
    }

    template <int dim>
    VertexOf<dim> vertex_of_part(const typename FaceNodes<dim>::Part &part, const unsigned int k)
    {
      return {part.points[k], {{part.nodes[k], 1.}}};
    }

    /** The mean of all nodes of a small face. */
    template <int dim>
    VertexOf<dim> middle_of_part(const typename FaceNodes<dim>::Part &part)
    {
      constexpr double share = 1. / FaceNodes<dim>::n_parts;
      VertexOf<dim> result;
      for (unsigned int k = 0; k < part.nodes.size(); ++k)
      {
        result.position += share * part.points[k];
        result.row.emplace_back(part.nodes[k], share);
      }
      return result;
    }

    const FaceNodes<3>::Part &part_at(const FaceNodes<3> &face, const unsigned int corner)
    {
      return *std::find_if(face.parts.begin(), face.parts.end(),
                           [&](const auto &part) { return part.corner == corner; });
    }

    /** The facets on a face with further nodes, turned outward. */
    void add_facets_of_face(const FaceNodes<2> &face, const Tensor<1, 2> &outward,
                            std::vector<CellFacet<2>> &facets)
    {
      for (const FaceNodes<2>::Part &part : face.parts)
      {
        CellFacet<2> facet;
        facet.vertices = {{vertex_of_part<2>(part, 0), vertex_of_part<2>(part, 1)}};
        facet.from = face.face;
        facet.to = SubCells<2>::outside;
        facet.face = face.face;
        facet.orientation = facet.area() * outward < 0. ? -1. : 1.;
        facets.push_back(facet);
      }
    }

    void add_facets_of_face(const FaceNodes<3> &face, const Tensor<1, 3> &outward,
                            std::vector<CellFacet<3>> &facets)
    {
      for (const FaceNodes<3>::Part &part : face.parts)
        for (const unsigned int edge : {0u, 1u})
          for (const unsigned int end : {0u, 3u})
          {
            CellFacet<3> facet;
            facet.vertices = {{vertex_of_part<3>(part, end), vertex_of_part<3>(part, 1 + edge),
                               middle_of_part<3>(part)}};
            // The sub-cells of even corners meet in the diagonal between the odd ones.
            facet.from =
                (SubCells<3>::is_even(part.corner) ? part.corner : part.neighbours[edge]) / 2;
            facet.to = SubCells<3>::outside;
            facet.face = face.face;
            facet.orientation = facet.area() * outward < 0. ? -1. : 1.;
            facets.push_back(facet);
          }
    }

    /** The face with further nodes whose middle is a vertex of this inner facet; or null. */
    const FaceNodes<3> *face_at(const SubCells<3>::Facet &facet,
                                const std::vector<FaceNodes<3>> &faces)
    {
      for (const FaceNodes<3> &face : faces)
        if (std::all_of(face.parts.begin(), face.parts.end(),
                        [&](const auto &part) { return facet.vertices[1][part.corner] > 0.; }))
          return &face;
      return nullptr;
    }

    /** A facet as it is without further nodes. */
    template <int dim>
    CellFacet<dim> plain_facet(const typename SubCells<dim>::Facet &facet,
                               const SmoothedCell<dim> &cell)
    {
      CellFacet<dim> result{{}, facet.orientation, facet.from, facet.to, facet.face};
      for (unsigned int k = 0; k < dim; ++k)
        result.vertices[k] = vertex_of_corners<dim>(facet.vertices[k], cell);
      return result;
    }

    /** Its edge in a face with further nodes goes through the middle of a small face there. */
    void add_inner_facet(const SubCells<3>::Facet &facet, const SmoothedCell<3> &cell,
                         std::vector<CellFacet<3>> &facets)
    {
      const CellFacet<3> whole = plain_facet<3>(facet, cell);
      const FaceNodes<3> *const face = face_at(facet, cell.face_nodes);
      if (face == nullptr)
      {
        facets.push_back(whole);
        return;
      }
      const auto &shares = facet.vertices[0];
      const auto corner = static_cast<unsigned int>(std::max_element(shares.begin(), shares.end()) -
                                                    shares.begin());
      const FaceNodes<3>::Part &part = part_at(*face, corner);
      const auto middle = middle_of_part<3>(part);
      CellFacet<3> outer = whole, inner = whole;
      outer.vertices[1] = middle;
      inner.vertices[0] = middle;
      inner.vertices[1] = vertex_of_part<3>(part, 3);
      facets.push_back(outer);
      facets.push_back(inner);
    }

    /** A facet on another face is between an edge and the middle of the face. */
    void add_outer_facet(const SubCells<3>::Facet &facet, const SmoothedCell<3> &cell,
                         const bool at_edge_nodes, std::vector<CellFacet<3>> &facets)
    {
      const CellFacet<3> whole = plain_facet<3>(facet, cell);
      const auto edge = std::find_if(cell.edge_nodes.begin(), cell.edge_nodes.end(),
                                     [&](const EdgeNode<3> &edge_node)
                                     {
                                       const auto [a, b] = edge_node.corners;
                                       return facet.vertices[0][a] + facet.vertices[0][b] == 1. &&
                                              facet.vertices[1][a] + facet.vertices[1][b] == 1.;
                                     });
      if (!at_edge_nodes || edge == cell.edge_nodes.end())
      {
        facets.push_back(whole);
        return;
      }
      CellFacet<3> first = whole, second = whole;
      first.vertices[1] = second.vertices[0] = {edge->point, {{edge->node, 1.}}};
      facets.push_back(first);
      facets.push_back(second);
    }

    /** The integrals of the multilinear functions of the corners over a cell. */
    template <int dim>
    typename SubCells<dim>::Shares corner_volumes(const typename SubCells<dim>::Corners &corners)
    {
      static const QGauss<dim> quadrature(2);
      typename SubCells<dim>::Shares volumes{};
      for (unsigned int q = 0; q < quadrature.size(); ++q)
      {
        Tensor<2, dim> jacobian;
        for (unsigned int k = 0; k < corners.size(); ++k)
          jacobian += outer_product(
              Tensor<1, dim>(corners[k]),
              GeometryInfo<dim>::d_linear_shape_function_gradient(quadrature.point(q), k));
        for (unsigned int k = 0; k < corners.size(); ++k)
          volumes[k] += quadrature.weight(q) * determinant(jacobian) *
                        GeometryInfo<dim>::d_linear_shape_function(quadrature.point(q), k);
      }
      return volumes;
    }

    /** The volumes of corners and further nodes of a cell with nodes on its faces. */
    template <int dim>
    std::map<types::global_dof_index, double> volumes_of_nodes(const SmoothedCell<dim> &cell)
    {
      std::map<types::global_dof_index, double> result;
      constexpr double vertex_share = 1. / (dim + 1);
      const Point<dim> centre = cell.centre();
      for (const CellFacet<dim> &facet : facets_of(cell, false))
      {
        if (facet.to != SubCells<dim>::outside)
          continue;
        const double volume = facet.area() * (facet.centroid() - centre) / dim;
        for (const auto &vertex : facet.vertices)
          for (const auto &[node, share] : vertex.row)
            result[node] += vertex_share * volume * share;
        for (const types::global_dof_index node : cell.nodes)
          result[node] += vertex_share * volume / static_cast<double>(cell.nodes.size());
      }
      return result;
    }
  } // namespace

  template <int dim>
  std::vector<SmoothedCell<dim>> smoothed_cells_of(const PartSetup<dim> &setup)
  {
    std::vector<SmoothedCell<dim>> result;
    std::vector<Point<dim>> points;
    for (const auto &cell : setup.cells())
    {
      SmoothedCell<dim> found;
      setup.nodes->cell_nodes(cell, found.nodes);
      setup.nodes->cell_points(cell, points);
      std::copy(points.begin(), points.end(), found.corners.begin());
      const auto is_void = [&setup](const typename Nodes<dim>::Cell &part_cell)
      { return setup.void_cells != nullptr && setup.void_cells->is_void(part_cell); };
      found.is_void = is_void(cell);
      for (const unsigned int face : cell->face_indices())
      {
        found.boundary_ids[face] = cell->face(face)->boundary_id();
        if (found.is_void)
          continue;
        // The size of cells changes inside of the part only.
        const bool is_at_end = cell->at_boundary(face) ||
                               (!cell->face(face)->has_children() &&
                                setup.part_cells->part_of(cell->neighbor(face)) != setup.index);
        found.is_towards_void[face] =
            !is_at_end && !cell->face(face)->has_children() && is_void(cell->neighbor(face));
        found.is_on_boundary[face] = is_at_end || found.is_towards_void[face];
      }
      found.face_nodes = face_nodes_of<dim>(cell);
      found.edge_nodes = edge_nodes_of<dim>(cell);
      result.push_back(std::move(found));
    }
    return result;
  }

  template <int dim>
  Point<dim> CellFacet<dim>::centroid() const
  {
    Point<dim> result;
    for (const Vertex &vertex : vertices)
      result += 1. / dim * vertex.position;
    return result;
  }

  template <int dim>
  std::vector<CellFacet<dim>> facets_of(const SmoothedCell<dim> &cell,
                                        [[maybe_unused]] const bool at_edge_nodes)
  {
    std::vector<CellFacet<dim>> result;
    const auto has_nodes = [&](const unsigned int face)
    {
      return std::any_of(cell.face_nodes.begin(), cell.face_nodes.end(),
                         [&](const FaceNodes<dim> &face_nodes) { return face_nodes.face == face; });
    };
    for (const auto &facet : SubCells<dim>::facets())
      if (facet.to == SubCells<dim>::outside && has_nodes(facet.face))
        continue;
      else if constexpr (dim == 2)
        result.push_back(plain_facet<dim>(facet, cell));
      else if (facet.to != SubCells<dim>::outside)
        add_inner_facet(facet, cell, result);
      else
        add_outer_facet(facet, cell, at_edge_nodes, result);
    for (const FaceNodes<dim> &face : cell.face_nodes)
    {
      Tensor<1, dim> outward;
      for (const auto &facet : SubCells<dim>::facets())
        if (facet.to == SubCells<dim>::outside && facet.face == face.face)
          outward += SubCells<dim>::area(facet, cell.corners);
      add_facets_of_face(face, outward, result);
    }
    return result;
  }

  template <int dim>
  void FurtherMasses<dim>::initialize(const PartSetup<dim> &setup)
  {
    entries.clear();
    node_set = IndexSet(setup.nodes->dof_handler().n_dofs());
    const std::vector<SmoothedCell<dim>> cells = smoothed_cells_of(setup);
    for (unsigned int c = 0; c < cells.size(); ++c)
    {
      if (cells[c].face_nodes.empty() || cells[c].is_void)
        continue;
      auto volumes = volumes_of_nodes(cells[c]);
      const auto uniform_volumes = corner_volumes<dim>(cells[c].corners);
      const double density = setup.material->density();
      const double cell_volume =
          std::accumulate(uniform_volumes.begin(), uniform_volumes.end(), 0.);
      for (unsigned int k = 0; k < uniform_volumes.size(); ++k)
        volumes[cells[c].nodes[k]] -= uniform_volumes[k];
      for (const auto &[node, volume] : volumes)
        entries.push_back({c, node, density * volume, volume / cell_volume});
    }
    std::vector<types::global_dof_index> nodes;
    for (const Entry &entry : entries)
      nodes.push_back(entry.node);
    node_set.add_indices(nodes.begin(), nodes.end());
    node_set.compress();
  }

  template <int dim>
  void FurtherMasses<dim>::set_partition(const NodePartition &partition)
  {
    local_nodes.clear();
    for (const Entry &entry : entries)
      local_nodes.push_back(partition.local_index(entry.node));
  }

  template <int dim>
  void FurtherMasses<dim>::add_mass(NodalVector &mass) const
  {
    for (std::size_t i = 0; i < entries.size(); ++i)
      *mass.node(local_nodes[i]) += entries[i].mass;
  }

  template <int dim>
  void FurtherMasses<dim>::add_extra_mass(const std::vector<double> &factors,
                                          NodalVector &mass) const
  {
    for (std::size_t i = 0; i < entries.size(); ++i)
      *mass.node(local_nodes[i]) += (factors[entries[i].cell] - 1.) * entries[i].mass;
  }

  template <int dim>
  void FurtherMasses<dim>::add_shares(const std::vector<double> &cell_values,
                                      NodalVector &result) const
  {
    for (std::size_t i = 0; i < entries.size(); ++i)
      *result.node(local_nodes[i]) += entries[i].share * cell_values[entries[i].cell];
  }

  template std::vector<SmoothedCell<2>> smoothed_cells_of<2>(const PartSetup<2> &);
  template std::vector<SmoothedCell<3>> smoothed_cells_of<3>(const PartSetup<3> &);
  template struct CellFacet<2>;
  template struct CellFacet<3>;
  template std::vector<CellFacet<2>> facets_of<2>(const SmoothedCell<2> &, bool);
  template std::vector<CellFacet<3>> facets_of<3>(const SmoothedCell<3> &, bool);
  template class FurtherMasses<2>;
  template class FurtherMasses<3>;
} // namespace tombolo
