// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/model/model.h>
#include <tombolo/model/static_process.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The contacts of a model in static steps. Their springs are those of explicit steps at the step
   * of eq. (41), α m c²/h² at a node, which no longer depends on any time, times a factor.
   */
  template <int dim>
  class StaticContacts
  {
  public:
    /** Finds the contacts of the model. */
    explicit StaticContacts(Model<dim> &model);

    /** Refuses contacts that need a mass or an acceleration, which needs no mesh. Throws
     * InputError.
     */
    static void refuse_unfit(const Parameters &parameters, const std::string &method);

    /** From now on steps are static, with springs that are by @p factor stiffer than those of
     * explicit steps. Collective. */
    void become_static(double factor);

    bool are_present() const
    {
      return !members.empty();
    }

    /** Of which springs are made [T]. */
    double spring_time() const
    {
      return time_of_springs;
    }

    void begin_trial(const Clock &clock);
    void restart_trial();

    /** Of the last evaluation. Collective. */
    std::vector<ContactStiffness<dim>> stiffness(const Clock &clock) const;

    /** Of what touches in the present state, at the start of the run. Collective. */
    std::vector<ContactStiffness<dim>> stiffness_at_start();

    /** Adds a bound of the stiffness of all contacts to sums by rows of owned nodes. */
    void add_stiffness_bound(const Clock &clock, NodalVector &sums) const;

  private:
    Model<dim> &model;
    std::vector<StaticProcess<dim> *> members;
    double time_of_springs = 0;
  };
} // namespace tombolo
