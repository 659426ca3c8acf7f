// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/moment.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/formulations/elements/eroding_cells.h>
#include <tombolo/model/internal_power.h>
#include <tombolo/model/model.h>
#include <tombolo/model/process.h>
#include <tombolo/output/time_table.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <vector>

namespace tombolo
{
  /** The losses of the bodies with the removed cells; this rank's share. */
  struct ErosionLoss
  {
    double n_cells = 0;
    double mass = 0; ///< [M]
    /** Kinetic, elastic and of hourglass stiffness; former dissipation stays where it is accounted
     * for [M L^2/T^2]. */
    double energy = 0;
    std::array<double, 3> momentum{};         ///< [M L/T]
    std::array<double, 3> angular_momentum{}; ///< [M L^2/T]
  };

  /**
   * Element erosion: before the forces at t_n, cells that fulfil the criterion of their part are
   * removed with their mass, momentum, energy and heat. Nodes that lose all their cells stay where
   * they are.
   */
  template <int dim>
  class Erosion : public Process<dim>
  {
  public:
    explicit Erosion(Model<dim> &model) : communicator(model.communicator)
    {
      for (std::size_t p = 0; p < model.parts.size(); ++p)
        if (ErodingCells<dim> *const cells = eroding_cells(model.parts[p]))
          parts.push_back({p, cells});
      this->structure.on_completion([this, &model] { remove_faces(model); });
      this->records.group("erosion").sums("eroded", lost.n_cells, lost.mass, lost.energy,
                                          interleaved(lost.momentum, lost.angular_momentum));
      this->observed.energy("eroded energy", EnergyKind::removed, lost.energy);
      this->observed.energies.connect(
          [this](EnergyAccounts &accounts)
          { accounts.add_removed_momentum(lost.momentum, lost.angular_momentum); });
      this->observed.columns.connect(
          [this](TimeTable &table)
          {
            const ErosionLoss total = total_loss();
            table.add("eroded cells", "1", total.n_cells);
            table.add("eroded mass", "M", total.mass);
            for (unsigned int d = 0; d < dim; ++d)
              table.add(std::string("eroded momentum ") + "xyz"[d], "M L/T", total.momentum[d]);
          });
      this->observed.results.connect(
          [this](const TimeTable &, Json &summary)
          {
            const ErosionLoss total = total_loss();
            summary["eroded_cells"] = n_removed_cells();
            summary["eroded_mass"] = total.mass;
            summary["eroded_energy"] = total.energy;
            summary["eroded_momentum"] =
                std::vector<double>(total.momentum.begin(), total.momentum.begin() + dim);
          });
    }

    ModelChange change_model(Model<dim> &model, const Clock &clock) override
    {
      ModelChange change;
      change.cells = erode(model, clock);
      return change;
    }

    void model_changed(const Model<dim> &model) override
    {
      massless.clear();
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        if (*model.state.mass.node(i) == 0.)
          massless.push_back(i);
    }

    void constrain_acceleration(const Model<dim> &, const Clock &, NodalState &state) override
    {
      for (const unsigned int node : massless)
        std::fill_n(state.acceleration.node(node), node_stride, 0.);
    }

    /** The cells of a part that can be removed, else null. */
    static ErodingCells<dim> *eroding_cells(const Part<dim> &part)
    {
      auto *const eroding = part.template as<ErodingCells>();
      return eroding != nullptr && eroding->erodes() ? eroding : nullptr;
    }

