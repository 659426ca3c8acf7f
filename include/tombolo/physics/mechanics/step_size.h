// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <memory>
#include <vector>

namespace tombolo
{
  class StateArchive;
  template <int dim>
  class Model;

  /**
   * Which cells and particles have become shorter since the stable step was estimated. The smallest
   * length over wave speed of a body has no information on a cell that was twice as long and now
   * limits the step, or of a layer that shears while another one grows.
   */
  template <int dim>
  class LocalShortening
  {
  public:
    /** Keeps the length over wave speed of each cell and particle of this rank. */
    void store(const Model<dim> &model);

    /** Whether any of those within twice the smallest of all has lost more than @p fraction since
     * store(). Parts whose cells have changed since do not count. Collective. */
    bool exceeds(const Model<dim> &model, double fraction) const;

    /** Writes to a checkpoint or reads from it, by cell and particle. Collective. */
    void serialize(StateArchive &archive, const Model<dim> &model);

  private:
    std::vector<std::vector<double>> times; // by part, in the order of courant_limits() [T]
  };

  /** Chooses the time step: the limit of the spectrum times the safety factor, at most the maximum,
   * such that outputs are met exactly by equal steps. */
  template <int dim>
  class StepSize
  {
  public:
    /** Of section "Time step". */
    explicit StepSize(const Entries &e);

    /** The step from the clock's time towards @p target, not beyond it. Estimates the limit again
     * where the configuration has changed by more than the threshold. Collective. */
    double next(const Model<dim> &model, const Clock &clock, double target,
                bool has_new_neighbours);

    /** Lists the state from step to step. */
    void list(Records &records, const Model<dim> &model);

    /** After a change of the mesh: the next limit is estimated as the first was. */
    void mesh_has_changed(const Parameters &parameters);

    /** The limit found last, before the safety factor, with the entity that limits it. */
    const StepLimit &limit() const
    {
      return present;
    }

    /** The next step needs a new estimate: cells have been removed, and the rest of a body can move
     * faster than the whole. */
    void discard_limit()
    {
      has_limit = false;
    }

    /** The step that the limit, the springs of contacts and the maximum allow, without regard to a
     * target. */
    double allowed() const;

    /** The limit itself, before the safety factor; or the step given by the user. */
    double stable() const;

    /** Whether the user gives the step, which no limit changes then. */
    bool is_given() const
    {
      return fixed > 0.;
    }

    double smallest() const
    {
      return smallest_step;
    }
    double largest() const
    {
      return largest_step;
    }
    unsigned int n_estimates() const
    {
      return count;
    }

  private:
    std::unique_ptr<SpectralEstimator<dim>> estimator;
    double safety_factor;
    /** The fraction of the limit of the bodies that is stable with the springs of contacts. */
    double stable_fraction = 1.;
    double maximum;
    double fixed;
    unsigned int check_interval;
    double reestimation_threshold;

    StepLimit present;
    bool has_limit = false;
    double courant_at_estimate = 0;
    /** Chooses when to check again, from the change over so many @p steps. */
    void adapt_interval(unsigned long steps, double courant);
    /** Doubles the time to the next estimate for renewed kernels while the last changed little from
     * the one before, @p last, @p steps ago. */
    void adapt_estimate_interval(unsigned long steps, double last);

    LocalShortening<dim> shortening; // since the last estimate
    unsigned long step_of_check = 0;
    unsigned int steps_to_check = 1;
    double courant_at_check = 0;
    /** Kernels that are renewed in every step: a few estimates of an unchanged limit apart. */
    static constexpr unsigned int shortest_estimate_interval = 5;
    unsigned int longest_estimate_interval = 40;
    unsigned int steps_to_estimate = shortest_estimate_interval;
    unsigned long step_of_estimate = 0;
    bool is_renewed = false; ///< shape functions have changed since the last estimate
    double smallest_step = 1e300, largest_step = 0;
    unsigned int count = 0;
  };
} // namespace tombolo
