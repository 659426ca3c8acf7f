// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/bodies.h>

#include <tombolo/base/on_ranks.h>

#include <boost/pending/disjoint_sets.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace tombolo
{
  template <int dim>
  Bodies<dim>::Bodies(const Nodes<dim> &nodes)
      : smallest(nodes.owned(), nodes.relevant(), nodes.communicator())
  {
    const IndexSet &relevant = nodes.relevant();
    const auto local = [&](const types::global_dof_index node)
    { return relevant.index_within_set(node); };
    boost::disjoint_sets_with_storage<> joined(relevant.n_elements());
    std::vector<types::global_dof_index> cell_nodes;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      if (cell->is_locally_owned())
      {
        nodes.cell_nodes(cell, cell_nodes);
        for (const types::global_dof_index node : cell_nodes)
          joined.union_set(local(cell_nodes.front()), local(node));
      }

    // A double holds every number of a node that a mesh can have.
    for (const types::global_dof_index node : relevant)
      smallest[node] = static_cast<double>(node);
    std::vector<double> lowest_in_set(relevant.n_elements());
    bool has_changed = true;
    while (has_changed)
    {
      lowest_in_set.assign(lowest_in_set.size(), std::numeric_limits<double>::max());
      for (const types::global_dof_index node : relevant)
      {
        double &lowest = lowest_in_set[joined.find_set(local(node))];
        lowest = std::min(lowest, static_cast<double>(smallest[node]));
      }
      smallest.set_ghost_state(false);
      int has_changed_here = 0;
      for (const types::global_dof_index node : relevant)
        if (const double lowest = lowest_in_set[joined.find_set(local(node))];
            smallest[node] > lowest)
        {
          smallest[node] = lowest;
          has_changed_here = 1;
        }
      smallest.compress(VectorOperation::min);
      smallest.update_ghost_values();
      has_changed = Utilities::MPI::max(has_changed_here, nodes.communicator()) == 1;
    }
    count = 0;
    for (const types::global_dof_index node : nodes.owned())
      count += body_of(node) == node ? 1 : 0;
    count = Utilities::MPI::sum(count, nodes.communicator());
  }

  template class Bodies<2>;
  template class Bodies<3>;

  template <int dim>
  PlanesOfBodies::PlanesOfBodies(const Bodies<dim> &bodies, const Images &images,
                                 const MPI_Comm communicator)
  {
    if (images.empty())
      return;
    std::map<types::global_dof_index, unsigned int> own_mirrors;
    for (unsigned int m = 0; m < images.all.size(); ++m)
      for (const types::global_dof_index node : images.all[m].own_images)
        own_mirrors[bodies.body_of(node)] |= 1u << m;
    std::vector<std::array<types::global_dof_index, 2>> sent;
    for (const auto &[body, mirrors] : own_mirrors)
      sent.push_back({{body, mirrors}});
    for (const auto &[body, mirrors] : from_all_ranks(sent, communicator))
      mirrors_of_body[body] |= static_cast<unsigned int>(mirrors);
  }

  template PlanesOfBodies::PlanesOfBodies(const Bodies<2> &, const Images &, MPI_Comm);
  template PlanesOfBodies::PlanesOfBodies(const Bodies<3> &, const Images &, MPI_Comm);
} // namespace tombolo
