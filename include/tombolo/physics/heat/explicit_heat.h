// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/physics/heat/growing_rates.h>
#include <tombolo/physics/heat/heat_integrator.h>
#include <tombolo/physics/mechanics/lobpcg.h>

namespace tombolo
{
  /** The forward Euler method of eqs (36), (37), (39), with the stable step of the spectrum of
   * the real operator, 2/λ. */
  template <int dim>
  class ExplicitHeat : public HeatIntegrator<dim>
  {
  public:
    explicit ExplicitHeat(const Entries &e);

    double allowed_step(Model<dim> &model, double time) override;
    void advance(Model<dim> &model, double time, double time_step,
                 std::vector<double> &of_condition) override;
    void mesh_has_changed() override;
    const StepLimit &limit() const override;
    void list(Records &records, const Model<dim> &model) override;

  private:
    void find_limit(Model<dim> &model, double time);
    void forget_estimate();
    /** @p time_step is the present one of find_limit(). */
    void mend_limit(Model<dim> &model, double time, double time_step);
    double step_of_limit() const;
    void find_rate(Model<dim> &model, double time);

    double safety_factor;
    double maximum;
    Lobpcg solver;
    StepLimit present;
    double paper_limit_at_estimate = 0;
    unsigned int steps_since_look = 0;
    unsigned int n_calls = 0;
    NodalVector rate, capacity;
    std::vector<double> rates_of_conditions;
    bool has_rate = false; ///< of the state that advance() will be given
    GrowingRates<dim> growing_rates;
    double shown_eigenvalue = 0; ///< by rates that grow, at the coming step
  };
} // namespace tombolo
