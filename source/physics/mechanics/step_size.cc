// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/step_size.h>

#include <tombolo/approximation/row_deformation.h>
#include <tombolo/model/model.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tombolo
{
  namespace
  {
    /** Supports stay as they are where a particle loses neighbours; its gradients grow. */
    template <int dim>
    std::vector<double> times_of_rows(const Part<dim> &part, const NodalVector &position)
    {
      const Stencils &shape = part.particles->stencils();
      std::vector<double> result(shape.n_particles(), std::numeric_limits<double>::max());
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
        if (!shape.is_undeformed(i))
          result[i] = 1. / (present_gradient<dim>(shape, i, position) *
                            part.material->longitudinal_wave_speed());
      return result;
    }

    template <int dim>
    std::vector<std::vector<double>> times_of(const Model<dim> &model)
    {
      std::vector<std::vector<double>> result(model.parts.size());
      for (std::size_t p = 0; p < result.size(); ++p)
        if (model.parts[p].particles != nullptr && model.stencils_change_for_good)
          result[p] = times_of_rows(model.parts[p], model.state.position);
        else
        {
          model.parts[p].formulation->courant_limits(model.state.position, result[p]);
          const std::vector<unsigned int> &ratios = model.parts[p].step_ratios;
          for (std::size_t i = 0; i < ratios.size(); ++i)
            result[p][i] /= ratios[i];
        }
      return result;
    }
  } // namespace

  template <int dim>
  void LocalShortening<dim>::store(const Model<dim> &model)
  {
    times = times_of(model);
  }

  template <int dim>
  bool LocalShortening<dim>::exceeds(const Model<dim> &model, const double fraction) const
  {
    const std::vector<std::vector<double>> present = times_of(model);
    double smallest = std::numeric_limits<double>::max();
    for (const std::vector<double> &part_times : present)
      for (const double time : part_times)
        smallest = std::min(smallest, time);
    smallest = Utilities::MPI::min(smallest, model.communicator);
    // A change on one rank counts for all, so that the number of ranks has no effect.
    std::vector<int> is_comparable(present.size(), 0);
    for (std::size_t p = 0; p < std::min(times.size(), present.size()); ++p)
      is_comparable[p] = times[p].size() == present[p].size() ? 1 : 0;
    Utilities::MPI::min(is_comparable, model.communicator, is_comparable);
    int result = 0;
    for (std::size_t p = 0; p < present.size(); ++p)
      for (std::size_t i = 0; is_comparable[p] == 1 && i < present[p].size(); ++i)
        if (present[p][i] < 2. * smallest && present[p][i] < (1. - fraction) * times[p][i])
          result = 1;
    return Utilities::MPI::max(result, model.communicator) == 1;
  }

  template <int dim>
  void LocalShortening<dim>::serialize(StateArchive &archive, const Model<dim> &model)
  {
    bool is_kept = !times.empty();
    archive("has lengths at estimate", is_kept);
    if (!is_kept)
      return;
    times.resize(model.parts.size());
    for (unsigned int p = 0; p < model.parts.size(); ++p)
    {
      const auto group = archive.group("lengths of part " + model.parts[p].name);
      const std::vector<std::uint64_t> ids = model.persistent_ids_of_points(p);
      // There are no data of cells that are new since, as in a run without interruption.
      bool is_complete =
          Utilities::MPI::min(times[p].size() == ids.size() ? 1 : 0, model.communicator) == 1;
      archive("is complete", is_complete);
      if (!is_complete)
        continue;
      archive.set_rows(ids);
      archive.rows("length over wave speed", 1, times[p]);
    }
  }

  template class LocalShortening<2>;
  template class LocalShortening<3>;

  template <int dim>
  StepSize<dim>::StepSize(const Entries &e)
  {
    safety_factor = e.number(
        "Safety factor", "0.85",
        positive_up_to(
            1.,
            ": a step beyond the limit is not stable. To take a step of your own, set `Fixed`."),
        "",
        "The step is this fraction of the limit, above 0 and up to 1, or what springs and dampers "
        "of contacts leave of it, if that is less.");
    maximum = e.number("Maximum", "0", at_least(0.), "T",
                       "The largest step allowed; 0 is no limit of its own.");
    fixed =
        e.number("Fixed", "0", at_least(0.), "T",
                 "A step given by the user, taken without looking at any limit; 0 is not given.");
    check_interval =
        e.integer("Check interval", "20", between(1, 1000000),
                  "At the latest every so many steps the check is made whether the limit must be "
                  "estimated anew; more often while cells or supports change fast.");
    e.alias("Check interval", "Look interval");
    reestimation_threshold = e.number("Re-estimation threshold", "0.03", between(0., 1.), "",
                                      "The estimate is repeated when the smallest length over wave "
                                      "speed has changed by this fraction since the last one.");
    e.alias("Re-estimation threshold", "Change that matters");
    longest_estimate_interval =
        e.integer("Estimate interval", "40", between(1, 1000000),
                  "Where particles renew their shape functions, the estimate is repeated at the "
                  "latest after so many steps, earlier where the last ones differed; 1: at each "
                  "renewal, for flows that stir, where one renewal can halve the stable step.");
    steps_to_estimate = std::min(shortest_estimate_interval, longest_estimate_interval);
    estimator = std::make_unique<SpectralEstimator<dim>>(e.subsection("spectral"));
  }

  template <int dim>
  double StepSize<dim>::next(const Model<dim> &model, const Clock &clock, const double target,
                             const bool has_new_neighbours)
  {
    stable_fraction = 1.;
    if (fixed == 0.)
    {
      is_renewed = has_new_neighbours || (is_renewed && model.stencils_change_for_good);
      const bool estimate_is_due = is_renewed && clock.step >= step_of_estimate + steps_to_estimate;
      const bool is_checked = !has_limit || has_new_neighbours || estimate_is_due ||
                              clock.step >= step_of_check + steps_to_check;
      if (is_checked)
      {
        const double courant = tombolo::courant_limit(model).time_step;
        adapt_interval(clock.step - step_of_check, courant);
        step_of_check = clock.step;
        const bool has_changed =
            std::abs(courant - courant_at_estimate) > reestimation_threshold * courant_at_estimate;
        // In an impact one cell shortens by tenths while the shortest stays as it is.
        constexpr double local_over_global = 2.;
        const bool has_shortened =
            has_limit && !has_changed &&
            shortening.exceeds(model, local_over_global * reestimation_threshold);
        // New shape functions have another spectrum at the same lengths. Kernels that are renewed
        // in every step change too little from one to the next.
        if (!has_limit || has_changed || has_shortened || estimate_is_due)
        {
          is_renewed = false;
          const double last = present.time_step;
          present = estimator->estimate(model, has_limit ? last : 0.);
          adapt_estimate_interval(clock.step - step_of_estimate, last);
          step_of_estimate = clock.step;
          courant_at_estimate = courant;
          shortening.store(model);
          has_limit = true;
          ++count;
        }
      }
    }
    if (fixed == 0.)
      for (const auto &process : model.processes)
        process->observed.step_limits(present.time_step, stable_fraction);
    double step = allowed();
    // Where the step grows from Δt to Δt' central differences lose ¼ (Δt' - Δt) f²/m Δt: with
    // pieces that oscillate fast it must not grow at once.
    constexpr double largest_growth = 1.1;
    if (fixed == 0. && model.stencils_change_for_good && clock.previous_step > 0.)
      step = std::min(step, largest_growth * clock.previous_step);
    const double remaining = target - clock.time;
    const double n_steps = std::max(1., std::ceil(remaining / step * (1. - 1e-9)));
    step = remaining / n_steps;
    smallest_step = std::min(smallest_step, step);
    largest_step = std::max(largest_step, step);
    return step;
  }

  template <int dim>
  void StepSize<dim>::mesh_has_changed(const Parameters &parameters)
  {
    estimator = std::make_unique<SpectralEstimator<dim>>(
        parameters.section("Time step").subsection("spectral"));
    shortening = LocalShortening<dim>();
    has_limit = is_renewed = false;
    courant_at_estimate = courant_at_check = 0;
    steps_to_check = 1;
  }

  template <int dim>
  double StepSize<dim>::stable() const
  {
    return fixed > 0. ? fixed : round_down(present.time_step);
  }

  template <int dim>
  double StepSize<dim>::allowed() const
  {
    if (fixed > 0.)
      return fixed;
    // The limit by contacts has no margin, and lengths may have shrunk by the threshold since.
    const double contact_factor = stable_fraction < 1. ? 1. - reestimation_threshold : 1.;
    const double step =
        round_down(std::min(safety_factor, contact_factor * stable_fraction) * present.time_step);
    return maximum > 0. ? std::min(step, maximum) : step;
  }

  template <int dim>
  void StepSize<dim>::adapt_interval(const unsigned long steps, const double courant)
  {
    // In an impact cells shrink by tenths within few steps: the next check comes before the
    // threshold is reached, judged by the last one.
    const double change =
        std::abs(courant - courant_at_check) / std::max(courant, courant_at_check);
    const double most = std::min(2. * steps_to_check, double(check_interval));
    const double wanted = courant_at_check > 0. ? 0.5 * reestimation_threshold /
                                                      std::max(change, 1e-12) * double(steps)
                                                : 1.;
    steps_to_check = static_cast<unsigned int>(std::max(1., std::min(wanted, most)));
    courant_at_check = courant;
  }

  template <int dim>
  void StepSize<dim>::adapt_estimate_interval(const unsigned long steps, const double last)
  {
    const double change = std::abs(present.time_step - last) / present.time_step;
    constexpr double tolerated_change = 0.005;
    const double wanted =
        has_limit ? tolerated_change / std::max(change, 1e-12) * double(steps) : 1.;
    steps_to_estimate = static_cast<unsigned int>(std::min(
        std::max(double(shortest_estimate_interval), std::min(wanted, 2. * steps_to_estimate)),
        double(longest_estimate_interval)));
  }

  template <int dim>
  void StepSize<dim>::list(Records &records, const Model<dim> &model)
  {
    tombolo::list(records, present);
    records.value("has limit", has_limit);
    records.value("paper's limit at estimate", courant_at_estimate);
    records.value("step of look", step_of_check);
    records.value("steps to look", steps_to_check);
    records.value("paper's limit at look", courant_at_check);
    records.value("step of estimate", step_of_estimate);
    records.value("steps to estimate", steps_to_estimate);
    records.value("is renewed", is_renewed);
    records.value("smallest", smallest_step);
    records.value("largest", largest_step);
    records.value("estimates", count);
    records.archived([this, &model](StateArchive &archive)
                     { shortening.serialize(archive, model); });
    estimator->list(records.group("spectral estimator"), model);
  }

  template class StepSize<2>;
  template class StepSize<3>;
} // namespace tombolo
