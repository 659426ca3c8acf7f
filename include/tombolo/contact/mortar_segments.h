// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/contact/contact_faces.h>
#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/contact/pairing.h>
#include <tombolo/contact/surfaces/facet_list.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/mpi.h>

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * Sums of a pairing of two surfaces: with the weights w^s_IJ, w^m_IL and the areas A_I of its
   * pairs of faces, gather() finds sums for slave nodes I, scatter() applies the transpose to
   * tractions, so that forces on both sides have the sum zero to round-off.
   */
  template <int dim>
  class MortarSegments
  {
  public:
    /** Sums at slave nodes, valid at owned ones after gather(). */
    struct Sums
    {
      NodalVector gap;     ///< Σ_L w^m_IL x_L - Σ_J w^s_IJ x_J [L^dim]
      NodalVector motion;  ///< Σ_J w^s_IJ Δx_J - Σ_L w^m_IL Δx_L over the last step [L^dim]
      NodalVector normal;  ///< ∫ N_I n dA, n out of the slave [L^(dim-1)]
      NodalVector scalars; ///< in the slots of Scalar
      /** Σ_J w^s_IJ e_J and Σ_L w^m_IL e_L of the effusivities; only where they split heat. */
      NodalVector effusivity;
    };
    enum Scalar : unsigned int
    {
      area,                   ///< A_I [L^(dim-1)]
      temperature_difference, ///< Σ_L w^m_IL θ_L - Σ_J w^s_IJ θ_J
      inverse_capacity,       ///< Σ_J w^s_IJ / γ_J + Σ_L w^m_IL / γ_L
      mean_temperature        ///< the mean of Σ_L w^m_IL θ_L and Σ_J w^s_IJ θ_J
    };

    /** Thermal slots of nodes: temperature, and 1/γ, area over heat capacity, on either side. */
    enum Thermal : unsigned int
    {
      temperature,
      slave_inverse_capacity,
      master_inverse_capacity,
      effusivity
    };

    /** What is referred to must outlive this. */
    MortarSegments(const ContactFaces<dim> &slaves, const ContactFaces<dim> &masters,
                   const Pairing<dim> &pairing, const bool sums_effusivity,
                   const MPI_Comm communicator)
        : slaves(slaves), masters(masters), pairing(pairing), communicator(communicator),
          exchange(communicator), sums_effusivity(sums_effusivity)
    {
      double thinnest = std::numeric_limits<double>::max();
      for (const ContactFaces<dim> *const side : {&slaves, &masters})
        for (const auto &face : side->faces())
          thinnest = std::min(thinnest, face.thickness);
      margin = dealii::Utilities::MPI::min(thinnest, communicator);
    }

    /** Translates node numbers to those of @p partition; the faces have it. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition)
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

    /** Finds sums() with the segments in these positions, or those of the first call where the
     * pairing is tied, and the motion since @p last_position. All arguments have current ghosts;
     * @p thermal is null without heat. Collective. */
    void gather(const NodalVector &position, const NodalVector &last_position,
                const NodalVector *const thermal)
    {
      const bool are_kept = has_pairs && pairing.is_tied();
      if (!are_kept && (!has_pairs || has_moved(position)))
      {
        exchange.find_pairs(slaves, masters, position, pairing.reach(), margin + pairing.radius());
        position_of_pairs.copy_from(position);
        has_pairs = true;
      }
      receive_values(position, last_position, thermal);
      if (!are_kept)
        find_segments(position);
      else
        for (Segment &segment : segments)
        {
          dealii::Tensor<1, dim> normal = slave_face(segment.slave, position).area;
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

    const Sums &sums() const
    {
      return at_slaves;
    }

    double area_of(const unsigned int node) const
    {
      return at_slaves.scalars.node(node)[area];
    }

    /** Whether a slave node has a master near, by sums(), and the normal out of it. */
    bool find_normal(const unsigned int node, dealii::Tensor<1, dim> &normal) const
    {
      normal = vector_of<dim>(at_slaves.normal.node(node));
      const double length = normal.norm();
      if (!(area_of(node) > 0. && length > 0.))
        return false;
      normal /= -length;
      return true;
    }

    /** Adds the forces Σ_I w^s_IJ t_I on slave nodes and -Σ_I w^m_IL t_I on master nodes to
     * @p loads, for the @p traction t per area at slave nodes, with current ghosts; ghosts of the
     * results are not collected. With @p heat_flow, whose slots are the heat of a slave node by
     * conduction, that of friction, both per area, and the share of the slave in the latter, adds
     * the heat of both sides to @p heat (scalar). Collective. */
    void scatter(const NodalVector &traction, const NodalVector *const heat_flow,
                 NodalVector &loads, NodalVector *const heat)
    {
      const unsigned int n_sums = heat_flow != nullptr ? dim + 1 : dim;
      values.assign(exchange.masters().size() * n_corners * n_sums, 0.);
      for (const Segment &segment : segments)
      {
        const auto &face = slaves.faces()[segment.slave];
        double *const at_master = values.data() + segment.master * n_corners * n_sums;
        NodeLanes corner_traction[n_corners];
        for (unsigned int i = 0; i < n_corners; ++i)
          corner_traction[i] = load_node(traction.node(face.nodes[i]));
        for (unsigned int j = 0; j < n_corners; ++j)
        {
          NodeLanes to_slave = 0., to_master = 0.;
          for (unsigned int i = 0; i < n_corners; ++i)
          {
            to_slave += segment.of_slave[i][j] * corner_traction[i];
            to_master += segment.of_master[i][j] * corner_traction[i];
          }
          double *const load = loads.node(face.nodes[j]);
          store_node(load_node(load) + to_slave, load);
          for (unsigned int d = 0; d < dim; ++d)
            at_master[j * n_sums + d] -= to_master[d];
          for (unsigned int i = 0; heat_flow != nullptr && i < n_corners; ++i)
          {
            const double *const flow = heat_flow->node(face.nodes[i]);
            *heat->node(face.nodes[j]) += segment.of_slave[i][j] * (flow[0] + flow[2] * flow[1]);
            at_master[j * n_sums + dim] +=
                segment.of_master[i][j] * ((1. - flow[2]) * flow[1] - flow[0]);
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

    /** Adds the weights w^s_IJ and -w^m_IL of the segments to the rows of slave nodes I, with the
     * @p normal of each slave node for the normal part; its ghosts are current. */
    void add_weights(const NodalVector &normal, ContactRows<dim> &rows) const
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
            const double slave_weight = segment.of_slave[i][j],
                         master_weight = -segment.of_master[i][j];
            rows.add(slave.global_nodes[i], slave.global_nodes[j], slave_weight * n, slave_weight);
            rows.add(slave.global_nodes[i], master.nodes[j], master_weight * n, master_weight);
          }
        }
      }
    }

    /** Adds to the same rows how the integral of the depth changes with the weights, by difference
     * quotients of the segments in these positions. @p pressed has normal and depth (the last slot)
     * of slave nodes, zero where nothing is pressed; its ghosts are current. Collective. */
    void add_changes_of_weights(const NodalVector &position, const NodalVector &pressed,
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
        const auto &master_face_data = exchange.masters()[segment.master];
        std::array<dealii::Tensor<1, dim>, n_corners> normals;
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
        const dealii::Tensor<1, dim> origin = slave.corners[0];
        for (PairedFace<dim> *const side : sides)
          for (dealii::Tensor<1, dim> &corner : side->corners)
            corner -= origin;
        const double step = relative_step * std::pow(slave.area.norm(), 1. / (dim - 1));
        const auto integrals = [&]
        {
          slave.area = face.orientation * area_vector<dim>(slave.corners);
          master[0].area = master_face_data.orientation * area_vector<dim>(master[0].corners);
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
            std::array<dealii::Tensor<1, dim>, n_corners> shifts;
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
              rows.add(face.global_nodes[i],
                       side == 0 ? face.global_nodes[k] : master_face_data.nodes[k], {}, 0.,
                       shifts[i] - weight * normals[i]);
            }
          }
      }
    }

  private:
    static constexpr unsigned int n_corners = ContactFaces<dim>::n_corners;
    using Segment = FacePair<dim>;

    /** The slot of a nodal vector behind the components of a normal. */
    static constexpr unsigned int slot_of_depth = node_stride - 1;

    /** Whether nodes have moved by more than half of the margin on any rank. Collective. */
    bool has_moved(const NodalVector &position) const
    {
      double farthest = 0;
      for (const unsigned int node : nodes)
        farthest = std::max(farthest, (vector_of<dim>(position.node(node)) -
                                       vector_of<dim>(position_of_pairs.node(node)))
                                          .norm_square());
      return dealii::Utilities::MPI::max(farthest, communicator) > 0.25 * margin * margin;
    }

    /** Values of corners of master faces: x, x - @p last_position, and of @p thermal. */
    void receive_values(const NodalVector &position, const NodalVector &last_position,
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
            sent_values.insert(sent_values.end(), {thermal->node(node)[temperature],
                                                   thermal->node(node)[master_inverse_capacity]});
          if (n_thermal == 3)
            sent_values.push_back(thermal->node(node)[effusivity]);
        }
      exchange.send(n_corners * n_values, sent_values, values);
    }

    void find_segments(const NodalVector &position)
    {
      segments.clear();
      master_faces.clear();
      master_boxes.clear();
      for (unsigned int m = 0; m < exchange.masters().size(); ++m)
      {
        master_faces.push_back(master_face(m, values, n_values));
        master_boxes.push_back(box_around<dim>(master_faces.back().corners, 0.));
      }
      const auto &pairs = exchange.pairs();
      for (auto pair = pairs.begin(); pair != pairs.end();)
      {
        const PairedFace<dim> slave = slave_face(pair->slave, position);
        const auto box =
            box_around<dim>(slave.corners, pairing.reach() * slave.thickness + pairing.radius());
        for (near.clear(); pair != pairs.end() && pair->slave == slave.number; ++pair)
          if (have_common_points(box, master_boxes[pair->master]))
            near.push_back(master_faces[pair->master]);
        if (!near.empty())
          pairing.find(slave, near, segments);
      }
    }

    PairedFace<dim> slave_face(const unsigned int number, const NodalVector &position) const
    {
      const auto &face = slaves.faces()[number];
      const FaceCorners<dim> corners = slaves.corners(face, position);
      return {number, face.thickness, corners, face.orientation * area_vector<dim>(corners)};
    }

    /** With @p n_corner_values values for each corner of a master, positions first. */
    PairedFace<dim> master_face(const unsigned int number, const std::vector<double> &corner_values,
                                const unsigned int n_corner_values) const
    {
      const auto &face = exchange.masters()[number];
      PairedFace<dim> result{number, face.thickness, {}, {}};
      for (unsigned int k = 0; k < n_corners; ++k)
        result.corners[k] =
            vector_of<dim>(corner_values.data() + (number * n_corners + k) * n_corner_values);
      result.area = face.orientation * area_vector<dim>(result.corners);
      return result;
    }

    void add_segment(const Segment &segment, const NodalVector &position,
                     const NodalVector &last_position, const NodalVector *const thermal)
    {
      const auto &face = slaves.faces()[segment.slave];
      const double *const master = values.data() + segment.master * n_corners * n_values;
      // Differences to a point near by: both sums of weights are equal only to round-off.
      const double *const origin = position.node(face.nodes[0]);
      NodeLanes offset[2][n_corners], motion[2][n_corners]; // of the slave, of the master
      for (unsigned int j = 0; j < n_corners; ++j)
      {
        alignas(32) double slave_values[2][node_stride] = {}, master_values[2][node_stride] = {};
        const double *const x = position.node(face.nodes[j]);
        const double *const last_x = last_position.node(face.nodes[j]);
        const double *const at_master = master + j * n_values;
        for (unsigned int d = 0; d < dim; ++d)
        {
          slave_values[0][d] = x[d] - origin[d];
          slave_values[1][d] = x[d] - last_x[d];
          master_values[0][d] = at_master[d] - origin[d];
          master_values[1][d] = at_master[dim + d];
        }
        offset[0][j] = load_node(slave_values[0]);
        motion[0][j] = load_node(slave_values[1]);
        offset[1][j] = load_node(master_values[0]);
        motion[1][j] = load_node(master_values[1]);
      }
      for (unsigned int i = 0; i < n_corners; ++i)
      {
        NodeLanes gap = 0., moved = 0.;
        double corner_area = 0;
        for (unsigned int j = 0; j < n_corners; ++j)
        {
          const double slave_weight = segment.of_slave[i][j],
                       master_weight = segment.of_master[i][j];
          gap += master_weight * offset[1][j] - slave_weight * offset[0][j];
          moved += slave_weight * motion[0][j] - master_weight * motion[1][j];
          corner_area += slave_weight;
        }
        const unsigned int node = face.nodes[i];
        const auto add = [&](NodalVector &sum, const NodeLanes &value)
        { store_node(load_node(sum.node(node)) + value, sum.node(node)); };
        alignas(32) double normal[node_stride] = {};
        for (unsigned int d = 0; d < dim; ++d)
          normal[d] = corner_area * segment.normals[i][d];
        const NodeLanes weighted_normal = load_node(normal);
        add(at_slaves.gap, gap - pairing.radius() * weighted_normal);
        add(at_slaves.motion, moved);
        add(at_slaves.normal, weighted_normal);
        at_slaves.scalars.node(node)[area] += corner_area;
        if (thermal != nullptr)
          add_thermal(segment, i, *thermal);
      }
    }

    /** The part of corner @p i of the slave in the sums of heat. */
    void add_thermal(const Segment &segment, const unsigned int i, const NodalVector &thermal)
    {
      const auto &face = slaves.faces()[segment.slave];
      const double *const master = values.data() + segment.master * n_corners * n_values;
      double *const scalars = at_slaves.scalars.node(face.nodes[i]);
      for (unsigned int j = 0; j < n_corners; ++j)
      {
        const double slave_weight = segment.of_slave[i][j], master_weight = segment.of_master[i][j];
        const double *const at_slave = thermal.node(face.nodes[j]);
        const double *const at_master = master + j * n_values + 2 * dim;
        const double theta = slave_weight * at_slave[temperature],
                     other = master_weight * at_master[0];
        scalars[temperature_difference] += other - theta;
        scalars[mean_temperature] += 0.5 * (other + theta);
        scalars[inverse_capacity] +=
            slave_weight * at_slave[MortarSegments::slave_inverse_capacity] +
            master_weight * at_master[1];
        if (!sums_effusivity)
          continue;
        at_slaves.effusivity.node(face.nodes[i])[0] += slave_weight * at_slave[effusivity];
        at_slaves.effusivity.node(face.nodes[i])[1] += master_weight * at_master[2];
      }
    }

    const ContactFaces<dim> &slaves, &masters;
    const Pairing<dim> &pairing;
    double margin;
    MPI_Comm communicator;
    FaceExchange<dim> exchange;
    std::vector<PairedFace<dim>> master_faces, near; // of the exchange, in this step
    std::vector<dealii::BoundingBox<dim>> master_boxes;
    std::vector<Segment> segments;
    Sums at_slaves;
    NodalVector position_of_pairs;   ///< where nodes were when the pairs were found
    std::vector<unsigned int> nodes; ///< local ones on any face, ascending
    unsigned int n_values = 0;       ///< of a corner of a master
    std::vector<double> sent_values, values, returned; // buffers
    bool has_pairs = false, sums_effusivity;
  };
} // namespace tombolo
