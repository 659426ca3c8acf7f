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

    /** Σ max(σ_p, 0) e_p ⊗ e_p of the stress in the plane of the kernel. Returns whether there is
     * tension. */
    template <int dim>
    bool find_tensile_part(const double *const (&stress)[6], const unsigned int point,
                           double (&tensile)[dim][dim])
    {
      constexpr unsigned int component[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
      SymmetricTensor<2, dim> sigma;
      double bound = 0;
      for (unsigned int a = 0; a < dim; ++a)
      {
        double row = stress[a][point];
        for (unsigned int b = 0; b < dim; ++b)
        {
          sigma[a][b] = stress[component[a][b]][point];
          row += a == b ? 0. : std::abs(sigma[a][b]);
        }
        bound = std::max(bound, row);
      }
      if (!(bound > 0.))
        return false;
      bool is_tensile = false;
      SymmetricTensor<2, dim> sum;
      for (const auto &[value, direction] :
           eigenvectors(sigma, SymmetricTensorEigenvectorMethod::jacobi))
        if (value > 0.)
        {
          is_tensile = true;
          sum += value * symmetrize(outer_product(direction, direction));
        }
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          tensile[a][b] = sum[a][b];
      return is_tensile;
    }

    /** For all pairs of a row: set_action(pairs, action) sets what acts on the neighbours, which is
     * added to @p target, and the opposite to the particle. */
    template <int dim, typename SetAction>
    TOMBOLO_ALWAYS_INLINE void add_actions(const PairRows &rows, const unsigned int row,
                                           const double *position, double *target,
                                           const SetAction &set_action)
    {
      Lanes action[dim], sum[dim] = {};
      for_pairs_of_row<dim>(rows, row, position,
                            [&](const RowPairs<dim> &pairs)
                            {
                              set_action(pairs, action);
                              for (unsigned int d = 0; d < dim; ++d)
                                sum[d] += action[d];
                              add_to_nodes(action, pairs.node, pairs.n, target);
                            });
      double *const own = target + std::size_t(rows.shape->particle_node[row]) * node_stride;
      for (unsigned int d = 0; d < dim; ++d)
        own[d] -= sum_of_lanes(sum[d]);
    }

    /** The values of a field at neighbours less those of the particle of the row. */
    template <int dim>
    TOMBOLO_ALWAYS_INLINE void find_differences(const double *field, const RowPairs<dim> &pairs,
                                                const Lanes (&own)[dim], Lanes (&result)[dim])
    {
      gather_nodes(field, pairs.node, result);
      for (unsigned int d = 0; d < dim; ++d)
        result[d] -= own[d];
    }
  } // namespace

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
  void PairTerms<dim>::add_viscous_force(const PairRows &rows, const double *position,
                                         const double *velocity, double *force, double *power) const
  {
    const double h = smoothing_length, least = 0.01 * h * h, alpha_c = linear * wave_speed;
    Lanes own_velocity[dim], other_velocity[dim];
    const Stencils &shape = *rows.shape;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const double half_mass = 0.5 * inertia_ratio * shape.mass[row];
      spread_node(velocity, shape.particle_node[row], own_velocity);
      Lanes taken = 0.;
      add_actions<dim>(rows, row, position, force,
                       [&](const RowPairs<dim> &pairs, Lanes(&action)[dim])
                       {
                         find_differences(velocity, pairs, own_velocity, other_velocity);
                         const Lanes approach = min(pairs.along_offset(other_velocity), Lanes(0.));
                         const Lanes mu = h * approach / (pairs.squared + least);
                         const Lanes strength =
                             half_mass * pairs.weight * (mu * (quadratic * mu - alpha_c));
                         for (unsigned int d = 0; d < dim; ++d)
                           action[d] = strength * pairs.offset[d];
                         taken -= strength * approach;
                       });
      power[row] += sum_of_lanes(taken);
    }
  }

  template <int dim>
  void PairTerms<dim>::apply_viscosity(const PairRows &rows, const double *position,
                                       const double *velocity, const double *direction,
                                       const double factor, double *force) const
  {
    const double h = smoothing_length, least = 0.01 * h * h, alpha_c = linear * wave_speed;
    Lanes own_velocity[dim], own_direction[dim], other[dim];
    const Stencils &shape = *rows.shape;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const double scale = 0.5 * inertia_ratio * shape.mass[row] * factor * h;
      spread_node(velocity, shape.particle_node[row], own_velocity);
      spread_node(direction, shape.particle_node[row], own_direction);
      add_actions<dim>(rows, row, position, force,
                       [&](const RowPairs<dim> &pairs, Lanes(&action)[dim])
                       {
                         find_differences(velocity, pairs, own_velocity, other);
                         const Lanes distance = pairs.squared + least;
                         const Lanes mu = h * min(pairs.along_offset(other), Lanes(0.)) / distance;
                         find_differences(direction, pairs, own_direction, other);
                         const Lanes strength = scale * pairs.weight *
                                                (alpha_c - 2. * quadratic * mu) *
                                                pairs.along_offset(other) / distance;
                         for (unsigned int d = 0; d < dim; ++d)
                           action[d] = strength * pairs.offset[d];
                       });
    }
  }

  template <int dim>
  void PairTerms<dim>::add_artificial_stress(const PairRows &rows, const MaterialPoints &points,
                                             const double *position, double *force) const
  {
    const double *stress[6];
    for (unsigned int c = 0; c < 6; ++c)
      stress[c] = points.component(MaterialPoints::stress, c);
    double tensile[dim][dim];
    for (unsigned int row = 0; row < rows.shape->n_particles(); ++row)
    {
      if (!find_tensile_part<dim>(stress, row, tensile))
        continue;
      const double scale = stress_factor * rows.volume[row];
      add_actions<dim>(rows, row, position, force,
                       [&](const RowPairs<dim> &pairs, Lanes(&action)[dim])
                       {
                         const Lanes strength =
                             scale * stress_weight(pairs.distance) * pairs.weight;
                         for (unsigned int a = 0; a < dim; ++a)
                         {
                           Lanes traction = tensile[a][0] * pairs.offset[0];
                           for (unsigned int b = 1; b < dim; ++b)
                             traction += tensile[a][b] * pairs.offset[b];
                           action[a] = strength * traction;
                         }
                       });
    }
  }

  template <int dim>
  void PairTerms<dim>::add_exchanged_momentum(const PairRows &rows, const double *position,
                                              const double *velocity, double *momentum) const
  {
    Lanes own_velocity[dim];
    const Stencils &shape = *rows.shape;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const double scale = 0.5 * xsph_factor * shape.mass[row];
      spread_node(velocity, shape.particle_node[row], own_velocity);
      add_actions<dim>(rows, row, position, momentum,
                       [&](const RowPairs<dim> &pairs, Lanes(&action)[dim])
                       {
                         const Lanes strength = scale * pairs.of_row * pairs.other_volume *
                                                kernel_value(pairs.distance);
                         gather_nodes(velocity, pairs.node, action);
                         for (unsigned int d = 0; d < dim; ++d)
                           action[d] = strength * (own_velocity[d] - action[d]);
                       });
    }
  }

  template class PairTerms<2>;
  template class PairTerms<3>;
} // namespace tombolo
