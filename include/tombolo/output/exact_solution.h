// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/state/records.h>

#include <deal.II/base/symmetric_tensor.h>

#include <vector>

namespace tombolo
{

  /** Relative errors at one time, in the L2 norm over the material points, weighted by their
   * volumes. NaN where the exact solution is zero everywhere, or was 10^10 times larger before. */
  struct ExactSolutionErrors
  {
    double axial_stress = 0; ///< component xx alone
    double stress = 0;       ///< all components
    double velocity = 0;     ///< at the nodes, weighted by their masses
  };

  /** What a case's solution should be: section "Exact solution", functions of the initial position
   * and of time. */
  template <int dim>
  class ExactSolution
  {
  public:
    /** Whether the section gives anything. */
    static bool is_given(const Section &section);

    explicit ExactSolution(const Entries &e);

    /** Throws InputError if the section gives what no run can compare with. */
    static void validate(const Section &section, bool has_mechanics, bool has_heat);

    bool has_stress() const
    {
      return stress_function.has_value();
    }

    bool has_velocity() const
    {
      return velocity_function.has_value();
    }

    bool has_temperature() const
    {
      return temperature_function.has_value();
    }

    /** xx; yy; zz; yz; xz; xy at an initial position. */
    dealii::SymmetricTensor<2, 3> stress(const dealii::Point<dim> &place, double time) const;

    double temperature(const dealii::Point<dim> &place, const double time) const
    {
      return temperature_function->value(place, time);
    }

    /** Errors at @p time of the stress of the parts and of the nodal velocities, which are those of
     * half a step before; so the exact velocity is taken at @p velocity_time. Collective. */
    ExactSolutionErrors errors(const std::vector<const Formulation<dim> *> &parts,
                               const NodalVector &initial_position, const NodalVector &velocity,
                               const NodalVector &mass, double time, double velocity_time);

    /** Relative L2 error at @p time of the temperatures in slot 0 at the nodes, weighted by @p
     * weights (scalar, owned: capacities). Collective. */
    double temperature_error(const NodalVector &initial_position, const NodalVector &temperature,
                             const NodalVector &weights, double time) const;

    /** Lists what is kept between evaluations. */
    void list(Records &records)
    {
      records.value("largest axial stress", largest_axial_stress);
      records.value("largest stress", largest_stress);
      records.value("largest velocity", largest_velocity);
    }

  private:
    std::optional<Expression<dim>> stress_function;
    std::optional<Expression<dim>> velocity_function;
    std::optional<Expression<dim>> temperature_function;
    // Squares of the largest norms of the exact solution so far.
    double largest_axial_stress = 0, largest_stress = 0, largest_velocity = 0;
  };
} // namespace tombolo
