// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/nodal_vector.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/state/work_while_waiting.h>

#include <deal.II/lac/vector_operation.h>

#include <algorithm>
#include <chrono>

namespace tombolo
{
  using namespace dealii;

  static_assert(node_stride == NodeLanes::size(), "A node of a nodal vector is one NodeLanes.");

  namespace
  {
    /** Whether a plane of symmetry changes it. */
    bool turns(const Quantity quantity)
    {
      return quantity == Quantity::vector || quantity == Quantity::position;
    }

    using WallClock = std::chrono::steady_clock;

    /** Books one exchange, from its construction to its destruction. */
    class ExchangeTimer
    {
    public:
      ExchangeTimer(ExchangeCost &cost, const std::size_t n_messages, const std::size_t n_doubles)
          : cost(cost), start(WallClock::now())
      {
        ++cost.n_exchanges;
        cost.n_messages += n_messages;
        cost.n_doubles += n_doubles;
      }

      ExchangeTimer(const ExchangeTimer &) = delete;
      ExchangeTimer &operator=(const ExchangeTimer &) = delete;

      ~ExchangeTimer()
      {
        cost.seconds += std::chrono::duration<double>(WallClock::now() - start).count();
      }

      /** Other work, if there is any, until all @p requests are there. Its time does not count. */
      void work_until_complete(std::vector<MPI_Request> &requests)
      {
        if (!WorkWhileWaiting::is_there())
          return;
        const auto before = WallClock::now();
        WorkWhileWaiting::work_until(
            [&]
            {
              int are_complete = 0;
              MPI_Testall(static_cast<int>(requests.size()), requests.data(), &are_complete,
                          MPI_STATUSES_IGNORE);
              return are_complete != 0;
            });
        start += WallClock::now() - before;
      }

    private:
      ExchangeCost &cost;
      WallClock::time_point start;
    };
  } // namespace

  void NodalVector::reinit(const std::shared_ptr<const NodePartition> &partition,
                           const Quantity quantity)
  {
    kind = quantity;
    slots = kind == Quantity::scalar ? 1 : node_stride;
    allocate(partition);
    set_zero();
  }

  void NodalVector::allocate(const std::shared_ptr<const NodePartition> &partition)
  {
    node_partition = partition;
    storage.resize_fast(static_cast<std::size_t>(partition->n_local()) * slots);
    exchange_buffer.resize_fast(partition->exchange_of(slots).n_import_indices());
    values = storage.data();
  }

  void NodalVector::move_to(const std::shared_ptr<const NodePartition> &partition)
  {
    Assert(partition->owned() == node_partition->owned(), ExcInternalError());
    AlignedVector<double> old;
    old.swap(storage);
    allocate(partition);
    std::copy_n(old.begin(), static_cast<std::size_t>(partition->n_owned()) * slots, values);
    update_ghosts();
  }

  void NodalVector::set_zero()
  {
    std::fill_n(values, static_cast<std::size_t>(node_partition->n_local()) * slots, 0.);
  }

  void NodalVector::copy_from(const NodalVector &other)
  {
    Assert(other.slots == slots && other.node_partition == node_partition, ExcInternalError());
    std::copy_n(other.values, static_cast<std::size_t>(node_partition->n_local()) * slots, values);
  }

  NodalVector NodalVector::copy() const
  {
    NodalVector result;
    result.reinit_like(*this);
    result.copy_from(*this);
    return result;
  }

  void NodalVector::update_ghosts()
  {
    make_symmetric();
    const Utilities::MPI::Partitioner &exchange = node_partition->exchange_of(slots);
    if (exchange.n_ghost_indices() > 0 || exchange.n_import_indices() > 0)
    {
      ExchangeTimer timer(node_partition->exchange_cost(), exchange.import_targets().size(),
                          exchange.n_import_indices());
      const ArrayView<double> ghosts(values + exchange.locally_owned_size(),
                                     exchange.n_ghost_indices());
      std::vector<MPI_Request> requests;
      exchange.export_to_ghosted_array_start<double, MemorySpace::Host>(
          0, ArrayView<const double>(values, exchange.locally_owned_size()),
          ArrayView<double>(exchange_buffer.data(), exchange_buffer.size()), ghosts, requests);
      timer.work_until_complete(requests);
      exchange.export_to_ghosted_array_finish<double, MemorySpace::Host>(ghosts, requests);
    }
    fill_images();
  }

