// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/surface_slide.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/physics/remeshing/cell_marks.h>
#include <tombolo/remesh/cell_overlap.h>
#include <tombolo/remesh/cell_simplices.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The stiffness of a membrane that is a segment or a triangle. */
    template <int dim>
    std::array<std::array<double, dim>, dim>
    membrane_of_facet(const std::array<Point<dim>, dim> &vertices, const double area)
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

    // Slots of what is known of the faces around a node.
    enum FaceSlot : unsigned int
    {
      n_faces,
      id,
      squared_id,
      held
    };

    // Of faces towards void cells: no boundary of a mesh has it.
    constexpr double id_of_void = -1.;

    /** Moves a node by a distance along the normal of its boundary. */
    template <int dim>
    void move_outward(const double distance, const Tensor<1, dim> &area, double *const position)
    {
      for (unsigned int d = 0; d < dim; ++d)
        position[d] += distance * area[d] / area.norm();
    }
  } // namespace

  /** A piece of the boundary of a part, of all ranks: facets that are curved between the nodes of
   * their faces. Where several places are equally near, one direction decides, and no round-off. */
  template <int dim>
  struct CurvedSurface
  {
    using Nearest = typename FacetTree<dim>::Nearest;

    static constexpr unsigned int n_face_nodes = GeometryInfo<dim>::vertices_per_face;

    /** The nodes of a face of the boundary, and the normals there; zero at edges of the body. */
    struct Face
    {
      std::array<Tensor<1, dim>, n_face_nodes> places, normals;
    };

    ClosedSurface<dim> facets;
    FacetTree<dim> tree;
    std::vector<Face> faces; ///< of each facet
    /** Of the vertices of each facet, in the places of the nodes of its face. */
    std::vector<std::array<std::array<double, n_face_nodes>, dim>> shares;

    /** Adds what a rank has sent: of each facet its vertices, its normal, the shares, and the
     * places and normals of its face. */
    void add(const std::vector<double> &of_rank)
    {
      const double *value = of_rank.data();
      const auto read = [&value](Tensor<1, dim> &vector)
      {
        for (unsigned int d = 0; d < dim; ++d)
          vector[d] = *value++;
      };
      while (value != of_rank.data() + of_rank.size())
      {
        typename ClosedSurface<dim>::Facet facet;
        for (unsigned int v = 0; v < dim; ++v)
        {
          facet.vertex[v] = static_cast<unsigned int>(facets.vertices.size());
          facets.vertices.emplace_back();
          read(facets.vertices.back());
        }
        facets.facets.push_back(facet);
        facets.facet_normals.emplace_back();
        read(facets.facet_normals.back());
        facets.edges.insert(facets.edges.end(), ClosedSurface<dim>::n_sides, 0u);
        shares.emplace_back();
        for (auto &of_vertex : shares.back())
          for (double &share : of_vertex)
            share = *value++;
        faces.emplace_back();
        for (auto &place : faces.back().places)
          read(place);
        for (auto &normal : faces.back().normals)
          read(normal);
      }
    }

    /** All facets were added. */
    void complete()
    {
      constexpr double share_of_size = 1e-7;
      // No plane between two nodes of a lattice is along this direction.
      constexpr double direction[3] = {0.8192, 0.4657, 0.3346};
      tree = FacetTree<dim>(facets);
      double largest = 0; // so that it does not depend on the order of ranks
      for (const Face &face : faces)
        largest = std::max(largest, (face.places.back() - face.places.front()).norm_square());
      for (unsigned int d = 0; d < dim; ++d)
        aside[d] = share_of_size * std::sqrt(largest) * direction[d];
    }

    /** See FacetTree. */
    Nearest nearest(const Tensor<1, dim> &point) const
    {
      return tree.nearest_on_facet_of(tree.nearest(point + aside), point);
    }

    std::optional<Nearest> nearest_facing(const Tensor<1, dim> &point,
                                          const Tensor<1, dim> &direction, const double limit) const
    {
      const auto found = tree.nearest_facing(point + aside, direction, limit);
      return found ? std::optional<Nearest>(tree.nearest_on_facet_of(*found, point)) : std::nullopt;
    }

    /** The place on the curved surface over a place of a facet: half of the way to the tangent
     * planes at the nodes of the face. */
    Tensor<1, dim> raise(const Tensor<1, dim> &place, const unsigned int facet) const
    {
      const auto vertex = [&](const unsigned int v) -> const Tensor<1, dim> &
      { return facets.vertices[facets.facets[facet].vertex[v]]; };
      std::array<double, dim> coordinates{};
      if constexpr (dim == 2)
      {
        const Tensor<1, dim> along = vertex(1) - vertex(0);
        coordinates[1] = (place - vertex(0)) * along / along.norm_square();
      }
      else
      {
        const Tensor<1, dim> a = vertex(1) - vertex(0), b = vertex(2) - vertex(0),
                             r = place - vertex(0);
        const double aa = a * a, ab = a * b, bb = b * b, determinant = aa * bb - ab * ab;
        coordinates[1] = (bb * (r * a) - ab * (r * b)) / determinant;
        coordinates[2] = (aa * (r * b) - ab * (r * a)) / determinant;
      }
      coordinates[0] = 1.;
      for (unsigned int v = 1; v < dim; ++v)
        coordinates[0] -= coordinates[v];
      Tensor<1, dim> result = place;
      for (unsigned int k = 0; k < n_face_nodes; ++k)
      {
        double share = 0;
        for (unsigned int v = 0; v < dim; ++v)
          share += coordinates[v] * shares[facet][v][k];
        const Tensor<1, dim> &normal = faces[facet].normals[k];
        result += 0.5 * share * (normal * (faces[facet].places[k] - place)) * normal;
      }
      return result;
    }

    /** The node next to a place, of the face of a facet. */
    const Tensor<1, dim> &node_near(const Tensor<1, dim> &place, const unsigned int facet) const
    {
      const auto &places = faces[facet].places;
      return *std::min_element(
          places.begin(), places.end(),
          [&](const Tensor<1, dim> &a, const Tensor<1, dim> &b)
          { return (a - place - aside).norm_square() < (b - place - aside).norm_square(); });
    }

    Tensor<1, dim> aside; ///< a small way, by which ties are decided [L]
  };

  template <int dim>
  SurfaceSlide<dim>::SurfaceSlide(const Model<dim> &model,
                                  const std::vector<SmoothedCell<dim>> &lattice,
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
        std::array<Point<dim>, dim> vertices;
        for (unsigned int v = 0; v < dim; ++v)
          vertices[v] = SubCells<dim>::point_at(all[f].vertices[v], lattice[c].corners);
        const auto membrane = membrane_of_facet<dim>(
            vertices, SubCells<dim>::area(all[f], lattice[c].corners).norm());
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

  template <int dim>
  void SurfaceSlide<dim>::examine_nodes(const NodePartition &partition,
                                        const std::vector<SmoothedCell<dim>> &lattice)
  {
    constexpr double smooth = 0.92; // half of 46 degrees between two faces
    NodalVector ids(partition.shared_from_this(), Quantity::scalars),
        normals(partition.shared_from_this(), Quantity::scalars);
    const auto add_face = [&](const SmoothedCell<dim> &cell, const unsigned int face)
    {
      const bool is_held = cell.boundary_ids[face] == numbers::internal_face_boundary_id &&
                           !cell.is_towards_void[face];
      const double number = cell.is_towards_void[face] ? id_of_void : cell.boundary_ids[face];
      Tensor<1, dim> normal;
      for (const auto &facet : SubCells<dim>::facets())
        if (facet.to == SubCells<dim>::outside && facet.face == face)
          normal += SubCells<dim>::area(facet, cell.corners);
      normal /= normal.norm();
      for (unsigned int k = 0; k < n_corners; ++k)
      {
        if (!SubCells<dim>::is_on_face(k, face))
          continue;
        const unsigned int node = partition.local_index(cell.nodes[k]);
        double *const of_node = ids.node(node);
        of_node[n_faces] += 1.;
        of_node[held] += is_held ? 1. : 0.;
        of_node[id] += is_held ? 0. : number;
        of_node[squared_id] += is_held ? 0. : number * number;
        for (unsigned int d = 0; d < dim; ++d)
          normals.node(node)[d] += normal[d];
      }
    };
    add_up({&ids, &normals},
           [&]
           {
             for (const SmoothedCell<dim> &cell : lattice)
               for (unsigned int face = 0; face < GeometryInfo<dim>::faces_per_cell; ++face)
                 if (cell.is_on_boundary[face])
                   add_face(cell, face);
           });
    for (unsigned int i = 0; i < partition.n_owned(); ++i)
    {
      const double *const of_node = ids.node(i);
      boundary_nodes.push_back(of_node[n_faces] > 0.);
      // Steps of the lattice towards void cells are no edges of the body.
      const bool has_edge = of_node[id] != id_of_void * of_node[n_faces] &&
                            vector_of<dim>(normals.node(i)).norm() <= smooth * of_node[n_faces];
      smooth_nodes.push_back(of_node[n_faces] > 0. && of_node[held] == 0. &&
                             of_node[n_faces] * of_node[squared_id] == of_node[id] * of_node[id] &&
                             !has_edge);
    }
    for (const NodePartition::Reflected &own_image : partition.nodes_on_planes())
      smooth_nodes[own_image.source] = false;
  }

  template <int dim>
  CurvedSurface<dim> SurfaceSlide<dim>::gather_surface(const NodalVector &slides,
                                                       const NodalVector &position) const
  {
    constexpr double same_side = 0.7; // of the product of two normals: nearer is a kink
    const auto &all = SubCells<dim>::facets();
    NodalVector normals = areas_of_nodes(position); // where the body is smooth
    normals.fill(
        [&](const unsigned int i, double *const of_node)
        {
          const double area = is_smooth(i) ? vector_of<dim>(of_node).norm() : 0.;
          for (unsigned int d = 0; d < dim; ++d)
            of_node[d] = area > 0. ? of_node[d] / area : 0.;
        });
    std::vector<double> own;
    const auto append = [&own](const Tensor<1, dim> &vector)
    { own.insert(own.end(), &vector[0], &vector[0] + dim); };
    for (std::size_t c = 0; c < nodes.size(); ++c)
    {
      if (facets_of_cells[c].empty() || !CellMarks::any_marked(nodes[c], slides))
        continue;
      const Corners corners = corners_at<dim>(nodes[c], position);
      for (const unsigned int f : facets_of_cells[c])
      {
        const Tensor<1, dim> area = SubCells<dim>::area(all[f], corners);
        if (!(area.norm() > 0.))
          continue;
        std::vector<unsigned int> of_face;
        for (unsigned int k = 0; k < n_corners; ++k)
          if (SubCells<dim>::is_on_face(k, all[f].face))
            of_face.push_back(k);
        const Tensor<1, dim> normal = area / area.norm();
        for (unsigned int v = 0; v < dim; ++v)
          append(SubCells<dim>::point_at(all[f].vertices[v], corners));
        append(normal);
        for (unsigned int v = 0; v < dim; ++v)
          for (const unsigned int k : of_face)
            own.push_back(all[f].vertices[v][k]);
        for (const unsigned int k : of_face)
          append(corners[k]);
        for (const unsigned int k : of_face)
        {
          const auto of_node = vector_of<dim>(normals.node(nodes[c][k]));
          append(of_node * normal > same_side ? of_node : Tensor<1, dim>());
        }
      }
    }
    CurvedSurface<dim> surface;
    for (const std::vector<double> &of_rank : numbers_of_ranks(own, communicator))
      surface.add(of_rank);
    if (!surface.facets.facets.empty())
      surface.complete();
    return surface;
  }

  template <int dim>
  NodalVector SurfaceSlide<dim>::areas_of_nodes(const NodalVector &position) const
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
                                const Tensor<1, dim> area = SubCells<dim>::area(all[f], corners);
                                for (unsigned int k = 0; k < n_corners; ++k)
                                  for (unsigned int d = 0; d < dim; ++d)
                                    sums.node(nodes[c][k])[d] += all[f].centroid[k] * area[d];
                              }
                            }
                          });
  }

  template <int dim>
  double SurfaceSlide<dim>::volume(const NodalVector &near, const NodalVector &position) const
  {
    double result = 0;
    for (std::size_t c = 0; c < nodes.size(); ++c)
      if (!is_void[c] && CellMarks::any_marked(nodes[c], near))
        for (const double of_sub_cell :
             CellSimplices<dim>::volumes(corners_at<dim>(nodes[c], position)))
          result += of_sub_cell;
    return ordered_sum(result, communicator);
  }

  template <int dim>
  void SurfaceSlide<dim>::restore_volume(const NodalVector &slides, const NodalVector &near,
                                         const NodalVector &from, const KeepOutside &keep_outside,
                                         const double target, NodalVector &position) const
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
          [&](const unsigned int i, double *const place)
          {
            if (moves(i))
              move_outward(distance, vector_of<dim>(areas.node(i)), place);
          });
    }
  }

  template <int dim>
  void SurfaceSlide<dim>::restore_missing(const NodalVector &slides, const NodalVector &is_bound,
                                          const NodalVector &missing, NodalVector &position) const
  {
    constexpr double farthest = 0.25;
    const NodalVector areas = areas_of_nodes(position);
    position.fill(
        [&](const unsigned int i, double *const place)
        {
          const auto area = vector_of<dim>(areas.node(i));
          if (!(*slides.node(i) > 0.) || *is_bound.node(i) > 0. || !(area.norm() > 0.))
            return;
          const double limit = farthest * std::pow(area.norm(), 1. / (dim - 1));
          move_outward(std::clamp(*missing.node(i) / area.norm(), -limit, limit), area, place);
        });
  }

  template <int dim>
  void SurfaceSlide<dim>::slide(const NodalVector &slides, const NodalVector &initial,
                                const NodalVector &before, const KeepOutside &keep_outside,
                                NodalVector &position) const
  {
    const CurvedSurface<dim> surface = gather_surface(slides, before);
    if (surface.facets.facets.empty())
      return;
    relax_onto(surface, slides, initial, &before, position);
    restore_volume(slides, slides, before, keep_outside, volume(slides, before), position);
  }

  template <int dim>
  void SurfaceSlide<dim>::slide_onto(const SurfaceSlide &former, const NodalVector &near,
                                     const double target, const NodalVector &slides,
                                     const NodalVector &way_shares, const NodalVector &initial,
                                     const NodalVector &before, const KeepOutside &keep_outside,
                                     const FindMissing &missing, NodalVector &position) const
  {
    constexpr unsigned int n_iterations = 2;
    const CurvedSurface<dim> surface = former.gather_surface(near, before);
    if (surface.facets.facets.empty())
      return;
    relax_onto(surface, slides, initial, nullptr, position);
    NodalVector from = before.copy(), is_bound;
    from.fill(
        [&](const unsigned int i, double *const of_node)
        {
          if (!(*slides.node(i) > 0.))
            return;
          const auto found = surface.nearest(vector_of<dim>(position.node(i)));
          const Tensor<1, dim> &next = surface.node_near(found.place, surface.tree.facet_of(found));
          for (unsigned int d = 0; d < dim; ++d)
            of_node[d] = next[d];
        });
    position.fill(
        [&](const unsigned int i, double *const place)
        {
          for (unsigned int d = 0; d<dim && * slides.node(i)> 0.; ++d)
            place[d] = initial.node(i)[d] + *way_shares.node(i) * (place[d] - initial.node(i)[d]);
        });
    is_bound.reinit(position.partition(), Quantity::scalar);
    for (unsigned int iteration = 0; iteration < n_iterations; ++iteration)
    {
      change_owned({&position}, [&] { keep_outside(from, position, is_bound); });
      restore_missing(slides, is_bound, missing(position, is_bound), position);
    }
    restore_volume(slides, near, from, keep_outside, target, position);
  }

  template <int dim>
  void SurfaceSlide<dim>::relax_onto(const CurvedSurface<dim> &surface, const NodalVector &slides,
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
          [&](const unsigned int i, double *const place)
          {
            for (unsigned int d = 0; d < dim && *slides.node(i) == relaxes; ++d)
              place[d] -= relaxation * residual.node(i)[d] / *diagonal.node(i);
          });
      const NodalVector areas = areas_of_nodes(position);
      position.fill(
          [&](const unsigned int i, double *const place)
          {
            if (!(*slides.node(i) > 0.))
              return;
            const Tensor<1, dim> area = vector_of<dim>(areas.node(i));
            const auto found =
                surface.nearest_facing(vector_of<dim>(place), -area / area.norm(), -same_side);
            if (!found && otherwise == nullptr)
              return;
            const Tensor<1, dim> on_surface =
                found ? surface.raise(found->place, surface.tree.facet_of(*found))
                      : vector_of<dim>(otherwise->node(i));
            for (unsigned int d = 0; d < dim; ++d)
              place[d] = on_surface[d];
          });
    }
  }

  template <int dim>
  std::optional<NodalVector>
  SurfaceSlide<dim>::nodes_of_cut_faces(const NodalVector &slides, const NodalVector &before,
                                        const NodalVector &after, const double way,
                                        const FindDepths &find_depths) const
  {
    constexpr double allowed = 0.2; // of the size of a face; less is the sag on a round tool
    const auto &all = SubCells<dim>::facets();
    std::vector<Tensor<1, dim>> places;
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
        places.push_back(SubCells<dim>::point_at(all[f].centroid, was));
        places.push_back(SubCells<dim>::point_at(all[f].centroid, is));
        sizes.push_back(std::pow(SubCells<dim>::area(all[f], was).norm(), 1. / (dim - 1)));
        cells.push_back(c);
      }
    }
    std::vector<unsigned int> numbers(places.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    std::vector<double> depths;
    find_depths(places_as_nodes<dim>(places), numbers, depths);
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
    if (Utilities::MPI::max(any ? 1 : 0, communicator) == 0)
      return {};
    return marks;
  }

  template class SurfaceSlide<2>;
  template class SurfaceSlide<3>;
} // namespace tombolo
