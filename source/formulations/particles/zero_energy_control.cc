// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/zero_energy_control.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/formulations/row_block.h>
#include <tombolo/materials/kinematics.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    const std::string slip_name = "zero-energy slip";
    const std::string energy_name = "zero-energy density";
    const std::string loss_name = "zero-energy loss";

    NodeLanes residual(const Stencils::Row &row, const unsigned int own, const NodalVector &values)
    {
      const NodeLanes origin = load_node(values.node(own));
      NodeLanes sum = 0.;
      for (unsigned int k = 0; k < row.size; ++k)
        sum += row.value[k] * (load_node(values.node(row.neighbour[k])) - origin);
      return sum;
    }

    /** Von Mises'. */
    double equivalent_stress(const MaterialPoints &points, const unsigned int i)
    {
      double s[6];
      for (unsigned int c = 0; c < 6; ++c)
        s[c] = points.component(MaterialPoints::stress, c)[i];
      return std::sqrt(0.5 * ((s[0] - s[1]) * (s[0] - s[1]) + (s[1] - s[2]) * (s[1] - s[2]) +
                              (s[2] - s[0]) * (s[2] - s[0])) +
                       3. * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
    }

    void scatter(const Stencils::Row &row, const unsigned int own, const NodeLanes &of_residual,
                 NodalVector &force)
    {
      NodeLanes all = 0.;
      for (unsigned int k = 0; k < row.size; ++k)
      {
        const NodeLanes share = row.value[k] * of_residual;
        double *const at = force.node(row.neighbour[k]);
        store_node(load_node(at) + share, at);
        all += share;
      }
      double *const at = force.node(own);
      store_node(load_node(at) - all, at);
    }
  } // namespace

  ZeroEnergyControl::ZeroEnergyControl(const Entries &e)
      : coefficient(
            e.number("Zero-energy stiffness", "0.9", between(0., 4.), "1",
                     "With `Dilatation = of cells`: the stiffness of what alternates from node to "
                     "node, in shear moduli; 0: none.")),
        limit(e.number("Zero-energy limit", "0.001", between(0., 1.), "1",
                       "Its largest energy where material flows, in elastic energies of the "
                       "deviator at the flow stress."))
  {}

  void ZeroEnergyControl::reset(const std::vector<double> &volumes,
                                const std::vector<double> &squared_lengths)
  {
    has_particles = true;
    volume = volumes;
    squared_length = squared_lengths;
  }

  void ZeroEnergyControl::set_material(const Material &material)
  {
    shear_modulus = material.shear_modulus();
    factor = 16. * coefficient * shear_modulus;
    can_flow = material.remembers("effective plastic strain");
  }

  std::vector<FieldDescription> ZeroEnergyControl::variables() const
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

  void ZeroEnergyControl::initialize(const MaterialPoints &points)
  {
    energy_field = points.find_field(energy_name);
    if (!can_flow)
      return;
    slip_field = points.find_field(slip_name);
    loss_field = points.find_field(loss_name);
    strain_field = points.find_field("effective plastic strain");
  }

  void ZeroEnergyControl::begin(const MaterialPoints &points, const unsigned int first,
                                const unsigned int last)
  {
    if (!can_flow)
      return;
    const double *const strain = points.component(strain_field, 0);
    strain_before.assign(strain + first, strain + last);
    stress_before.resize(last - first);
    for (unsigned int i = first; i < last; ++i)
      stress_before[i - first] = equivalent_stress(points, i);
  }

  ZeroEnergyControl::Range ZeroEnergyControl::elastic_range(const MaterialPoints &points,
                                                            const unsigned int first,
                                                            const unsigned int i) const
  {
    Range result;
    if (!can_flow)
      return result;
    const double flow = points.component(strain_field, 0)[i] - strain_before[i - first];
    if (!(flow > 0.))
      return result;
    // A yield surface that moves lets a particle flow while its stress passes zero.
    const double stress = std::max(equivalent_stress(points, i), stress_before[i - first]);
    result.length = stress * std::sqrt(limit * squared_length[i] / (3. * shear_modulus * factor));
    result.beyond = stress / (stress + 10. * shear_modulus * flow);
    return result;
  }

  void ZeroEnergyControl::advance(MaterialPoints &points, const unsigned int first,
                                  const unsigned int last, const double *const spin[3],
                                  double *const residuals) const
  {
    double *slip[3] = {}, *loss = nullptr;
    if (can_flow)
    {
      for (unsigned int d = 0; d < 3; ++d)
        slip[d] = points.component(slip_field, d);
      loss = points.component(loss_field, 0);
    }
    double *const energy = points.component(energy_field, 0);
    for (unsigned int i = first; i < last; ++i)
    {
      double *const place = residuals + node_stride * (i - first);
      NodeLanes elastic = load_node(place);
      if (can_flow)
      {
        double of_slip[3] = {slip[0][i], slip[1][i], slip[2][i]};
        if (of_slip[0] != 0. || of_slip[1] != 0. || of_slip[2] != 0.)
        {
          const double of_step[3] = {spin[0][i - first], spin[1][i - first], spin[2][i - first]};
          const Matrix3<double> turn = rotation_of(of_step);
          double turned[3];
          for (unsigned int d = 0; d < 3; ++d)
            turned[d] = turn(d, 0) * of_slip[0] + turn(d, 1) * of_slip[1] + turn(d, 2) * of_slip[2];
          std::copy_n(turned, 3, of_slip);
        }
        double squared = 0;
        for (unsigned int d = 0; d < 3; ++d)
        {
          elastic[d] -= of_slip[d];
          squared += elastic[d] * elastic[d];
        }
        const Range range = elastic_range(points, first, i);
        if (const double length = std::sqrt(squared); length > range.length)
        {
          const double kept = range.length + range.beyond * (length - range.length);
          for (unsigned int d = 0; d < 3; ++d)
          {
            of_slip[d] += (1. - kept / length) * elastic[d];
            elastic[d] *= kept / length;
          }
          // Work is found from the mean of the forces at both ends of a step.
          const double before = std::sqrt(2. * energy[i] * squared_length[i] / factor);
          loss[i] += 0.5 * factor / squared_length[i] * (before + kept) * (length - kept);
        }
        for (unsigned int d = 0; d < 3; ++d)
          slip[d][i] = of_slip[d];
      }
      const double k = stiffness(i);
      energy[i] = 0.5 * factor / squared_length[i] *
                  (elastic[0] * elastic[0] + elastic[1] * elastic[1] + elastic[2] * elastic[2]);
      store_node(k * elastic, place);
    }
  }

  void ZeroEnergyControl::apply_stiffness(const Stencils &shape, const NodalVector &velocity,
                                          NodalVector &force) const
  {
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      const unsigned int own = shape.particle_node[i];
      scatter(row, own, stiffness(i) * residual(row, own, velocity), force);
    }
  }

  void ZeroEnergyControl::add_tangent(const Stencils &shape, const MaterialPoints &points,
                                      const unsigned int first, const unsigned int particle,
                                      const NodalVector &position, CellEquations &equations) const
  {
    const Stencils::Row row = shape.row(particle);
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
    const Range range = elastic_range(points, first, particle);
    if (length > range.length)
    {
      across *= (range.length + range.beyond * (length - range.length)) / length;
      along *= range.beyond;
    }
    const std::size_t n_nodes = equations.nodes.size();
    const std::size_t dim = equations.force.size() / n_nodes;
    std::vector<double> weight(n_nodes, 0.);
    const auto add = [&](const unsigned int node, const double value)
    {
      const auto place = std::lower_bound(equations.nodes.begin(), equations.nodes.end(), node);
      weight[static_cast<std::size_t>(place - equations.nodes.begin())] += value;
    };
    for (unsigned int n = 0; n < row.size; ++n)
    {
      add(row.neighbour[n], row.value[n]);
      add(own, -row.value[n]);
    }
    for (std::size_t a = 0; a < n_nodes; ++a)
      for (std::size_t d = 0; d < dim; ++d)
      {
        equations.force[dim * a + d] += across * weight[a] * elastic[d];
        for (std::size_t e = 0; e < dim; ++e)
        {
          const double derivative =
              (d == e ? across : 0.) +
              (length > range.length ? (along - across) * elastic[d] * elastic[e] / squared : 0.);
          for (std::size_t b = 0; b < n_nodes; ++b)
            equations.matrix[(dim * a + d) * n_nodes * dim + dim * b + e] +=
                derivative * weight[a] * weight[b];
        }
      }
  }

  void ZeroEnergyControl::account(const MaterialPoints &points, EnergyAccounts &accounts) const
  {
    accounts.add("hourglass energy", EnergyKind::stored,
                 integral_over_initial_volume(points, energy_name));
    accounts.add("viscous dissipation", EnergyKind::artificial,
                 integral_over_initial_volume(points, loss_name));
  }
} // namespace tombolo
