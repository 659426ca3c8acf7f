// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/part_surface.h>

#include <tombolo/base/input/declarations.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/contact/place_text.h>
#include <tombolo/contact/surfaces/surface_normals.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int no_place = static_cast<unsigned int>(-1);
    /** How far beyond an edge a node may be, and how deep below the facet that it faces, over the
     * size of the cell there. */
    constexpr double across_edge = 0.01, depth_at_edge = 0.5;
    /** A node with faces touches facets whose normals have a cosine below this with its own. */
    constexpr double facing_limit = -0.1;
  } // namespace

  template <int dim>
  void PartSurface<dim>::declare_parameters(ParameterHandler &handler)
  {
    Declarations(handler).text(
        "Part", mandatory, "",
        "The part whose boundary is the surface: one of elements, or a rigid "
        "one. Its own nodes do not touch it.");
  }

  template <int dim>
  PartSurface<dim>::PartSurface(const Section &section) : section(section)
  {
    section.get("Part");
  }

  template <int dim>
  void PartSurface<dim>::take(MasterPart<dim> part, const NodalState &state)
  {
    layer = std::move(part.layer);
    is_driven = part.is_driven;
    set_partition(*state.partition());
    if (state.partition()->symmetry() != nullptr)
      section.parent().fail("Surface", "where planes of symmetry cut bodies, the surface of a "
                                       "contact cannot be a part; allowed is another surface, or "
                                       "no plane of symmetry.");
    try
    {
      surface = ClosedSurface<dim>(layer->facets());
      const std::size_t n_given = layer->facets().facets.size();
      if (surface.facets.size() != n_given)
        throw std::invalid_argument("it has faces without extent");
      node_of_vertex.resize(surface.vertices.size());
      for (std::size_t f = 0; f < n_given; ++f)
        for (const unsigned int v : surface.facets[f].vertex)
        {
          const auto &given = layer->facets().facets[f].vertex;
          const auto found =
              std::find_if(std::begin(given), std::end(given),
                           [&](const unsigned int node)
                           { return layer->facets().vertices[node] == surface.vertices[v]; });
          if (found == std::end(given))
            throw std::invalid_argument("it has two nodes at " + place_text(surface.vertices[v]));
          node_of_vertex[v] = *found;
        }
    }
    catch (const std::invalid_argument &error)
    {
      section.fail("Part", std::string("the boundary of the part cannot be the surface of a "
                                       "contact: ") +
                               error.what() + ".");
    }
    tree = FacetTree<dim>(surface);
    for (std::size_t f = 0; f < surface.facets.size(); ++f)
      largest_size = std::max(largest_size, layer->size(f));
    reactions.assign(dim * layer->n_nodes(), 0.);
    forget_motion(state);
  }

  template <int dim>
  void PartSurface<dim>::set_partition(const NodePartition &partition)
  {
    n_owned_nodes = partition.n_owned();
    layer->set_partition(partition);
  }

  template <int dim>
  void PartSurface<dim>::drop_own_nodes(const Section &contact,
                                        std::vector<unsigned int> &candidates) const
  {
    candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                    [&](const unsigned int node) { return layer->has_node(node); }),
                     candidates.end());
    if (Utilities::MPI::sum(candidates.size(), contact.all().communicator()) == 0)
      contact.fail(contact.get("Boundary").empty() ? "Surface" : "Boundary",
                   "no node can touch but those of the part \"" + section.get("Part") +
                       "\", whose boundary is the surface, and a part is not its own master; "
                       "allowed are nodes of other parts. For a body that touches itself there "
                       "are body contacts.");
  }

  template <int dim>
  void PartSurface<dim>::set_areas(const OutwardAreas<dim> &areas)
  {
    this->areas = &areas;
  }

  template <int dim>
  std::vector<Tensor<1, dim>> PartSurface<dim>::gather_positions(const NodalVector &position) const
  {
    const std::vector<double> values =
        layer->gather(dim, [&](const unsigned int node, double *const x)
                      { std::copy_n(position.node(node), dim, x); });
    std::vector<Tensor<1, dim>> result(layer->n_nodes());
    for (std::size_t a = 0; a < result.size(); ++a)
      result[a] = vector_of<dim>(&values[dim * a]);
    return result;
  }

  template <int dim>
  void PartSurface<dim>::refit()
  {
    std::vector<Tensor<1, dim>> vertices(node_of_vertex.size());
    for (std::size_t v = 0; v < vertices.size(); ++v)
      vertices[v] = positions[node_of_vertex[v]];
    move_vertices(surface, vertices);
    tree.refit(surface);
  }

  template <int dim>
  void PartSurface<dim>::forget_motion(const NodalState &state)
  {
    positions = last_positions = gather_positions(state.position);
    refit();
  }

  template <int dim>
  void PartSurface<dim>::follow(const NodalState &state)
  {
    last_positions = std::move(positions);
    positions = gather_positions(state.position);
    if (!is_driven)
      masses = layer->gather(1, [&](const unsigned int node, double *const mass)
                             { *mass = *state.mass.node(node); });
    refit();
  }

  template <int dim>
  typename PartSurface<dim>::Below PartSurface<dim>::below(const Tensor<1, dim> &point,
                                                           const Tensor<1, dim> *const facing) const
  {
    using Feature = typename FacetTree<dim>::Feature;
    const auto nearest = tree.nearest(point);
    const Tensor<1, dim> &outward =
        nearest.feature == Feature::facet  ? surface.facet_normals[nearest.number]
        : nearest.feature == Feature::edge ? surface.edge_normals[nearest.number]
                                           : surface.vertex_normals[nearest.number];
    const Tensor<1, dim> away = point - nearest.place;
    const double distance = std::sqrt(nearest.distance_square);
    const double sign = away * outward < 0. ? -1. : 1.;
    Below result{sign * distance, outward, tree.facet_of(nearest)};
    // On the surface itself the way to it has no direction.
    if (nearest.feature != Feature::facet && distance > 1e-12 * (surface.high - surface.low).norm())
      result.normal = sign / distance * away;
    if (facing == nullptr || result.gap > across_edge * layer->size(result.facet))
      return result;
    const double limit = facing_limit * facing->norm();
    if (surface.facet_normals[result.facet] * *facing < limit)
      return result;
    const auto faced = tree.nearest_facing(point, *facing, limit);
    if (!faced)
      return result;
    const unsigned int facet = tree.facet_of(*faced);
    const Tensor<1, dim> &normal = surface.facet_normals[facet];
    const Tensor<1, dim> from_facet = point - faced->place;
    const double gap = from_facet * normal, size = layer->size(facet);
    if (gap < -depth_at_edge * size || gap > across_edge * size ||
        (from_facet - gap * normal).norm() > across_edge * size)
      return result;
    return {gap, normal, facet};
  }

  template <int dim>
  typename PartSurface<dim>::Below PartSurface<dim>::below_node(const Tensor<1, dim> &point,
                                                                const unsigned int node) const
  {
    if (areas == nullptr || node >= n_owned_nodes || !areas->has_face(node))
      return below(point);
    const Tensor<1, dim> facing = areas->area(node);
    return below(point, facing.norm_square() > 0. ? &facing : nullptr);
  }

  template <int dim>
  void PartSurface<dim>::evaluate_gaps(const NodalVector &position,
                                       const std::vector<unsigned int> &nodes,
                                       const double /*time*/, std::vector<double> &gap) const
  {
    gap.resize(nodes.size());
    // Beside an edge a node may be outside of the box and touch; gaps beyond the reach may be less.
    const double edge = areas == nullptr ? 0. : across_edge * largest_size;
    for (std::size_t k = 0; k < nodes.size(); ++k)
    {
      const auto x = vector_of<dim>(position.node(nodes[k]));
      double outside = 0;
      for (unsigned int d = 0; d < dim; ++d)
        outside = std::max({outside, surface.low[d] - x[d], x[d] - surface.high[d]});
      gap[k] = outside > reach + edge ? outside - edge : below_node(x, nodes[k]).gap;
    }
  }

  template <int dim>
  Tensor<1, dim> PartSurface<dim>::normal(const Tensor<1, dim> &point, const double /*time*/) const
  {
    return below(point).normal;
  }

  template <int dim>
  Tensor<1, dim> PartSurface<dim>::motion(const Tensor<1, dim> &point, const double /*from*/,
                                          const double /*to*/) const
  {
    const unsigned int cell = layer->cell_of_facet()[below(point).facet];
    return motion_of(cell, layer->weights(point, cell, positions));
  }

  template <int dim>
  Tensor<1, dim> PartSurface<dim>::motion_of(const unsigned int cell, const Weights &weights) const
  {
    Tensor<1, dim> result;
    for (unsigned int c = 0; c < n_corners; ++c)
    {
      const unsigned int a = layer->cells()[cell][c];
      result += weights[c] * (positions[a] - last_positions[a]);
    }
    return result;
  }

  template <int dim>
  Tensor<1, dim> PartSurface<dim>::reference_point(const double /*time*/) const
  {
    Tensor<1, dim> sum;
    for (const Tensor<1, dim> &vertex : surface.vertices)
      sum += vertex;
    return sum / std::max<double>(1., static_cast<double>(surface.vertices.size()));
  }

  template <int dim>
  void PartSurface<dim>::find_places(const NodalState &state,
                                     const std::vector<unsigned int> &nodes,
                                     const std::vector<std::size_t> &candidates)
  {
    place_of_candidate.resize(nodes.size(), no_place);
    for (const Place &place : places)
      place_of_candidate[place.candidate] = no_place;
    places.clear();
    for (const std::size_t k : candidates)
    {
      const auto x = vector_of<dim>(state.position.node(nodes[k]));
      const Below found = below_node(x, nodes[k]);
      Place place;
      place.candidate = k;
      place.normal = found.normal;
      place.cell = layer->cell_of_facet()[found.facet];
      place.weights = layer->weights(x, place.cell, positions);
      place.motion = motion_of(place.cell, place.weights);
      place.crowding = 0.;
      place_of_candidate[k] = static_cast<unsigned int>(places.size());
      places.push_back(place);
    }
    if (is_driven)
      return;
    std::vector<const Place *> all;
    std::vector<double> of_place;
    for (const Place &place : places)
    {
      all.push_back(&place);
      of_place.push_back(*state.mass.node(nodes[place.candidate]));
    }
    const std::vector<double> found = crowding(all, of_place, masses);
    for (std::size_t i = 0; i < places.size(); ++i)
      places[i].crowding = found[i];
  }

  template <int dim>
  const typename PartSurface<dim>::Place &PartSurface<dim>::place(const std::size_t candidate) const
  {
    return places[place_of_candidate[candidate]];
  }

  template <int dim>
  std::vector<double> PartSurface<dim>::crowding(const std::vector<const Place *> &places,
                                                 const std::vector<double> &of_place,
                                                 const std::vector<double> &of_nodes) const
  {
    std::vector<double> sums(layer->n_nodes(), 0.);
    for (std::size_t i = 0; i < places.size(); ++i)
      for (unsigned int c = 0; c < n_corners; ++c)
        sums[cell(*places[i])[c]] += std::abs(places[i]->weights[c]) * of_place[i];
    layer->sum(1, sums);
    std::vector<double> result;
    for (const Place *const place : places)
    {
      double largest = 0;
      for (unsigned int c = 0; c < n_corners; ++c)
        if (const unsigned int a = cell(*place)[c]; sums[a] > 0.)
          largest = std::max(largest, sums[a] / of_nodes[a]);
      result.push_back(largest);
    }
    return result;
  }

  template <int dim>
  void PartSurface<dim>::add_reaction(const Place &place, const Tensor<1, dim> &force)
  {
    for (unsigned int c = 0; c < n_corners; ++c)
      for (unsigned int d = 0; d < dim; ++d)
        reactions[dim * cell(place)[c] + d] -= place.weights[c] * force[d];
  }

  template <int dim>
  void PartSurface<dim>::collect_reactions(NodalVector &loads,
                                           std::vector<unsigned int> &loaded_nodes)
  {
    layer->sum(dim, reactions);
    for (const auto &owned : layer->owned())
    {
      const double *const reaction = &reactions[dim * owned.number];
      if (std::all_of(reaction, reaction + dim, [](const double value) { return value == 0.; }))
        continue;
      for (unsigned int d = 0; d < dim; ++d)
        loads.node(owned.node)[d] += reaction[d];
      loaded_nodes.push_back(owned.node);
    }
    std::fill(reactions.begin(), reactions.end(), 0.);
  }

  template <int dim>
  void PartSurface<dim>::serialize(StateArchive &archive)
  {
    const auto group = archive.group("surface of the part");
    std::vector<unsigned int> nodes;
    std::vector<std::array<double, 3>> values;
    for (const auto &owned : layer->owned())
    {
      nodes.push_back(owned.node);
      std::array<double, 3> value{};
      for (unsigned int d = 0; d < dim; ++d)
        value[d] = positions[owned.number][d];
      values.push_back(value);
    }
    archive.nodal("position", nodes, values);
    if (!archive.is_reading())
      return;
    std::size_t k = 0;
    const std::vector<double> all = layer->gather(dim, [&](unsigned int, double *const x)
                                                  { std::copy_n(values[k++].data(), dim, x); });
    for (std::size_t a = 0; a < positions.size(); ++a)
      positions[a] = vector_of<dim>(&all[dim * a]);
    refit();
  }

  template <int dim>
  std::string PartSurface<dim>::description() const
  {
    return "the boundary of the part \"" + section.get("Part") + "\", " +
           std::to_string(surface.facets.size()) + (dim == 2 ? " sides" : " triangles") +
           "; every rank gathers " + std::to_string(layer->n_nodes()) +
           " nodes of its outermost cells in each step";
  }

  template <int dim>
  std::size_t PartSurface<dim>::memory_consumption() const
  {
    return layer->memory_consumption() + surface.memory_consumption() + tree.memory_consumption();
  }

  template class PartSurface<2>;
  template class PartSurface<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(ContactSurface, PartSurface, "part",
                                  "the boundary of a part of the scene, which bodies push back, "
                                  "deform and heat")
} // namespace tombolo
