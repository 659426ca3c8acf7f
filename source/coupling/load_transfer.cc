// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/load_transfer.h>

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
  LoadTransfer::LoadTransfer(const MassSplit &split, const bool direct)
      : split(split), direct(direct)
  {}

  namespace
  {
    /** Where a load at particle @p row acts, of the field @p position. */
    NodeLanes place_of_row(const Stencils &shape, const unsigned int row,
                           const NodalVector &position)
    {
      return shape.is_lumped ? load_node(position.node(shape.particle_node[row]))
                             : NodalSmoothing::gather_row(shape.row(row), position.data());
    }

    /** Adds the force of @p load at particle @p row. */
    void spread(const Stencils &shape, const unsigned int row, const NodeLanes &load,
                NodalVector &force)
    {
      if (!shape.is_lumped)
      {
        NodalSmoothing::scatter_row(shape.row(row), load, force.data());
        return;
      }
      double *const target = force.node(shape.particle_node[row]);
      store_node(load_node(target) + load, target);
    }
  } // namespace

  bool LoadTransfer::acts_at_nodes() const
  {
    return split.has_lumped_rows;
  }

  void LoadTransfer::forget_rows()
  {
    position_in_own.clear();
  }

  void LoadTransfer::set_loaded_nodes(const std::vector<unsigned int> &nodes)
  {
    std::vector<bool> is_loaded(split.total_mass.partition()->n_owned(), false);
    for (const unsigned int node : nodes)
      is_loaded[node] = true;
    loaded_own.clear();
    for (std::size_t k = 0; k < split.own_nodes.size(); ++k)
      if (is_loaded[split.own_nodes[k]])
        loaded_own.push_back(k);
    loaded_rows.assign(split.parts.size(), {});
    for (std::size_t p = 0; p < split.parts.size(); ++p)
      for (unsigned int row = 0;
           split.parts[p].is_smoothed && row < split.parts[p].shape->n_particles(); ++row)
        if (is_loaded[split.parts[p].shape->particle_node[row]])
          loaded_rows[p].push_back(row);
    find_touched_nodes();
  }

  void LoadTransfer::find_touched_nodes()
  {
    const auto &partition = split.total_mass.partition();
    std::vector<bool> is_touched(partition->n_local(), false);
    for (const std::size_t k : loaded_own)
      is_touched[split.own_nodes[k]] = true;
    for (std::size_t p = 0; p < split.parts.size(); ++p)
      for (const unsigned int row : loaded_rows[p])
      {
        const Stencils &shape = *split.parts[p].shape;
        is_touched[shape.particle_node[row]] = true;
        const Stencils::Row of_row = shape.row(row);
        for (unsigned int k = 0; !shape.is_lumped && k < of_row.size; ++k)
          is_touched[of_row.neighbour[k]] = true;
      }
    NodalVector mark;
    mark.reinit(partition, Quantity::scalar);
    for (unsigned int i = 0; i < partition->n_local(); ++i)
      *mark.node(i) = is_touched[i] ? 1. : 0.;
    mark.add_to_owners();
    touched.clear();
    for (unsigned int i = 0; i < partition->n_local(); ++i)
      if (is_touched[i] || (i < partition->n_owned() && *mark.node(i) > 0.))
        touched.push_back(i);
  }

  void LoadTransfer::places_of_loads(const NodalVector &position, NodalVector &result) const
  {
    result.copy_from(position);
    for (std::size_t p = 0; p < split.parts.size(); ++p)
      for (const unsigned int row : loaded_rows[p])
        store_node(NodeLanes(0.), result.node(split.parts[p].shape->particle_node[row]));
    for (const std::size_t k : loaded_own)
      store_node(load_node(split.own_fraction.data() + k * node_stride) *
                     load_node(position.node(split.own_nodes[k])),
                 result.node(split.own_nodes[k]));
    for (std::size_t p = 0; p < split.parts.size(); ++p)
      for (const unsigned int row : loaded_rows[p])
      {
        const Stencils &shape = *split.parts[p].shape;
        const NodeLanes place = place_of_row(shape, row, position);
        double *const node = result.node(shape.particle_node[row]);
        store_node(load_node(node) + place * load_node(split.parts[p].smoothed_fraction.data() +
                                                       std::size_t(row) * node_stride),
                   node);
      }
    result.distribute();
  }

  void LoadTransfer::force_of_loads(const NodalVector &loads, NodalVector &force) const
  {
    for (const unsigned int node : touched)
      store_node(NodeLanes(0.), force.node(node));
    for (const std::size_t k : loaded_own)
      store_node(load_node(split.own_fraction.data() + k * node_stride) *
                     load_node(loads.node(split.own_nodes[k])),
                 force.node(split.own_nodes[k]));
    for (std::size_t p = 0; p < split.parts.size(); ++p)
      for (const unsigned int row : loaded_rows[p])
      {
        const Stencils &shape = *split.parts[p].shape;
        const NodeLanes load =
            load_node(loads.node(shape.particle_node[row])) *
            load_node(split.parts[p].smoothed_fraction.data() + std::size_t(row) * node_stride);
        spread(shape, row, load, force);
      }
    force.add_to_owners();
  }

  void LoadTransfer::interpolate(const NodalVector &field, NodalVector &result) const
  {
    split.set_own_fraction(field, result);
    for (const MassSplit::ParticlePart &part : split.parts)
      for (unsigned int row = 0; part.is_smoothed && row < part.shape->n_particles(); ++row)
      {
        double *const target = result.node(part.shape->particle_node[row]);
        store_node(load_node(target) + place_of_row(*part.shape, row, field) *
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
              place_of_row(*split.parts[p].shape, row, field) *
              load_node(split.parts[p].smoothed_fraction.data() + std::size_t(row) * node_stride);
      store_node(sum, result.node(node));
    }
  }

  const std::vector<unsigned int> &LoadTransfer::touched_nodes() const
  {
    return touched;
  }
} // namespace tombolo
