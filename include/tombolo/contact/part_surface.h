// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/outward_areas.h>
#include <tombolo/contact/part_layer.h>
#include <tombolo/contact/surfaces/facet_tree.h>
#include <tombolo/state/nodal_state.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  class Records;

  /** What a PartSurface is made of. */
  template <int dim>
  struct MasterPart
  {
    std::unique_ptr<PartLayer<dim>> layer; ///< null where the surface is not that of a part
    bool is_driven = false;                ///< whether no force changes its motion
  };

  /**
   * The boundary of a part of the scene as the surface of a contact: `Surface = part`. In each step
   * all ranks gather the positions of the nodes of its outermost cells. A node that touches is at a
   * place of the cell behind the facet next to it, with the shape functions N_a of that cell: Σ N_a
   * = 1 and Σ N_a x_a = x, also a little outside of the cell. So a reaction -N_a f of the nodes
   * keeps momentum and angular momentum to round-off, with friction too, and the motion of the
   * surface there, Σ N_a Δx_a, is zero relative to a node that turns with the part.
   *
   * Springs and exchanges of heat of several nodes i act on one node a of the part. They are weaker
   * by 1 + R_i,
   *
   *   R_i = max_a (Σ_j N_ja m_j) / m_a   over the nodes a of the cell of i,
   *
   * with the masses m_j of the nodes that touch (their heat capacities): then the springs of all of
   * them add at most α/Δt² to the square of any frequency. For one pair of nodes m_i / (1 + R_i) is
   * the reduced mass.
   *
   * The force of a spring has a potential where its gap depends on places continuously. So near a
   * convex edge a node of the mesh belongs to the sides that its own faces face, from the step in
   * which it gets behind them near by until it is in front of them again: its gap is that of the
   * plane of the nearest of these sides, which goes on beyond the edge and there falls off slowly,
   * so that a node that slides over the edge is released where its gap is zero. All other nodes
   * have the distance to the surface. So bodies with a common side touch up to their edges, and
   * what passes an edge without having touched does not touch.
   */
  template <int dim>
  class PartSurface : public ContactSurface<dim>
  {
  public:
    static constexpr unsigned int n_corners = PartLayer<dim>::n_corners;
    using Weights = typename PartLayer<dim>::Weights;

    /** Where a node touches. */
    struct Place
    {
      std::size_t candidate;
      dealii::Tensor<1, dim> normal, motion; ///< motion over the last step [L]
      unsigned int cell;                     ///< of the layer
      Weights weights;                       ///< N_a
      double crowding;                       ///< R_i
    };

    explicit PartSurface(const Entries &e);

    /** Takes the part. Throws InputError where its boundary cannot be used. Collective. */
    void take(MasterPart<dim> part, const NodalState &state);

    void set_partition(const NodePartition &partition)
    {
      sides.resize(partition.n_owned(), Side::in_front);
      layer->set_partition(partition);
    }

    /** Takes the nodes of the part off the owned @p candidates of a contact. Throws InputError
     * where no other ones are left. Collective. */
    void drop_own_nodes(const Section &contact, std::vector<unsigned int> &candidates) const;

    /** Takes what owned nodes have of faces, to tell sides of edges; must outlive the surface. */
    void set_areas(const OutwardAreas<dim> &areas)
    {
      this->areas = &areas;
    }

    /** Finds which of the owned @p candidates have got behind the sides that they face, and which
     * are in front of them again. Once in each step, after follow(). */
    void find_sides(const NodalVector &position, const std::vector<unsigned int> &candidates);

    /** Nodes are where they are: none has moved over the last step. Collective. */
    void forget_motion(const NodalState &state)
    {
      positions = last_positions = gather_positions(state.position);
      refit();
    }

    /** The positions of the state, and masses; those that were known are the ones before.
     * Collective. */
    void follow(const NodalState &state);

    /** Finds the places of these candidates, of which @p nodes has the owned nodes, until the next
     * call. Collective. */
    void find_places(const NodalState &state, const std::vector<unsigned int> &nodes,
                     const std::vector<std::size_t> &candidates);
    const Place &place(const std::size_t candidate) const
    {
      return places[place_of_candidate[candidate]];
    }

    /** Adds minus the @p force on a candidate to the nodes of the part. */
    void add_reaction(const Place &place, const dealii::Tensor<1, dim> &force);
    /** Adds the reactions of all ranks to the owned nodes of @p loads and appends these to
     * @p loaded_nodes. Collective. */
    void collect_reactions(NodalVector &loads, std::vector<unsigned int> &loaded_nodes);

    const PartLayer<dim> &nodes_of_part() const
    {
      return *layer;
    }
    const typename PartLayer<dim>::Cell &cell(const Place &place) const
    {
      return layer->cells()[place.cell];
    }

    /** R of each place for what the nodes that touch have, @p of_place in the order of places, and
     * what nodes of the part have. Collective. */
    std::vector<double> crowding(const std::vector<const Place *> &places,
                                 const std::vector<double> &of_place,
                                 const std::vector<double> &of_nodes) const;

    /** Lists where nodes of the part were, and the sides of @p candidates, which is referred to. */
    void list(Records &records, const std::vector<unsigned int> &candidates);

    std::string description() const override;
    void evaluate_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes,
                       double time, std::vector<double> &gap) const override;
    void set_reach(const double distance) override
    {
      reach = std::max(reach, distance);
    }
    dealii::Tensor<1, dim> normal(const dealii::Tensor<1, dim> &point, double time) const override;
    /** Over the last step. */
    dealii::Tensor<1, dim> motion(const dealii::Tensor<1, dim> &point, double from,
                                  double to) const override;
    /** The mean of the vertices. */
    dealii::Tensor<1, dim> reference_point(double time) const override;
    RigidTranslation<dim> &translation() override
    {
      return no_translation;
    }
    PartSurface *of_part() override
    {
      return this;
    }

  private:
    std::vector<dealii::Tensor<1, dim>> gather_positions(const NodalVector &position) const;
    void refit();
    /** Of an owned node, relative to the sides that it faces. */
    enum class Side : unsigned char
    {
      in_front,
      held,  ///< behind, and touches them
      behind ///< where it does not
    };

    SurfaceGap<dim> gap_of_node(const dealii::Tensor<1, dim> &point, unsigned int node) const;
    /** Nothing where it has no faces, or faces nothing. */
    std::optional<FacedSides<dim>> faced_by(const dealii::Tensor<1, dim> &point,
                                            unsigned int node) const;
    dealii::Tensor<1, dim> motion_of(unsigned int cell, const Weights &weights) const;

    Section section;
    std::unique_ptr<PartLayer<dim>> layer;
    bool is_driven = false;
    SearchedSurface<dim> surface;
    std::vector<unsigned int> node_of_vertex; ///< number in the layer of each vertex
    const OutwardAreas<dim> *areas = nullptr;
    std::vector<Side> sides;                                       ///< of owned nodes
    std::vector<dealii::Tensor<1, dim>> positions, last_positions; ///< of nodes of the layer [L]
    std::vector<double> masses;                                    ///< likewise [M]
    std::vector<Place> places;
    std::vector<unsigned int> place_of_candidate;
    std::vector<double> reactions; ///< of this rank, dim of each node of the layer
    RigidTranslation<dim> no_translation;
    double reach = 0;        ///< outside of the box around the part
    double largest_size = 0; ///< of cells below facets [L]
  };
} // namespace tombolo
