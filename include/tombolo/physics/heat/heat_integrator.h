// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

#include <vector>

namespace tombolo
{
  class Summary;

  /** How heat goes from one thermal time to the next: a plug-in, `Heat/Time integration`. */
  template <int dim>
  class HeatIntegrator
  {
  public:
    virtual ~HeatIntegrator() = default;

    /** The step allowed at the present state: a fraction of the stable one, or the one that the
     * user gives. Collective. */
    virtual double allowed_step(const Model<dim> &model, double time) = 0;

    /** From enthalpy, unsmoothed temperature and temperature at @p time to next_enthalpy and
     * next_unsmoothed_temperature (owned) at the end of the step, such that Σ next_enthalpy has
     * changed by what is added to @p of_condition, summed over conditions and ranks, to round-off.
     * Collective. */
    virtual void advance(const Model<dim> &model, double time, double time_step,
                         std::vector<double> &of_condition) = 0;

    /** Forgets what belongs to the nodes of a mesh, which is another one now. */
    virtual void mesh_has_changed() {}

    /** What limits the step, where something does. */
    virtual const StepLimit &limit() const = 0;

    /** Lists what is kept between steps. */
    virtual void list(Records & /*records*/, const Model<dim> & /*scene*/) {}

    /** Adds what it cost so far to the summary of the run. */
    virtual void add_to_summary(Summary & /*summary*/) const {}
  };

  template <int dim>
  struct PluginKind<HeatIntegrator<dim>>
  {
    static constexpr const char *name = "heat integrator";
  };
} // namespace tombolo
