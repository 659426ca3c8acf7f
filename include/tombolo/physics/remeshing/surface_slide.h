// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/on_ranks.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/remeshing/cell_marks.h>
#include <tombolo/physics/remeshing/curved_surface.h>
#include <tombolo/remesh/cell_matrices.h>
#include <tombolo/remesh/cell_overlap.h>
#include <tombolo/remesh/cell_simplices.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <vector>

namespace tombolo
{
  /**
   * Nodes on the boundary of a part that slide on its surface, so that a refill can space them as
   * in the initial lattice: sweeps relax their displacements from the lattice towards those of
   * their neighbours on the surface, and project them onto the former surface. This surface is
   * curved between its nodes, by half of the distance to their tangent planes, so that nodes on a
   * round tool stay on it. In the end all nodes move by one distance along their normals that
   * restores the former volume.
   *
   * A node can slide where the boundary around it is smooth at the start, has one boundary id, and
   * is neither towards another part nor on a plane of symmetry. It can slide as well where all of
   * the boundary around it is towards void cells.
   */
  template <int dim>
  class SurfaceSlide
  {
  public:
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;
    using CellNodes = std::vector<std::array<unsigned int, n_corners>>;

    /** @p lattice: the cells of the part on this rank, with their initial corners; @p nodes: the
     * local numbers of these, which must be current in all calls. Collective. */
    SurfaceSlide(const Model<dim> &model, const std::vector<SmoothedCell<dim>> &lattice,
                 const CellNodes &nodes)
        : communicator(model.communicator), nodes(nodes), facets_of_cells(lattice.size()),
          membranes(lattice.size())
    {
      const auto &all = SubCells<dim>::facets();
      for (std::size_t c = 0; c < lattice.size(); ++c)
      {
        is_void.push_back(lattice[c].is_void);
        for (unsigned int f = 0; f < all.size(); ++f)
        {
          if (all[f].to != SubCells<dim>::outside || !lattice[c].is_on_boundary[all[f].face])
            continue;
          facets_of_cells[c].push_back(f);
          std::array<dealii::Point<dim>, dim> vertices;
          for (unsigned int v = 0; v < dim; ++v)
            vertices[v] = SubCells<dim>::point_at(all[f].vertices[v], lattice[c].corners);
          const auto membrane =
              membrane_of_facet(vertices, SubCells<dim>::area(all[f], lattice[c].corners).norm());
          for (unsigned int v = 0; v < dim; ++v)
            for (unsigned int w = 0; w < dim; ++w)
              for (unsigned int j = 0; j < n_corners; ++j)
                for (unsigned int k = 0; k < n_corners; ++k)
                  membranes[c][j * n_corners + k] +=
                      all[f].vertices[v][j] * membrane[v][w] * all[f].vertices[w][k];
        }
      }
      examine_nodes(*model.state.partition(), lattice);
    }

    /** Whether an owned node is on the boundary of the full cells. */
    bool is_on_boundary(const unsigned int node) const
    {
      return boundary_nodes[node];
    }

    /** Of an owned node: whether it can slide. */
    bool is_smooth(const unsigned int node) const
    {
      return smooth_nodes[node];
    }

    /** @p from: former positions of nodes, or those of the nearest nodes of the former surface. */
    using KeepOutside =
        std::function<void(const NodalVector &from, NodalVector &position, NodalVector &is_bound)>;
    /** The volume that is missing at owned nodes [L^dim], in a scalar vector, of those that are not
     * bound (scalar, owned). Collective. */
    using FindMissing =
        std::function<NodalVector(const NodalVector &position, const NodalVector &is_bound)>;
    using FindDepths =
        std::function<void(const NodalVector &positions, const std::vector<unsigned int> &numbers,
                           std::vector<double> &depths)>;

    /** A sliding node relaxes towards its position in the mesh, or is only projected onto the
     * surface. */
    static constexpr double relaxes = 1., moves_with_mesh = 0.5;

    /**
     * Moves the nodes of which @p slides (scalar, owned: relaxes, moves_with_mesh or zero) is
     * positive. @p initial: positions in the mesh, @p before: positions, with ghosts. @p
     * keep_outside corrects the positions of owned nodes and marks those that stay as they are
     * then. @p position: the start of sliding nodes, and the former positions of others; set to the
     * new ones, with ghosts. Collective.
     */
    void slide(const NodalVector &slides, const NodalVector &initial, const NodalVector &before,
               const KeepOutside &keep_outside, NodalVector &position) const
    {
      const CurvedSurface<dim> surface = gather_surface(slides, before);
      if (surface.facets.facets.empty())
        return;
      relax_onto(surface, slides, initial, &before, position);
      restore_volume(slides, slides, before, keep_outside, volume(slides, before), position);
    }

