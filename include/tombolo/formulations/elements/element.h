// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/step_cost.h>
#include <tombolo/materials/kinematics.h>
#include <tombolo/materials/material.h>

#include <vector>

namespace tombolo
{
  /** What an element's hooks may do with its own state variables: component c at point q of n_lanes
   * cells is the Lanes at variables[c] + n_lanes q, in the order of Element::variables(). */
  using ElementVariables = double *const *;
  using ConstElementVariables = const double *const *;

  /**
   * An element type is a small class that CellFormulation<dim, Element> is instantiated with. All
   * its arithmetic is on Lanes: n_lanes cells at a time. It has no virtual functions; the compiler
   * puts it into the loops of the driver. To derive from ElementDefaults gives it the members that
   * an element without state of its own does not need; what remains to be written is
   *
   * @code
   *   static constexpr unsigned int degree, n_nodes, n_points;
   *   struct Work;  // what integrate() needs from evaluate()
   *   explicit Element(const Section &section);
   *   static std::vector<dealii::Point<dim>> reference_points();     // in [-1, 1]^dim
   *   void evaluate(const Lanes (&x)[n_nodes][dim], const Lanes (&v)[n_nodes][dim], Work &work,
   *                 Lanes (&volume)[n_points], Matrix3<Lanes> (&gradient)[n_points]) const;
   *   void integrate(const Work &work, const Lanes (&stress)[n_points][6],
   *                  Lanes (&force)[n_nodes][dim]) const;
   * @endcode
   *
   * evaluate() returns the volume of each point and the gradient of v with respect to x there
   * (∂v_i/∂x_j is gradient(i, j); zero in the third row and column in two dimensions). integrate()
   * is its transpose: the nodal forces that, for every v, have the power Σ_q stress_q : gradient_q
   * plus that of hourglass forces kept in @p work; the stress comes multiplied by the volume. It
   * sets @p force. Nodes are lexicographic, x fastest.
   */
  struct ElementDefaults
  {
    static constexpr MassLumping lumping = MassLumping::row_sum;
    /** Whether share() gives all points of a cell one growth of volume (logarithmic strains). */
    static constexpr bool shares_volume = false;
    /** The default of `Strain measure`. */
    static constexpr StrainMeasure measure = StrainMeasure::logarithmic;
    /** Of a point in a step, without stress, in units of StepCosts (Formulation::step_cost()). */
    static constexpr double cost_per_point = StepCosts::per_point;

    static void declare_parameters(dealii::ParameterHandler & /*handler*/) {}

    /** State variables of the element at its points, beyond the stress. */
    std::vector<FieldDescription> variables() const
    {
      return {};
    }

    /** Called once, before all else. */
    void set_material(const Material & /*material*/) {}

    /** Whether the element resists the rate of its deformation. */
    bool is_viscous() const
    {
      return false;
    }

    /** Initial values of the state variables; @p work is of the initial positions. */
    template <typename Work>
    void initialize_variables(const Work & /*work*/, ElementVariables /*variables*/) const
    {}

    /** For elements whose points share a part of their strain: removes from the gradient of
     * evaluate(), at the end of the step, what is shared, ... */
    template <typename Work, unsigned int n_points>
    static void separate(const Work & /*work*/, Matrix3<Lanes> (&/*gradient*/)[n_points])
    {}

    /** ... and shares the strain of the middle of the step, which was made of the gradient; for
     * StrainMeasure::logarithmic the volumes of the points, too. */
    template <typename Work, unsigned int n_points>
    static void share(const Work & /*work*/, const bool /*is_logarithmic*/,
                      MotionIncrement<Lanes> (&/*motion*/)[n_points])
    {}

    /** Advances the state variables by a step and keeps in @p work the hourglass forces that
     * integrate() is to add. @p spin is the axial vector of the rotation increment of each point
     * (see rotation_of()). Called between evaluate() and integrate(). */
    template <typename Work, unsigned int n_points>
    void advance(Work & /*work*/, const Lanes (&/*spin*/)[n_points][3],
                 const double /*time_increment*/, ElementVariables /*variables*/) const
    {}

    /** Whether limit() is to be called. */
    static constexpr bool limits_forces = false;

    /** After the stresses: limits the hourglass forces in @p work and @p variables. @p flow_stress
     * is the von Mises stress of points that flow plastically in this step, zero elsewhere. */
    template <typename Work, unsigned int n_points>
    void limit(Work & /*work*/, const Lanes (&/*flow_stress*/)[n_points],
               ElementVariables /*variables*/) const
    {}

    /** Instead of advance(), keeps in @p work the hourglass force that the velocity of evaluate()
     * causes per unit time: (K + 2/Δt C) v of hourglass stiffness and viscosity. */
    template <typename Work>
    void linearize(Work & /*work*/, const double /*time_step*/,
                   ConstElementVariables /*variables*/) const
    {}

    /** Adds the stored energy of n_lanes cells, and what they have dissipated since the start. */
    void add_energies(ConstElementVariables /*variables*/, Lanes & /*stored*/,
                      Lanes & /*dissipated*/) const
    {}
  };
} // namespace tombolo
