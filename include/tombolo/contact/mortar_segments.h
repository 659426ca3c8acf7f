// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_faces.h>
#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/contact/pairing.h>
#include <tombolo/contact/surfaces/facet_list.h>
#include <tombolo/state/nodal_vector.h>

#include <mpi.h>

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

    /** Slots of what nodes have of heat: the temperature, and 1/γ, the area over the capacity, as
     * nodes of slave and of master. */
    enum Thermal : unsigned int
    {
      temperature,
      of_slave,
      of_master,
      effusivity
    };

    /** What is referred to must outlive this. */
    MortarSegments(const ContactFaces<dim> &slaves, const ContactFaces<dim> &masters,
                   const Pairing<dim> &pairing, MPI_Comm communicator);

    /** Finds the sums of effusivities as well. Before set_partition(). */
    void split_by_effusivity()
    {
      sums_effusivity = true;
    }

    /** Translates node numbers to those of @p partition; the faces have it. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);

    /** Finds sums() with the segments in these positions, or those of the first call where the
     * pairing is tied, and the motion since @p last_position. All arguments have current ghosts;
     * @p thermal is null without heat. Collective. */
    void gather(const NodalVector &position, const NodalVector &last_position,
                const NodalVector *thermal);

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

    /** Adds the forces Σ_I w^s_IJ t_I on slave nodes and -Σ_I w^m_IL t_I on master nodes to @p
     * loads, for the @p traction t per area at slave nodes, with current ghosts; ghosts of the
     * results are not collected. With @p heat_flow, whose slots are what a slave node gets of
     * conduction, what friction heats, both per area, and the share of the latter that the slave
     * gets, adds what both sides get to @p heat (scalar). Collective. */
    void scatter(const NodalVector &traction, const NodalVector *heat_flow, NodalVector &loads,
                 NodalVector *heat);

    /** Adds the weights w^s_IJ and -w^m_IL of the segments to the rows of slave nodes I, with the
     * @p normal of each slave node for the normal part; its ghosts are current. */
    void add_weights(const NodalVector &normal, ContactRows<dim> &rows) const;

    /** Adds to the same rows how the integral of the depth changes with the weights, by difference
     * quotients of the segments in these positions. @p pressed has normal and depth (the last slot)
     * of slave nodes, zero where nothing is pressed; its ghosts are current. Collective. */
    void add_changes_of_weights(const NodalVector &position, const NodalVector &pressed,
                                ContactRows<dim> &rows) const;

    /** Pairs of faces that were looked at in the last step, and of which a part is common, on this
     * rank. */
    std::size_t n_pairs() const
    {
      return exchange.pairs().size();
    }

  private:
    static constexpr unsigned int n_corners = ContactFaces<dim>::n_corners;
    using Segment = FacePair<dim>;

    struct Box
    {
      /** Around the corners, @p by wider on all sides. */
      Box(const FaceCorners<dim> &corners, const double by) : low(corners[0]), high(corners[0])
      {
        for (const dealii::Tensor<1, dim> &corner : corners)
          widen_box(low, high, corner);
        for (unsigned int d = 0; d < dim; ++d)
        {
          low[d] -= by;
          high[d] += by;
        }
      }
      bool meets(const Box &other) const
      {
        for (unsigned int d = 0; d < dim; ++d)
          if (low[d] > other.high[d] || other.low[d] > high[d])
            return false;
        return true;
      }

      dealii::Tensor<1, dim> low, high;
    };

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
    void find_pairs(const NodalVector &position)
    {
      exchange.find_pairs(slaves, masters, position, pairing.reach(), margin + pairing.radius());
      position_of_pairs.copy_from(position);
      has_pairs = true;
    }

    /** Values of corners of master faces: x, x - @p last_position, and of @p thermal. */
    void receive_values(const NodalVector &position, const NodalVector &last_position,
                        const NodalVector *thermal);
    void find_segments(const NodalVector &position);
    PairedFace<dim> slave_face(unsigned int number, const NodalVector &position) const;
    /** With @p n_of_corner values for each corner of a master, the first of which are positions. */
    PairedFace<dim> master_face(unsigned int number, const std::vector<double> &of_corners,
                                unsigned int n_of_corner) const;
    void add_segment(const Segment &segment, const NodalVector &position,
                     const NodalVector &last_position, const NodalVector *thermal);
    /** The part of corner @p i of the slave in the sums of heat. */
    void add_thermal(const Segment &segment, unsigned int i, const NodalVector &thermal);

    const ContactFaces<dim> &slaves, &masters;
    const Pairing<dim> &pairing;
    double margin;
    MPI_Comm communicator;
    FaceExchange<dim> exchange;
    std::vector<PairedFace<dim>> master_faces, near; // of the exchange, in this step
    std::vector<Box> master_boxes;
    std::vector<Segment> segments;
    Sums at_slaves;
    NodalVector position_of_pairs;   ///< where nodes were when the pairs were found
    std::vector<unsigned int> nodes; ///< local ones on any face, ascending
    unsigned int n_values = 0;       ///< of a corner of a master
    std::vector<double> sent_values, values, returned; // buffers
    bool has_pairs = false, sums_effusivity = false;
  };
} // namespace tombolo
