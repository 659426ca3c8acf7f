// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/force_work.h>

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/state/state_archive.h>

#include <numeric>

namespace tombolo
{
  void ForceWork::begin(const std::shared_ptr<const NodePartition> &partition)
  {
    if (force.partition() != partition)
      force.reinit(partition);
    else
      force.set_zero();
  }

  void ForceWork::add_to(NodalVector &total)
  {
    force.add_to_owners();
    for (unsigned int i = 0; i < force.partition()->n_owned(); ++i)
      store_node(load_node(total.node(i)) + load_node(force.node(i)), total.node(i));
  }

  void ForceWork::close(const NodalVector &velocity)
  {
    for (std::size_t i = 0; i < previous_impulse.size(); ++i)
      for (unsigned int d = 0; d < 3; ++d)
        work -= 0.5 * velocity.node(static_cast<unsigned int>(i))[d] * previous_impulse[i][d];
    previous_impulse.clear();
    first_half_is_counted = true;
  }

  void ForceWork::accumulate(const NodalVector &velocity, const Clock &clock)
  {
    const bool is_start = clock.step == 0;
    // Velocities are given at t_0, so that Δt_0 is half a step; as the beginning of the first
    // interval a force counts whole, like at any other.
    const double as_previous = is_start ? 2. : 1.;
    const bool has_history = !previous_impulse.empty() || first_half_is_counted;
    const bool has_previous = !previous_impulse.empty();
    const unsigned int n_owned = force.partition()->n_owned();
    previous_impulse.resize(n_owned, Vector{});
    for (unsigned int i = 0; i < n_owned; ++i)
      for (unsigned int d = 0; d < 3; ++d)
      {
        const double impulse = clock.velocity_step() * force.node(i)[d];
        const double before = has_previous ? previous_impulse[i][d] : has_history ? 0. : impulse;
        if (!is_start)
          work -= 0.5 * velocity.node(i)[d] * (impulse + before);
        previous_impulse[i][d] = as_previous * impulse;
      }
    first_half_is_counted = false;
  }

  std::size_t ForceWork::memory_consumption() const
  {
    return previous_impulse.capacity() * sizeof(Vector) + force.memory_consumption();
  }

  void ForceWork::serialize(const std::string &name, const NodePartition &partition,
                            StateArchive &archive)
  {
    archive.sums(name + " taken", {&work});
    std::vector<unsigned int> nodes(partition.n_owned());
    std::iota(nodes.begin(), nodes.end(), 0u);
    archive.nodal(name + " previous impulse", nodes, previous_impulse);
  }
} // namespace tombolo
