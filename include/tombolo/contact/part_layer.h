// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/contact/surfaces/facet_list.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace tombolo
{
  /**
   * The outermost layer of cells of a part, of degree 1, with their nodes: all ranks know it as a
   * whole. Its facets are the faces where the part ends, at the boundary of the mesh or at another
   * part, in three dimensions as two triangles each; so they enclose the part. Nodes of the layer
   * are numbered in an order that does not depend on the number of ranks. Where the part touches a
   * mirror (Images), images of its nodes and cells follow: with them the facets enclose the part
   * and its images, and are not in the mirror.
   *
   * Values at these nodes are gathered from their owners, and sums are given back to them. Every
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

    /** A node that this rank owns. */
    struct OwnedNode
    {
      unsigned int number; ///< in the layer
      unsigned int node;   ///< local
    };

    /** Takes the cells that @p is_of_part selects. Collective. */
    PartLayer(const Nodes<dim> &nodes, const Selector &is_of_part);

    /** Translates node numbers to those of @p partition. */
    void set_partition(const NodePartition &partition);

    /** The number of nodes of the layer. */
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
     * this rank owns. Images have those of their sources, @p kind says how. Collective. */
    std::vector<double> gather(unsigned int n_values, Quantity kind,
                               const std::function<void(unsigned int node, double *)> &fill) const;

    /** Sums @p values, @p n_values of each node, over ranks in their order, and over images.
     * Collective. */
    void sum(unsigned int n_values, Quantity kind, std::vector<double> &values) const;

  private:
    /** What the ranks tell each other at the start: owners of nodes of these, owners of cells of
     * these. */
    struct SurveyNode
    {
      std::uint64_t global_number, id; ///< the latter is the persistent one
      std::array<double, dim> position;
    };
    struct SurveyCell
    {
      std::array<std::uint64_t, n_corners> nodes; ///< global numbers
      unsigned int mask;                          ///< a bit for each face that is one of the part's
      double size;
    };
    void take_survey(const std::vector<SurveyNode> &nodes, std::vector<SurveyCell> cells);
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
    std::vector<int> n_owned_of_rank;
    std::vector<Image> images; ///< nodes behind all others
  };
} // namespace tombolo
