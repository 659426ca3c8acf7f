// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/failure/momentum_redistribution.h>

#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/model/model.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    // As many neighbours as the basis has functions make φ the unit vector of the particle itself,
    // and the others then have 1e-17 of either sign.
    constexpr double negligible_share = 1e-10;
  } // namespace

  template <int dim>
  MomentumRedistribution<dim>::MomentumRedistribution(Model<dim> &model) : model(model)
  {
    model.signals.rows_change.connect([this] { prepare(); });
  }

  template <int dim>
  void MomentumRedistribution<dim>::prepare()
  {
    if (is_prepared)
      return;
    // Of one part, nothing leaves before a bond is broken. Of several, another one can be next,
    // when the local numbers of this one are different already.
    const Part<dim> *only = nullptr;
    unsigned int n_parts = 0;
    for (const Part<dim> &part : model.parts)
      if (part.particles != nullptr)
      {
        only = &part;
        ++n_parts;
      }
    if (n_parts == 1 && !only->particles->has_broken_bonds())
      return;
    is_prepared = true;
    // Where rows change their neighbours, particles get other local numbers for a while.
    node_of_row.clear();
    for (const Part<dim> &part : model.parts)
      node_of_row.push_back(part.particles == nullptr ? std::vector<unsigned int>()
                                                      : part.particles->stencils().particle_node);
    model.bridge->smooth_velocity(model.state);
  }

  template <int dim>
  void MomentumRedistribution<dim>::complete()
  {
    if (!is_prepared)
      return;
    is_prepared = false;
    const auto &partition = model.state.partition();
    std::vector<unsigned int> n_rows(partition->n_owned(), 0), n_of_debris(partition->n_owned(), 0);
    for (std::size_t p = 0; p < model.parts.size(); ++p)
    {
      for (const unsigned int node : node_of_row[p])
        ++n_rows[node];
      if (!node_of_row[p].empty())
        for (const unsigned int row : model.parts[p].particles->debris())
          ++n_of_debris[node_of_row[p][row]];
    }
    const auto has_left = [&](const unsigned int node)
    {
      return n_of_debris[node] > 0 && n_of_debris[node] == n_rows[node] &&
             *model.element_mass.node(node) == 0.;
    };

    leaving = LeavingParticles();
    std::vector<bool> is_taken(partition->n_owned(), false); // a node can have two rows
    for (std::size_t p = 0; p < model.parts.size(); ++p)
    {
      if (model.parts[p].particles == nullptr)
        continue;
      const LeavingParticles of_part = model.parts[p].particles->take_leaving_particles();
      for (std::size_t k = 0; k < of_part.row.size(); ++k)
      {
        const unsigned int node = node_of_row[p][of_part.row[k]];
        const std::size_t begin = of_part.row_start[k];
        if (!has_left(node) || is_taken[node])
          continue;
        is_taken[node] = true;
        leaving.add(node,
                    {static_cast<unsigned int>(of_part.row_start[k + 1] - begin),
                     of_part.neighbour.data() + begin, of_part.value.data() + begin, nullptr});
      }
    }
    if (Utilities::MPI::max(leaving.row.empty() ? 0 : 1, partition->communicator()) == 0)
      return;
    is_debris =
        scalar_field(partition, [&](const unsigned int node) { return has_left(node) ? 1. : 0.; });

    hand_over_velocity();
    if (!model.heat)
      return;
    ThermalState &heat = model.heat->state;
    find_weights(model.heat->bridge.mass(), model.heat->conditions.constrained_components());
    hand_over_heat(heat.temperature, heat.unsmoothed_temperature, heat.enthalpy);
    hand_over_heat(heat.next_temperature, heat.next_unsmoothed_temperature, heat.next_enthalpy);
  }

  template <int dim>
  void MomentumRedistribution<dim>::find_weights(const NodalVector &mass,
                                                 const std::vector<std::uint8_t> &constrained)
  {
    const auto &partition = model.state.partition();
    std::vector<double> factor(partition->n_owned(), 1.);
    for (const NodePartition::Reflected &on_plane : partition->nodes_on_planes())
      factor[on_plane.source] *= 2.;
    weight = nodal_field(partition, Quantity::scalars,
                         [&](const unsigned int node, double *const of_node)
                         {
                           for (unsigned int c = 0; c < node_stride; ++c)
                             if (constrained.empty() || !((constrained[node] >> c) & 1u))
                               of_node[c] = factor[node] * *mass.node(node);
                         });
  }

  template <int dim>
  double MomentumRedistribution<dim>::receivable(const std::size_t entry, const unsigned int c,
                                                 const bool only_bonded) const
  {
    const unsigned int node = leaving.neighbour[entry];
    const bool takes =
        leaving.value[entry] > negligible_share && (!only_bonded || *is_debris.node(node) == 0.);
    return takes ? leaving.value[entry] * weight.node(node)[c] : 0.;
  }

  template <int dim>
  double MomentumRedistribution<dim>::sum_of_receivable(const std::size_t k, const unsigned int c,
                                                        const bool only_bonded) const
  {
    double sum = 0;
    for (std::size_t entry = leaving.row_start[k]; entry < leaving.row_start[k + 1]; ++entry)
      sum += receivable(entry, c, only_bonded);
    return sum;
  }

  template <int dim>
  bool MomentumRedistribution<dim>::can_give(const std::size_t k, const unsigned int c) const
  {
    return weight.node(leaving.row[k])[c] > 0. && sum_of_receivable(k, c, false) > 0.;
  }

  template <int dim>
  NodalVector MomentumRedistribution<dim>::share(const std::vector<double> &given,
                                                 const Quantity quantity) const
  {
    const auto add = [&](NodalVector &received)
    {
      for (std::size_t k = 0; k < leaving.row.size(); ++k)
        for (unsigned int c = 0; c < node_stride; ++c)
        {
          const double amount = given[k * node_stride + c];
          if (amount == 0.)
            continue;
          double sum = sum_of_receivable(k, c, true);
          const bool only_bonded = sum > 0.;
          if (!only_bonded)
            sum = sum_of_receivable(k, c, false);
          for (std::size_t entry = leaving.row_start[k]; entry < leaving.row_start[k + 1]; ++entry)
            received.node(leaving.neighbour[entry])[c] +=
                amount * (receivable(entry, c, only_bonded) / sum);
        }
    };
    return sums_at_owners(model.state.partition(), quantity, add);
  }

  template <int dim>
  void MomentumRedistribution<dim>::hand_over_velocity()
  {
    const SmoothingSettings &smoothing = model.bridge->smoothing();
    if (!smoothing.is_active)
      return;
    const auto &partition = model.state.partition();
    const NodalVector &mass = model.bridge->mass();
    find_weights(mass, model.conditions->constrained_components());

    NodalVector &v_hat = model.state.unsmoothed_velocity;
    const NodalVector before = v_hat.copy();
    std::vector<double> given(leaving.row.size() * node_stride, 0.);
    for (std::size_t k = 0; k < leaving.row.size(); ++k)
    {
      const unsigned int node = leaving.row[k];
      for (unsigned int c = 0; c < dim; ++c)
      {
        if (!can_give(k, c))
          continue;
        double smoothed = 0;
        if (smoothing.affine)
          smoothed = model.state.velocity.node(node)[c]; // it moves with S v̂, not with Φ S v̂
        else
          for (std::size_t entry = leaving.row_start[k]; entry < leaving.row_start[k + 1]; ++entry)
            smoothed +=
                leaving.value[entry] * model.state.velocity.node(leaving.neighbour[entry])[c];
        given[k * node_stride + c] = *mass.node(node) * (v_hat.node(node)[c] - smoothed);
        v_hat.node(node)[c] = smoothed;
      }
    }
    const NodalVector received = share(given, Quantity::vector);
    for (unsigned int node = 0; node < partition->n_owned(); ++node)
      for (unsigned int c = 0; c < dim; ++c)
        if (received.node(node)[c] != 0.)
          v_hat.node(node)[c] += received.node(node)[c] / *mass.node(node);

    std::vector<double> lost(partition->n_owned(), 0.);
    for (unsigned int node = 0; node < partition->n_owned(); ++node)
      for (unsigned int c = 0; c < dim; ++c)
      {
        const double old_value = before.node(node)[c], value = v_hat.node(node)[c];
        lost[node] += 0.5 * *mass.node(node) * (old_value - value) * (old_value + value);
      }
    for (std::size_t p = 0; p < model.parts.size(); ++p)
    {
      if (model.parts[p].particles == nullptr)
        continue;
      MaterialPoints &points = model.parts[p].formulation->points();
      const unsigned int field = points.find_field(Bonds<dim>::dissipation_name);
      if (field == points.fields().size())
        continue;
      double *const dissipation = points.component(field, 0);
      for (std::size_t row = 0; row < node_of_row[p].size(); ++row)
      {
        double &of_node = lost[node_of_row[p][row]];
        dissipation[row] += of_node * points.component(MaterialPoints::volume_ratio, 0)[row] /
                            points.component(MaterialPoints::volume, 0)[row];
        of_node = 0.;
      }
    }
    v_hat.update_ghosts(); // and not before what was lost is known, without normal components
  }

  template <int dim>
  void MomentumRedistribution<dim>::hand_over_heat(const NodalVector &field,
                                                   NodalVector &unsmoothed, NodalVector &enthalpy)
  {
    const NodalEnthalpy &of_temperature = model.heat->nodal_enthalpy;
    std::vector<double> given(leaving.row.size() * node_stride, 0.);
    for (std::size_t k = 0; k < leaving.row.size(); ++k)
    {
      const unsigned int node = leaving.row[k];
      if (!can_give(k, 0))
        continue;
      *unsmoothed.node(node) = *field.node(node);
      const double kept = of_temperature.enthalpy(node, *field.node(node));
      given[k * node_stride] = *enthalpy.node(node) - kept;
      *enthalpy.node(node) = kept;
    }
    const NodalVector received = share(given, Quantity::scalars);
    unsmoothed.fill(
        [&](const unsigned int node, double *const of_node)
        {
          if (*received.node(node) == 0.)
            return;
          *enthalpy.node(node) += *received.node(node);
          *of_node = of_temperature.temperature(node, *enthalpy.node(node));
        });
  }

  template class MomentumRedistribution<2>;
  template class MomentumRedistribution<3>;
} // namespace tombolo
