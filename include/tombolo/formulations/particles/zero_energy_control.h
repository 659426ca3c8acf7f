// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/fetch_ahead.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/row_block.h>
#include <tombolo/materials/kinematics.h>
#include <tombolo/materials/material.h>
#include <tombolo/state/material_points.h>

#include <cmath>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * A stiffness of what alternates from node to node, to which nodal gradients are nearly
   * insensitive. The residual of a particle is what φ makes of the positions less its own, zero for
   * any affine motion, and has the energy of a spring:
   *
   * @verbatim
   *   r_I = Σ_J φ_J(x_I) x_J - x_I,   E = Σ_I ½ k_I |r_I - s_I|²,   k_I = 16 c G V_I / h_I²
   * @endverbatim
   *
   * with the shear modulus G and the square h² of the length of the edges of cells around the
   * particle, in the mean. Where the particle flows, what is above the energy l V σ²/(6 G), with
   * the equivalent stress σ, the larger of those at the ends of the step, decays with the plastic
   * strain of the step over σ/(10 G): it goes to the slip s_I, which turns with the particle, and
   * the loss is artificial. The energy thus depends on the spin, too: to it belongs the couple
   * -s_I x k_I (r_I - s_I), without which the forces would change the angular momentum.
   */
  class ZeroEnergyControl
  {
  public:
    ZeroEnergyControl() = default;
    explicit ZeroEnergyControl(const Entries &e)
        : coefficient(e.number(
              "Zero-energy stiffness", "0.9", between(0., 4.), "1",
              "With `Dilatation = of cells`: the stiffness of what alternates from node to "
              "node, in shear moduli; 0: none.")),
          limit(e.number("Zero-energy limit", "0.001", between(0., 1.), "1",
                         "Its largest energy where material flows, in elastic energies of the "
                         "deviator at the flow stress."))
    {}

    /** The first entry that has not its default; empty: all have. */
    std::string changed_entry() const
    {
      return coefficient != default_coefficient ? "Zero-energy stiffness"
             : limit != default_limit           ? "Zero-energy limit"
                                                : "";
    }

    bool is_requested() const
    {
      return coefficient > 0.;
    }
    /** Whether reset() and set_material() have set a stiffness, on some rank. */
    bool is_on() const
    {
      return is_requested() && shear_modulus > 0. && has_particles;
    }

    /** Of particles with these V_I [L^dim] and h_I² [L^2]. */
    void reset(const std::vector<double> &volumes, const std::vector<double> &squared_lengths)
    {
      has_particles = true;
      volume = volumes;
      volume.resize(padded_to_lanes(static_cast<unsigned int>(volumes.size())), 0.);
      squared_length = squared_lengths;
      squared_length.resize(volume.size(), 1.);
    }
    void set_material(const Material &material)
    {
      shear_modulus = material.shear_modulus();
      factor = 16. * coefficient * shear_modulus;
      can_flow = material.remembers("effective plastic strain");
    }

    /** The fields that points need; none if off. */
    std::vector<FieldDescription> variables() const
    {
      if (!is_on())
        return {};
      const FieldLocation point = FieldLocation::material_point;
      std::vector<FieldDescription> fields = {{energy_name, "M/(L T^2)", point, 1, true, 0., true}};
      if (can_flow)
      {
        fields.push_back({slip_name, "L", point, 3, true, 0., true});
        fields.push_back({loss_name, "M/(L T^2)", point, 1, true, 0., true});
      }
      return fields;
    }
    void initialize(const MaterialPoints &points)
    {
      energy_field = points.find_field(energy_name);
      if (!can_flow)
        return;
      slip_field = points.find_field(slip_name);
      loss_field = points.find_field(loss_name);
      strain_field = points.find_field("effective plastic strain");
    }

    /** Stores the plastic strains and stresses of the particles @p first, a multiple of n_lanes,
     * to @p last - 1 before the step. */
    void begin(const MaterialPoints &points, const unsigned int first, const unsigned int last)
    {
      if (!can_flow)
        return;
      const double *const strain = points.component(strain_field, 0) + first;
      const unsigned int n = padded_to_lanes(last - first);
      strain_before.assign(strain, strain + n);
      squared_stress_before.resize(n);
      for (unsigned int p = 0; p < n; p += n_lanes)
        store_lanes(squared_equivalent_stress(points, first + p), &squared_stress_before[p]);
    }
    /** Advances their slip, with the spins of the step by component and particle, and turns their
     * r_I, node_stride doubles each, into k_I (r_I - s_I). Returns whether there are slips, for
     * which it sets the @p couples s_I x k_I (r_I - s_I) by component and particle [M L^2/T^2]. */
    bool advance(MaterialPoints &points, const unsigned int first, const unsigned int last,
                 const double *const spin[3], double *const residuals,
                 double *const couples[3]) const
    {
      bool has_slips = false;
      double *const energy_density = points.component(energy_field, 0) + first;
      for (unsigned int p = 0; p < last - first; p += n_lanes)
      {
        NodeLanes node_residuals[n_lanes];
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          node_residuals[lane] = first + p + lane < last
                                     ? load_node(residuals + node_stride * (p + lane))
                                     : NodeLanes(0.);
        Lanes elastic[3], slip[3] = {0., 0., 0.};
        nodes_to_lanes(node_residuals, elastic);
        const Lanes area = load_lanes(&squared_length[first + p]);
        const Lanes modulus = factor / area;
        if (can_flow)
          has_slips = apply_slip(points, first, p, spin, elastic, slip) || has_slips;
        store_lanes(
            0.5 * modulus *
                (elastic[0] * elastic[0] + elastic[1] * elastic[1] + elastic[2] * elastic[2]),
            energy_density + p);
        for (Lanes &component : elastic)
          component *= modulus * load_lanes(&volume[first + p]);
        for (unsigned int d = 0; can_flow && d < 3; ++d)
        {
          const unsigned int e = (d + 1) % 3, f = (d + 2) % 3;
          store_lanes(slip[e] * elastic[f] - slip[f] * elastic[e], couples[d] + p);
        }
        lanes_to_nodes(elastic, node_residuals);
        for (unsigned int lane = 0; lane < n_lanes && first + p + lane < last; ++lane)
          store_node(node_residuals[lane], residuals + node_stride * (p + lane));
      }
      return has_slips;
    }

    /** Adds to the stress times the volume of n_lanes particles from @p p on what has the power of
     * their couples with the opposite of the spin. */
    TOMBOLO_ALWAYS_INLINE static void add_couples(const double *const couples[3],
                                                  const unsigned int p, Matrix3<Lanes> &stress)
    {
      for (unsigned int d = 0; d < 3; ++d)
      {
        const unsigned int e = (d + 1) % 3, f = (d + 2) % 3;
        const Lanes half = 0.5 * load_lanes(couples[d] + p);
        stress(e, f) += half;
        stress(f, e) -= half;
      }
    }

    /** Turns residuals of velocities of the particles @p first to @p last - 1 into the opposite of
     * their forces, which scatter_force() subtracts. */
    void multiply_by_stiffness(const unsigned int first, const unsigned int last,
                               double *const residuals) const
    {
      for (unsigned int i = first; i < last; ++i)
      {
        double *const at = residuals + std::size_t(i - first) * node_stride;
        store_node(-stiffness(i) * load_node(at), at);
      }
    }

    /** Adds K v to @p force. */
    void apply_stiffness(const Stencils &shape, const NodalVector &velocity,
                         NodalVector &force) const
    {
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
      {
        fetch_ahead(shape, i, velocity.data(), force.data());
        const Stencils::Row row = shape.row_of_values(i);
        const unsigned int own = shape.particle_node[i];
        scatter(row, own, stiffness(i) * residual(row, own, velocity), force);
      }
    }

    /** Adds the terms of the residual to the equations of the row of @p particle, in the block from
     * @p first on, with a secant of what is limited and the slip before the step. */
    void add_tangent(const Stencils &shape, const MaterialPoints &points, const unsigned int first,
                     const unsigned int particle, const NodalVector &position,
                     CellEquations &equations) const
    {
      const Stencils::Row row = shape.row_of_values(particle);
      const unsigned int own = shape.particle_node[particle];
      NodeLanes elastic = residual(row, own, position);
      double squared = 0;
      for (unsigned int d = 0; d < 3; ++d)
      {
        if (can_flow)
          elastic[d] -= points.component(slip_field, d)[particle];
        squared += elastic[d] * elastic[d];
      }
      // D = a (I - e e) + b e e, with the direction e of r - s.
      double across = stiffness(particle), along = across;
      const double length = std::sqrt(squared);
      const Range range = elastic_range(points, first, 0);
      const double largest = range.length[particle - first];
      if (length > largest)
      {
        const double beyond = range.beyond[particle - first];
        across *= (largest + beyond * (length - largest)) / length;
        along *= beyond;
      }
      const std::size_t n_nodes = equations.nodes.size();
      const std::size_t dim = equations.force.size() / n_nodes;
      std::vector<double> weight(n_nodes, 0.);
      for (unsigned int n = 0; n < row.size; ++n)
      {
        weight[equations.index_of(row.neighbour[n])] += row.value[n];
        weight[equations.index_of(own)] -= row.value[n];
      }
      for (std::size_t a = 0; a < n_nodes; ++a)
        for (std::size_t d = 0; d < dim; ++d)
        {
          equations.force[dim * a + d] += across * weight[a] * elastic[d];
          for (std::size_t e = 0; e < dim; ++e)
          {
            const double derivative =
                (d == e ? across : 0.) +
                (length > largest ? (along - across) * elastic[d] * elastic[e] / squared : 0.);
            for (std::size_t b = 0; b < n_nodes; ++b)
              equations.matrix[(dim * a + d) * n_nodes * dim + dim * b + e] +=
                  derivative * weight[a] * weight[b];
          }
        }
    }

    void account(const MaterialPoints &points, EnergyAccounts &accounts) const
    {
      accounts.add("hourglass energy", EnergyKind::stored,
                   integral_over_initial_volume(points, energy_name));
      accounts.add("viscous dissipation", EnergyKind::artificial,
                   integral_over_initial_volume(points, loss_name));
    }

  private:
    static inline const std::string slip_name = "zero-energy slip";
    static inline const std::string energy_name = "zero-energy density";
    static inline const std::string loss_name = "zero-energy loss";

    static NodeLanes residual(const Stencils::Row &row, const unsigned int own,
                              const NodalVector &values)
    {
      const NodeLanes origin = load_node(values.node(own));
      NodeLanes sum = 0.;
      for (unsigned int k = 0; k < row.size; ++k)
        sum += row.value[k] * (load_node(values.node(row.neighbour[k])) - origin);
      return sum;
    }

    /** The square of von Mises' stress of n_lanes points from @p i on. */
    static Lanes squared_equivalent_stress(const MaterialPoints &points, const unsigned int i)
    {
      Lanes s[6];
      for (unsigned int c = 0; c < 6; ++c)
        s[c] = load_lanes(points.component(MaterialPoints::stress, c) + i);
      return 0.5 * ((s[0] - s[1]) * (s[0] - s[1]) + (s[1] - s[2]) * (s[1] - s[2]) +
                    (s[2] - s[0]) * (s[2] - s[0])) +
             3. * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
    }

    static void scatter(const Stencils::Row &row, const unsigned int own,
                        const NodeLanes &residual_force, NodalVector &force)
    {
      NodeLanes all = 0.;
      for (unsigned int k = 0; k < row.size; ++k)
      {
        const NodeLanes share = row.value[k] * residual_force;
        double *const at = force.node(row.neighbour[k]);
        store_node(load_node(at) + share, at);
        all += share;
      }
      double *const at = force.node(own);
      store_node(load_node(at) - all, at);
    }

    double stiffness(const unsigned int i) const
    {
      return factor * volume[i] / squared_length[i];
    }
    /** How far |r - s| of n_lanes particles can be elastic. */
    struct Range
    {
      Lanes length = 1e100; ///< [L]
      Lanes beyond = 1.;    ///< share of what is longer that stays
    };
    /** Of those from number @p p of the block from @p first on, after their stress is known. */
    Range elastic_range(const MaterialPoints &points, const unsigned int first,
                        const unsigned int p) const
    {
      Range result;
      if (!can_flow)
        return result;
      const Lanes flow =
          load_lanes(points.component(strain_field, 0) + first + p) - load_lanes(&strain_before[p]);
      if (none_of(flow > 0.))
        return result;
      // A yield surface that moves lets a particle flow while its stress passes zero.
      const Lanes stress = square_root(
          max(squared_equivalent_stress(points, first + p), load_lanes(&squared_stress_before[p])));
      where(flow > 0., result.length) =
          stress * square_root((limit / (3. * shear_modulus * factor)) *
                               load_lanes(&squared_length[first + p]));
      where(flow > 0., result.beyond) = stress / (stress + 10. * shear_modulus * flow);
      return result;
    }
    /** Turns the slip of these particles by @p spin, subtracts it from their residuals, and adds to
     * it what is beyond their range. Returns whether any slips. */
    bool apply_slip(MaterialPoints &points, const unsigned int first, const unsigned int p,
                    const double *const spin[3], Lanes (&elastic)[3], Lanes (&slip_values)[3]) const
    {
      double *slip[3];
      Lanes squared = 0.;
      for (unsigned int d = 0; d < 3; ++d)
      {
        slip[d] = points.component(slip_field, d) + first + p;
        slip_values[d] = load_lanes(slip[d]);
      }
      const bool has_slip =
          any_of(slip_values[0] != 0. || slip_values[1] != 0. || slip_values[2] != 0.);
      if (has_slip)
      {
        const Lanes step_spin[3] = {load_lanes(spin[0] + p), load_lanes(spin[1] + p),
                                    load_lanes(spin[2] + p)};
        const Matrix3<Lanes> turn = rotation_of(step_spin);
        const Lanes former[3] = {slip_values[0], slip_values[1], slip_values[2]};
        for (unsigned int d = 0; d < 3; ++d)
          slip_values[d] = turn(d, 0) * former[0] + turn(d, 1) * former[1] + turn(d, 2) * former[2];
      }
      for (unsigned int d = 0; d < 3; ++d)
      {
        elastic[d] -= slip_values[d];
        squared += elastic[d] * elastic[d];
      }
      const Range range = elastic_range(points, first, p);
      const LaneMask is_beyond = squared > range.length * range.length;
      if (any_of(is_beyond))
      {
        const Lanes length = square_root(squared);
        Lanes kept = length, share = 1.;
        where(is_beyond, kept) = range.length + range.beyond * (length - range.length);
        where(is_beyond, share) = kept / length;
        for (unsigned int d = 0; d < 3; ++d)
        {
          slip_values[d] += (1. - share) * elastic[d];
          elastic[d] *= share;
        }
        // Work is found from the mean of the forces at both ends of a step.
        const Lanes area = load_lanes(&squared_length[first + p]);
        const Lanes before = square_root(
            (2. / factor) * load_lanes(points.component(energy_field, 0) + first + p) * area);
        double *const loss = points.component(loss_field, 0) + first + p;
        store_lanes(load_lanes(loss) + 0.5 * factor / area * (before + kept) * (length - kept),
                    loss);
      }
      else if (!has_slip)
        return false;
      for (unsigned int d = 0; d < 3; ++d)
        store_lanes(slip_values[d], slip[d]);
      return true;
    }

    static constexpr double default_coefficient = 0.9, default_limit = 0.001;

    double coefficient = 0., limit = 0.;
    double shear_modulus = 0., factor = 0.;
    std::vector<double> volume, squared_length;
    unsigned int slip_field = 0, energy_field = 0, loss_field = 0, strain_field = 0;
    bool can_flow = false, has_particles = false;
    std::vector<double> strain_before, squared_stress_before; ///< of the block at hand
  };
} // namespace tombolo
