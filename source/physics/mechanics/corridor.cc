// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/rigid_contacts.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/contact/nodal_geometry.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr const char *corridor_entry = "Corridor";
  }

  template <int dim>
  Corridor<dim>::Corridor(const Section &section)
      : section(section), is_inside(section, corridor_entry)
  {}

  template <int dim>
  void Corridor<dim>::check(const SurfaceContact<dim> &contact, const NodalState &state) const
  {
    bool any = false;
    std::string failure;
    try
    {
      for (const unsigned int node : contact.candidate_nodes())
        any = is_inside(Point<dim>(vector_of<dim>(state.initial_position.node(node)))) || any;
    }
    catch (const InputError &error)
    {
      failure = error.what();
    }
    throw_on_all_ranks<InputError>(failure, state.partition()->communicator());
    if (Utilities::MPI::max(any ? 1 : 0, state.partition()->communicator()) == 0)
      section.fail(corridor_entry, "no node that the surface can touch is there; allowed is a "
                                   "condition on x, y, z that some of them meet at the start.");
  }

  template <int dim>
  std::optional<std::string> Corridor<dim>::find_exit(const SurfaceContact<dim> &contact,
                                                      const NodalState &state, const Clock &clock)
  {
    if (was_left)
      return {};
    const std::vector<unsigned int> nodes = contact.nodes_in_contact();
    const auto outside = std::find_if(
        nodes.begin(), nodes.end(),
        [&](const unsigned int node)
        { return !is_inside(Point<dim>(vector_of<dim>(state.initial_position.node(node)))); });
    std::string place;
    if (outside != nodes.end())
      place = place_text(vector_of<dim>(state.position.node(*outside)));
    for (const std::string &of_rank : texts_of_ranks(state.partition()->communicator(), place))
    {
      if (of_rank.empty())
        continue;
      was_left = true;
      std::ostringstream text;
      text
          << "At t = " << clock.time << " the contact \"" << contact.name()
          << "\" touches a node at " << of_rank << " that is outside of its `Corridor`, \""
          << section.get(corridor_entry)
          << "\". What is deformed there is not made for it: a shorter way of the tool, or a wider "
             "corridor with the particles or the refined cells in it, helps.";
      return text.str();
    }
    return {};
  }

  template class Corridor<2>;
  template class Corridor<3>;
} // namespace tombolo
