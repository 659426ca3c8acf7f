// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/trace_transfer.h>

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
  const NodalVector &TraceTransfer::field_of_particles(const NodalVector &velocity)
  {
    if (trace_velocity.partition() != velocity.partition())
      trace_velocity.reinit_like(velocity);
    trace_velocity.copy_from(velocity);
    for (const MassSplit::ParticlePart &part : split.parts)
      for (const unsigned int row : part.element_rows)
      {
        const Stencils &shape = *part.shape;
        const NodeLanes sum = NodalSmoothing::gather_row(shape.row(row), velocity.data());
        // A prescribed component keeps its own value.
        const NodeLanes weight =
            load_node(part.smoothed_fraction.data() + std::size_t(row) * node_stride);
        double *const target = trace_velocity.node(shape.particle_node[row]);
        store_node(load_node(target) +
                       weight * (sum - load_node(velocity.node(shape.particle_node[row]))),
                   target);
      }
    trace_velocity.distribute();
    return trace_velocity;
  }

  void TraceTransfer::add_element_force(NodalVector &element_force, NodalVector &force)
  {
    element_force.collect();
    if (trace_force.partition() != force.partition())
      trace_force.reinit_like(force);
    trace_force.set_zero();
    for (const MassSplit::ParticlePart &part : split.parts)
      for (const unsigned int row : part.element_rows)
      {
        const Stencils &shape = *part.shape;
        double *const own = element_force.node(shape.particle_node[row]);
        const NodeLanes moved = load_node(own) * load_node(part.smoothed_fraction.data() +
                                                           std::size_t(row) * node_stride);
        NodalSmoothing::scatter_row(shape.row(row), moved, trace_force.data());
        double *const remaining = trace_force.node(shape.particle_node[row]);
        store_node(load_node(remaining) - moved, remaining);
      }
    trace_force.add_to_owners();
    const unsigned int n_owned = force.partition()->n_owned();
    for (unsigned int i = 0; i < n_owned; ++i)
      store_node(load_node(force.node(i)) + load_node(element_force.node(i)) +
                     load_node(trace_force.node(i)),
                 force.node(i));
  }
} // namespace tombolo
