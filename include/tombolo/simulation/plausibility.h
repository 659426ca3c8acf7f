// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/materials/material.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/simulation/energy_check.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iomanip>
#include <limits>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Implausible results of a run: the worst of all rows of the table over time, each as a
   * sentence with position and number.
   *
   * - a material point that is hotter than the melting temperature of its material, if it has one;
   * - a kinetic energy that is nearly all in the lattice mode, with velocities that alternate from
   *   particle to particle, where it is not negligible;
   * - an angular momentum that drifts though nothing acts on the body from outside;
   * - an energy balance that is off, though not by so much that the run stops.
   */
  class Plausibility
  {
  public:
    Plausibility()
    {
      const auto add = [this](const std::string &name, Worst &worst)
      {
        records.value("largest " + name, worst.value);
        records.value("sentence about " + name, worst.sentence);
      };
      add("melt", melt);
      add("lattice mode", lattice_mode);
      add("angular momentum", angular_momentum);
      add("energy error", energy_error);
    }

    /** Checks a row. Collective. */
    template <int dim>
    void update(const Model<dim> &model, const EnergyBalance &balance, const double time)
    {
      check_melt(model, time);
      check_lattice_mode(model, balance, time);
      check_drift(balance, time);
      check_energy(model, balance, time);
    }

    /** The sentences; the same on all ranks. */
    std::vector<std::string> findings() const
    {
      std::vector<std::string> result;
      for (const Worst *const worst : {&melt, &lattice_mode, &angular_momentum, &energy_error})
        if (worst->value > 0.)
          result.push_back(worst->sentence);
      return result;
    }

    Records records;

  private:
    struct Worst
    {
      double value = 0; ///< zero: nothing
      std::string sentence;
    };

    template <int dim>
    void check_melt(const Model<dim> &model, const double time)
    {
      for (const Part<dim> &part : model.parts)
      {
        const double melting_temperature = part.material->melts_at();
        const MaterialPoints &points = part.formulation->points();
        const unsigned int field = points.find_field("temperature");
        if (!std::isfinite(melting_temperature) || field == points.fields().size())
          continue;
        const double *const temperature = points.component(field, 0);
        const double *const volume = points.component(MaterialPoints::volume, 0);
        double largest = std::numeric_limits<double>::lowest();
        unsigned int hottest = 0;
        for (unsigned int i = 0; i < points.size(); ++i)
          if (volume[i] > 0. && temperature[i] > largest)
          {
            largest = temperature[i];
            hottest = i;
          }
        const double excess =
            Utilities::MPI::max(largest, model.communicator) - melting_temperature;
        if (!(excess > melt.value))
          continue;
        const auto largest_position = [&]
        { return position_text<dim>(part.formulation->initial_point_positions()[hottest]); };
        melt = {excess,
                as_text(std::setprecision(4), "At t = ", time, " part \"", part.name, "\" has ",
                        melting_temperature + excess, " at the point that started at ",
                        text_at_largest(largest, model.communicator, largest_position), ", ",
                        excess, " above the melting temperature of its material.")};
      }
    }
    template <int dim>
    void check_lattice_mode(const Model<dim> &model, const EnergyBalance &balance,
                            const double time)
    {
      constexpr double near_one = 0.9;
      constexpr double smallest_kinetic = 1e-3; // of the energy put in
      if (!(balance.short_wave_share > std::max(near_one, lattice_mode.value)) ||
          !(std::abs(balance.energies["kinetic energy"]) >
            smallest_kinetic * std::abs(balance.initial_total + balance.external)))
        return;
      const NodalVector &velocity = model.state.unsmoothed_velocity;
      NodalVector alternating(velocity.partition());
      model.bridge->apply_short_wave_part(velocity, alternating);
      double largest = -1.;
      unsigned int node = 0;
      for (unsigned int i = 0; i < velocity.partition()->n_owned(); ++i)
      {
        const double energy =
            *model.bridge->mass().node(i) * vector_of<dim>(alternating.node(i)).norm_square();
        if (energy > largest)
        {
          largest = energy;
          node = i;
        }
      }
      const auto largest_position = [&]
      { return position_text(vector_of<dim>(model.state.position.node(node))); };
      lattice_mode = {
          balance.short_wave_share,
          as_text(std::setprecision(3), "At t = ", time, " ", 100. * balance.short_wave_share,
                  " % of the kinetic energy are velocities that alternate from particle "
                  "to particle, the lattice mode, most at ",
                  text_at_largest(largest, model.communicator, largest_position), ".")};
    }
    void check_drift(const EnergyBalance &balance, const double time)
    {
      constexpr double largest_drift = 0.01;
      constexpr std::array<double, 3> zero{};
      if (balance.impulse != zero || balance.angular_impulse != zero ||
          !(balance.angular_momentum_drift > std::max(largest_drift, angular_momentum.value)))
        return;
      angular_momentum = {
          balance.angular_momentum_drift,
          as_text(std::setprecision(3), "At t = ", time,
                  " the angular momentum of the free body has drifted by ",
                  100. * balance.angular_momentum_drift,
                  " % of the largest sum of its magnitudes about the centre of mass, ",
                  balance.angular_momentum_scale, ".")};
    }

    template <int dim>
    void check_energy(const Model<dim> &model, const EnergyBalance &balance, const double time)
    {
      constexpr double largest_error = 0.02;
      if (!is_off_balance(model, balance, std::max(largest_error, energy_error.value)))
        return;
      energy_error = {
          std::abs(balance.error),
          as_text(
              std::setprecision(3), "At t = ", time, " the energy balance is off by ",
              100. * balance.error,
              " % of the largest energy so far that was there at the start and came in since.")};
    }

    /** The text of the rank that has the largest @p value, on all of them. Collective. */
    static std::string text_at_largest(const double value, const MPI_Comm communicator,
                                       const std::function<std::string()> &text)
    {
      const bool is_here = Utilities::MPI::max(value, communicator) == value;
      return first_text(communicator, is_here ? text() : "");
    }

    Worst melt, lattice_mode, angular_momentum, energy_error;
  };
} // namespace tombolo
