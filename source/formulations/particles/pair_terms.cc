// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/pair_terms.h>

#include <tombolo/base/input/entries.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

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

    /** Takes the sums of what row @p particle gave to its neighbours from its own value. */
    template <int dim>
    void subtract_from_own(const Lanes (&sum)[dim], const unsigned int particle, double *target)
    {
      double *const own = target + static_cast<std::size_t>(particle) * node_stride;
      for (unsigned int d = 0; d < dim; ++d)
        own[d] -= sum_of_lanes(sum[d]);
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
    Lanes own[dim], own_velocity[dim], other_velocity[dim], of_pair[dim];
    const Stencils &shape = *rows.shape;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const unsigned int particle = shape.particle_node[row];
      const double half_mass = 0.5 * inertia_ratio * shape.mass[row];
      const unsigned int n_neighbours = shape.row(row).size;
      spread_node(position, particle, own);
      spread_node(velocity, particle, own_velocity);
      Lanes sum[dim] = {}, taken = 0.;
      for (unsigned int first = 0; first < n_neighbours; first += n_lanes)
      {
        const RowPairs<dim> pairs(rows, row, first, particle, own, position);
        gather_nodes(velocity, pairs.node, other_velocity);
        for (unsigned int d = 0; d < dim; ++d)
          other_velocity[d] -= own_velocity[d];
        const Lanes approach = min(pairs.along_offset(other_velocity), Lanes(0.));
        const Lanes mu = h * approach / (pairs.squared + least);
        const Lanes strength = half_mass * pairs.weight * (mu * (quadratic * mu - alpha_c));
        for (unsigned int d = 0; d < dim; ++d)
        {
          of_pair[d] = strength * pairs.offset[d];
          sum[d] += of_pair[d];
        }
        taken -= strength * approach;
        add_to_nodes(of_pair, pairs.node, pairs.n, force);
      }
      subtract_from_own(sum, particle, force);
      power[row] += sum_of_lanes(taken);
    }
  }

  template <int dim>
  void PairTerms<dim>::apply_viscosity(const PairRows &rows, const double *position,
                                       const double *velocity, const double *direction,
                                       const double factor, double *force) const
  {
    const double h = smoothing_length, least = 0.01 * h * h, alpha_c = linear * wave_speed;
    Lanes own[dim], own_velocity[dim], own_direction[dim], other[dim], of_pair[dim];
    const Stencils &shape = *rows.shape;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const unsigned int particle = shape.particle_node[row];
      const double scale = 0.5 * inertia_ratio * shape.mass[row] * factor * h;
      const unsigned int n_neighbours = shape.row(row).size;
      spread_node(position, particle, own);
      spread_node(velocity, particle, own_velocity);
      spread_node(direction, particle, own_direction);
      Lanes sum[dim] = {};
      for (unsigned int first = 0; first < n_neighbours; first += n_lanes)
      {
        const RowPairs<dim> pairs(rows, row, first, particle, own, position);
        gather_nodes(velocity, pairs.node, other);
        for (unsigned int d = 0; d < dim; ++d)
          other[d] -= own_velocity[d];
        const Lanes distance = pairs.squared + least;
        const Lanes mu = h * min(pairs.along_offset(other), Lanes(0.)) / distance;
        gather_nodes(direction, pairs.node, other);
        for (unsigned int d = 0; d < dim; ++d)
          other[d] -= own_direction[d];
        const Lanes strength = scale * pairs.weight * (alpha_c - 2. * quadratic * mu) *
                               pairs.along_offset(other) / distance;
        for (unsigned int d = 0; d < dim; ++d)
        {
          of_pair[d] = strength * pairs.offset[d];
          sum[d] += of_pair[d];
        }
        add_to_nodes(of_pair, pairs.node, pairs.n, force);
      }
      subtract_from_own(sum, particle, force);
    }
  }

  template <int dim>
  void PairTerms<dim>::add_artificial_stress(const PairRows &rows, const MaterialPoints &points,
                                             const double *position, double *force) const
  {
    const double *stress[6];
    for (unsigned int c = 0; c < 6; ++c)
      stress[c] = points.component(MaterialPoints::stress, c);
    Lanes own[dim], of_pair[dim];
    double tensile[dim][dim];
    const Stencils &shape = *rows.shape;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      if (!find_tensile_part<dim>(stress, row, tensile))
        continue;
      const unsigned int particle = shape.particle_node[row];
      const double scale = stress_factor * rows.volume[row];
      const unsigned int n_neighbours = shape.row(row).size;
      spread_node(position, particle, own);
      Lanes sum[dim] = {};
      for (unsigned int first = 0; first < n_neighbours; first += n_lanes)
      {
        const RowPairs<dim> pairs(rows, row, first, particle, own, position);
        const Lanes strength = scale * stress_weight(pairs.distance) * pairs.weight;
        for (unsigned int a = 0; a < dim; ++a)
        {
          Lanes traction = tensile[a][0] * pairs.offset[0];
          for (unsigned int b = 1; b < dim; ++b)
            traction += tensile[a][b] * pairs.offset[b];
          of_pair[a] = strength * traction;
          sum[a] += of_pair[a];
        }
        add_to_nodes(of_pair, pairs.node, pairs.n, force);
      }
      subtract_from_own(sum, particle, force);
    }
  }

  template <int dim>
  void PairTerms<dim>::add_exchanged_momentum(const PairRows &rows, const double *position,
                                              const double *velocity, double *momentum) const
  {
    Lanes own[dim], own_velocity[dim], of_pair[dim];
    const Stencils &shape = *rows.shape;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const unsigned int particle = shape.particle_node[row];
      const double scale = 0.5 * xsph_factor * shape.mass[row];
      const unsigned int n_neighbours = shape.row(row).size;
      spread_node(position, particle, own);
      spread_node(velocity, particle, own_velocity);
      Lanes sum[dim] = {};
      for (unsigned int first = 0; first < n_neighbours; first += n_lanes)
      {
        const RowPairs<dim> pairs(rows, row, first, particle, own, position);
        const Lanes strength =
            scale * pairs.of_row * pairs.other_volume * kernel_value(pairs.distance);
        gather_nodes(velocity, pairs.node, of_pair);
        for (unsigned int d = 0; d < dim; ++d)
        {
          of_pair[d] = strength * (own_velocity[d] - of_pair[d]);
          sum[d] += of_pair[d];
        }
        add_to_nodes(of_pair, pairs.node, pairs.n, momentum);
      }
      subtract_from_own(sum, particle, momentum);
    }
  }

  template class PairTerms<2>;
  template class PairTerms<3>;
} // namespace tombolo
