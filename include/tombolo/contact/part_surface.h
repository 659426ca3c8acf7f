// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/outward_areas.h>
#include <tombolo/contact/surfaces/facet_list.h>
#include <tombolo/contact/surfaces/facet_tree.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_state.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The outermost layer of cells of a part, of degree 1, with their nodes: stored as a whole on all
   * ranks. Its facets are the faces where the part ends, at the boundary of the mesh or at another
   * part, in three dimensions as two triangles each; so they enclose the part. Nodes of the layer
   * are numbered in an order that does not depend on the number of ranks. Where the part touches a
   * mirror (Images), images of its nodes and cells follow: with them the facets enclose the part
   * and its images, and are not in the mirror.
   *
   * Values at these nodes are gathered from their owners, and sums are sent back to them. Every
   * rank takes part in each exchange, also one without cells of the part.
   */
  template <int dim>
  class PartLayer
  {
  public:
    static constexpr unsigned int n_corners = 1u << dim;
    using Selector = std::function<bool(const typename Nodes<dim>::Cell &)>;

    /** Numbers of the nodes of the layer, lexicographic. */
    using Cell = std::array<unsigned int, n_corners>;
    using Weights = std::array<double, n_corners>;

    struct OwnedNode
    {
      unsigned int number; ///< in the layer
      unsigned int node;   ///< local
    };

    /** Has the cells that @p is_of_part selects. Collective. */
    PartLayer(const Nodes<dim> &nodes, const Selector &is_of_part);

    /** Translates node numbers to those of @p partition. */
    void set_partition(const NodePartition &partition);

    std::size_t n_nodes() const
    {
      return initial_positions.size();
    }
    const std::vector<Cell> &cells() const
    {
      return layer_cells;
    }
    /** Faces with numbers of nodes and their initial positions, not yet oriented. */
    const FacetList<dim> &facets() const
    {
      return faces;
    }
    /** Of each facet: its cell, and the shortest distance of two corners of that [L]. */
    const std::vector<unsigned int> &cell_of_facet() const
    {
      return cells_of_facets;
    }
    double size(const std::size_t facet) const
    {
      return sizes[cells_of_facets[facet]];
    }

    const std::vector<OwnedNode> &owned() const
    {
      return owned_nodes;
    }

    /** Whether a local node that this rank owns is a node of the layer. */
    bool has_node(const unsigned int node) const
    {
      return std::binary_search(local_nodes.begin(), local_nodes.end(), node);
    }

    /** The shape functions N_a of a cell, whose nodes are at these @p positions, at a point in the
     * cell or a little outside: Σ N_a = 1 and Σ N_a x_a = @p point to round-off. */
    Weights weights(const dealii::Tensor<1, dim> &point, unsigned int cell,
                    const std::vector<dealii::Tensor<1, dim>> &positions) const;

    /** @p n_values of each node, by number in the layer: @p fill writes those of a local node that
     * this rank owns. Images have those of their sources, by @p kind. Collective. */
    std::vector<double> gather(unsigned int n_values, Quantity kind,
                               const std::function<void(unsigned int node, double *)> &fill) const;

    /** Sums @p values, @p n_values of each node, over ranks in their order, and over images.
     * Collective. */
    void sum(unsigned int n_values, Quantity kind, std::vector<double> &values) const;

  private:
    /** What ranks exchange at the start: nodes from their owners, and cells from theirs. */
    struct SurveyNode
    {
      std::uint64_t global_number, id; ///< the latter is the persistent one
      dealii::Tensor<1, dim> position;
    };
    struct SurveyCell
    {
      std::array<std::uint64_t, n_corners> nodes; ///< global numbers
      unsigned int mask;                          ///< a bit for each face that is one of the part's
      double size;
    };
    void read_survey(const std::vector<SurveyNode> &nodes, std::vector<SurveyCell> cells);
    void add_facets(const Nodes<dim> &nodes);
    /** Of nodes, cells and facets in the mirrors that the part touches. */
    void add_images(const Nodes<dim> &nodes);
    void fill_images(unsigned int n_values, Quantity kind, std::vector<double> &values) const;

    struct Image
    {
      unsigned int source; ///< number in the layer
      Images::Map map;
    };

    MPI_Comm communicator;
    std::vector<dealii::Tensor<1, dim>> initial_positions;
    std::vector<Cell> layer_cells;
    std::vector<double> sizes;       ///< of cells
    std::vector<unsigned int> masks; ///< of cells, as in the survey
    FacetList<dim> faces;
    std::vector<unsigned int> cells_of_facets;
    std::vector<dealii::types::global_dof_index> global_numbers; ///< of all nodes of the layer
    std::vector<OwnedNode> owned_nodes;                          ///< by number
    std::vector<unsigned int> local_nodes; ///< the same, local numbers, ascending
    std::vector<unsigned int> received;    ///< numbers of the nodes of all ranks, by rank
    std::vector<int> begin_of_rank;        ///< in these
    std::vector<Image> images;             ///< nodes behind all others
  };

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
   * point of the cell behind the facet next to it, with the shape functions N_a of that cell: Σ N_a
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
   * The force of a spring has a potential where its gap depends on positions continuously. So near
   * a convex edge a node of the mesh belongs to the sides that its own faces face, from the step in
   * which it is first behind them near by until it is in front of them again: its gap is that of
   * the plane of the nearest of these sides, which goes on beyond the edge and there falls off
   * slowly, so that a node that slides over the edge is released where its gap is zero. All other
   * nodes have the distance to the surface. So bodies with a common side touch up to their edges,
   * and what passes an edge without having touched does not touch.
   */
  template <int dim>
  class PartSurface : public ContactSurface<dim>
  {
  public:
    static constexpr unsigned int n_corners = PartLayer<dim>::n_corners;
    using Weights = typename PartLayer<dim>::Weights;

    /** Where a node touches. */
    struct ContactPoint
    {
      std::size_t candidate;
      dealii::Tensor<1, dim> normal, motion; ///< motion over the last step [L]
      unsigned int cell;                     ///< of the layer
      Weights weights;                       ///< N_a
      double crowding;                       ///< R_i
    };

    explicit PartSurface(const Entries &e);

    /** Sets the part. Throws InputError where its boundary cannot be used. Collective. */
    void set_part(MasterPart<dim> part, const NodalState &state);

    void set_partition(const NodePartition &partition)
    {
      sides.resize(partition.n_owned(), Side::in_front);
      layer->set_partition(partition);
    }

    /** Removes the nodes of the part from the owned @p candidates of a contact. Throws InputError
     * where no others are left. Collective. */
    void drop_own_nodes(const Section &contact, std::vector<unsigned int> &candidates) const;

    /** Sets the outward areas, by which sides of edges differ; must outlive the surface. */
    void set_areas(const OutwardAreas<dim> &areas)
    {
      this->areas = &areas;
    }

    /** Finds which of the owned @p candidates are behind the sides that they face, and which are in
     * front of them again. Once in each step, after follow(). */
    void find_sides(const NodalVector &position, const std::vector<unsigned int> &candidates);

    /** Sets the motion over the last step to zero. Collective. */
    void reset_motion(const NodalState &state)
    {
      positions = last_positions = gather_positions(state.position);
      refit();
    }

    /** The positions of the state, and masses; the former ones become the last. Collective. */
    void follow(const NodalState &state)
    {
      last_positions = std::move(positions);
      positions = gather_positions(state.position);
      if (!is_driven)
        masses = layer->gather(1, Quantity::scalar,
                               [&](const unsigned int node, double *const mass)
                               { *mass = *state.mass.node(node); });
      refit();
    }

    /** Finds the contact points of these candidates, whose owned nodes are in @p nodes, until the
     * next call. Collective. */
    void find_contact_points(const NodalState &state, const std::vector<unsigned int> &nodes,
                             const std::vector<std::size_t> &candidates);
    const ContactPoint &contact_point(const std::size_t candidate) const
    {
      return contact_points[point_of_candidate[candidate]];
    }

    void add_reaction(const ContactPoint &point, const dealii::Tensor<1, dim> &force)
    {
      for (unsigned int c = 0; c < n_corners; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          reactions[dim * cell(point)[c] + d] -= point.weights[c] * force[d];
    }
    /** Adds the reactions of all ranks to the owned nodes of @p loads and appends these to
     * @p loaded_nodes. Collective. */
    void collect_reactions(NodalVector &loads, std::vector<unsigned int> &loaded_nodes);

    const PartLayer<dim> &nodes_of_part() const
    {
      return *layer;
    }
    const typename PartLayer<dim>::Cell &cell(const ContactPoint &point) const
    {
      return layer->cells()[point.cell];
    }

    /** R at the contact points of these candidates, with a value of each of them and
     * @p value_of(node) of the nodes of the part: masses or heat capacities. Collective. */
    template <typename ValueOf>
    std::vector<double> crowding(const std::vector<std::size_t> &candidates,
                                 const std::vector<double> &values, const ValueOf &value_of) const
    {
      std::vector<double> sums(layer->n_nodes(), 0.);
      for (std::size_t i = 0; i < candidates.size(); ++i)
      {
        const ContactPoint &point = contact_point(candidates[i]);
        for (unsigned int c = 0; c < n_corners; ++c)
          sums[cell(point)[c]] += std::abs(point.weights[c]) * values[i];
      }
      layer->sum(1, Quantity::scalar, sums);
      std::vector<double> result;
      for (const std::size_t candidate : candidates)
      {
        double largest = 0;
        for (const unsigned int a : cell(contact_point(candidate)))
          if (sums[a] > 0.)
            largest = std::max(largest, sums[a] / value_of(a));
        result.push_back(largest);
      }
      return result;
    }

    /** Lists where nodes of the part were, and the sides of @p candidates, which is referred to. */
    void list(Records &records, const std::vector<unsigned int> &candidates);

    std::string description() const override
    {
      return "the boundary of the part \"" + section.get("Part") + "\", " +
             std::to_string(surface.facets.size()) + (dim == 2 ? " sides" : " triangles") +
             "; every rank gathers " + std::to_string(layer->n_nodes()) +
             " nodes of its outermost cells in each step";
    }
    void evaluate_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes,
                       double time, std::vector<double> &gap) const override;
    void set_reach(const double distance) override
    {
      reach = std::max(reach, distance);
    }
    dealii::Tensor<1, dim> normal(const dealii::Tensor<1, dim> &point,
                                  const double /*time*/) const override
    {
      return surface.gap(point).normal;
    }
    /** Over the last step. */
    dealii::Tensor<1, dim> motion(const dealii::Tensor<1, dim> &point, const double /*from*/,
                                  const double /*to*/) const override
    {
      const unsigned int cell = layer->cell_of_facet()[surface.gap(point).facet];
      return motion_of(cell, layer->weights(point, cell, positions));
    }
    /** The mean of the vertices. */
    dealii::Tensor<1, dim> reference_point(const double /*time*/) const override
    {
      dealii::Tensor<1, dim> sum;
      for (const dealii::Tensor<1, dim> &vertex : surface.vertices)
        sum += vertex;
      return sum / std::max<double>(1., static_cast<double>(surface.vertices.size()));
    }
    RigidTranslation<dim> &translation() override
    {
      return no_translation;
    }
    PartSurface *part_surface() override
    {
      return this;
    }

  private:
    std::vector<dealii::Tensor<1, dim>> gather_positions(const NodalVector &position) const;
    void refit()
    {
      std::vector<dealii::Tensor<1, dim>> vertices(node_of_vertex.size());
      for (std::size_t v = 0; v < vertices.size(); ++v)
        vertices[v] = positions[node_of_vertex[v]];
      surface.move_vertices(vertices);
    }

    /** Of an owned node, relative to the sides that it faces. */
    enum class Side : unsigned char
    {
      in_front,
      held,  ///< behind, and touches them
      behind ///< where it does not
    };

    SurfaceGap<dim> gap_of_node(const dealii::Tensor<1, dim> &point, unsigned int node) const;
    /** Empty where it has no faces, or no side is faced. */
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
    std::vector<ContactPoint> contact_points;
    std::vector<unsigned int> point_of_candidate;
    std::vector<double> reactions; ///< of this rank, dim of each node of the layer
    RigidTranslation<dim> no_translation;
    double reach = 0;        ///< outside of the box around the part
    double largest_size = 0; ///< of cells below facets [L]
  };

  extern template class PartLayer<2>;
  extern template class PartLayer<3>;
} // namespace tombolo
