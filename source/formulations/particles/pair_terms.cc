// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/pair_interactions.h>

#include <tombolo/base/input/entries.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    const char *const viscosity_entry = "Artificial viscosity";
    const char *const stress_entry = "Artificial stress";
    const char *const xsph_entry = "XSPH";

    /** Σ max(σ_p, 0) e_p ⊗ e_p of the stress in the plane of the kernel. */
    template <int dim>
    SymmetricTensor<2, dim> tensile_part(const SymmetricTensor<2, dim> &sigma)
    {
      double bound = 0;
      for (unsigned int a = 0; a < dim; ++a)
      {
        double row = sigma[a][a];
        for (unsigned int b = 0; b < dim; ++b)
          row += a == b ? 0. : std::abs(sigma[a][b]);
        bound = std::max(bound, row);
      }
      SymmetricTensor<2, dim> sum;
      if (!(bound > 0.))
        return sum;
      if constexpr (dim == 2)
      {
        const double mean = 0.5 * (sigma[0][0] + sigma[1][1]);
        const double half = 0.5 * (sigma[0][0] - sigma[1][1]);
        const double radius = std::sqrt(half * half + sigma[0][1] * sigma[0][1]);
        if (mean >= radius)
          return sigma;
        if (mean + radius > 0.)
          sum = (mean + radius) / (2. * radius) *
                (sigma - (mean - radius) * unit_symmetric_tensor<dim>());
      }
      else
        for (const auto &[value, direction] :
             eigenvectors(sigma, SymmetricTensorEigenvectorMethod::jacobi))
          if (value > 0.)
            sum += value * symmetrize(outer_product(direction, direction));
      return sum;
    }

    /** T · a of symmetric T with the components of PairTerms::tensile, as Lanes. */
    TOMBOLO_ALWAYS_INLINE void multiply_packed(const Lanes (&t)[3], const Lanes (&a)[2],
                                               Lanes (&result)[2])
    {
      result[0] = t[0] * a[0] + t[2] * a[1];
      result[1] = t[2] * a[0] + t[1] * a[1];
    }

    TOMBOLO_ALWAYS_INLINE void multiply_packed(const Lanes (&t)[6], const Lanes (&a)[3],
                                               Lanes (&result)[3])
    {
      result[0] = t[0] * a[0] + t[5] * a[1] + t[4] * a[2];
      result[1] = t[5] * a[0] + t[1] * a[1] + t[3] * a[2];
      result[2] = t[4] * a[0] + t[3] * a[1] + t[2] * a[2];
    }

    /** Adds the action on the neighbours to @p target, and to @p sum. */
    template <int dim>
    TOMBOLO_ALWAYS_INLINE void act(const Lanes (&action)[dim], const unsigned int *node,
                                   const unsigned int n, Lanes (&sum)[dim], double *target)
    {
      for (unsigned int d = 0; d < dim; ++d)
        sum[d] += action[d];
      add_to_nodes(action, node, n, target);
    }

    /** Adds the opposite of the action on its neighbours to a particle. */
    template <int dim>
    TOMBOLO_ALWAYS_INLINE void act_back(const Lanes (&sum)[dim], const unsigned int particle,
                                        double *target)
    {
      for (unsigned int d = 0; d < dim; ++d)
        target[std::size_t(particle) * node_stride + d] -= reduce(sum[d]);
    }

    /** The values of a field at neighbours less those of the particle of the row. */
    template <int dim>
    TOMBOLO_ALWAYS_INLINE void find_differences(const double *field, const unsigned int *node,
                                                const Lanes (&own)[dim], Lanes (&result)[dim])
    {
      gather_nodes(field, node, result);
      for (unsigned int d = 0; d < dim; ++d)
        result[d] -= own[d];
    }
  } // namespace

  template <int dim>
  void PairDampers<dim>::apply(const double *direction, const double factor, double *force) const
  {
    Lanes own[dim], difference[dim], e[dim];
    for (std::size_t row = 0; row < particle.size(); ++row)
    {
      spread_node(direction, particle[row], own);
      Lanes sum[dim] = {};
      for (std::size_t k = start[row]; k < start[row + 1]; k += n_lanes)
      {
        find_differences(direction, &node[k], own, difference);
        Lanes strength = 0.;
        for (unsigned int d = 0; d < dim; ++d)
        {
          e[d] = load_lanes(&way[d][k]);
          strength += e[d] * difference[d];
        }
        for (unsigned int d = 0; d < dim; ++d)
          e[d] *= factor * strength;
        act(e, &node[k], n_lanes, sum, force);
      }
      act_back(sum, particle[row], force);
    }
  }

  template class PairDampers<2>;
  template class PairDampers<3>;

  template <int dim>
  PairTerms<dim>::PairTerms(const Entries &e)
  {
    if (e.when(e.flag(viscosity_entry, "false",
                      "Pairs that approach each other are braked along the line that joins them: "
                      "the artificial viscosity of Monaghan. It damps what alternates from "
                      "particle to particle, and shocks.")))
    {
      linear = e.number("Artificial viscosity alpha", "1", from_to(0., 10.), "1",
                        "Its linear coefficient, of the speed of P waves. The part of it that "
                        "resists shear grows with the speed of the run: 0.2 suits cutting.");
      quadratic = e.number("Artificial viscosity beta", "1", from_to(0., 10.), "1",
                           "Its quadratic coefficient, for shocks.");
      e.refuse(!has_viscosity(), viscosity_entry,
               "both coefficients are zero; allowed is `false`, or one above zero.");
    }
    if (e.when(e.flag(stress_entry, "false",
                      "Pairs nearer than the spacing repel each other where the material is under "
                      "tension, so that it does not clump (Gray, Monaghan, Swift 2001). Only for "
                      "kernels in the current configuration, which need it.")))
    {
      e.refuse(e.given("Configuration") != "current", stress_entry,
               "particles do not clump under tension where the kernel keeps their neighbours of a "
               "reference; allowed is `true` only with `Configuration = current`.");
      stress_factor =
          e.number("Artificial stress factor", "0.3", from_to(0., 1.), "1",
                   "The share of the tensile stress that is taken back at the spacing.");
      stress_exponent = e.number("Artificial stress exponent", "4", from_to(0., 100.), "1",
                                 "n of (W/W(spacing))^n, by which it ends with the distance.");
    }
    if (e.when(e.flag(xsph_entry, "false",
                      "Positions, and nothing else, move with velocities that are a mean over the "
                      "neighbours, which keeps particles in order.")))
      xsph_factor = e.number("XSPH factor", "0.5", from_to(0., 1.), "1",
                             "The weight of the neighbours in this mean.");
  }

  template <int dim>
  void PairTerms<dim>::initialize(const Material &material,
                                  const std::function<double(double)> &kernel, const double radius,
                                  const double length, const double spacing)
  {
    smoothing_length = length;
    wave_speed = material.longitudinal_wave_speed();
    inertia_ratio = material.inertial_density() / material.density();
    if (has_artificial_stress())
    {
      const double at_spacing = kernel(spacing);
      const double exponent = stress_exponent;
      stress_weight =
          RadialTable(radius, [&](const double distance)
                      { return std::pow(std::max(kernel(distance), 0.) / at_spacing, exponent); });
    }
    if (has_xsph())
      kernel_value = RadialTable(radius, kernel);
  }

  template <int dim>
  bool PairTerms<dim>::find_tensile_parts(const PairRows &rows, const MaterialPoints &points) const
  {
    constexpr unsigned int component[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    const double *stress[6];
    for (unsigned int c = 0; c < 6; ++c)
      stress[c] = points.component(MaterialPoints::stress, c);
    for (auto &values : tensile)
    {
      values.resize_fast(rows.n_nodes * node_stride);
      values.fill(0.);
    }
    bool is_tensile = false;
    for (unsigned int row = 0; row < rows.shape->n_particles(); ++row)
    {
      SymmetricTensor<2, dim> sigma;
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b <= a; ++b)
          sigma[a][b] = stress[component[a][b]][row];
      const SymmetricTensor<2, dim> part =
          stress_factor * rows.volume_ratio(row) * tensile_part(sigma);
      is_tensile = is_tensile || trace(part) > 0.;
      const std::size_t slot = std::size_t(rows.shape->particle_node[row]) * node_stride;
      for (unsigned int a = 0; a < dim; ++a)
      {
        tensile[0][slot + a] = part[a][a];
        tensile[dim - 2][slot + (dim == 2 ? 2 : a)] = part[(a + 1) % dim][(a + 2) % dim];
      }
    }
    return is_tensile;
  }

  template <int dim>
  void PairTerms<dim>::add_forces(const PairRows &rows, const MaterialPoints &points,
                                  const double *position, const double *velocity,
                                  double *viscous_force, double *power, double *stress_force) const
  {
    constexpr unsigned int n_of_tensor = SymmetricTensor<2, dim>::n_independent_components;
    const bool is_tensile = has_artificial_stress() && find_tensile_parts(rows, points);
    if (!has_viscosity() && !is_tensile)
      return;
    const double h = smoothing_length, least = 0.01 * h * h, alpha_c = linear * wave_speed;
    const auto gather_tensile = [&](const unsigned int *node, Lanes(&result)[n_of_tensor])
    {
      Lanes part[3];
      for (unsigned int k = 0; k < n_of_tensor; k += 3)
      {
        gather_nodes(tensile[k / 3].data(), node, part);
        std::copy_n(part, 3, result + k);
      }
    };
    const Stencils &shape = *rows.shape;
    Lanes own_velocity[dim], other_velocity[dim], own_tensor[n_of_tensor] = {}, tensor[n_of_tensor];
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const unsigned int particle = shape.particle_node[row];
      const double half_density = 0.5 * inertia_ratio * shape.mass[row] / rows.initial_volume[row];
      spread_node(velocity, particle, own_velocity);
      for (unsigned int k = 0; is_tensile && k < n_of_tensor; ++k)
        own_tensor[k] = tensile[k / 3][std::size_t(particle) * node_stride + k % 3];
      Lanes action[dim], viscous[dim] = {}, stress_action[dim] = {}, dissipated_power = 0.;
      for_pairs_of_row<dim>(
          rows, row, position,
          [&](const RowPairs<dim> &pairs) TOMBOLO_INLINE_LAMBDA
          {
            if (has_viscosity())
            {
              find_differences(velocity, pairs.node, own_velocity, other_velocity);
              const Lanes approach = min(pairs.along_offset(other_velocity), Lanes(0.));
              const Lanes mu = h * approach / (pairs.squared + least);
              const Lanes strength = half_density * (mu * (quadratic * mu - alpha_c));
              const Lanes both_sides = strength * (pairs.row_slope + pairs.other_slope);
              for (unsigned int d = 0; d < dim; ++d)
                action[d] = both_sides * pairs.offset[d];
              act(action, pairs.node, pairs.n, viscous, viscous_force);
              if (power != nullptr)
              {
                dissipated_power -= strength * pairs.row_slope * approach;
                const Lanes other_power = strength * pairs.other_slope * approach;
                for (unsigned int lane = 0; lane < pairs.n; ++lane)
                  power[pairs.node[lane]] -= other_power[lane];
              }
            }
            if (!is_tensile)
              return;
            gather_tensile(pairs.node, tensor);
            Lanes size = 0.;
            for (unsigned int k = 0; k < n_of_tensor; ++k)
            {
              tensor[k] = tensor[k] * pairs.other_slope + own_tensor[k] * pairs.row_slope;
              size += k < dim ? tensor[k] : Lanes(0.);
            }
            if (none_of(size > 0.))
              return;
            multiply_packed(tensor, pairs.offset, action);
            const Lanes weight = stress_weight(pairs.distance);
            for (unsigned int d = 0; d < dim; ++d)
              action[d] *= weight;
            act(action, pairs.node, pairs.n, stress_action, stress_force);
          });
      if (has_viscosity())
        act_back(viscous, particle, viscous_force);
      if (is_tensile)
        act_back(stress_action, particle, stress_force);
      if (power != nullptr)
        power[particle] += reduce(dissipated_power);
    }
  }

  template <int dim>
  void PairTerms<dim>::linearize_viscosity(const PairRows &rows, const double *position,
                                           const double *velocity, PairDampers<dim> &dampers) const
  {
    const double h = smoothing_length, least = 0.01 * h * h, alpha_c = linear * wave_speed;
    const Stencils &shape = *rows.shape;
    dampers.particle = shape.particle_node;
    dampers.start.assign(1, 0);
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
      dampers.start.push_back(dampers.start.back() +
                              padded_to_lanes(static_cast<unsigned int>(shape.row_start[row + 1] -
                                                                        rows.own_entry[row] - 1)));
    dampers.node.resize(dampers.start.back());
    for (auto &component : dampers.way)
      component.resize_fast(dampers.start.back());
    Lanes own_velocity[dim], other[dim];
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const double scale = 0.5 * inertia_ratio * h * shape.mass[row] / rows.initial_volume[row];
      spread_node(velocity, shape.particle_node[row], own_velocity);
      std::size_t entry = dampers.start[row];
      for_pairs_of_row<dim>(rows, row, position,
                            [&](const RowPairs<dim> &pairs) TOMBOLO_INLINE_LAMBDA
                            {
                              find_differences(velocity, pairs.node, own_velocity, other);
                              const Lanes distance = pairs.squared + least;
                              const Lanes mu =
                                  h * min(pairs.along_offset(other), Lanes(0.)) / distance;
                              const Lanes strength =
                                  square_root(scale * (pairs.row_slope + pairs.other_slope) *
                                              (alpha_c - 2. * quadratic * mu) / distance);
                              std::copy_n(pairs.node, n_lanes, &dampers.node[entry]);
                              for (unsigned int d = 0; d < dim; ++d)
                                store_lanes(strength * pairs.offset[d], &dampers.way[d][entry]);
                              entry += n_lanes;
                            });
    }
  }

  template <int dim>
  void PairTerms<dim>::add_exchanged_momentum(const PairRows &rows, const double *position,
                                              const double *velocity, double *momentum) const
  {
    Lanes own_velocity[dim], action[dim];
    const Stencils &shape = *rows.shape;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const double scale = -0.5 * xsph_factor * shape.mass[row] / rows.initial_volume[row];
      spread_node(velocity, shape.particle_node[row], own_velocity);
      Lanes sum[dim] = {};
      for_pairs_of_row<dim>(rows, row, position,
                            [&](const RowPairs<dim> &pairs) TOMBOLO_INLINE_LAMBDA
                            {
                              const Lanes strength =
                                  scale * pairs.volumes * kernel_value(pairs.distance);
                              find_differences(velocity, pairs.node, own_velocity, action);
                              for (unsigned int d = 0; d < dim; ++d)
                                action[d] *= strength;
                              act(action, pairs.node, pairs.n, sum, momentum);
                            });
      act_back(sum, shape.particle_node[row], momentum);
    }
  }

  template class PairTerms<2>;
  template class PairTerms<3>;
} // namespace tombolo
