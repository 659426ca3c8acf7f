// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/state/node_partition.h>

#include <memory>

namespace tombolo
{
  /** What a nodal vector holds: how many values a node has, and what a plane of symmetry does to
   * them. */
  enum class Quantity
  {
    scalar,  ///< one value, which a plane leaves
    scalars, ///< node_stride of these: such as masses by component
    vector,  ///< a plane changes the sign of its normal component
    position ///< a plane reflects it
  };

  /**
   * One quantity at every owned and ghost node, with one double (scalar) or node_stride doubles
   * a node, contiguous: node(i) is the address of local node i. Owned values are
   * authoritative. update_ghosts() copies them to the ghosts of other ranks (gather);
   * add_to_owners() adds what was accumulated at ghosts to their owners, in a fixed order, and
   * clears the ghosts (scatter). Both are collective and bitwise repeatable.
   *
   * Where the partition has images of nodes in planes of symmetry, update_ghosts() also fills these
   * with the reflected values of their sources, and add_to_owners() first adds the reflected values
   * of images to their sources. A node on a plane is its own image: both put the normal component
   * of a vector there to zero, and a position onto the plane.
   *
   * distribute() and condense() are the same with dependent nodes of the partition: the means of
   * others C, and what is moved to these others Cᵀ.
   */
  class NodalVector
  {
  public:
    NodalVector() = default;

    NodalVector(NodalVector &&) = default;
    NodalVector &operator=(NodalVector &&) = default;

    /** All zero. */
    void reinit(const std::shared_ptr<const NodePartition> &partition,
                Quantity quantity = Quantity::vector);
    /** All zero, of the partition and quantity of the other one. */
    void reinit_like(const NodalVector &other);

    /** Keeps the owned values, takes the ghosts of @p partition, which must own the same nodes;
     * updates the ghosts. Collective. */
    void move_to(const std::shared_ptr<const NodePartition> &partition);

    double *node(const unsigned int local)
    {
      return values + static_cast<std::size_t>(local) * slots;
    }
    const double *node(const unsigned int local) const
    {
      return values + static_cast<std::size_t>(local) * slots;
    }
    double *data()
    {
      return values;
    }
    const double *data() const
    {
      return values;
    }

    unsigned int n_slots_per_node() const;
    Quantity quantity() const
    {
      return kind;
    }
    const std::shared_ptr<const NodePartition> &partition() const;

    void set_zero();                          ///< owned, ghosts and images
    void copy_from(const NodalVector &other); ///< likewise; same partition and slots
    void update_ghosts();
    void add_to_owners();
    /** Gives dependent nodes the mean of others, and updates the ghosts. Collective. */
    void distribute();
    /** Moves what dependent nodes have to those on which they depend. Ghosts must be zero, and are
     * zero afterwards. Collective where there are such nodes. */
    void condense();
    /** What was accumulated at all local nodes to those that move: add_to_owners(), condense().
     * Collective. */
    void collect();
    /** Gives owners and ghosts the sums of what was accumulated at all local nodes. Collective. */
    void sum_over_ranks();
    /** Makes the values of owned nodes on planes of symmetry symmetric, as update_ghosts() does
     * first. */
    void make_symmetric();

    /** Sum over owned values of this times other, summed over ranks. Collective. */
    double dot(const NodalVector &other) const;

  private:
    void allocate(const std::shared_ptr<const NodePartition> &partition);
    void fill_images();
    void collect_images();

    std::shared_ptr<const NodePartition> node_partition;
    dealii::AlignedVector<double> storage;
    dealii::AlignedVector<double> exchange_buffer;
    double *values = nullptr;
    Quantity kind = Quantity::scalar;
    unsigned int slots = 0;
  };

  /** A scalar field with the values that @p value_of gives owned nodes, and current ghosts.
   * Collective. */
  template <typename ValueOf>
  NodalVector scalar_field(const std::shared_ptr<const NodePartition> &partition,
                           const ValueOf &value_of)
  {
    NodalVector result;
    result.reinit(partition, Quantity::scalar);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      *result.node(i) = value_of(i);
    result.update_ghosts();
    return result;
  }
} // namespace tombolo
