// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/position_response.h>

#include <tombolo/approximation/nodal_smoothing.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    /** Sets prescribed components of these nodes to zero. */
    void clear_prescribed(const std::vector<std::uint8_t> &constrained, const ObliqueNodes &oblique,
                          const std::vector<unsigned int> &nodes, NodalVector &vector)
    {
      if (!oblique.all().empty())
        for (const unsigned int i : nodes)
          if (const ObliqueNode *const frame = oblique.find(i))
            frame->remove_prescribed(vector.node(i));
      for (const unsigned int i : nodes)
        for (unsigned int d = 0; i < constrained.size() && constrained[i] != 0 && d < 3; ++d)
          if ((constrained[i] >> d) & 1u)
            vector.node(i)[d] = 0.;
    }

    void clear(const std::vector<unsigned int> &nodes, NodalVector &vector)
    {
      for (const unsigned int node : nodes)
        store_node(NodeLanes(0.), vector.node(node));
    }
  } // namespace

  void PositionResponse::begin_step(const std::shared_ptr<const NodePartition> &partition)
  {
    for (NodalVector *const vector : {&force, &field, &rate})
      vector->fit_to(partition);
    mark.fit_to(partition, Quantity::scalar);
  }

  void PositionResponse::predict(const NodalState &state, const Clock &clock,
                                 const std::vector<unsigned int> &nodes, NodalVector &predicted)
  {
    const double velocity_step = clock.velocity_step();
    if (is_global())
    {
      const ConstrainedParticles &constrained = bridge.get_constrained_particles();
      bridge.apply_adjoint(state.acceleration, rate);
      constrained.set_prescribed(state.acceleration, rate);
      bridge.apply_smoothing(rate, field);
      constrained.set_prescribed(state.acceleration, field);
      for (const unsigned int node : nodes)
        store_node(load_node(state.velocity.node(node)) +
                       load_node(field.node(node)) * velocity_step,
                   predicted.node(node));
    }
    else
    {
      for (unsigned int i = 0; i < field.partition()->n_local(); ++i)
        store_node(load_node(state.velocity.node(i)) +
                       load_node(state.acceleration.node(i)) * velocity_step,
                   field.node(i));
      bridge.load_transfer().interpolate(nodes, field, predicted);
    }
    for (const unsigned int node : nodes)
      store_node(load_node(state.position.node(node)) +
                     load_node(predicted.node(node)) * clock.next_step,
                 predicted.node(node));
  }

  void PositionResponse::set_nodes(const std::vector<unsigned int> &nodes)
  {
    nodes_of_forces = nodes;
    const MassSplit &split = bridge.mass_split();
    mark.set_zero();
    for (const unsigned int node : nodes)
      *mark.node(node) = 1.;
    own.clear();
    for (std::size_t k = 0; k < split.own_nodes.size(); ++k)
      if (*mark.node(split.own_nodes[k]) != 0.)
        own.push_back(k);
    mark.update_ghosts();
    std::vector<unsigned int> reached;
    rows.assign(split.parts.size(), {});
    for (std::size_t p = 0; p < split.parts.size(); ++p)
      for (unsigned int row = 0;
           split.parts[p].is_smoothed && row < split.parts[p].shape->n_particles(); ++row)
      {
        const Stencils::Row stencil = split.parts[p].shape->row(row);
        const unsigned int *const end = stencil.neighbour + stencil.size;
        if (std::none_of(stencil.neighbour, end,
                         [&](const unsigned int node) { return *mark.node(node) != 0.; }))
          continue;
        rows[p].push_back(row);
        reached.push_back(split.parts[p].shape->particle_node[row]);
        reached.insert(reached.end(), stencil.neighbour, end);
      }
    find_touched_nodes(reached);
  }

  void PositionResponse::find_touched_nodes(const std::vector<unsigned int> &reached)
  {
    for (const unsigned int node : reached)
      *mark.node(node) = 1.;
    mark.add_to_owners(); // what other ranks reach
    mark.update_ghosts();
    touched = positive_nodes(mark, mark.partition()->n_local());
    touched_owned.assign(touched.begin(), std::lower_bound(touched.begin(), touched.end(),
                                                           mark.partition()->n_owned()));
    keep_nodes();
  }

  void PositionResponse::divide_by_mass(const std::vector<std::uint8_t> &constrained,
                                        const ObliqueNodes &oblique)
  {
    const NodalVector &mass = bridge.mass_split().row_sums();
    for (const unsigned int i : touched_owned)
      store_node(load_node(force.node(i)) / load_node(mass.node(i)), field.node(i));
    clear_prescribed(constrained, oblique, touched_owned, field);
    field.update_ghosts();
  }

  void PositionResponse::respond(const NodalVector &loads,
                                 const std::vector<std::uint8_t> &constrained,
                                 NodalVector &response, const ObliqueNodes &oblique)
  {
    clear(touched, force);
    bridge.load_transfer().add_force_at_positions(nodes_of_forces, loads, force);
    force.add_to_owners();
    divide_by_mass(constrained, oblique);
    if (is_global())
      respond_affine(constrained, oblique, response);
    else
      bridge.load_transfer().interpolate(nodes_of_forces, field, response);
  }

  void PositionResponse::respond_affine(const std::vector<std::uint8_t> &constrained,
                                        const ObliqueNodes &oblique, NodalVector &response)
  {
    const MassSplit &split = bridge.mass_split();
    const auto add_own = [&](const NodalVector &from, NodalVector &to)
    {
      for (const std::size_t k : own)
        add_to_node(split.own_mass_of(k) * load_node(from.node(split.own_nodes[k])),
                    to.node(split.own_nodes[k]));
    };
    clear(touched, rate);
    add_own(field, rate);
    for (std::size_t p = 0; p < split.parts.size(); ++p)
      NodalSmoothing::gather_affine(*split.parts[p].shape, split.parts[p].smoothed_mass.data(),
                                    field.data(), rate.data(), &rows[p]);
    rate.add_to_owners();
    for (const unsigned int i : touched_owned)
    {
      const double mass = *split.unsmoothed_mass().node(i);
      store_node(load_node(rate.node(i)) / (mass > 0. ? mass : 1.), rate.node(i));
    }
    clear_prescribed(constrained, oblique, touched_owned, rate);
    rate.update_ghosts();
    clear(touched, force);
    add_own(rate, force);
    for (std::size_t p = 0; p < split.parts.size(); ++p)
      NodalSmoothing::scatter_affine(*split.parts[p].shape, split.parts[p].smoothed_mass.data(),
                                     rate.data(), force.data(), &rows[p]);
    force.add_to_owners();
    for (const unsigned int node : nodes_of_forces)
      store_node(load_node(force.node(node)) / load_node(split.row_sums().node(node)),
                 response.node(node));
  }
} // namespace tombolo
