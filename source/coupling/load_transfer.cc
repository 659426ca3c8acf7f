// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/load_transfer.h>

#include <tombolo/approximation/nodal_smoothing.h>

namespace tombolo
{
  const NodalVector &TraceTransfer::field_of_particles(const NodalVector &velocity)
  {
    trace_velocity.fit_to(velocity.partition(), velocity.quantity());
    trace_velocity.copy_from(velocity);
    for (const MassSplit::ParticlePart &part : split.parts)
      for (const unsigned int row : part.element_rows)
      {
        const Stencils &shape = *part.shape;
        const NodeLanes sum = NodalSmoothing::gather_row(shape.row_of_values(row), velocity.data());
        // A prescribed component keeps its own value.
        add_to_node(part.fraction_of_row(row) *
                        (sum - load_node(velocity.node(shape.particle_node[row]))),
                    trace_velocity.node(shape.particle_node[row]));
      }
    trace_velocity.distribute();
    return trace_velocity;
  }

  void TraceTransfer::add_element_force(NodalVector &element_force, NodalVector &force)
  {
    element_force.collect();
    trace_force.fit_to(force.partition(), force.quantity());
    trace_force.set_zero();
    for (const MassSplit::ParticlePart &part : split.parts)
      for (const unsigned int row : part.element_rows)
      {
        const Stencils &shape = *part.shape;
        const NodeLanes moved =
            load_node(element_force.node(shape.particle_node[row])) * part.fraction_of_row(row);
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
      if (shape.is_lumped)
        add_to_node(load, force.node(shape.particle_node[row]));
      else
        NodalSmoothing::scatter_row(shape.row_of_values(row), load, force.data());
    }
  } // namespace

  void LoadTransfer::interpolate(const NodalVector &field, NodalVector &result) const
  {
    split.set_own_fraction(field, result);
    for (const MassSplit::ParticlePart &part : split.parts)
      for (unsigned int row = 0; part.is_smoothed && row < part.shape->n_particles(); ++row)
        add_to_node(field_at_row(*part.shape, row, field) * part.fraction_of_row(row),
                    result.node(part.shape->particle_node[row]));
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
    if (!direct)
      return add_force_of_loads(nodes, loads, force);
    for (const unsigned int node : nodes)
      add_to_node(load_node(loads.node(node)), force.node(node));
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
        add_to_node(load * split.own_fraction_of(k), force.node(node));
      for (std::size_t p = 0; p < split.parts.size(); ++p)
        if (const unsigned int row = row_of_node[p][node]; row != is_nowhere)
          spread(*split.parts[p].shape, row, load * split.parts[p].fraction_of_row(row), force);
    }
  }

  void LoadTransfer::interpolate(const std::vector<unsigned int> &nodes, const NodalVector &field,
                                 NodalVector &result)
  {
    if (!direct)
      return interpolate_rows(nodes, field, result);
    for (const unsigned int node : nodes)
      store_node(load_node(field.node(node)), result.node(node));
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
        sum = load_node(field.node(node)) * split.own_fraction_of(k);
      for (std::size_t p = 0; p < split.parts.size(); ++p)
        if (const unsigned int row = row_of_node[p][node]; row != is_nowhere)
          sum +=
              field_at_row(*split.parts[p].shape, row, field) * split.parts[p].fraction_of_row(row);
      store_node(sum, result.node(node));
    }
  }
} // namespace tombolo