    /** Removes the cells that fulfil their criterion. Returns whether there were any on any rank.
     * Collective. */
    bool erode(Model<dim> &model, const Clock &clock)
    {
      std::vector<std::vector<unsigned int>> failed;
      for (const auto &[number, cells] : parts)
        failed.push_back(cells->find_failed_cells(model.state.position));
      const auto are_some = [&]
      {
        return any_of_all_ranks(
            failed, [](const auto &cells) { return !cells.empty(); }, communicator);
      };
      if (!are_some())
        return false;
      for (std::size_t k = 0; k < parts.size(); ++k)
        model.step_groups.keep_ready(model, parts[k].number, failed[k]);
      if (!are_some())
        return false;
      model.begin_change();

      const NodalVector &element_velocity = model.bridge->element_velocity(model.state.velocity);
      double pending_heat = 0;
      for (std::size_t k = 0; k < parts.size(); ++k)
      {
        const RemovedCells removed = parts[k].cells->remove_cells(
            failed[k], model.state.position, element_velocity, clock.previous_step);
        lost.n_cells += removed.n_cells;
        lost.energy += removed.energy;
        pending_heat += removed.pending_heat;
      }
      const NodalVector old_mass = model.state.mass.copy(),
                        old_body_mass = model.body_mass().copy();
      // Particles beside the cells are smoothed with other masses, and strain at another velocity.
      const double step = clock.previous_step;
      const bool smooths = step > 0. && !model.particle_parts().empty();
      const double power = smooths ? internal_power(model, step) : 0.;
      remove_faces(model);
      ++model.revisions.cells;
      model.renew_masses();
      lose_mass(model, old_mass, old_body_mass, pending_heat);
      if (smooths)
      {
        model.bridge->smooth_velocity(model.state);
        lost.energy += energy_of_change(power, internal_power(model, step), step, communicator);
      }
      return true;
    }

    /** Since the start, on this rank. */
    const ErosionLoss &loss() const
    {
      return lost;
    }

    /** Over all ranks. Collective. */
    unsigned long n_removed_cells() const
    {
      unsigned long count = 0;
      for (const ErodingPart &part : parts)
        count += part.cells->n_removed_cells();
      return dealii::Utilities::MPI::sum(count, communicator);
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &, Model<dim> &model)
    {
      if (std::none_of(model.parts.begin(), model.parts.end(), eroding_cells))
        return nullptr;
      if (model.heat)
        model.heat->can_lose_heat = true;
      return std::make_unique<Erosion>(model);
    }

  private:
    struct ErodingPart
    {
      std::size_t number;
      ErodingCells<dim> *cells;
    };

    void remove_faces(Model<dim> &model) const
    {
      std::vector<std::vector<dealii::types::global_dof_index>> cells;
      for (const ErodingPart &part : parts)
        part.cells->add_nodes_of_removed_cells(cells);
      model.remove_faces(cells);
    }

    /** Accounts for the momentum, the kinetic energy and the heat of the mass that nodes have lost.
     */
    void lose_mass(Model<dim> &model, const NodalVector &old_mass, const NodalVector &old_body_mass,
                   const double pending_heat)
    {
      NodalState &state = model.state;
      const NodalVector &body_mass = model.body_mass();
      std::vector<unsigned int> lighter;
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      {
        const double mass = *old_mass.node(i) - *state.mass.node(i);
        if (mass == 0.)
          continue;
        lighter.push_back(i);
        lost.mass += *old_body_mass.node(i) - *body_mass.node(i);
        const double *const x = state.position_of_unsmoothed().node(i);
        double *const v = state.unsmoothed_velocity.node(i);
        std::array<double, 3> momentum;
        for (unsigned int d = 0; d < 3; ++d)
        {
          momentum[d] = mass * v[d];
          lost.momentum[d] += momentum[d];
          lost.energy += 0.5 * mass * v[d] * v[d];
        }
        add_moment(x, momentum.data(), lost.angular_momentum);
        if (*state.mass.node(i) > 0.)
          continue;
        // Stays for the rest of the run.
        for (NodalVector *vector :
             {&state.unsmoothed_velocity, &state.velocity, &state.acceleration})
          std::fill_n(vector->node(i), node_stride, 0.);
      }
      state.unsmoothed_velocity.update_ghosts();
      if (model.heat)
        model.heat->lose_heat(lighter, pending_heat);
    }

    /** Sums over all ranks. Collective. */
    ErosionLoss total_loss() const
    {
      const std::array<double, 6> sums =
          ordered_sum(std::array<double, 6>{{lost.n_cells, lost.mass, lost.energy, lost.momentum[0],
                                             lost.momentum[1], lost.momentum[2]}},
                      communicator);
      return {sums[0], sums[1], sums[2], {{sums[3], sums[4], sums[5]}}, {}};
    }

    MPI_Comm communicator;
    std::vector<ErodingPart> parts; ///< whose cells can be removed
    ErosionLoss lost;
    std::vector<unsigned int> massless; ///< owned nodes all of whose cells were removed
  };
} // namespace tombolo
