// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/bridge.h>

#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
  void Bridge::set_loaded_nodes(const std::vector<unsigned int> &loaded_nodes)
  {
    const auto &partition = total_mass.partition();
    std::vector<bool> is_loaded(partition->n_owned(), false);
    for (const unsigned int node : loaded_nodes)
      is_loaded[node] = true;

    loaded_own.clear();
    for (std::size_t k = 0; k < own_nodes.size(); ++k)
      if (is_loaded[own_nodes[k]])
        loaded_own.push_back(k);
    for (ParticlePart &part : parts)
    {
      part.loaded_rows.clear();
      for (unsigned int row = 0; part.is_smoothed && row < part.shape->n_particles(); ++row)
        if (is_loaded[part.shape->particle_node[row]])
          part.loaded_rows.push_back(row);
    }

    std::vector<bool> is_touched(partition->n_local(), false);
    for (const std::size_t k : loaded_own)
      is_touched[own_nodes[k]] = true;
    for (const ParticlePart &part : parts)
      for (const unsigned int row : part.loaded_rows)
      {
        const Stencils::Row of_row = part.shape->row(row);
        for (unsigned int k = 0; k < of_row.size; ++k)
          is_touched[of_row.neighbour[k]] = true;
      }
    NodalVector mark;
    mark.reinit(partition, 1);
    for (unsigned int i = 0; i < partition->n_local(); ++i)
      *mark.node(i) = is_touched[i] ? 1. : 0.;
    mark.add_to_owners();
    touched_nodes.clear();
    for (unsigned int i = 0; i < partition->n_local(); ++i)
      if (is_touched[i] || (i < partition->n_owned() && *mark.node(i) > 0.))
        touched_nodes.push_back(i);
  }

  void Bridge::force_of_loads(const NodalVector &loads, NodalVector &force)
  {
    for (const unsigned int node : touched_nodes)
      store_node(NodeLanes(0.), force.node(node));
    for (const std::size_t k : loaded_own)
      store_node(load_node(own_fraction.data() + k * node_stride) *
                     load_node(loads.node(own_nodes[k])),
                 force.node(own_nodes[k]));
    for (const ParticlePart &part : parts)
      for (const unsigned int row : part.loaded_rows)
      {
        const Stencils &shape = *part.shape;
        const NodeLanes load =
            load_node(loads.node(shape.particle_node[row])) *
            load_node(part.smoothed_fraction.data() + std::size_t(row) * node_stride);
        NodalSmoothing::scatter_row(shape.row(row), load, force.data());
      }
    force.add_to_owners();
  }

  void Bridge::find_places()
  {
    const unsigned int n_owned = total_mass.partition()->n_owned();
    place_in_own.assign(n_owned, is_nowhere);
    for (std::size_t k = 0; k < own_nodes.size(); ++k)
      place_in_own[own_nodes[k]] = static_cast<unsigned int>(k);
    for (ParticlePart &part : parts)
    {
      part.row_of_node.assign(n_owned, is_nowhere);
      for (unsigned int row = 0; part.is_smoothed && row < part.shape->n_particles(); ++row)
        part.row_of_node[part.shape->particle_node[row]] = row;
    }
  }

  void Bridge::add_force_of_loads(const std::vector<unsigned int> &nodes, const NodalVector &loads,
                                  NodalVector &force)
  {
    if (place_in_own.empty())
      find_places();
    for (const unsigned int node : nodes)
    {
      const NodeLanes load = load_node(loads.node(node));
      if (const std::size_t k = place_in_own[node]; k != is_nowhere)
        store_node(load_node(force.node(node)) +
                       load * load_node(own_fraction.data() + k * node_stride),
                   force.node(node));
      for (const ParticlePart &part : parts)
        if (const unsigned int row = part.row_of_node[node]; row != is_nowhere)
        {
          const Stencils &shape = *part.shape;
          const NodeLanes share =
              load * load_node(part.smoothed_fraction.data() + std::size_t(row) * node_stride);
          NodalSmoothing::scatter_row(shape.row(row), share, force.data());
        }
    }
  }

  const std::vector<unsigned int> &Bridge::nodes_touched_by_loads() const
  {
    return touched_nodes;
  }

  const NodalVector &Bridge::element_velocity(const NodalVector &velocity)
  {
    if (!trace)
      return velocity;
    trace_velocity.copy_from(velocity);
    for (const ParticlePart &part : parts)
      for (const unsigned int row : part.element_rows)
      {
        const Stencils &shape = *part.shape;
        const NodeLanes sum = NodalSmoothing::gather_row(shape.row(row), velocity.data());
        // A prescribed component keeps its own value.
        const NodeLanes weight =
            load_node(part.smoothed_fraction.data() + std::size_t(row) * node_stride);
        double *const target = trace_velocity.node(shape.particle_node[row]);
        store_node(load_node(target) +
                       weight * (sum - load_node(velocity.node(shape.particle_node[row]))),
                   target);
      }
    trace_velocity.update_ghosts();
    return trace_velocity;
  }

  void Bridge::collect_element_force(NodalVector &element_force, NodalVector &force)
  {
    Assert(trace, dealii::ExcInternalError());
    element_force.add_to_owners();
    trace_force.set_zero();
    for (const ParticlePart &part : parts)
      for (const unsigned int row : part.element_rows)
      {
        const Stencils &shape = *part.shape;
        double *const own = element_force.node(shape.particle_node[row]);
        const NodeLanes moved = load_node(own) * load_node(part.smoothed_fraction.data() +
                                                           std::size_t(row) * node_stride);
        NodalSmoothing::scatter_row(shape.row(row), moved, trace_force.data());
        double *const remaining = trace_force.node(shape.particle_node[row]);
        store_node(load_node(remaining) - moved, remaining);
      }
    trace_force.add_to_owners();
    const unsigned int n_owned = force.partition()->n_owned();
    for (unsigned int i = 0; i < n_owned; ++i)
      store_node(load_node(force.node(i)) + load_node(element_force.node(i)) +
                     load_node(trace_force.node(i)),
                 force.node(i));
  }
} // namespace tombolo