  void NodalVector::add_to_owners()
  {
    collect_images();
    const Utilities::MPI::Partitioner &exchange = node_partition->exchange_of(slots);
    if (exchange.n_ghost_indices() > 0 || exchange.n_import_indices() > 0)
    {
      ExchangeTimer timer(node_partition->exchange_cost(), exchange.ghost_targets().size(),
                          exchange.n_ghost_indices());
      const ArrayView<double> buffer(exchange_buffer.data(), exchange_buffer.size());
      const ArrayView<double> ghosts(values + exchange.locally_owned_size(),
                                     exchange.n_ghost_indices());
      std::vector<MPI_Request> requests;
      exchange.import_from_ghosted_array_start<double, MemorySpace::Host>(VectorOperation::add, 0,
                                                                          ghosts, buffer, requests);
      timer.work_until_complete(requests);
      exchange.import_from_ghosted_array_finish<double, MemorySpace::Host>(
          VectorOperation::add, ArrayView<const double>(buffer.data(), buffer.size()),
          ArrayView<double>(values, exchange.locally_owned_size()), ghosts, requests);
      std::fill(ghosts.begin(), ghosts.end(), 0.);
    }
    make_symmetric();
  }

  void NodalVector::distribute()
  {
    update_ghosts();
    if (!node_partition->has_dependent_nodes())
      return;
    const NodePartition::DependentNodes &dependent = node_partition->dependent_nodes();
    for (std::size_t row = 0; row < dependent.node.size(); ++row)
    {
      double mean[node_stride] = {};
      for (std::size_t k = dependent.start[row]; k < dependent.start[row + 1]; ++k)
        for (unsigned int c = 0; c < slots; ++c)
          mean[c] += dependent.weights[k].second * node(dependent.weights[k].first)[c];
      std::copy_n(mean, slots, node(dependent.node[row]));
    }
    update_ghosts();
  }

  void NodalVector::condense()
  {
    if (!node_partition->has_dependent_nodes())
      return;
    const NodePartition::DependentNodes &dependent = node_partition->dependent_nodes();
    for (std::size_t row = 0; row < dependent.node.size(); ++row)
    {
      double *const moved = node(dependent.node[row]);
      for (std::size_t k = dependent.start[row]; k < dependent.start[row + 1]; ++k)
        for (unsigned int c = 0; c < slots; ++c)
          node(dependent.weights[k].first)[c] += dependent.weights[k].second * moved[c];
      std::fill_n(moved, slots, 0.);
    }
    add_to_owners();
  }

  void NodalVector::make_symmetric()
  {
    if (!turns(kind))
      return;
    for (const NodePartition::Reflected &on_plane : node_partition->nodes_on_planes())
    {
      double *const value = node(on_plane.source);
      for (unsigned int c = 0; c < node_stride; ++c)
        if (on_plane.reflection.sign[c] < 0.)
          value[c] = kind == Quantity::position ? 0.5 * on_plane.reflection.offset[c] : 0.;
    }
  }

  void NodalVector::fill_images()
  {
    const bool is_even = !turns(kind);
    const double shift = kind == Quantity::position ? 1. : 0.;
    double *image =
        values + std::size_t(node_partition->n_owned() + node_partition->n_ghosts()) * slots;
    for (const NodePartition::Reflected &of : node_partition->images())
    {
      const double *const source = node(of.source);
      for (unsigned int c = 0; c < slots; ++c)
        image[c] = is_even ? source[c]
                           : of.reflection.sign[c] * source[c] + shift * of.reflection.offset[c];
      image += slots;
    }
  }

  void NodalVector::collect_images()
  {
    Assert(kind != Quantity::position || node_partition->n_images() == 0, ExcInternalError());
    const bool is_even = !turns(kind);
    double *image =
        values + std::size_t(node_partition->n_owned() + node_partition->n_ghosts()) * slots;
    for (const NodePartition::Reflected &of : node_partition->images())
    {
      double *const source = node(of.source);
      for (unsigned int c = 0; c < slots; ++c)
      {
        source[c] += is_even ? image[c] : of.reflection.sign[c] * image[c];
        image[c] = 0.;
      }
      image += slots;
    }
  }

  double NodalVector::dot(const NodalVector &other) const
  {
    double sum = 0;
    const std::size_t n = static_cast<std::size_t>(node_partition->n_owned()) * slots;
    for (std::size_t i = 0; i < n; ++i)
      sum += values[i] * other.values[i];
    return ordered_sum(sum, node_partition->communicator());
  }

  std::vector<unsigned int> positive_nodes(const NodalVector &scalar, const unsigned int n)
  {
    std::vector<unsigned int> nodes;
    for (unsigned int i = 0; i < n; ++i)
      if (*scalar.node(i) > 0.)
        nodes.push_back(i);
    return nodes;
  }

  NodalVector difference(const NodalVector &a, const NodalVector &b)
  {
    const bool are_positions = a.quantity() == Quantity::position;
    NodalVector result(a.partition(), are_positions ? Quantity::vector : a.quantity());
    result.fill(
        [&](const unsigned int i, double *const value)
        {
          for (unsigned int c = 0; c < result.n_slots_per_node(); ++c)
            value[c] = a.node(i)[c] - b.node(i)[c];
        });
    return result;
  }
} // namespace tombolo
