// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/state/node_partition.h>

#include <memory>

namespace tombolo
{
  /** What a plane of symmetry does to a quantity. */
  enum class ReflectionParity
  {
    even,   ///< nothing: scalars, and magnitudes by component (masses, half widths)
    vector, ///< changes the sign of the normal component
    point   ///< reflects a position about the plane
  };

  /**
   * One quantity at every owned and ghost node, with one double (scalar) or node_stride doubles
   * (vector) a node, contiguous: node(i) is the address of local node i. Owned values are
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

    /** All zero. @p slots is 1 or node_stride; one slot holds a scalar, which is even. */
    void reinit(const std::shared_ptr<const NodePartition> &partition,
                unsigned int slots = node_stride,
                ReflectionParity under_reflection = ReflectionParity::vector);

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
    ReflectionParity under_reflection() const
    {
      return reflection;
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
    /** Makes the values of owned nodes on planes of symmetry symmetric, as update_ghosts() does
     * first. */
    void make_symmetric();

    /** Sum over owned values of this times other, summed over ranks. Collective. */
    double dot(const NodalVector &other) const;

    std::size_t memory_consumption() const;

  private:
    void allocate(const std::shared_ptr<const NodePartition> &partition);
    void fill_images();
    void collect_images();

    std::shared_ptr<const NodePartition> node_partition;
    dealii::AlignedVector<double> storage;
    dealii::AlignedVector<double> exchange_buffer;
    double *values = nullptr;
    ReflectionParity reflection = ReflectionParity::even;
    unsigned int slots = 0;
  };
} // namespace tombolo
