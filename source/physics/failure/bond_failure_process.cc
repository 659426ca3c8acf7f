// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/failure/bond_counts.h>

#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/model/model.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace tombolo
{
  template <int dim>
  BondCounts bond_counts(const Model<dim> &model)
  {
    BondCounts sum;
    for (ParticleFormulation<dim> *const particles : model.particle_parts())
    {
      const Bonds<dim> *const bonds = particles->breaking_bonds();
      const BondCounts counts = bonds != nullptr ? bonds->counts() : BondCounts();
      if (sum.criterion.empty())
        sum.criterion = counts.criterion;
      sum.n_broken += counts.n_broken;
      sum.n_debris += counts.n_debris;
    }
    sum.n_broken = Utilities::MPI::sum(sum.n_broken, model.communicator);
    sum.n_debris = Utilities::MPI::sum(sum.n_debris, model.communicator);
    return sum;
  }

  namespace
  {
    // As many neighbours as the basis has functions make φ the unit vector of the particle itself,
    // and the others then have 1e-17 of either sign.
    constexpr double negligible_share = 1e-10;

    template <int dim>
    Bonds<dim> *breaking_bonds(const Part<dim> &part)
    {
      return part.particles == nullptr ? nullptr : part.particles->breaking_bonds();
    }
  } // namespace

  /**
   * Redistributes momentum and heat of particles that become debris. As a part of the body a
   * particle moves with a smoothed velocity, Φ S v̂ (with affine smoothing S v̂), and has a smoothed
   * temperature, Φ S θ̂. Debris would continue with its own v̂ and θ̂. So it gets the smoothed ones as
   * its own, and the difference of its momentum and heat goes to the neighbours that it leaves: to
   * each in proportion to φ m of its former row, where φ is positive and no round-off, but not to
   * other debris, unless there is nothing else. Momentum and heat are conserved to round-off; the
   * difference in kinetic energy is booked as lost to failure, at the points of the particles that
   * lost or received it.
   *
   * Nodes shared with elements are no debris: the bond to the elements holds. Prescribed components
   * are left alone at both ends.
   */
  template <int dim>
  class MomentumRedistribution
  {
  public:
    /** Connects to ModelSignals::rows_change of @p model. */
    explicit MomentumRedistribution(Model<dim> &model) : model(model)
    {
      model.signals.rows_change.connect([this] { prepare(); });
    }

    /** After all parts were updated and one has changed, as long as the state has the partition in
     * force before. Collective. */
    void complete()
    {
      if (!is_prepared)
        return;
      is_prepared = false;
      const auto &partition = model.state.partition();
      std::vector<unsigned int> n_rows(partition->n_owned(), 0),
          n_of_debris(partition->n_owned(), 0);
      for (std::size_t p = 0; p < model.parts.size(); ++p)
      {
        for (const unsigned int node : node_of_row[p])
          ++n_rows[node];
        if (const Bonds<dim> *const bonds = breaking_bonds(model.parts[p]))
          for (const unsigned int row : bonds->debris())
            ++n_of_debris[node_of_row[p][row]];
      }
      const auto has_left = [&](const unsigned int node)
      {
        return n_of_debris[node] > 0 && n_of_debris[node] == n_rows[node] &&
               *model.element_mass.node(node) == 0.;
      };

      leaving.clear();
      std::vector<bool> is_taken(partition->n_owned(), false); // a node can have two rows
      for (std::size_t p = 0; p < model.parts.size(); ++p)
      {
        Bonds<dim> *const bonds = breaking_bonds(model.parts[p]);
        if (bonds == nullptr)
          continue;
        for (LeavingParticle &particle : bonds->leaving_particles())
        {
          const unsigned int node = node_of_row[p][particle.row];
          if (!has_left(node) || is_taken[node])
            continue;
          is_taken[node] = true;
          leaving.push_back({node, std::move(particle.entries)});
        }
      }
      if (Utilities::MPI::max(leaving.empty() ? 0 : 1, partition->communicator()) == 0)
        return;
      is_debris = scalar_field(partition,
                               [&](const unsigned int node) { return has_left(node) ? 1. : 0.; });

      hand_over_velocity();
      if (!model.heat)
        return;
      ThermalState &heat = model.heat->state;
      find_weights(model.heat->bridge.mass(), model.heat->conditions.constrained_components());
      hand_over_heat(heat.temperature, heat.unsmoothed_temperature, heat.enthalpy);
      hand_over_heat(heat.next_temperature, heat.next_unsmoothed_temperature, heat.next_enthalpy);
    }

  private:
    /** Before the first change: the smoothed velocity of the rows as they are. */
    void prepare()
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
      if (n_parts == 1 && !(breaking_bonds(*only) != nullptr && breaking_bonds(*only)->any()))
        return;
      is_prepared = true;
      // Where rows change their neighbours, particles get other local numbers for a while.
      node_of_row.clear();
      for (const Part<dim> &part : model.parts)
        node_of_row.push_back(part.particles == nullptr ? std::vector<unsigned int>()
                                                        : part.particles->stencils().particle_node);
      model.bridge->smooth_velocity(model.state);
    }

    void hand_over_velocity()
    {
      const SmoothingSettings &smoothing = model.bridge->smoothing();
      if (!smoothing.is_active)
        return;
      const auto &partition = model.state.partition();
      const NodalVector &mass = model.bridge->mass();

      find_weights(mass, model.conditions->constrained_components());

      NodalVector &v_hat = model.state.unsmoothed_velocity;
      const NodalVector before = v_hat.copy();
      std::vector<double> given(leaving.size() * node_stride, 0.);
      for (std::size_t k = 0; k < leaving.size(); ++k)
      {
        const unsigned int node = leaving[k].row;
        for (unsigned int c = 0; c < dim; ++c)
        {
          if (!can_give(k, c))
            continue;
          double smoothed = 0;
          if (smoothing.affine)
            smoothed = model.state.velocity.node(node)[c]; // it moves with S v̂, not with Φ S v̂
          else
            for (const auto &[neighbour, value] : leaving[k].entries)
              smoothed += value * model.state.velocity.node(neighbour)[c];
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
          double &node_loss = lost[node_of_row[p][row]];
          dissipation[row] += node_loss * points.component(MaterialPoints::volume_ratio, 0)[row] /
                              points.component(MaterialPoints::volume, 0)[row];
          node_loss = 0.;
        }
      }
      v_hat.update_ghosts(); // after the loss is computed without normal components
    }

    void hand_over_heat(const NodalVector &field, NodalVector &unsmoothed, NodalVector &enthalpy)
    {
      const NodalEnthalpy &nodal_enthalpy = model.heat->nodal_enthalpy;
      std::vector<double> given(leaving.size() * node_stride, 0.);
      for (std::size_t k = 0; k < leaving.size(); ++k)
      {
        const unsigned int node = leaving[k].row;
        if (!can_give(k, 0))
          continue;
        *unsmoothed.node(node) = *field.node(node);
        const double kept = nodal_enthalpy.enthalpy(node, *field.node(node));
        given[k * node_stride] = *enthalpy.node(node) - kept;
        *enthalpy.node(node) = kept;
      }
      const NodalVector received = share(given, Quantity::scalars);
      unsmoothed.fill(
          [&](const unsigned int node, double *const temperature)
          {
            if (*received.node(node) == 0.)
              return;
            *enthalpy.node(node) += *received.node(node);
            *temperature = nodal_enthalpy.temperature(node, *enthalpy.node(node));
          });
    }

    /** m at each local node, in the components that are not @p constrained: those of a whole body
     * also on planes of symmetry. @p mass is scalar. */
    void find_weights(const NodalVector &mass, const std::vector<std::uint8_t> &constrained)
    {
      const auto &partition = model.state.partition();
      std::vector<double> factor(partition->n_owned(), 1.);
      for (const NodePartition::Reflected &on_plane : partition->nodes_on_planes())
        factor[on_plane.source] *= 2.;
      weight = nodal_field(partition, Quantity::scalars,
                           [&](const unsigned int node, double *const weights)
                           {
                             for (unsigned int c = 0; c < node_stride; ++c)
                               if (constrained.empty() || !((constrained[node] >> c) & 1u))
                                 weights[c] = factor[node] * *mass.node(node);
                           });
    }
    /** Whether any node can receive component @p c from leaving particle @p k. */
    bool can_give(const std::size_t k, const unsigned int c) const
    {
      return weight.node(leaving[k].row)[c] > 0. && sum_of_receivable(k, c, false) > 0.;
    }

    /** Distributes @p given, node_stride for each leaving particle, over the nodes of its row.
     * Collective. */
    NodalVector share(const std::vector<double> &given, const Quantity quantity) const
    {
      const auto add = [&](NodalVector &received)
      {
        for (std::size_t k = 0; k < leaving.size(); ++k)
          for (unsigned int c = 0; c < node_stride; ++c)
          {
            const double amount = given[k * node_stride + c];
            if (amount == 0.)
              continue;
            double sum = sum_of_receivable(k, c, true);
            const bool only_bonded = sum > 0.;
            if (!only_bonded)
              sum = sum_of_receivable(k, c, false);
            for (const auto &entry : leaving[k].entries)
              received.node(entry.first)[c] += amount * (receivable(entry, c, only_bonded) / sum);
          }
      };
      return sums_at_owners(model.state.partition(), quantity, add);
    }

    /** The part of component @p c that goes to @p entry of the row of a leaving particle is
     * receivable(...) over its sum. */
    double receivable(const std::pair<unsigned int, double> &entry, const unsigned int c,
                      const bool only_bonded) const
    {
      const auto [node, value] = entry;
      const bool takes = value > negligible_share && (!only_bonded || *is_debris.node(node) == 0.);
      return takes ? value * weight.node(node)[c] : 0.;
    }

    double sum_of_receivable(const std::size_t k, const unsigned int c,
                             const bool only_bonded) const
    {
      double sum = 0;
      for (const auto &entry : leaving[k].entries)
        sum += receivable(entry, c, only_bonded);
      return sum;
    }

    Model<dim> &model;
    bool is_prepared = false;
    std::vector<std::vector<unsigned int>> node_of_row; // by part; empty: not one of particles

    // While complete() works.
    std::vector<LeavingParticle> leaving; // of all parts; rows are owned nodes
    NodalVector is_debris;                // scalar: 1 or 0
    NodalVector weight;
  };

  /**
   * Bonds between particles that break, and particles that are isolated by it. The particle parts
   * break their bonds where they renew their rows; this process hands the momentum and the heat of
   * isolated particles to those that they leave (MomentumRedistribution), and counts.
   */
  template <int dim>
  class BondFailureProcess : public Process<dim>
  {
  public:
    explicit BondFailureProcess(Model<dim> &model) : redistribution(model)
    {
      model.stencils_change_for_good = true;
      model.signals.rows_changed.connect(
          [this, &model]
          {
            redistribution.complete();
            // Broken bonds make larger gradients at the same lengths.
            if (model.heat)
              model.heat->limit_is_outdated = true;
          });
      const auto n_broken = [&model] { return bond_counts(model).n_broken; };
      this->observed.column("broken bonds", "1", n_broken);
      this->observed.column("debris particles", "1",
                            [&model] { return static_cast<double>(bond_counts(model).n_debris); });
      this->observed.result("broken_bonds", n_broken);
      this->observed.result("debris_particles", [&model] { return bond_counts(model).n_debris; });
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &, Model<dim> &model)
    {
      const auto particles = model.particle_parts();
      if (std::none_of(particles.begin(), particles.end(),
                       [](auto *part) { return part->breaking_bonds() != nullptr; }))
        return nullptr;
      return std::make_unique<BondFailureProcess>(model);
    }

  private:
    MomentumRedistribution<dim> redistribution;
  };

  template BondCounts bond_counts(const Model<2> &);
  template BondCounts bond_counts(const Model<3> &);

  TOMBOLO_REGISTER_PROCESS(BondFailureProcess, process_order::bond_failure)
} // namespace tombolo