    /** The same onto the surface @p former of a body of which cells have been filled or emptied
     * since, as far as cells with a node that is @p near (scalar, with ghosts) bound it. A node
     * without a point there stays. A node moves a share @p way_shares (scalar, owned) of the way
     * from its position in the mesh. Then it moves along its normal by what is @p missing at it,
     * and in the end the near cells have the volume @p target. Collective. */
    void slide_onto(const SurfaceSlide &former, const NodalVector &near, const double target,
                    const NodalVector &slides, const NodalVector &way_shares,
                    const NodalVector &initial, const NodalVector &before,
                    const KeepOutside &keep_outside, const FindMissing &missing,
                    NodalVector &position) const
    {
      constexpr unsigned int n_iterations = 2;
      const CurvedSurface<dim> surface = former.gather_surface(near, before);
      if (surface.facets.facets.empty())
        return;
      relax_onto(surface, slides, initial, nullptr, position);
      NodalVector from = before.copy(), is_bound(position.partition(), Quantity::scalar);
      from.fill(
          [&](const unsigned int i, double *const coordinates)
          {
            if (!(*slides.node(i) > 0.))
              return;
            const auto found = surface.nearest(vector_of<dim>(position.node(i)));
            const dealii::Tensor<1, dim> &nearest =
                surface.node_near(found.point, surface.tree.facet_of(found));
            for (unsigned int d = 0; d < dim; ++d)
              coordinates[d] = nearest[d];
          });
      position.fill(
          [&](const unsigned int i, double *const coordinates)
          {
            for (unsigned int d = 0; d<dim && * slides.node(i)> 0.; ++d)
              coordinates[d] =
                  initial.node(i)[d] + *way_shares.node(i) * (coordinates[d] - initial.node(i)[d]);
          });
      for (unsigned int iteration = 0; iteration < n_iterations; ++iteration)
      {
        change_owned({&position}, [&] { keep_outside(from, position, is_bound); });
        restore_missing(slides, is_bound, missing(position, is_bound), position);
      }
      restore_volume(slides, near, from, keep_outside, target, position);
    }

    /** Scalar, with ghosts: positive at sliding nodes whose faces would be cut by a surface that
     * did not cut them before, as by the edge of a tool; a tool that has moved with the mesh may
     * cut them deeper by its @p way [L]. @p find_depths returns the depths of points. Nothing if
     * there is none. Collective. */
    std::optional<NodalVector> nodes_of_cut_faces(const NodalVector &slides,
                                                  const NodalVector &before,
                                                  const NodalVector &after, const double way,
                                                  const FindDepths &find_depths) const
    {
      constexpr double allowed = 0.2; // of the size of a face; less is the sag on a round tool
      const auto &all = SubCells<dim>::facets();
      std::vector<dealii::Tensor<1, dim>> points;
      std::vector<double> sizes;
      std::vector<std::size_t> cells;
      for (std::size_t c = 0; c < nodes.size(); ++c)
      {
        if (facets_of_cells[c].empty() || !CellMarks::any_marked(nodes[c], slides))
          continue;
        const Corners was = corners_at<dim>(nodes[c], before);
        const Corners is = corners_at<dim>(nodes[c], after);
        for (const unsigned int f : facets_of_cells[c])
        {
          points.push_back(SubCells<dim>::point_at(all[f].centroid, was));
          points.push_back(SubCells<dim>::point_at(all[f].centroid, is));
          sizes.push_back(std::pow(SubCells<dim>::area(all[f], was).norm(), 1. / (dim - 1)));
          cells.push_back(c);
        }
      }
      std::vector<unsigned int> numbers(points.size());
      std::iota(numbers.begin(), numbers.end(), 0u);
      std::vector<double> depths;
      find_depths(positions_as_nodes<dim>(points), numbers, depths);
      bool any = false;
      NodalVector marks = marked_nodes(
          before.partition(),
          [&](const auto &mark)
          {
            for (std::size_t k = 0; k < cells.size(); ++k)
              if (depths[2 * k + 1] > std::max(0., depths[2 * k]) + allowed * sizes[k] + way)
              {
                std::for_each(nodes[cells[k]].begin(), nodes[cells[k]].end(), mark);
                any = any || CellMarks::any_marked(nodes[cells[k]], slides);
              }
          });
      if (dealii::Utilities::MPI::max(any ? 1 : 0, communicator) == 0)
        return {};
      return marks;
    }

