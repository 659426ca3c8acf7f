// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surface_contact.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/contact/contact_heat.h>
#include <tombolo/contact/contact_settings.h>
#include <tombolo/mesh/region.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  template <int dim>
  std::unique_ptr<ContactSurface<dim>> ContactScene<dim>::create_surface(const Section &section)
  {
    const std::string name = section.get("Surface");
    return Registry<ContactSurface<dim>>::instance().create(name, section.subsection(name));
  }

  template <int dim>
  void ContactScene<dim>::declare(const Entries &e)
  {
    e.choice("Surface", mandatory, Registry<ContactSurface<dim>>::instance().selection(),
             "The surface that nodes touch: a rigid one, or the boundary of a part.");
    e.plugins<ContactSurface<dim>>();
    e.text("Boundary", "", "",
           "Names of the boundaries whose nodes can touch, separated by commas; empty for the "
           "nodes of the whole surface, all particles, and all nodes of elements that erode.");
    e.text("Where", "", "", "A predicate of the initial position that nodes must fulfil to touch.");
    tombolo::declare<ContactSettings>(e);
    tombolo::declare<HeatPartner>(e);
  }

  template <int dim>
  void ContactScene<dim>::validate(const Section &section, const bool has_heat)
  {
    const Parameters &parameters = section.all();
    parameters.attempt([&] { ContactSettings settings(section, has_heat); });
    parameters.attempt([&] { create_surface(section); });
    const bool is_of_part = section.get("Surface") == surface_of_part;
    if (is_of_part && section.get("Method") != "penalty")
      parameters.attempt(
          [&]
          {
            section.fail("Method", "the surface is that of a part, which nodes push back by "
                                   "springs; allowed is penalty.");
          });
    if (has_heat)
      parameters.attempt([&] { HeatPartner partner(section, is_of_part); });
    parameters.attempt([&] { Region<dim>(section, true); });
  }

  template <int dim>
  std::set<types::boundary_id> ContactScene<dim>::boundaries() const
  {
    if (section.get("Boundary").empty())
      return {};
    return boundary_ids(mesh, section, "Boundary");
  }

  template <int dim>
  std::vector<unsigned int>
  ContactScene<dim>::candidates(const std::set<types::boundary_id> &boundaries) const
  {
    const NodePartition &partition = *state.partition();
    std::vector<bool> is_candidate(partition.n_owned(), false);
    if (section.get("Boundary").empty())
      is_candidate = can_be_exposed;
    nodes.for_each_boundary_node(
        [&](const auto &cell, const unsigned int f)
        {
          return nodes.is_outer_face(cell, f) &&
                 (boundaries.empty() || boundaries.count(cell->face(f)->boundary_id()) > 0);
        },
        [&](const types::global_dof_index node)
        {
          if (nodes.owned().is_element(node))
            is_candidate[partition.local_index(node)] = true;
        });

    const Region<dim> where(section, true);
    std::vector<unsigned int> result;
    attempt_on_all_ranks<InputError>(
        nodes.communicator(),
        [&]
        {
          for (unsigned int i = 0; i < partition.n_owned(); ++i)
            if (is_candidate[i] && where.contains(point_of<dim>(state.initial_position.node(i))))
              result.push_back(i);
        });
    if (Utilities::MPI::sum(result.size(), nodes.communicator()) == 0)
      section.fail(section.get("Where").empty() ? "Boundary" : "Where",
                   "no node can touch; the contact would do nothing.");
    return result;
  }

  template <int dim>
  void ContactScene<dim>::refuse_depth(
      const Nodes<dim> &nodes, const NodalState &state, const std::vector<unsigned int> &candidates,
      const std::vector<double> &depths,
      const std::function<std::string(const std::string &depth, const std::string &node)> &message)
  {
    double extent = 0;
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      extent = std::max(extent, vector_of<dim>(state.initial_position.node(i)).norm());
    extent = Utilities::MPI::max(extent, nodes.communicator());
    std::string failure;
    double deepest = 0;
    for (std::size_t k = 0; k < candidates.size(); ++k)
      if (depths[k] > std::max(deepest, 1e-9 * extent))
      {
        deepest = depths[k];
        failure = message(
            as_text(deepest),
            "the node with the number " + std::to_string(nodes.persistent_ids()[candidates[k]]) +
                " at " + position_text(vector_of<dim>(state.initial_position.node(candidates[k]))));
      }
    // Of all ranks, the one with the deepest node reports it.
    if (deepest < Utilities::MPI::max(deepest, nodes.communicator()))
      failure.clear();
    throw_on_all_ranks<InputError>(failure, nodes.communicator());
  }

  template <int dim>
  void ContactScene<dim>::refuse_motion_out_of_mirrors(ContactSurface<dim> &surface) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (nodes.images()->are_opposite_along(d) && surface.translation().moves_along(d))
        section.subsection(section.get("Surface"))
            .fail("Directions", "a body with a mass would move out of a " + Images::words(true) +
                                    "; allowed are directions without " + "xyz"[d] + ".");
  }

  template struct ContactScene<2>;
  template struct ContactScene<3>;
} // namespace tombolo
