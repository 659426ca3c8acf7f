#pragma once

#include <deal.II/lac/la_parallel_vector.h>

#include <tombolo/state/node_partition.h>

#include <memory>

namespace tombolo
{
  /**
   * One quantity at every owned and ghost node, with one double (scalar) or n_slots doubles
   * (vector) a node, contiguous: node(i) is the address of local node i. Owned values are the
   * truth. update_ghosts() copies them to the ghosts of other ranks (gather); add_to_owners() adds
   * what was accumulated at ghosts to their owners, in a fixed order, and clears the ghosts
   * (scatter). Both are collective and bitwise repeatable.
   */
  class NodalVector
  {
  public:
    NodalVector() = default;

    /** All zero. @p slots is 1 or n_slots. */
    void reinit(const std::shared_ptr<const NodePartition> &partition,
                unsigned int slots = n_slots);

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
    const std::shared_ptr<const NodePartition> &partition() const;

    void set_zero();                          ///< owned and ghosts
    void copy_from(const NodalVector &other); ///< owned and ghosts; same partition and slots
    void update_ghosts();
    void add_to_owners();

    /** Sum over owned values of this times other, summed over ranks. Collective. */
    double dot(const NodalVector &other) const;

    std::size_t memory_consumption() const;

  private:
    std::shared_ptr<const NodePartition> node_partition;
    dealii::LinearAlgebra::distributed::Vector<double> storage;
    double *values = nullptr;
    unsigned int slots = 0;
  };
} // namespace tombolo