  private:
    using Corners = typename SubCells<dim>::Corners;

    /** Classifies the boundary around nodes. Collective. */
    void examine_nodes(const NodePartition &partition,
                       const std::vector<SmoothedCell<dim>> &lattice)
    {
      constexpr double smooth = 0.92; // half of 46 degrees between two faces
      NodalVector ids(partition.shared_from_this(), Quantity::scalars),
          normals(partition.shared_from_this(), Quantity::scalars);
      const auto add_face = [&](const SmoothedCell<dim> &cell, const unsigned int face)
      {
        const bool is_held =
            cell.boundary_ids[face] == dealii::numbers::internal_face_boundary_id &&
            !cell.is_towards_void[face];
        const double number = cell.is_towards_void[face] ? id_of_void : cell.boundary_ids[face];
        dealii::Tensor<1, dim> normal;
        for (const auto &facet : SubCells<dim>::facets())
          if (facet.to == SubCells<dim>::outside && facet.face == face)
            normal += SubCells<dim>::area(facet, cell.corners);
        normal /= normal.norm();
        for (unsigned int k = 0; k < n_corners; ++k)
        {
          if (!SubCells<dim>::is_on_face(k, face))
            continue;
          const unsigned int node = partition.local_index(cell.nodes[k]);
          double *const node_values = ids.node(node);
          node_values[n_faces] += 1.;
          node_values[held] += is_held ? 1. : 0.;
          node_values[id] += is_held ? 0. : number;
          node_values[squared_id] += is_held ? 0. : number * number;
          for (unsigned int d = 0; d < dim; ++d)
            normals.node(node)[d] += normal[d];
        }
      };
      add_up({&ids, &normals},
             [&]
             {
               for (const SmoothedCell<dim> &cell : lattice)
                 for (unsigned int face = 0; face < dealii::GeometryInfo<dim>::faces_per_cell;
                      ++face)
                   if (cell.is_on_boundary[face])
                     add_face(cell, face);
             });
      for (unsigned int i = 0; i < partition.n_owned(); ++i)
      {
        const double *const node_values = ids.node(i);
        boundary_nodes.push_back(node_values[n_faces] > 0.);
        // Steps of the lattice towards void cells are no edges of the body.
        const bool has_edge =
            node_values[id] != id_of_void * node_values[n_faces] &&
            vector_of<dim>(normals.node(i)).norm() <= smooth * node_values[n_faces];
        smooth_nodes.push_back(node_values[n_faces] > 0. && node_values[held] == 0. &&
                               node_values[n_faces] * node_values[squared_id] ==
                                   node_values[id] * node_values[id] &&
                               !has_edge);
      }
      for (const NodePartition::Reflected &own_image : partition.nodes_on_planes())
        smooth_nodes[own_image.source] = false;
    }

    /** Of the cells with a node that slides. Collective. */
    CurvedSurface<dim> gather_surface(const NodalVector &slides, const NodalVector &position) const
    {
      constexpr double same_side = 0.7; // of the product of two normals: nearer is a kink
      const auto &all = SubCells<dim>::facets();
      NodalVector normals = areas_of_nodes(position); // where the body is smooth
      normals.fill(
          [&](const unsigned int i, double *const normal)
          {
            const double area = is_smooth(i) ? vector_of<dim>(normal).norm() : 0.;
            for (unsigned int d = 0; d < dim; ++d)
              normal[d] = area > 0. ? normal[d] / area : 0.;
          });
      std::vector<typename CurvedSurface<dim>::Piece> own;
      for (std::size_t c = 0; c < nodes.size(); ++c)
      {
        if (facets_of_cells[c].empty() || !CellMarks::any_marked(nodes[c], slides))
          continue;
        const Corners corners = corners_at<dim>(nodes[c], position);
        for (const unsigned int f : facets_of_cells[c])
        {
          const dealii::Tensor<1, dim> area = SubCells<dim>::area(all[f], corners);
          if (!(area.norm() > 0.))
            continue;
          auto &piece = own.emplace_back();
          piece.normal = area / area.norm();
          for (unsigned int v = 0; v < dim; ++v)
            piece.vertices[v] = SubCells<dim>::point_at(all[f].vertices[v], corners);
          for (unsigned int k = 0, face_node = 0; k < n_corners; ++k)
          {
            if (!SubCells<dim>::is_on_face(k, all[f].face))
              continue;
            for (unsigned int v = 0; v < dim; ++v)
              piece.shares[v][face_node] = all[f].vertices[v][k];
            piece.face.positions[face_node] = corners[k];
            if (const auto normal = vector_of<dim>(normals.node(nodes[c][k]));
                normal * piece.normal > same_side)
              piece.face.normals[face_node] = normal;
            ++face_node;
          }
        }
      }
      CurvedSurface<dim> surface;
      for (const auto &rank_pieces : items_by_rank(own, communicator))
        surface.add(rank_pieces);
      if (!surface.facets.facets.empty())
        surface.complete();
      return surface;
    }

