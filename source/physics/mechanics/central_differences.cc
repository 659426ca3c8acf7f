// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/central_differences.h>

#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
  namespace
  {
    /** target += factor · increment at owned nodes. */
    void add_scaled(const double factor, const NodalVector &increment, NodalVector &target)
    {
      for (unsigned int i = 0; i < target.partition()->n_owned(); ++i)
        store_node(load_node(target.node(i)) + load_node(increment.node(i)) * factor,
                   target.node(i));
    }
  } // namespace

  template <int dim>
  void CentralDifferences<dim>::advance(Model<dim> &model, const Clock &clock)
  {
    Bridge &bridge = *model.bridge;
    const NodalVector &v = model.state.velocity, &a = model.state.acceleration;
    NodalVector &v_hat = model.state.unsmoothed_velocity, &x = model.state.position;
    const double dt_n = clock.velocity_step(), dt = clock.next_step;
    switch (bridge.operators())
    {
    case Bridge::Operators::identity:
    case Bridge::Operators::interpolation:
      bridge.add_interpolated_motion(v, a, dt_n, dt, v_hat, x); // (22)-(25), (52)-(56)
      break;
    case Bridge::Operators::sharpened:
      if (rate.partition() != x.partition())
      {
        rate.reinit(x.partition());
        field.reinit(x.partition());
      }
      bridge.velocity_rate(model.state, dt_n, rate);
      add_scaled(dt_n, rate, v_hat); // (22), (55), (56)
      for (std::size_t i = 0; i < std::size_t(x.partition()->n_local()) * node_stride; ++i)
        field.data()[i] = v.data()[i] + dt_n * a.data()[i]; // (23)
      bridge.apply_interpolation(field, rate);
      add_scaled(dt, rate, x); // (24), (25), (52)-(54)
      break;
    case Bridge::Operators::affine: {
      const NodalVector &momentum = bridge.momentum_rate(model.state, dt_n);
      v_hat.fill(
          [&](const unsigned int i, double *const velocity)
          {
            const double mass = *bridge.mass().node(i);
            store_node(load_node(velocity) +
                           load_node(momentum.node(i)) * (mass > 0. ? dt_n / mass : 0.),
                       velocity);
          });
      bridge.move_with_smoothed_velocity(model.state, dt); // x = S x̂, (10)-(12)
    }
    }
    bridge.positions_have_changed();
    x.distribute();
    // The scatter of eq. (10) reads owned values only.
    if (bridge.operators() == Bridge::Operators::identity || x.partition()->has_dependent_nodes())
      v_hat.distribute();
    else if (bridge.operators() != Bridge::Operators::affine)
      v_hat.make_symmetric();
  }

  template class CentralDifferences<2>;
  template class CentralDifferences<3>;
} // namespace tombolo
