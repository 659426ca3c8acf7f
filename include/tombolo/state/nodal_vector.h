// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/point.h>

#include <tombolo/state/node_partition.h>

#include <initializer_list>
#include <memory>
#include <vector>

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
   * of images to their sources. A node on a plane is its own image: both set the normal component
   * of a vector there to zero, and move a position onto the plane.
   *
   * distribute() and condense() are the same with dependent nodes of the partition: the means of
   * others C, and what is moved to these others Cᵀ.
   *
   * Values at nodes are set or added up within fill(), change_owned(), add_up() and the
   * functions below, which do all exchanges.
   */
  class NodalVector
  {
  public:
    NodalVector() = default;

    /** All zero. */
    explicit NodalVector(const std::shared_ptr<const NodePartition> &partition,
                         Quantity quantity = Quantity::vector)
    {
      reinit(partition, quantity);
    }

    NodalVector(NodalVector &&) = default;
    NodalVector &operator=(NodalVector &&) = default;

    /** All zero. */
    void reinit(const std::shared_ptr<const NodePartition> &partition,
                Quantity quantity = Quantity::vector);
    /** The same, unless it is of this partition already: then it stays as it is. */
    void fit_to(const std::shared_ptr<const NodePartition> &partition,
                const Quantity quantity = Quantity::vector)
    {
      if (node_partition != partition)
        reinit(partition, quantity);
    }
    /** All zero, of the partition and quantity of the other one. */
    void reinit_like(const NodalVector &other)
    {
      reinit(other.node_partition, other.kind);
    }

    /** Keeps the owned values, changes to the ghosts of @p partition, which must own the same
     * nodes; updates the ghosts. Collective. */
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

    unsigned int n_slots_per_node() const
    {
      return slots;
    }

    Quantity quantity() const
    {
      return kind;
    }
    const std::shared_ptr<const NodePartition> &partition() const
    {
      return node_partition;
    }

    void set_zero();                          ///< owned, ghosts and images
    void copy_from(const NodalVector &other); ///< likewise; same partition and slots
    NodalVector copy() const;                 ///< likewise

    /** Calls @p set(node, values) for all owned nodes, and updates the ghosts. Collective. */
    template <typename Set>
    void fill(const Set &set)
    {
      for (unsigned int i = 0; i < node_partition->n_owned(); ++i)
        set(i, node(i));
      update_ghosts();
    }

    /** The same for these owned @p nodes alone: @p set(index in the list, values). Collective. */
    template <typename Nodes, typename Set>
    void fill(const Nodes &nodes, const Set &set)
    {
      for (std::size_t k = 0; k < nodes.size(); ++k)
        set(k, node(nodes[k]));
      update_ghosts();
    }

    void update_ghosts();
    void add_to_owners();
    /** Sets dependent nodes to the mean of others, and updates the ghosts. Collective. */
    void distribute();
    /** Moves what dependent nodes have to those on which they depend. Ghosts must be zero, and are
     * zero afterwards. Collective where there are such nodes. */
    void condense();
    /** What was accumulated at all local nodes to those that move: add_to_owners(), condense().
     * Collective. */
    void collect()
    {
      add_to_owners();
      condense();
    }
    /** Sets owners and ghosts to the sums of what was accumulated at all local nodes. Collective.
     */
    void sum_over_ranks()
    {
      add_to_owners();
      update_ghosts();
    }
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

  /** The first dim components of the values at a node; point_of() is the same of a position. */
  template <int dim>
  dealii::Tensor<1, dim> vector_of(const double *node)
  {
    dealii::Tensor<1, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = node[d];
    return result;
  }
  template <int dim>
  dealii::Point<dim> point_of(const double *node)
  {
    return dealii::Point<dim>(vector_of<dim>(node));
  }

  /** Updates the ghosts of @p vectors, of which @p change() has changed owned values. Collective.
   */
  template <typename Change>
  void change_owned(const std::initializer_list<NodalVector *> vectors, const Change &change)
  {
    change();
    for (NodalVector *const vector : vectors)
      vector->update_ghosts();
  }

  /** Writes to owned nodes of @p sums what @p add() adds to zero at local ones. Collective. */
  template <typename Add, typename Vectors = std::initializer_list<NodalVector *>>
  void add_up(const Vectors &sums, const Add &add)
  {
    for (NodalVector *const sum : sums)
      sum->set_zero();
    add();
    for (NodalVector *const sum : sums)
      sum->add_to_owners();
  }

  /** The sums at owned nodes of what @p add(vector) adds at local ones. Collective. */
  template <typename Add>
  NodalVector sums_at_owners(const std::shared_ptr<const NodePartition> &partition,
                             const Quantity quantity, const Add &add)
  {
    NodalVector result(partition, quantity);
    add(result);
    result.add_to_owners();
    return result;
  }

  /** A field with the values that @p set(node, values) sets at owned nodes, zero before, and
   * current ghosts. Collective. */
  template <typename Set>
  NodalVector nodal_field(const std::shared_ptr<const NodePartition> &partition,
                          const Quantity quantity, const Set &set)
  {
    NodalVector result(partition, quantity);
    result.fill(set);
    return result;
  }

  /** The same with @p set(index in the list, values) for these owned @p nodes alone. */
  template <typename Nodes, typename Set>
  NodalVector nodal_field(const std::shared_ptr<const NodePartition> &partition,
                          const Quantity quantity, const Nodes &nodes, const Set &set)
  {
    NodalVector result(partition, quantity);
    result.fill(nodes, set);
    return result;
  }

  /** A scalar field with the values that @p value_of returns for owned nodes, and current ghosts.
   * Collective. */
  template <typename ValueOf>
  NodalVector scalar_field(const std::shared_ptr<const NodePartition> &partition,
                           const ValueOf &value_of)
  {
    return nodal_field(partition, Quantity::scalar,
                       [&](const unsigned int i, double *const value) { *value = value_of(i); });
  }

  /** @p a - @p b at owned nodes, with current ghosts. Collective. */
  NodalVector difference(const NodalVector &a, const NodalVector &b);

  /** Those of the first @p n local nodes of which a scalar is positive, ascending. */
  std::vector<unsigned int> positive_nodes(const NodalVector &scalar, unsigned int n);

  /** Scalar, with current ghosts: positive at the nodes for which a rank calls mark(local number)
   * in @p visit(mark), else zero. Collective. */
  template <typename Visit>
  NodalVector marked_nodes(const std::shared_ptr<const NodePartition> &partition,
                           const Visit &visit)
  {
    NodalVector result(partition, Quantity::scalar);
    visit([&](const unsigned int node) { *result.node(node) = 1.; });
    result.sum_over_ranks();
    return result;
  }

  /** The owned ones among them, ascending. Collective. */
  template <typename Visit>
  std::vector<unsigned int>
  owned_marked_nodes(const std::shared_ptr<const NodePartition> &partition, const Visit &visit)
  {
    return positive_nodes(marked_nodes(partition, visit), partition->n_owned());
  }
} // namespace tombolo
