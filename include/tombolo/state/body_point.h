// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>

#include <tombolo/base/format.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_state.h>
#include <tombolo/state/records.h>

#include <cstdint>
#include <limits>
#include <optional>

namespace tombolo
{
  /**
   * A point of a body that is watched or pulled: the node that is nearest to a position at the
   * start, of several the one with the smallest persistent id, whatever the number of ranks. One
   * rank owns it; where it is all ranks can query.
   */
  template <int dim>
  class BodyPoint
  {
  public:
    using Vector = dealii::Tensor<1, dim>;

    /** Finds the node nearest to initial coordinates @p target. Nodes that are equally far but for
     * a billionth of the @p largest_cell (its diameter) are alike; of these the one with the
     * persistent id @p preferred is taken. Collective. */
    void find(const Nodes<dim> &nodes, const NodalState &state, const Vector &target,
              const double largest_cell, const std::optional<std::uint64_t> preferred = {})
    {
      struct Candidate
      {
        std::uint64_t id = std::numeric_limits<std::uint64_t>::max();
        Vector position;
      };
      const NodalVector &initial = state.initial_position;
      const unsigned int n_owned = initial.partition()->n_owned();
      const auto position_of = [&](const unsigned int i)
      { return Vector(dealii::ArrayView<const double>(initial.node(i), dim)); };
      communicator = nodes.communicator();
      requested_position = target;
      largest_distance = largest_cell;
      distance = std::numeric_limits<double>::max();
      for (unsigned int i = 0; i < n_owned; ++i)
        distance = std::min(distance, (position_of(i) - target).norm());
      distance = dealii::Utilities::MPI::min(distance, communicator);

      const auto is_before = [&](const std::uint64_t a, const std::uint64_t b)
      { return a != b && (a == preferred || (a < b && b != preferred)); };
      Candidate here;
      for (unsigned int i = 0; i < n_owned; ++i)
        if ((position_of(i) - target).norm() <= distance + 1e-9 * largest_cell &&
            is_before(nodes.persistent_ids()[i], here.id))
        {
          here = {nodes.persistent_ids()[i], position_of(i)};
          number = i;
        }
      Candidate best;
      for (const Candidate &candidate : from_all_ranks(std::vector<Candidate>{here}, communicator))
        if (is_before(candidate.id, best.id))
          best = candidate;
      id = best.id;
      initial_coordinates = best.position;
      is_owned = here.id == id && n_owned > 0;
    }

    /** The same, and lists it in the @p records of the object that follows the point: where cells
     * have been divided in the run it stays the same node. Nodes and state must outlive the list.
     */
    void find(const Nodes<dim> &nodes, const NodalState &state, const Vector &target,
              Records &records)
    {
      find(nodes, state, target, largest_cell_diameter(nodes));
      records.value("node", initial_coordinates);
      records.on_reading(
          [this, &nodes, &state]
          { find(nodes, state, Vector(initial_coordinates), largest_cell_diameter(nodes)); });
    }

    /** Whether this rank owns the node. */
    bool is_here() const
    {
      return is_owned;
    }

    /** Its local number on the rank that owns it. */
    unsigned int node() const
    {
      return number;
    }

    /** Its global number, on all ranks. Collective. */
    dealii::types::global_dof_index global_node(const NodePartition &partition) const
    {
      return dealii::Utilities::MPI::max(is_owned ? partition.global_index(number) : 0,
                                         communicator);
    }

    std::uint64_t persistent_id() const
    {
      return id;
    }

    /** Its initial coordinates, on all ranks. */
    const Vector &initial_position() const
    {
      return initial_coordinates;
    }

    /** Why the requested position is outside of the body, the node being farther from it than a
     * cell is large; empty where it is inside. */
    std::string why_outside() const
    {
      if (!(distance > largest_distance))
        return "";
      return "the nearest node is " + format_number(distance) + " away from " +
             position_text(requested_position) + ", more than the largest cell measures (" +
             format_number(largest_distance) + "): this place is outside of the body";
    }

    /** The values of a @p field at the node on all ranks, such as its position. Collective. */
    Vector value(const NodalVector &field) const
    {
      Vector result;
      for (unsigned int d = 0; d < dim && is_owned; ++d)
        result[d] = field.node(number)[d];
      return dealii::Utilities::MPI::sum(result, communicator);
    }

  private:
    MPI_Comm communicator = MPI_COMM_SELF;
    double distance = 0, largest_distance = 0;
    Vector requested_position;
    std::uint64_t id = 0;
    Vector initial_coordinates;
    unsigned int number = 0;
    bool is_owned = false;
  };
} // namespace tombolo
