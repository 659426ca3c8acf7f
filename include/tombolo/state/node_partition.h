// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/index_set.h>
#include <deal.II/base/partitioner.h>

#include <tombolo/mesh/images.h>

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  template <int dim>
  class Nodes;

  /** Doubles per node in nodal vectors: three components and a pad, so that a node is one 256-bit
   * load. In two dimensions the third component is zero. */
  constexpr unsigned int node_stride = 4;

  /** The cost of the exchanges of nodal values on this rank. */
  struct ExchangeCost
  {
    unsigned long n_exchanges = 0; ///< calls of update_ghosts() and add_to_owners()
    unsigned long n_messages = 0;  ///< that this rank has sent
    unsigned long n_doubles = 0;   ///< that this rank has sent
    double seconds = 0;            ///< in exchanges, including the wait for other ranks
  };

  /**
   * Which nodes a rank owns and which ghosts it reads, and the exchange between them. Local node
   * numbers are 0 ... n_owned()-1 for owned nodes, in the order of their global numbers, then the
   * ghosts, in the order of theirs, then the images of owned and ghost nodes, if the body has such
   * (Images). Immutable: when ghosts change, a new partition is made and
   * nodal vectors move over to it (NodalVector::move_to). Held by shared pointers.
   *
   * Some owned nodes can depend on others (C): such as those on a face of an element beside
   * elements of half its size. Fields of elements are then continuous. Forces and masses of
   * dependent nodes go to the others by Cᵀ, so that a dependent node has no mass and receives no
   * force. The rows of C sum to one and keep linear fields, hence Cᵀ keeps mass, momentum and
   * angular momentum, and f · C v = Cᵀ f · v.
   */
  class NodePartition : public std::enable_shared_from_this<NodePartition>
  {
  public:
    /** @p ghosts may contain owned nodes; they are left out. @p images are those of the body among
     * which are @p image_nodes, in any order, whose sources must be owned or ghosts. Collective. */
    NodePartition(const dealii::IndexSet &owned, const dealii::IndexSet &ghosts,
                  MPI_Comm communicator,
                  const std::shared_ptr<const Images> &images = Images::none(),
                  const std::vector<ImageNode> &image_nodes = {});

    unsigned int n_owned() const
    {
      return scalar_partitioner->locally_owned_size();
    }

    unsigned int n_ghosts() const
    {
      return scalar_partitioner->n_ghost_indices();
    }

    unsigned int n_images() const
    {
      return static_cast<unsigned int>(reflected_images.size());
    }

    unsigned int n_local() const ///< owned, ghosts and images
    {
      return n_owned() + n_ghosts() + n_images();
    }

    dealii::types::global_dof_index n_global() const
    {
      return scalar_partitioner->size();
    }

    /** Throws (Assert) for a node that is neither owned nor ghost. */
    unsigned int local_index(const dealii::types::global_dof_index node) const
    {
      return scalar_partitioner->global_to_local(node);
    }

    dealii::types::global_dof_index global_index(const unsigned int local) const
    {
      return scalar_partitioner->local_to_global(local);
    }

    bool has(const dealii::types::global_dof_index node) const
    {
      return scalar_partitioner->in_local_range(node) || scalar_partitioner->is_ghost_entry(node);
    }

    /** The local number of an image that the constructor was given. */
    unsigned int local_index(const ImageNode &image) const;

    /** The image of the values of one node: value <- sign * value + offset, where the offset is for
     * positions only. */
    struct Reflected
    {
      unsigned int source; ///< local number
      Images::Map reflection;
    };

    /** Makes these owned nodes dependent on others, which are owned or ghosts and depend on none.
     * For a partition that no vector has yet. Collective. */
    void set_dependent_nodes(const std::vector<DependentNode> &rows);

    /** Owned nodes with their rows of C, one after the other, in local numbers. */
    struct DependentNodes
    {
      std::vector<unsigned int> node;
      std::vector<std::size_t> start; ///< of each row in the weights, and their number
      std::vector<std::pair<unsigned int, double>> weights;
    };

    const DependentNodes &dependent_nodes() const
    {
      return dependent;
    }

    /** On any rank. */
    bool has_dependent_nodes() const
    {
      return some_rank_has_dependent_nodes;
    }

    /** All that the body has. */
    const Images &images_of_body() const
    {
      return *all_images;
    }

    /** By image, in the order of local numbers; the source is owned or a ghost. */
    const std::vector<Reflected> &images() const
    {
      return reflected_images;
    }

    /** Owned nodes that are their own images, once for each mirror. */
    const std::vector<Reflected> &nodes_on_planes() const
    {
      return reflected_onto_themselves;
    }

    /** Owned nodes that can receive something in NodalVector::add_to_owners(): ghosts of other
     * ranks, and sources of images. In any order, some repeatedly. */
    const std::vector<unsigned int> &receiving_nodes() const
    {
      return receivers;
    }

    const dealii::IndexSet &owned() const
    {
      return scalar_partitioner->locally_owned_range();
    }

    const dealii::IndexSet &ghosts() const
    {
      return scalar_partitioner->ghost_indices();
    }

    MPI_Comm communicator() const
    {
      return scalar_partitioner->get_mpi_communicator();
    }

    /** Continues the statistics of @p previous, which this partition replaces. */
    void continue_counting(const NodePartition &previous)
    {
      cost = previous.cost;
    }

    /** Where NodalVector books what its exchanges cost. */
    ExchangeCost &exchange_cost() const
    {
      return *cost;
    }

    /** The exchange of one double per node. */
    const std::shared_ptr<const dealii::Utilities::MPI::Partitioner> &scalars() const
    {
      return scalar_partitioner;
    }

    /** The exchange of one double per node, or of node_stride. */
    const dealii::Utilities::MPI::Partitioner &exchange_of(const unsigned int n_slots) const
    {
      return *(n_slots == 1 ? scalar_partitioner : vector_partitioner);
    }

  private:
    DependentNodes dependent;
    bool some_rank_has_dependent_nodes = false;
    std::shared_ptr<const Images> all_images;
    std::vector<ImageNode> image_nodes; // ascending
    std::vector<Reflected> reflected_images, reflected_onto_themselves;
    std::vector<unsigned int> receivers;
    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> scalar_partitioner;
    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> vector_partitioner;
    std::shared_ptr<ExchangeCost> cost = std::make_shared<ExchangeCost>();
  };

  /** A partition of the @p nodes of a mesh with the ghosts @p required, those on which owned nodes
   * depend, and @p images. Collective. */
  template <int dim>
  std::shared_ptr<NodePartition> partition_of(const Nodes<dim> &nodes, dealii::IndexSet required,
                                              const std::vector<ImageNode> &images = {});
} // namespace tombolo
