// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/mass_split.h>

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/base/ordered_sum.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  MassSplit::MassSplit(const SmoothingSettings &smoothing, const bool is_trace,
                       const bool is_of_motion)
      : is_smoothed(smoothing.is_active), smallest_mass_share(smoothing.smallest_mass_share),
        is_trace(is_trace), is_of_motion(is_of_motion)
  {}

  double MassSplit::Masses::mass_of_row(const std::size_t part, const unsigned int row) const
  {
    const double mass = (weights.empty() ? 1. : weights[part]) * particle_parts[part]->mass[row];
    return row_weights.empty() || row_weights[part].empty() ? mass : row_weights[part][row] * mass;
  }

  void MassSplit::reinit(const std::shared_ptr<const NodePartition> &partition,
                         const Masses &masses)
  {
    const std::size_t n_parts = masses.particle_parts.size();
    Assert(masses.weights.empty() || masses.weights.size() == n_parts, ExcInternalError());
    Assert(masses.row_weights.empty() || masses.row_weights.size() == n_parts, ExcInternalError());
    parts.resize(n_parts);
    for (std::size_t p = 0; p < n_parts; ++p)
    {
      parts[p].shape = masses.particle_parts[p];
      parts[p].is_smoothed = parts[p].is_smoothed && is_smoothed;
    }
    has_lumped_rows = std::any_of(parts.begin(), parts.end(),
                                  [](const ParticlePart &part)
                                  { return part.is_smoothed && part.shape->is_lumped; });
    sum_total_mass(partition, masses);

    // What is not smoothed is the node's own.
    const unsigned int n_owned = partition->n_owned();
    std::vector<double> own(static_cast<std::size_t>(n_owned) * node_stride);
    for (unsigned int i = 0; i < n_owned; ++i)
      std::fill_n(own.begin() + static_cast<std::ptrdiff_t>(i) * node_stride, node_stride,
                  *total_mass.node(i));
    split_rows(masses, own);
    if (has_lumped_rows)
    {
      free_own_mass.reinit(partition, Quantity::scalar);
      free_own_mass.copy_from(total_mass);
    }
    for (ParticlePart &part : parts)
      for (unsigned int row = 0; has_lumped_rows && row < part.shape->n_particles(); ++row)
        *free_own_mass.node(part.shape->particle_node[row]) -=
            part.row_mass[std::size_t(row) * node_stride];
    collect_own_nodes(own);
    clear_fractions_on_planes();
    nodal_mass.reinit(partition, Quantity::scalars);
  }

  void MassSplit::sum_total_mass(const std::shared_ptr<const NodePartition> &partition,
                                 const Masses &masses)
  {
    const unsigned int n_owned = partition->n_owned();
    total_mass.reinit(partition, Quantity::scalar);
    n_particle_parts.assign(n_owned, 0);
    for (unsigned int i = 0; i < n_owned; ++i)
      *total_mass.node(i) = *masses.element_mass.node(i);
    for (std::size_t p = 0; p < parts.size(); ++p)
      for (unsigned int row = 0; row < parts[p].shape->n_particles(); ++row)
      {
        *total_mass.node(parts[p].shape->particle_node[row]) += masses.mass_of_row(p, row);
        n_particle_parts[parts[p].shape->particle_node[row]] += parts[p].is_smoothed ? 1 : 0;
      }
    shared_by_particle_parts = std::any_of(n_particle_parts.begin(), n_particle_parts.end(),
                                           [](const unsigned int count) { return count > 1; });
    total_mass.update_ghosts();
  }

  void MassSplit::split_rows(const Masses &masses, std::vector<double> &own)
  {
    for (std::size_t p = 0; p < parts.size(); ++p)
    {
      ParticlePart &part = parts[p];
      const unsigned int n_rows = part.shape->n_particles();
      part.smoothed_mass.resize_fast(static_cast<std::size_t>(n_rows) * node_stride);
      part.smoothed_fraction.resize_fast(static_cast<std::size_t>(n_rows) * node_stride);
      part.row_mass.resize_fast(has_lumped_rows ? part.smoothed_mass.size() : 0);
      part.element_rows.clear();
      for (unsigned int row = 0; row < n_rows; ++row)
      {
        const unsigned int node = part.shape->particle_node[row];
        const double element_mass = *masses.element_mass.node(node);
        if (element_mass > 0)
          part.element_rows.push_back(row);
        double smoothed = part.is_smoothed ? masses.mass_of_row(p, row) : 0.;
        if (is_trace && part.is_smoothed)
          smoothed *= *total_mass.node(node) / (*total_mass.node(node) - element_mass);
        if (has_lumped_rows)
          std::fill_n(part.row_mass.begin() + std::ptrdiff_t(row) * node_stride, node_stride,
                      smoothed);
        for (unsigned int c = 0; c < node_stride; ++c)
        {
          const bool is_free =
              masses.constrained.empty() || !((masses.constrained[node] >> c) & 1u);
          const double mass = is_free ? smoothed : 0.;
          part.smoothed_mass[row * node_stride + c] = mass;
          part.smoothed_fraction[row * node_stride + c] = mass / *total_mass.node(node);
          own[static_cast<std::size_t>(node) * node_stride + c] -= mass;
        }
      }
    }
  }

  void MassSplit::collect_own_nodes(std::vector<double> &own)
  {
    own_nodes.clear();
    own_mass.resize(0);
    own_fraction.resize(0);
    for (unsigned int i = 0; i < total_mass.partition()->n_owned(); ++i)
    {
      double *const node_mass = own.data() + static_cast<std::size_t>(i) * node_stride;
      bool has_own = false;
      for (unsigned int c = 0; c < node_stride; ++c)
      {
        // Round-off of the subtraction is not mass.
        if (std::abs(node_mass[c]) < 1e-13 * *total_mass.node(i))
          node_mass[c] = 0.;
        has_own = has_own || node_mass[c] != 0.;
      }
      if (!has_own)
        continue;
      own_nodes.push_back(i);
      for (unsigned int c = 0; c < node_stride; ++c)
      {
        own_mass.push_back(node_mass[c]);
        own_fraction.push_back(node_mass[c] / *total_mass.node(i));
      }
    }
  }

  void MassSplit::clear_fractions_on_planes()
  {
    const auto &on_planes = total_mass.partition()->nodes_on_planes();
    if (!is_of_motion || on_planes.empty())
      return;
    std::vector<double> factor(std::size_t(total_mass.partition()->n_owned()) * node_stride, 1.);
    for (const NodePartition::Reflected &on_plane : on_planes)
      for (unsigned int c = 0; c < 3; ++c)
        if (on_plane.reflection.sign[c] < 0.)
          factor[std::size_t(on_plane.source) * node_stride + c] = 0.;
    const auto clear = [&](const unsigned int node, double *const fraction)
    {
      for (unsigned int c = 0; c < node_stride; ++c)
        fraction[c] *= factor[std::size_t(node) * node_stride + c];
    };
    for (std::size_t k = 0; k < own_nodes.size(); ++k)
      clear(own_nodes[k], own_fraction.data() + k * node_stride);
    for (ParticlePart &part : parts)
      for (unsigned int row = 0; row < part.shape->n_particles(); ++row)
        clear(part.shape->particle_node[row],
              part.smoothed_fraction.data() + std::size_t(row) * node_stride);
  }

  std::vector<bool> MassSplit::move_alone() const
  {
    std::vector<bool> result(n_particle_parts.size(), false);
    for (std::size_t k = 0; k < own_nodes.size(); ++k)
    {
      const double *const fraction = own_fraction.data() + k * node_stride;
      result[own_nodes[k]] =
          n_particle_parts[own_nodes[k]] == 0 &&
          std::all_of(fraction, fraction + 3,
                      [](const double component_fraction) { return component_fraction == 1.; });
    }
    return result;
  }

  void MassSplit::add_own_momentum(const NodalVector &velocity, NodalVector &result) const
  {
    for (std::size_t k = 0; k < own_nodes.size(); ++k)
      add_to_node(own_mass_of(k) * load_node(velocity.node(own_nodes[k])),
                  result.node(own_nodes[k]));
  }

  void MassSplit::set_own_fraction(const NodalVector &field, NodalVector &result) const
  {
    result.set_zero();
    for (std::size_t k = 0; k < own_nodes.size(); ++k)
      store_node(own_fraction_of(k) * load_node(field.node(own_nodes[k])),
                 result.node(own_nodes[k]));
  }

  void MassSplit::sum_nodal_mass()
  {
    // m = W 1 (eqs 11, 48).
    const auto &partition = total_mass.partition();
    const unsigned int n_owned = partition->n_owned();
    ones.fit_to(partition);
    for (unsigned int i = 0; i < partition->n_local(); ++i)
      std::fill_n(ones.node(i), node_stride, 1.);
    if (has_lumped_rows)
    {
      find_lumped_masses();
      return;
    }
    sum_rows(true, false, nodal_mass);
    // Of nodes that erosion left without mass: there is no momentum to divide by it.
    for (unsigned int i = 0; i < n_owned; ++i)
      if (*total_mass.node(i) == 0.)
        std::fill_n(nodal_mass.node(i), node_stride, 1.);
    nodal_mass.update_ghosts();
  }

  void MassSplit::sum_rows(const bool constrained, const bool as_accelerated, NodalVector &result)
  {
    result.set_zero();
    if (constrained)
      add_own_momentum(ones, result);
    else
      for (unsigned int i = 0; i < total_mass.partition()->n_owned(); ++i)
        std::fill_n(result.node(i), node_stride, *free_own_mass.node(i));
    for (const ParticlePart &part : parts)
    {
      if (!part.is_smoothed)
        continue;
      const double *const mass = (constrained ? part.smoothed_mass : part.row_mass).data();
      if (!as_accelerated || !part.shape->is_lumped)
        NodalSmoothing::scatter(*part.shape, mass, ones.data(), result.data());
      else
        for (unsigned int row = 0; row < part.shape->n_particles(); ++row)
          add_to_node(load_node(mass + std::size_t(row) * node_stride) *
                          accelerated_share(part, row),
                      result.node(part.shape->particle_node[row]));
    }
    result.add_to_owners();
  }

  void MassSplit::find_lumped_masses()
  {
    const auto &partition = total_mass.partition();
    for (NodalVector *const vector : {&sums_of_rows, &ratio_of_masses})
      vector->fit_to(partition, Quantity::scalars);
    const auto set_ratio = [&](const NodalVector &sums, const NodalVector &accelerated)
    {
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (*total_mass.node(i) > 0.)
          store_node(load_node(accelerated.node(i)) / load_node(sums.node(i)),
                     ratio_of_masses.node(i));
        else // erosion left it without mass
          std::fill_n(ratio_of_masses.node(i), node_stride, 1.);
      ratio_of_masses.update_ghosts();
    };
    sum_rows(false, false, sums_of_rows);
    sum_rows(false, true, nodal_mass);
    set_ratio(sums_of_rows, nodal_mass);

    // m̂ = Sᵀ m; nodal_mass serves as the target.
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      store_node(load_node(ratio_of_masses.node(i)) * *free_own_mass.node(i), nodal_mass.node(i));
    for (unsigned int i = partition->n_owned(); i < partition->n_local(); ++i)
      store_node(NodeLanes(0.), nodal_mass.node(i));
    for (const ParticlePart &part : parts)
      if (part.is_smoothed)
        NodalSmoothing::gather_affine(*part.shape, part.row_mass.data(), ratio_of_masses.data(),
                                      nodal_mass.data());
    nodal_mass.add_to_owners();
    adjoint_mass.reinit(partition, Quantity::scalar);
    double largest = 1.;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
    {
      *adjoint_mass.node(i) = *nodal_mass.node(i);
      if (*total_mass.node(i) > 0.)
        largest = std::max(largest, *total_mass.node(i) / *adjoint_mass.node(i));
    }
    adjoint_mass.update_ghosts();
    body_mass.reinit(partition, Quantity::scalar);
    body_mass.copy_from(total_mass);
    for (const ParticlePart &part : parts)
      for (unsigned int row = 0; part.is_smoothed && row < part.shape->n_particles(); ++row)
        *body_mass.node(part.shape->particle_node[row]) +=
            part.row_mass[std::size_t(row) * node_stride] * (accelerated_share(part, row) - 1.);
    body_mass.update_ghosts();
    largest_ratio = Utilities::MPI::max(largest, partition->communicator());

    sum_rows(true, false, sums_of_rows);
    sum_rows(true, true, nodal_mass);
    set_ratio(sums_of_rows, nodal_mass);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (*total_mass.node(i) == 0.)
        for (NodalVector *const vector : {&sums_of_rows, &nodal_mass})
          std::fill_n(vector->node(i), node_stride, 1.);
    sums_of_rows.update_ghosts();
    nodal_mass.update_ghosts();
  }

  const NodalVector &MassSplit::field_over_row_sums(const NodalVector &field)
  {
    if (!has_lumped_rows)
      return field;
    if (scaled.partition() != field.partition())
      scaled.reinit_like(field);
    const std::size_t n = static_cast<std::size_t>(scaled.partition()->n_local()) * node_stride;
    for (std::size_t i = 0; i < n; ++i)
      scaled.data()[i] = ratio_of_masses.data()[i] * field.data()[i];
    return scaled;
  }

  void MassSplit::make_symmetric(NodalVector &short_wave_part) const
  {
    if (!has_lumped_rows)
      return;
    for (unsigned int i = 0; i < short_wave_part.partition()->n_owned(); ++i)
      if (const double mass = *adjoint_mass.node(i); mass > 0.)
        store_node(load_node(short_wave_part.node(i)) *
                       (*total_mass.node(i) / (mass * largest_ratio)),
                   short_wave_part.node(i));
    short_wave_part.update_ghosts();
  }

  double MassSplit::kinetic_energy(const NodalVector &mass, const NodalVector &velocity)
  {
    double sum = 0;
    const unsigned int n_owned = velocity.partition()->n_owned();
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const double *const v = velocity.node(i);
      sum += 0.5 * *mass.node(i) * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
    return ordered_sum(sum, velocity.partition()->communicator());
  }

  bool MassSplit::has_mass_above(const double share) const
  {
    const auto &partition = nodal_mass.partition();
    bool all_above = true;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
    {
      if (*total_mass.node(i) > 0.)
        all_above = all_above && *unsmoothed_mass().node(i) > share * *total_mass.node(i);
      for (unsigned int c = 0; c < node_stride; ++c)
        all_above = all_above && row_sums().node(i)[c] > share * *total_mass.node(i);
    }
    return Utilities::MPI::min(all_above ? 1 : 0, partition->communicator()) == 1;
  }

  bool MassSplit::remove_negative_values()
  {
    const auto &partition = nodal_mass.partition();
    NodalVector is_light(partition, Quantity::scalar);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
    {
      const double *const mass = row_sums().node(i);
      if (!(*std::min_element(mass, mass + node_stride) >
            smallest_mass_share * *total_mass.node(i)))
        *is_light.node(i) = 1.;
    }
    is_light.update_ghosts();
    bool has_changed = false;
    for (ParticlePart &part : parts)
      for (unsigned int row = 0; part.is_smoothed && row < part.shape->n_particles(); ++row)
      {
        const Stencils::Row stencil = part.shape->row(row);
        bool reduces_mass = false;
        for (unsigned int k = 0; k < stencil.size; ++k)
          reduces_mass =
              reduces_mass || (stencil.value[k] < 0. && *is_light.node(stencil.neighbour[k]) > 0.);
        if (!reduces_mass)
          continue;
        part.shape->remove_negative_values(row);
        has_changed = true;
      }
    return Utilities::MPI::max(has_changed ? 1 : 0, partition->communicator()) == 1;
  }

  bool MassSplit::update_nodal_mass()
  {
    sum_nodal_mass();
    // A scaled row can leave too little to another node; each time there are fewer that can.
    bool is_sound = has_mass_above(smallest_mass_share);
    while (!is_sound && has_started && is_smoothed && remove_negative_values())
    {
      rows_have_changed = true;
      sum_nodal_mass();
      is_sound = has_mass_above(smallest_mass_share);
    }
    has_started = true;
    return is_sound || has_mass_above(0.);
  }
} // namespace tombolo
