// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/stopwatch.h>
#include <tombolo/model/model.h>
#include <tombolo/output/energy_ledger.h>

#include <mpi.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Algorithm 1 of Pan et al. 2019 (doc/method.md, section 5), in two halves around the time t_n:
   * forces, then motion. Between them the state is complete at t_n (stress, position, acceleration)
   * and can be looked at.
   */
  template <int dim>
  class MechanicalStep
  {
  public:
    MechanicalStep(Model<dim> &model, EnergyLedger &ledger);
    ~MechanicalStep();

    /** From positions at t_n and velocities at t_{n-1/2} to the acceleration at t_n. Returns
     * whether neighbourhoods or masses changed. Throws RunError on all ranks when a value stopped
     * being finite, one step after it did. Collective. */
    bool evaluate_acceleration(const Clock &clock);

    /** Prescribes motion and books the step; the size of the coming step must be known.
     * Collective. */
    void complete_acceleration(const Clock &clock);

    /** From t_n to t_{n+1}. Collective. */
    void advance(const Clock &clock);

    /** Throws the RunError of a failure found in the step last evaluated, without waiting for the
     * next. Collective. */
    void check_now();

    /** Writes to a checkpoint, or reads from it, what the steps so far leave to the next beside the
     * scene and the ledger. Collective. */
    void serialize(StateArchive &archive);

    /** Wall time of the phases of all steps on this rank. */
    const Stopwatch &times() const;

  private:
    /** Adds mass where it is scaled and due; whether masses changed. Collective. */
    bool raise_masses(const Clock &clock);
    void erode(const Clock &clock);
    bool convert(const Clock &clock);
    void apply_lattice_filter();
    void add_internal_force(const Clock &clock);
    void add_self_contact(const MechanicalInput &input);
    void divide_by_mass(const Clock &clock);
    void begin_check();
    void end_check();

    Model<dim> &model;
    EnergyLedger &ledger;
    NodalVector element_force; // of the trace bridge
    NodalVector fragment_loads;
    std::vector<unsigned int> loaded_fragment_nodes;
    NodalVector half_kick; // v̂ at t_{n-1/2}, then (v̂ at t_{n+1/2} - v̂ at t_{n-1/2}) / 2
    double time_since_filter = 0;
    Stopwatch stopwatch;

    // The check for failure is a reduction that travels while the step goes on.
    std::string local_failure;
    int has_failed = 0;
    int any_has_failed = 0;
    MPI_Request check_request = MPI_REQUEST_NULL;
  };
} // namespace tombolo
