#pragma once

#include <deal.II/base/index_set.h>
#include <deal.II/base/partitioner.h>

#include <memory>

namespace tombolo
{
  /** Doubles per node in nodal vectors: three components and a pad, so that a node is one 256-bit
   * load. In two dimensions the third component is zero. */
  constexpr unsigned int n_slots = 4;

  /**
   * Which nodes a rank owns and which ghosts it reads, and the exchange between them. Local node
   * numbers are 0 ... n_owned()-1 for owned nodes, in the order of their global numbers, then the
   * ghosts, in the order of theirs. Immutable: when ghosts change, a new partition is made and
   * nodal vectors move over to it (NodalVector::move_to).
   */
  class NodePartition
  {
  public:
    /** @p ghosts may contain owned nodes; they are left out. Collective. */
    NodePartition(const dealii::IndexSet &owned, const dealii::IndexSet &ghosts,
                  MPI_Comm communicator);

    unsigned int n_owned() const;
    unsigned int n_ghosts() const;
    unsigned int n_local() const; ///< owned and ghosts
    dealii::types::global_dof_index n_global() const;

    /** Throws (Assert) for a node that is neither owned nor ghost. */
    unsigned int local_index(dealii::types::global_dof_index node) const;
    dealii::types::global_dof_index global_index(unsigned int local) const;
    bool has(dealii::types::global_dof_index node) const;

    const dealii::IndexSet &owned() const;
    const dealii::IndexSet &ghosts() const;
    MPI_Comm communicator() const;

    /** The exchange of one double per node. */
    const std::shared_ptr<const dealii::Utilities::MPI::Partitioner> &scalars() const;
    /** The exchange of n_slots doubles per node. */
    const std::shared_ptr<const dealii::Utilities::MPI::Partitioner> &vectors() const;

  private:
    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> scalar_partitioner;
    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> vector_partitioner;
  };
} // namespace tombolo