    /** Relaxes nodes towards their positions in the mesh, and projects them onto the surface; where
     * it has no point on their side, they get the positions @p otherwise, if these are given.
     * Collective. */
    void relax_onto(const CurvedSurface<dim> &surface, const NodalVector &slides,
                    const NodalVector &initial, const NodalVector *const otherwise,
                    NodalVector &position) const
    {
      constexpr unsigned int n_sweeps = 10;
      constexpr double relaxation = 0.7, same_side = 0.5; // of the product of two normals
      const auto &partition = position.partition();
      CellMatrices<dim> membrane(partition, 0);
      for (std::size_t c = 0; c < nodes.size(); ++c)
        if (!facets_of_cells[c].empty())
          membrane.add_cell(nodes[c], membranes[c]);
      const NodalVector diagonal = membrane.diagonal_of_cells();
      NodalVector displacement(partition), residual(partition);
      for (unsigned int sweep = 0; sweep < n_sweeps; ++sweep)
      {
        for (std::size_t i = 0; i < std::size_t(partition->n_owned()) * node_stride; ++i)
          displacement.data()[i] = position.data()[i] - initial.data()[i];
        membrane.apply(displacement, residual);
        position.fill(
            [&](const unsigned int i, double *const coordinates)
            {
              for (unsigned int d = 0; d < dim && *slides.node(i) == relaxes; ++d)
                coordinates[d] -= relaxation * residual.node(i)[d] / *diagonal.node(i);
            });
        const NodalVector areas = areas_of_nodes(position);
        position.fill(
            [&](const unsigned int i, double *const coordinates)
            {
              if (!(*slides.node(i) > 0.))
                return;
              const dealii::Tensor<1, dim> area = vector_of<dim>(areas.node(i));
              const auto found = surface.nearest_facing(vector_of<dim>(coordinates),
                                                        -area / area.norm(), -same_side);
              if (!found && otherwise == nullptr)
                return;
              const dealii::Tensor<1, dim> on_surface =
                  found ? surface.raise(found->point, surface.tree.facet_of(*found))
                        : vector_of<dim>(otherwise->node(i));
              for (unsigned int d = 0; d < dim; ++d)
                coordinates[d] = on_surface[d];
            });
      }
    }

    /** Moves nodes that are not bound along their normals until the near cells have the volume
     * @p target. Collective. */
    void restore_volume(const NodalVector &slides, const NodalVector &near, const NodalVector &from,
                        const KeepOutside &keep_outside, const double target,
                        NodalVector &position) const
    {
      constexpr unsigned int n_iterations = 4; // of Newton's method; the volume is nearly linear
      NodalVector is_bound(position.partition(), Quantity::scalar);
      for (unsigned int iteration = 0; iteration < n_iterations; ++iteration)
      {
        change_owned({&position}, [&] { keep_outside(from, position, is_bound); });
        const NodalVector areas = areas_of_nodes(position);
        const auto moves = [&](const unsigned int i)
        { return *slides.node(i) > 0. && *is_bound.node(i) == 0.; };
        double sum = 0;
        for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
          if (moves(i))
            sum += vector_of<dim>(areas.node(i)).norm();
        sum = ordered_sum(sum, communicator);
        if (!(sum > 0.))
          continue;
        const double distance = (target - volume(near, position)) / sum;
        position.fill(
            [&](const unsigned int i, double *const coordinates)
            {
              if (moves(i))
                move_outward(distance, vector_of<dim>(areas.node(i)), coordinates);
            });
      }
    }

