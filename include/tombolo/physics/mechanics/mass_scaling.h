// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/model/process.h>

#include <mpi.h>

namespace tombolo
{
  /**
   * Section "Scaling": what makes a quasi-static process cheaper to follow with explicit steps.
   *
   * A process that runs s times faster, with everything that has a time in it carried along
   * (conductivity, film coefficients and radiation times s, reference strain rates times s,
   * functions of s t), is in its own time the same as one with s² times the inertia and all else as
   * it is. So nothing is carried along: the file stays in the time of the process, and inertia is
   * multiplied by inertia_factor().
   */
  struct ScalingSettings
  {
    /** Nothing scaled. */
    ScalingSettings() = default;

    explicit ScalingSettings(const Entries &e);

    /** Of the density of all materials. */
    double inertia_factor() const
    {
      return mass_factor * process_time_factor * process_time_factor;
    }

    /** Whether anything is scaled. */
    bool is_active() const
    {
      return inertia_factor() != 1. || is_selective();
    }

    /** Whether the mass of single cells and particles is. */
    bool is_selective() const
    {
      return target_time_step > 0.;
    }

    double mass_factor = 1.;
    double process_time_factor = 1.;
    double target_time_step = 0.; ///< by eq. (41) [T]; zero: none
    unsigned int interval = 0;    ///< steps between looks at the target

    /** The largest factor allowed; its inverse is the smallest. */
    static constexpr double largest_factor = 1e12;
  };

  /**
   * The inertia of the parts of a scene where it is not that of their densities. The uniform factor
   * is that of the materials (Material::scale_inertia); this process finds the factors of single
   * cells and particles (Part::inertia), which bring each of them to the target step, and reports
   * what was scaled. By the theorem of element eigenvalues the step of a mesh is at least the
   * smallest one of its elements, each with its own mass.
   */
  template <int dim>
  class MassScaling : public Process<dim>
  {
  public:
    /** Finds the factors for the initial positions and gives the model their masses. Throws
     * InputError where the target does nothing, or would take too much. Collective. */
    MassScaling(const Section &section, const ScalingSettings &settings, Model<dim> &model);

    ModelChange change_model(Model<dim> &model, const Clock &clock) override;

    /** Adds mass to cells and particles whose step has fallen below the target. Returns whether
     * there are any, on any rank. Collective. */
    bool raise_masses(Model<dim> &model);

    /** Numbers over all ranks. Collective. */
    struct Extent
    {
      unsigned long cells = 0, particles = 0; ///< that have more than the uniform factor
      double smallest_step = 0;               ///< by eq. (41), without any scaling [T]
    };
    Extent extent(const Model<dim> &model) const;

    /** True mass, added mass and inertia, in the time of the process [M]. */
    struct Masses
    {
      double true_mass, added, inertia;
    };
    /** Collective. */
    Masses masses(const Model<dim> &model) const;

  private:
    void start(Model<dim> &model);
    void describe(const Model<dim> &model, std::ostream &text) const;
    void report(const Model<dim> &model, TimeTable &table) const;
    Json results(const Model<dim> &model, const TimeTable &table) const;
    /** Finds the factors for the present positions; whether any has risen. Collective. */
    bool raise_factors(Model<dim> &model) const;
    /** Energy and momentum of mass that was added to nodes in motion, whose velocity stays. */
    void account_for_added_mass(Model<dim> &model, const NodalVector &previous_mass);

    Section section;
    ScalingSettings settings;
    MPI_Comm communicator;
    double work = 0; ///< this rank's share [M L^2/T^2]
  };
} // namespace tombolo
