// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/surface_slide.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/contact/places_as_nodes.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/remesh/corners_at.h>
#include <tombolo/remesh/numbers_of_ranks.h>

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

    template <int dim>
    bool has_sliding_node(const std::array<unsigned int, SubCells<dim>::n_corners> &nodes,
                          const NodalVector &slides)
    {
      return std::any_of(nodes.begin(), nodes.end(),
                         [&](const unsigned int node) { return *slides.node(node) > 0.; });
    }
  } // namespace

  template <int dim>
  SurfaceSlide<dim>::SurfaceSlide(const Model<dim> &model,
                                  const std::vector<SmoothedCell<dim>> &lattice)
      : communicator(model.communicator), of_nodes(model, lattice), facets_of_cells(lattice.size()),
        membranes(lattice.size())
  {
    const auto &all = SubCells<dim>::facets();
    for (const SmoothedCell<dim> &cell : lattice)
      is_void.push_back(cell.is_void);
    for (std::size_t c = 0; c < lattice.size(); ++c)
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

  template <int dim>
  NodalVector SurfaceSlide<dim>::normals_of_nodes(const CellNodes &nodes,
                                                  const NodalVector &position) const
  {
    NodalVector result = areas_of_nodes(nodes, position);
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
    {
      const double area = of_nodes.is_smooth(i) ? vector_of<dim>(result.node(i)).norm() : 0.;
      for (unsigned int d = 0; d < dim; ++d)
        result.node(i)[d] = area > 0. ? result.node(i)[d] / area : 0.;
    }
    result.update_ghosts();
    return result;
  }

  template <int dim>
  CurvedSurface<dim> SurfaceSlide<dim>::gather_surface(const CellNodes &nodes,
                                                       const NodalVector &slides,
                                                       const NodalVector &position) const
  {
    constexpr double same_side = 0.7; // of the product of two normals: nearer is a kink
    const auto &all = SubCells<dim>::facets();
    const NodalVector normals = normals_of_nodes(nodes, position);
    std::vector<double> own;
    const auto append = [&own](const Tensor<1, dim> &vector)
    { own.insert(own.end(), &vector[0], &vector[0] + dim); };
    for (std::size_t c = 0; c < nodes.size(); ++c)
    {
      if (facets_of_cells[c].empty() || !has_sliding_node<dim>(nodes[c], slides))
        continue;
      const Corners corners = corners_at<dim>(nodes[c], position);
      for (const unsigned int f : facets_of_cells[c])
      {
        const Tensor<1, dim> area = SubCells<dim>::area(all[f], corners);
        if (!(area.norm() > 0.))
          continue;
        std::vector<unsigned int> of_face;
        for (unsigned int k = 0; k < n_corners; ++k)
          if (((k >> (all[f].face / 2)) & 1u) == all[f].face % 2)
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
  NodalVector SurfaceSlide<dim>::areas_of_nodes(const CellNodes &nodes,
                                                const NodalVector &position) const
  {
    const auto &all = SubCells<dim>::facets();
    NodalVector result;
    result.reinit(position.partition());
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
            result.node(nodes[c][k])[d] += all[f].centroid[k] * area[d];
      }
    }
    result.add_to_owners();
    return result;
  }

  template <int dim>
  double SurfaceSlide<dim>::volume(const CellNodes &nodes, const NodalVector &near,
                                   const NodalVector &position) const
  {
    double result = 0;
    for (std::size_t c = 0; c < nodes.size(); ++c)
      if (!is_void[c] && has_sliding_node<dim>(nodes[c], near))
        for (const double of_sub_cell :
             CellSimplices<dim>::volumes(corners_at<dim>(nodes[c], position)))
          result += of_sub_cell;
    return ordered_sum(result, communicator);
  }

  template <int dim>
  void SurfaceSlide<dim>::put_onto(const CurvedSurface<dim> &surface, const CellNodes &nodes,
                                   const NodalVector &slides, const NodalVector *const otherwise,
                                   NodalVector &position) const
  {
    constexpr double same_side = 0.5; // of the product of two normals
    const NodalVector areas = areas_of_nodes(nodes, position);
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
    {
      if (!(*slides.node(i) > 0.))
        continue;
      const Tensor<1, dim> area = vector_of<dim>(areas.node(i));
      const auto found =
          surface.nearest_facing(vector_of<dim>(position.node(i)), -area / area.norm(), -same_side);
      if (!found && otherwise == nullptr)
        continue;
      const Tensor<1, dim> place = found
                                       ? surface.raise(found->place, surface.tree.facet_of(*found))
                                       : vector_of<dim>(otherwise->node(i));
      for (unsigned int d = 0; d < dim; ++d)
        position.node(i)[d] = place[d];
    }
    position.update_ghosts();
  }

  template <int dim>
  void SurfaceSlide<dim>::restore_volume(const CellNodes &nodes, const NodalVector &slides,
                                         const NodalVector &near, const NodalVector &from,
                                         const KeepOutside &keep_outside, const double target,
                                         NodalVector &position) const
  {
    constexpr unsigned int n_iterations = 4; // of Newton's method; the volume is nearly linear
    NodalVector is_bound;
    is_bound.reinit(position.partition(), Quantity::scalar);
    for (unsigned int iteration = 0; iteration < n_iterations; ++iteration)
    {
      keep_outside(from, position, is_bound);
      position.update_ghosts();
      const NodalVector areas = areas_of_nodes(nodes, position);
      const auto moves = [&](const unsigned int i)
      { return *slides.node(i) > 0. && *is_bound.node(i) == 0.; };
      double sum = 0;
      for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
        if (moves(i))
          sum += vector_of<dim>(areas.node(i)).norm();
      sum = ordered_sum(sum, communicator);
      if (!(sum > 0.))
        continue;
      const double distance = (target - volume(nodes, near, position)) / sum;
      for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
        if (moves(i))
        {
          const auto area = vector_of<dim>(areas.node(i));
          for (unsigned int d = 0; d < dim; ++d)
            position.node(i)[d] += distance * area[d] / area.norm();
        }
      position.update_ghosts();
    }
  }

  template <int dim>
  void SurfaceSlide<dim>::restore_missing(const CellNodes &nodes, const NodalVector &slides,
                                          const NodalVector &is_bound, const NodalVector &missing,
                                          NodalVector &position) const
  {
    constexpr double farthest = 0.25;
    const NodalVector areas = areas_of_nodes(nodes, position);
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
    {
      const auto area = vector_of<dim>(areas.node(i));
      if (!(*slides.node(i) > 0.) || *is_bound.node(i) > 0. || !(area.norm() > 0.))
        continue;
      const double limit = farthest * std::pow(area.norm(), 1. / (dim - 1));
      const double distance = std::clamp(*missing.node(i) / area.norm(), -limit, limit);
      for (unsigned int d = 0; d < dim; ++d)
        position.node(i)[d] += distance * area[d] / area.norm();
    }
    position.update_ghosts();
  }

  template <int dim>
  void SurfaceSlide<dim>::slide(const CellNodes &nodes, const NodalVector &slides,
                                const NodalVector &initial, const NodalVector &before,
                                const KeepOutside &keep_outside, NodalVector &position) const
  {
    const CurvedSurface<dim> surface = gather_surface(nodes, slides, before);
    if (surface.facets.facets.empty())
      return;
    relax_onto(surface, nodes, slides, initial, &before, position);
    restore_volume(nodes, slides, slides, before, keep_outside, volume(nodes, slides, before),
                   position);
  }

  template <int dim>
  void SurfaceSlide<dim>::slide_onto(const SurfaceSlide &former, const NodalVector &near,
                                     const double target, const CellNodes &nodes,
                                     const NodalVector &slides, const NodalVector &way_shares,
                                     const NodalVector &initial, const NodalVector &before,
                                     const KeepOutside &keep_outside, const FindMissing &missing,
                                     NodalVector &position) const
  {
    constexpr unsigned int n_iterations = 2;
    const CurvedSurface<dim> surface = former.gather_surface(nodes, near, before);
    if (surface.facets.facets.empty())
      return;
    relax_onto(surface, nodes, slides, initial, nullptr, position);
    const NodalVector from = nodes_near(surface, slides, before, position);
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
      if (*slides.node(i) > 0.)
        for (unsigned int d = 0; d < dim; ++d)
          position.node(i)[d] =
              initial.node(i)[d] + *way_shares.node(i) * (position.node(i)[d] - initial.node(i)[d]);
    position.update_ghosts();
    NodalVector is_bound;
    is_bound.reinit(position.partition(), Quantity::scalar);
    for (unsigned int iteration = 0; iteration < n_iterations; ++iteration)
    {
      keep_outside(from, position, is_bound);
      position.update_ghosts();
      restore_missing(nodes, slides, is_bound, missing(position, is_bound), position);
    }
    restore_volume(nodes, slides, near, from, keep_outside, target, position);
  }

  template <int dim>
  NodalVector SurfaceSlide<dim>::nodes_near(const CurvedSurface<dim> &surface,
                                            const NodalVector &slides, const NodalVector &before,
                                            const NodalVector &position)
  {
    NodalVector result;
    result.reinit_like(before);
    result.copy_from(before);
    for (unsigned int i = 0; i < before.partition()->n_owned(); ++i)
    {
      if (!(*slides.node(i) > 0.))
        continue;
      const auto found = surface.nearest(vector_of<dim>(position.node(i)));
      const Tensor<1, dim> &node = surface.node_near(found.place, surface.tree.facet_of(found));
      for (unsigned int d = 0; d < dim; ++d)
        result.node(i)[d] = node[d];
    }
    result.update_ghosts();
    return result;
  }

  template <int dim>
  void SurfaceSlide<dim>::relax_onto(const CurvedSurface<dim> &surface, const CellNodes &nodes,
                                     const NodalVector &slides, const NodalVector &initial,
                                     const NodalVector *const otherwise,
                                     NodalVector &position) const
  {
    constexpr unsigned int n_sweeps = 10;
    constexpr double relaxation = 0.7;
    const auto &partition = position.partition();
    CellMatrices<dim> membrane(partition, 0);
    for (std::size_t c = 0; c < nodes.size(); ++c)
      if (!facets_of_cells[c].empty())
        membrane.add_cell(nodes[c], membranes[c]);
    const NodalVector diagonal = membrane.diagonal_of_cells();
    NodalVector displacement, residual;
    for (NodalVector *const vector : {&displacement, &residual})
      vector->reinit(partition);
    for (unsigned int sweep = 0; sweep < n_sweeps; ++sweep)
    {
      for (std::size_t i = 0; i < std::size_t(partition->n_owned()) * node_stride; ++i)
        displacement.data()[i] = position.data()[i] - initial.data()[i];
      membrane.apply(displacement, residual);
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (*slides.node(i) == relaxes)
          for (unsigned int d = 0; d < dim; ++d)
            position.node(i)[d] -= relaxation * residual.node(i)[d] / *diagonal.node(i);
      position.update_ghosts();
      put_onto(surface, nodes, slides, otherwise, position);
    }
  }

  template <int dim>
  std::optional<NodalVector>
  SurfaceSlide<dim>::nodes_of_cut_faces(const CellNodes &nodes, const NodalVector &slides,
                                        const NodalVector &before, const NodalVector &after,
                                        const double way, const FindDepths &find_depths) const
  {
    constexpr double allowed = 0.2; // of the size of a face; less is the sag on a round tool
    const auto &all = SubCells<dim>::facets();
    std::vector<Tensor<1, dim>> places;
    std::vector<double> sizes;
    std::vector<std::size_t> cells;
    for (std::size_t c = 0; c < nodes.size(); ++c)
    {
      if (facets_of_cells[c].empty() || !has_sliding_node<dim>(nodes[c], slides))
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
    NodalVector marks;
    marks.reinit(before.partition(), Quantity::scalar);
    bool any = false;
    for (std::size_t k = 0; k < cells.size(); ++k)
      if (depths[2 * k + 1] > std::max(0., depths[2 * k]) + allowed * sizes[k] + way)
        for (const unsigned int node : nodes[cells[k]])
        {
          *marks.node(node) = 1.;
          any = any || *slides.node(node) > 0.;
        }
    if (Utilities::MPI::max(any ? 1 : 0, communicator) == 0)
      return {};
    marks.sum_over_ranks();
    return marks;
  }

  template class SurfaceSlide<2>;
  template class SurfaceSlide<3>;
} // namespace tombolo
