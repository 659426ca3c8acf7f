// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/part_surface.h>

#include <tombolo/base/format.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace tombolo
{
  namespace
  {
    constexpr unsigned int no_point = static_cast<unsigned int>(-1);
    /** How deep a node may be behind a side where it begins to touch, over the size of the cell. */
    constexpr double depth_of_onset = 0.1;

    /** The number in @p list of each vertex of the @p surface that was made of it. Throws
     * std::invalid_argument where two of them are at one point. */
    template <int dim>
    std::vector<unsigned int> numbers_of_vertices(const FacetList<dim> &list,
                                                  const ClosedSurface<dim> &surface)
    {
      std::vector<unsigned int> result(surface.vertices.size());
      for (std::size_t f = 0; f < list.facets.size(); ++f)
        for (const unsigned int v : surface.facets[f].vertex)
        {
          const auto &numbers = list.facets[f].vertex;
          const auto found = std::find_if(std::begin(numbers), std::end(numbers),
                                          [&](const unsigned int number)
                                          { return list.vertices[number] == surface.vertices[v]; });
          if (found == std::end(numbers))
            throw std::invalid_argument("it has two nodes at " +
                                        position_text(surface.vertices[v]));
          result[v] = *found;
        }
      return result;
    }
  } // namespace

  template <int dim>
  PartSurface<dim>::PartSurface(const Entries &e) : section(e.section())
  {
    e.text("Part", mandatory, "",
           "The part whose boundary is the surface: one of elements, or a rigid one. Its own nodes "
           "do not touch it.");
  }

  template <int dim>
  void PartSurface<dim>::set_part(MasterPart<dim> part, const NodalState &state)
  {
    layer = std::move(part.layer);
    is_driven = part.is_driven;
    set_partition(*state.partition());
    try
    {
      surface = SearchedSurface<dim>(ClosedSurface<dim>(layer->facets()));
      if (surface.facets.size() != layer->facets().facets.size())
        throw std::invalid_argument("it has faces without extent");
      node_of_vertex = numbers_of_vertices<dim>(layer->facets(), surface);
    }
    catch (const std::invalid_argument &error)
    {
      section.fail("Part", std::string("the boundary of the part cannot be the surface of a "
                                       "contact: ") +
                               error.what() + ".");
    }
    for (std::size_t f = 0; f < surface.facets.size(); ++f)
      largest_size = std::max(largest_size, layer->size(f));
    reactions.assign(dim * layer->n_nodes(), 0.);
    reset_motion(state);
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
  std::vector<Tensor<1, dim>> PartSurface<dim>::gather_positions(const NodalVector &position) const
  {
    const std::vector<double> values = layer->gather(dim, Quantity::position,
                                                     [&](const unsigned int node, double *const x)
                                                     { std::copy_n(position.node(node), dim, x); });
    std::vector<Tensor<1, dim>> result(layer->n_nodes());
    for (std::size_t a = 0; a < result.size(); ++a)
      result[a] = vector_of<dim>(&values[dim * a]);
    return result;
  }

  template <int dim>
  std::optional<FacedSides<dim>> PartSurface<dim>::faced_by(const Tensor<1, dim> &point,
                                                            const unsigned int node) const
  {
    if (areas == nullptr || node >= sides.size() || !areas->has_face(node))
      return std::nullopt;
    return surface.faced_sides(point, areas->area(node),
                               [&](const unsigned int facet) { return layer->size(facet); });
  }

  template <int dim>
  SurfaceGap<dim> PartSurface<dim>::gap_of_node(const Tensor<1, dim> &point,
                                                const unsigned int node) const
  {
    const SurfaceGap<dim> nearest = surface.gap(point);
    // Where the nearest side is one that it faces, the distance to it is that to its plane.
    if (node >= sides.size() || sides[node] != Side::held ||
        (nearest.gap < 0. &&
         FacedSides<dim>::are_of(areas->area(node), surface.facet_normals[nearest.facet])))
      return nearest;
    const auto faced = faced_by(point, node);
    return faced && faced->gap.gap < nearest.gap ? faced->gap : nearest;
  }

  template <int dim>
  void PartSurface<dim>::find_sides(const NodalVector &position,
                                    const std::vector<unsigned int> &candidates)
  {
    for (const unsigned int node : candidates)
    {
      const auto x = vector_of<dim>(position.node(node));
      if (sides[node] != Side::held && surface.distance_to_box(x) > largest_size)
      {
        sides[node] = Side::in_front;
        continue;
      }
      const auto faced = faced_by(x, node);
      if (!faced || !(faced->behind > 0.))
        sides[node] = Side::in_front;
      else if (sides[node] == Side::in_front)
      {
        const bool is_near = faced->outside <= faced->across_edge * faced->size &&
                             faced->behind <= depth_of_onset * faced->size;
        sides[node] = is_near ? Side::held : Side::behind;
      }
      else if (sides[node] == Side::held && !(gap_of_node(x, node).gap < 0.))
        sides[node] = Side::behind;
    }
  }

  template <int dim>
  void PartSurface<dim>::evaluate_gaps(const NodalVector &position,
                                       const std::vector<unsigned int> &nodes,
                                       const double /*time*/, std::vector<double> &gap) const
  {
    gap.resize(nodes.size());
    for (std::size_t k = 0; k < nodes.size(); ++k)
    {
      // Gaps beyond the reach may be less.
      const auto x = vector_of<dim>(position.node(nodes[k]));
      const double outside = surface.distance_to_box(x);
      const bool is_held = nodes[k] < sides.size() && sides[nodes[k]] == Side::held;
      gap[k] = outside > reach && !is_held ? outside : gap_of_node(x, nodes[k]).gap;
    }
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
  void PartSurface<dim>::find_contact_points(const NodalState &state,
                                             const std::vector<unsigned int> &nodes,
                                             const std::vector<std::size_t> &candidates)
  {
    point_of_candidate.resize(nodes.size(), no_point);
    for (const ContactPoint &point : contact_points)
      point_of_candidate[point.candidate] = no_point;
    contact_points.clear();
    for (const std::size_t k : candidates)
    {
      const auto x = vector_of<dim>(state.position.node(nodes[k]));
      const SurfaceGap<dim> found = gap_of_node(x, nodes[k]);
      ContactPoint point;
      point.candidate = k;
      point.normal = found.normal;
      point.cell = layer->cell_of_facet()[found.facet];
      point.weights = layer->weights(x, point.cell, positions);
      point.motion = motion_of(point.cell, point.weights);
      point.crowding = 0.;
      point_of_candidate[k] = static_cast<unsigned int>(contact_points.size());
      contact_points.push_back(point);
    }
    if (is_driven)
      return;
    std::vector<double> point_masses;
    for (const std::size_t k : candidates)
      point_masses.push_back(*state.mass.node(nodes[k]));
    const std::vector<double> found =
        crowding(candidates, point_masses, [&](const unsigned int a) { return masses[a]; });
    for (std::size_t i = 0; i < contact_points.size(); ++i)
      contact_points[i].crowding = found[i];
  }

  template <int dim>
  void PartSurface<dim>::collect_reactions(NodalVector &loads,
                                           std::vector<unsigned int> &loaded_nodes)
  {
    layer->sum(dim, Quantity::vector, reactions);
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
  void PartSurface<dim>::list(Records &records, const std::vector<unsigned int> &candidates)
  {
    records.archived(
        [this, &candidates](StateArchive &archive)
        {
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
          std::vector<std::array<double, 3>> side_of_candidates(candidates.size());
          for (std::size_t k = 0; k < candidates.size(); ++k)
            side_of_candidates[k][0] = static_cast<double>(sides[candidates[k]]);
          archive.nodal("side", candidates, side_of_candidates);
          for (std::size_t k = 0; k < candidates.size(); ++k)
            sides[candidates[k]] = static_cast<Side>(side_of_candidates[k][0]);
          if (!archive.is_reading())
            return;
          std::size_t k = 0;
          const std::vector<double> all = layer->gather(
              dim, Quantity::position,
              [&](unsigned int, double *const x) { std::copy_n(values[k++].data(), dim, x); });
          for (std::size_t a = 0; a < positions.size(); ++a)
            positions[a] = vector_of<dim>(&all[dim * a]);
          refit();
        });
  }

  template class PartSurface<2>;
  template class PartSurface<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(ContactSurface, PartSurface, "part",
                                  "the boundary of a part of the scene, which bodies push back, "
                                  "deform and heat")
} // namespace tombolo
