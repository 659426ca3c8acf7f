// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/load_transfer.h>

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
  const NodalVector &TraceTransfer::field_of_particles(const NodalVector &velocity)
  {
    if (trace_velocity.partition() != velocity.partition())
      trace_velocity.reinit_like(velocity);
    trace_velocity.copy_from(velocity);
    for (const MassSplit::ParticlePart &part : split.parts)
      for (const unsigned int row : part.element_rows)
      {
        const Stencils &shape = *part.shape;
        const NodeLanes sum = NodalSmoothing::gather_row(shape.row_of_values(row), velocity.data());
        // A prescribed component keeps its own value.
        const NodeLanes weight =
            load_node(part.smoothed_fraction.data() + std::size_t(row) * node_stride);
        double *const target = trace_velocity.node(shape.particle_node[row]);
        store_node(load_node(target) +
                       weight * (sum - load_node(velocity.node(shape.particle_node[row]))),
                   target);
      }
    trace_velocity.distribute();
    return trace_velocity;
  }

  void TraceTransfer::add_element_force(NodalVector &element_force, NodalVector &force)
  {
    element_force.collect();
    if (trace_force.partition() != force.partition())
      trace_force.reinit_like(force);
    trace_force.set_zero();
    for (const MassSplit::ParticlePart &part : split.parts)
      for (const unsigned int row : part.element_rows)
      {
        const Stencils &shape = *part.shape;
        double *const own = element_force.node(shape.particle_node[row]);
        const NodeLanes moved = load_node(own) * load_node(part.smoothed_fraction.data() +
                                                           std::size_t(row) * node_stride);
        NodalSmoothing::scatter_row(shape.row_of_values(row), moved, trace_force.data());
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

  LoadTransfer::LoadTransfer(const MassSplit &split, const bool direct)
      : split(split), direct(direct)
  {}

  namespace
  {
    /** The @p field where a load at particle @p row acts. */
    NodeLanes field_at_row(const Stencils &shape, const unsigned int row, const NodalVector &field)
    {
      return shape.is_lumped ? load_node(field.node(shape.particle_node[row]))
                             : NodalSmoothing::gather_row(shape.row_of_values(row), field.data());
    }

    /** Adds the force of @p load at particle @p row. */
    void spread(const Stencils &shape, const unsigned int row, const NodeLanes &load,
                NodalVector &force)
    {
      if (!shape.is_lumped)
      {
        NodalSmoothing::scatter_row(shape.row_of_values(row), load, force.data());
        return;
      }
      double *const target = force.node(shape.particle_node[row]);
      store_node(load_node(target) + load, target);
    }
  } // namespace

  void LoadTransfer::interpolate(const NodalVector &field, NodalVector &result) const
  {
    split.set_own_fraction(field, result);
    for (const MassSplit::ParticlePart &part : split.parts)
      for (unsigned int row = 0; part.is_smoothed && row < part.shape->n_particles(); ++row)
      {
        double *const target = result.node(part.shape->particle_node[row]);
        store_node(load_node(target) + field_at_row(*part.shape, row, field) *
                                           load_node(part.smoothed_fraction.data() +
                                                     std::size_t(row) * node_stride),
                   target);
      }
    result.distribute();
  }

  void LoadTransfer::find_positions_in_lists()
  {
    const unsigned int n_owned = split.total_mass.partition()->n_owned();
    position_in_own.assign(n_owned, is_nowhere);
    for (std::size_t k = 0; k < split.own_nodes.size(); ++k)
      position_in_own[split.own_nodes[k]] = static_cast<unsigned int>(k);
    row_of_node.assign(split.parts.size(), std::vector<unsigned int>(n_owned, is_nowhere));
    for (std::size_t p = 0; p < split.parts.size(); ++p)
      for (unsigned int row = 0;
           split.parts[p].is_smoothed && row < split.parts[p].shape->n_particles(); ++row)
        row_of_node[p][split.parts[p].shape->particle_node[row]] = row;
  }

  void LoadTransfer::add_force_at_positions(const std::vector<unsigned int> &nodes,
                                            const NodalVector &loads, NodalVector &force)
  {
    if (direct)
    {
      for (const unsigned int node : nodes)
        store_node(load_node(force.node(node)) + load_node(loads.node(node)), force.node(node));
      return;
    }
    add_force_of_loads(nodes, loads, force);
  }

  void LoadTransfer::add_force_of_loads(const std::vector<unsigned int> &nodes,
                                        const NodalVector &loads, NodalVector &force)
  {
    if (position_in_own.empty())
      find_positions_in_lists();
    for (const unsigned int node : nodes)
    {
      const NodeLanes load = load_node(loads.node(node));
      if (const std::size_t k = position_in_own[node]; k != is_nowhere)
        store_node(load_node(force.node(node)) +
                       load * load_node(split.own_fraction.data() + k * node_stride),
                   force.node(node));
      for (std::size_t p = 0; p < split.parts.size(); ++p)
        if (const unsigned int row = row_of_node[p][node]; row != is_nowhere)
        {
          const NodeLanes share = load * load_node(split.parts[p].smoothed_fraction.data() +
                                                   std::size_t(row) * node_stride);
          spread(*split.parts[p].shape, row, share, force);
        }
    }
  }

  void LoadTransfer::interpolate(const std::vector<unsigned int> &nodes, const NodalVector &field,
                                 NodalVector &result)
  {
    if (direct)
    {
      for (const unsigned int node : nodes)
        store_node(load_node(field.node(node)), result.node(node));
      return;
    }
    interpolate_rows(nodes, field, result);
  }

  void LoadTransfer::interpolate_rows(const std::vector<unsigned int> &nodes,
                                      const NodalVector &field, NodalVector &result)
  {
    if (position_in_own.empty())
      find_positions_in_lists();
    for (const unsigned int node : nodes)
    {
      NodeLanes sum = 0.;
      if (const std::size_t k = position_in_own[node]; k != is_nowhere)
        sum = load_node(field.node(node)) * load_node(split.own_fraction.data() + k * node_stride);
      for (std::size_t p = 0; p < split.parts.size(); ++p)
        if (const unsigned int row = row_of_node[p][node]; row != is_nowhere)
          sum +=
              field_at_row(*split.parts[p].shape, row, field) *
              load_node(split.parts[p].smoothed_fraction.data() + std::size_t(row) * node_stride);
      store_node(sum, result.node(node));
    }
  }
} // namespace tombolo