    /** Moves nodes that are not bound along their normals by the volume that is missing at each, at
     * most a quarter of the size of a face. Collective. */
    void restore_missing(const NodalVector &slides, const NodalVector &is_bound,
                         const NodalVector &missing, NodalVector &position) const
    {
      constexpr double farthest = 0.25;
      const NodalVector areas = areas_of_nodes(position);
      position.fill(
          [&](const unsigned int i, double *const coordinates)
          {
            const auto area = vector_of<dim>(areas.node(i));
            if (!(*slides.node(i) > 0.) || *is_bound.node(i) > 0. || !(area.norm() > 0.))
              return;
            const double limit = farthest * std::pow(area.norm(), 1. / (dim - 1));
            move_outward(std::clamp(*missing.node(i) / area.norm(), -limit, limit), area,
                         coordinates);
          });
    }

    /** ∫ N n dA of the boundary, at owned nodes. Collective. */
    NodalVector areas_of_nodes(const NodalVector &position) const
    {
      const auto &all = SubCells<dim>::facets();
      return sums_at_owners(position.partition(), Quantity::vector,
                            [&](NodalVector &sums)
                            {
                              for (std::size_t c = 0; c < nodes.size(); ++c)
                              {
                                if (facets_of_cells[c].empty())
                                  continue;
                                const Corners corners = corners_at<dim>(nodes[c], position);
                                for (const unsigned int f : facets_of_cells[c])
                                {
                                  const dealii::Tensor<1, dim> area =
                                      SubCells<dim>::area(all[f], corners);
                                  for (unsigned int k = 0; k < n_corners; ++k)
                                    for (unsigned int d = 0; d < dim; ++d)
                                      sums.node(nodes[c][k])[d] += all[f].centroid[k] * area[d];
                                }
                              }
                            });
    }

    /** Of the full cells with a node that is near. Collective. */
    double volume(const NodalVector &near, const NodalVector &position) const
    {
      double result = 0;
      for (std::size_t c = 0; c < nodes.size(); ++c)
        if (!is_void[c] && CellMarks::any_marked(nodes[c], near))
          for (const double sub_cell_volume :
               CellSimplices<dim>::volumes(corners_at<dim>(nodes[c], position)))
            result += sub_cell_volume;
      return ordered_sum(result, communicator);
    }

    /** The stiffness of a membrane that is a segment or a triangle. */
    static std::array<std::array<double, dim>, dim>
    membrane_of_facet(const std::array<dealii::Point<dim>, dim> &vertices, const double area)
    {
      std::array<std::array<double, dim>, dim> result{};
      if constexpr (dim == 2)
        for (unsigned int a = 0; a < 2; ++a)
          for (unsigned int b = 0; b < 2; ++b)
            result[a][b] = (a == b ? 1. : -1.) / area;
      else
        for (unsigned int a = 0; a < 3; ++a)
          for (unsigned int b = 0; b < 3; ++b)
            result[a][b] = (vertices[(a + 2) % 3] - vertices[(a + 1) % 3]) *
                           (vertices[(b + 2) % 3] - vertices[(b + 1) % 3]) / (4. * area);
      return result;
    }

    /** Sums over the faces around a node. */
    enum FaceSlot : unsigned int
    {
      n_faces,
      id,
      squared_id,
      held
    };

    /** Of faces towards void cells: no boundary of a mesh has it. */
    static constexpr double id_of_void = -1.;

    /** Moves a node by a distance along the normal of its boundary. */
    static void move_outward(const double distance, const dealii::Tensor<1, dim> &area,
                             double *const position)
    {
      for (unsigned int d = 0; d < dim; ++d)
        position[d] += distance * area[d] / area.norm();
    }

    MPI_Comm communicator;
    const CellNodes &nodes;
    std::vector<bool> is_void;                      ///< of cells
    std::vector<bool> boundary_nodes, smooth_nodes; ///< of owned nodes
    /** Which facets of SubCells of each cell bound the part. */
    std::vector<std::vector<unsigned int>> facets_of_cells;
    /** ∫ ∇N·∇N over the boundary faces of each cell, along the faces, initially. */
    std::vector<std::array<double, n_corners * n_corners>> membranes;
  };
} // namespace tombolo
