// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_segments.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tombolo
{
  namespace
  {
    /** The slot of a nodal vector behind the components of a normal. */
    constexpr unsigned int slot_of_depth = node_stride - 1;
  } // namespace

  template <int dim>
  MortarSegments<dim>::MortarSegments(const ContactFaces<dim> &slaves,
                                      const ContactFaces<dim> &masters, const Pairing<dim> &pairing,
                                      const MPI_Comm communicator)
      : slaves(slaves), masters(masters), pairing(pairing), communicator(communicator),
        exchange(communicator)
  {
    double thinnest = std::numeric_limits<double>::max();
    for (const ContactFaces<dim> *const side : {&slaves, &masters})
      for (const auto &face : side->faces())
        thinnest = std::min(thinnest, face.thickness);
    margin = Utilities::MPI::min(thinnest, communicator);
  }

  template <int dim>
  void MortarSegments<dim>::set_partition(const std::shared_ptr<const NodePartition> &partition)
  {
    for (NodalVector *const sum : {&at_slaves.gap, &at_slaves.motion, &at_slaves.normal})
      sum->reinit(partition);
    at_slaves.scalars.reinit(partition, Quantity::scalars);
    if (sums_effusivity)
      at_slaves.effusivity.reinit(partition, Quantity::scalars);
    position_of_pairs.reinit(partition, Quantity::position);
    nodes.clear();
    for (const ContactFaces<dim> *const side : {&slaves, &masters})
      for (const auto &face : side->faces())
        nodes.insert(nodes.end(), face.nodes.begin(), face.nodes.end());
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    has_pairs = has_pairs && pairing.is_tied();
  }

  template <int dim>
  void MortarSegments<dim>::receive_values(const NodalVector &position,
                                           const NodalVector &last_position,
                                           const NodalVector *const thermal)
  {
    const unsigned int n_thermal = thermal == nullptr ? 0 : sums_effusivity ? 3 : 2;
    n_values = 2 * dim + n_thermal;
    sent_values.clear();
    for (const unsigned int f : exchange.sent_faces())
      for (const unsigned int node : masters.faces()[f].nodes)
      {
        sent_values.insert(sent_values.end(), position.node(node), position.node(node) + dim);
        for (unsigned int d = 0; d < dim; ++d)
          sent_values.push_back(position.node(node)[d] - last_position.node(node)[d]);
        if (thermal != nullptr)
          sent_values.insert(sent_values.end(),
                             {thermal->node(node)[temperature], thermal->node(node)[of_master]});
        if (n_thermal == 3)
          sent_values.push_back(thermal->node(node)[effusivity]);
      }
    exchange.send(n_corners * n_values, sent_values, values);
  }

  template <int dim>
  PairedFace<dim> MortarSegments<dim>::slave_face(const unsigned int number,
                                                  const NodalVector &position) const
  {
    const auto &face = slaves.faces()[number];
    const FaceCorners<dim> corners = slaves.corners(face, position);
    return {number, face.thickness, corners, face.orientation * area_vector<dim>(corners)};
  }

  template <int dim>
  PairedFace<dim> MortarSegments<dim>::master_face(const unsigned int number,
                                                   const std::vector<double> &of_corners,
                                                   const unsigned int n_of_corner) const
  {
    const auto &face = exchange.masters()[number];
    PairedFace<dim> result{number, face.thickness, {}, {}};
    for (unsigned int k = 0; k < n_corners; ++k)
      result.corners[k] =
          vector_of<dim>(of_corners.data() + (number * n_corners + k) * n_of_corner);
    result.area = face.orientation * area_vector<dim>(result.corners);
    return result;
  }

  template <int dim>
  void MortarSegments<dim>::find_segments(const NodalVector &position)
  {
    segments.clear();
    std::vector<PairedFace<dim>> near;
    const auto &pairs = exchange.pairs();
    for (auto pair = pairs.begin(); pair != pairs.end();)
    {
      const unsigned int slave = pair->slave;
      for (near.clear(); pair != pairs.end() && pair->slave == slave; ++pair)
        near.push_back(master_face(pair->master, values, n_values));
      pairing.find(slave_face(slave, position), near, segments);
    }
  }

  template <int dim>
  void MortarSegments<dim>::add_segment(const Segment &segment, const NodalVector &position,
                                        const NodalVector &last_position,
                                        const NodalVector *const thermal)
  {
    const auto &face = slaves.faces()[segment.slave];
    const FaceCorners<dim> corners = slaves.corners(face, position);
    const double *const master = values.data() + segment.master * n_corners * n_values;
    for (unsigned int i = 0; i < n_corners; ++i)
    {
      Tensor<1, dim> gap, motion;
      std::array<double, node_stride> scalars{};
      double effusivities[2] = {};
      for (unsigned int j = 0; j < n_corners; ++j)
      {
        const double of_slave = segment.of_slave[i][j], of_master = segment.of_master[i][j];
        const unsigned int node = face.nodes[j];
        const double *const at_master = master + j * n_values;
        // Differences to a place near by: both sums of weights are equal only to round-off.
        gap += of_master * (vector_of<dim>(at_master) - corners[0]) -
               of_slave * (corners[j] - corners[0]);
        motion += of_slave * (corners[j] - vector_of<dim>(last_position.node(node))) -
                  of_master * vector_of<dim>(at_master + dim);
        scalars[area] += of_slave;
        if (thermal == nullptr)
          continue;
        const double theta = thermal->node(node)[temperature], of_other = at_master[2 * dim];
        scalars[temperature_difference] += of_master * of_other - of_slave * theta;
        scalars[mean_temperature] += 0.5 * (of_master * of_other + of_slave * theta);
        scalars[inverse_capacity] += of_slave * thermal->node(node)[MortarSegments::of_slave] +
                                     of_master * at_master[2 * dim + 1];
        if (!sums_effusivity)
          continue;
        effusivities[0] += of_slave * thermal->node(node)[effusivity];
        effusivities[1] += of_master * at_master[2 * dim + 2];
      }
      const unsigned int node = face.nodes[i];
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double normal = segment.normals[i][d];
        at_slaves.gap.node(node)[d] += gap[d] - pairing.radius() * scalars[area] * normal;
        at_slaves.motion.node(node)[d] += motion[d];
        at_slaves.normal.node(node)[d] += scalars[area] * normal;
      }
      for (unsigned int s = 0; s < node_stride; ++s)
        at_slaves.scalars.node(node)[s] += scalars[s];
      for (unsigned int side = 0; side < 2 && sums_effusivity; ++side)
        at_slaves.effusivity.node(node)[side] += effusivities[side];
    }
  }

  template <int dim>
  void MortarSegments<dim>::gather(const NodalVector &position, const NodalVector &last_position,
                                   const NodalVector *const thermal)
  {
    const bool are_kept = has_pairs && pairing.is_tied();
    if (!are_kept && (!has_pairs || has_moved(position)))
      find_pairs(position);
    receive_values(position, last_position, thermal);
    if (!are_kept)
      find_segments(position);
    else
      for (Segment &segment : segments)
      {
        Tensor<1, dim> normal = slave_face(segment.slave, position).area;
        normal /= normal.norm();
        segment.set_normal(normal);
      }
    std::vector<NodalVector *> sums = {&at_slaves.gap, &at_slaves.motion, &at_slaves.normal,
                                       &at_slaves.scalars};
    if (sums_effusivity)
      sums.push_back(&at_slaves.effusivity);
    for (NodalVector *const sum : sums)
      for (const unsigned int node : slaves.owned_nodes())
        std::fill_n(sum->node(node), node_stride, 0.);
    for (const Segment &segment : segments)
      add_segment(segment, position, last_position, thermal);
    for (NodalVector *const sum : sums)
      sum->add_to_owners();
  }

  template <int dim>
  void MortarSegments<dim>::scatter(const NodalVector &traction, const NodalVector *const heat_flow,
                                    NodalVector &loads, NodalVector *const heat)
  {
    const unsigned int n_sums = heat_flow != nullptr ? dim + 1 : dim;
    values.assign(exchange.masters().size() * n_corners * n_sums, 0.);
    for (const Segment &segment : segments)
    {
      const auto &face = slaves.faces()[segment.slave];
      double *const at_master = values.data() + segment.master * n_corners * n_sums;
      for (unsigned int i = 0; i < n_corners; ++i)
      {
        const double *const t = traction.node(face.nodes[i]);
        const double conducted = heat_flow != nullptr ? heat_flow->node(face.nodes[i])[0] : 0.;
        const double friction = heat_flow != nullptr ? heat_flow->node(face.nodes[i])[1] : 0.;
        const double heat_fraction = heat_flow != nullptr ? heat_flow->node(face.nodes[i])[2] : 0.;
        for (unsigned int j = 0; j < n_corners; ++j)
        {
          for (unsigned int d = 0; d < dim; ++d)
          {
            loads.node(face.nodes[j])[d] += segment.of_slave[i][j] * t[d];
            at_master[j * n_sums + d] -= segment.of_master[i][j] * t[d];
          }
          if (heat_flow == nullptr)
            continue;
          *heat->node(face.nodes[j]) +=
              segment.of_slave[i][j] * (conducted + heat_fraction * friction);
          at_master[j * n_sums + dim] +=
              segment.of_master[i][j] * ((1. - heat_fraction) * friction - conducted);
        }
      }
    }
    exchange.send_back(n_corners * n_sums, values, returned);
    const double *value = returned.data();
    for (const unsigned int f : exchange.sent_faces())
      for (const unsigned int node : masters.faces()[f].nodes)
      {
        for (unsigned int d = 0; d < dim; ++d)
          loads.node(node)[d] += *value++;
        if (heat_flow != nullptr)
          *heat->node(node) += *value++;
      }
  }

  template <int dim>
  void MortarSegments<dim>::add_weights(const NodalVector &normal, ContactRows<dim> &rows) const
  {
    for (const Segment &segment : segments)
    {
      const auto &slave = slaves.faces()[segment.slave];
      const auto &master = exchange.masters()[segment.master];
      for (unsigned int i = 0; i < n_corners; ++i)
      {
        const auto n = vector_of<dim>(normal.node(slave.nodes[i]));
        for (unsigned int j = 0; j < n_corners; ++j)
        {
          const double of_slave = segment.of_slave[i][j], of_master = -segment.of_master[i][j];
          rows.add(slave.global_nodes[i], slave.global_nodes[j], of_slave * n, of_slave);
          rows.add(slave.global_nodes[i], master.nodes[j], of_master * n, of_master);
        }
      }
    }
  }

  template <int dim>
  void MortarSegments<dim>::add_changes_of_weights(const NodalVector &position,
                                                   const NodalVector &pressed,
                                                   ContactRows<dim> &rows) const
  {
    constexpr double relative_step = 1e-6; // of the size of the slave face
    std::vector<double> sent, received;
    std::vector<Segment> moved;
    for (const unsigned int f : exchange.sent_faces())
      for (const unsigned int node : masters.faces()[f].nodes)
        sent.insert(sent.end(), position.node(node), position.node(node) + dim);
    exchange.send(n_corners * dim, sent, received);
    for (const Segment &segment : segments)
    {
      const auto &face = slaves.faces()[segment.slave];
      const auto &of_master = exchange.masters()[segment.master];
      std::array<Tensor<1, dim>, n_corners> normals;
      std::array<double, n_corners> depths;
      bool is_pressed = false;
      for (unsigned int i = 0; i < n_corners; ++i)
      {
        normals[i] = vector_of<dim>(pressed.node(face.nodes[i]));
        depths[i] = pressed.node(face.nodes[i])[slot_of_depth] - pairing.radius();
        is_pressed = is_pressed || normals[i].norm_square() > 0.;
      }
      if (!is_pressed)
        continue;
      // About a corner: far from the origin the quotients would lose digits.
      PairedFace<dim> slave = slave_face(segment.slave, position);
      std::vector<PairedFace<dim>> master{master_face(segment.master, received, dim)};
      const std::array<PairedFace<dim> *, 2> sides{{&slave, master.data()}};
      const Tensor<1, dim> place = slave.corners[0];
      for (PairedFace<dim> *const side : sides)
        for (Tensor<1, dim> &corner : side->corners)
          corner -= place;
      const double step = relative_step * std::pow(slave.area.norm(), 1. / (dim - 1));
      const auto integrals = [&]
      {
        slave.area = face.orientation * area_vector<dim>(slave.corners);
        master[0].area = of_master.orientation * area_vector<dim>(master[0].corners);
        moved.clear();
        pairing.find(slave, master, moved);
        std::array<double, n_corners> result{};
        for (const Segment &pair : moved)
          for (unsigned int i = 0; i < n_corners; ++i)
            for (unsigned int j = 0; j < n_corners; ++j)
              result[i] += pair.of_master[i][j] * (master[0].corners[j] * normals[i]) -
                           pair.of_slave[i][j] * (slave.corners[j] * normals[i] + depths[i]);
        return result;
      };
      for (const unsigned int side : {0u, 1u})
        for (unsigned int k = 0; k < n_corners; ++k)
        {
          std::array<Tensor<1, dim>, n_corners> shifts;
          for (unsigned int d = 0; d < dim; ++d)
          {
            double &coordinate = sides[side]->corners[k][d];
            const double middle = coordinate;
            coordinate = middle + step;
            const auto after = integrals();
            coordinate = middle - step;
            const auto before = integrals();
            coordinate = middle;
            for (unsigned int i = 0; i < n_corners; ++i)
              shifts[i][d] = -(after[i] - before[i]) / (2. * step);
          }
          for (unsigned int i = 0; i < n_corners; ++i)
          {
            const double weight = side == 0 ? segment.of_slave[i][k] : -segment.of_master[i][k];
            rows.add(face.global_nodes[i], side == 0 ? face.global_nodes[k] : of_master.nodes[k],
                     {}, 0., shifts[i] - weight * normals[i]);
          }
        }
    }
  }

  template class MortarSegments<2>;
  template class MortarSegments<3>;
} // namespace tombolo
