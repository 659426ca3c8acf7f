// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
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

  /** Section "Exact solution": functions of the initial position and of time. */
  template <int dim>
  class ExactSolution
  {
  public:
    /** Whether the section sets anything. */
    static bool is_given(const Section &section)
    {
      return section.is_set("Stress") || section.is_set("Velocity") ||
             section.is_set("Temperature");
    }

    explicit ExactSolution(const Entries &e)
    {
      stress_function = e.if_set<Expression<dim>>(
          "Stress", "M/(L T^2)",
          "Six components xx; yy; zz; yz; xz; xy of the exact Cauchy "
          "stress, functions of the initial position and of t. Errors "
          "against it are reported at every output, and pictures show it.",
          6);
      velocity_function =
          e.if_set<Expression<dim>>("Velocity", "L/T", "Components of the exact velocity.", dim);
      temperature_function =
          e.if_set<Expression<dim>>("Temperature", "temperature", "The exact temperature.", 1);
    }

    /** Throws InputError if the section sets what no run can compare with. */
    static void validate(const Section &section, const bool has_mechanics, const bool has_heat)
    {
      const ExactSolution solution(section);
      for (const char *const entry : {"Stress", "Velocity"})
        if (section.is_set(entry) && !has_mechanics)
          section.fail(entry, "the scene has no mechanics, since its materials have no stresses; "
                              "allowed is `Temperature`.");
      if (solution.has_temperature() && !has_heat)
        section.fail("Temperature",
                     "the scene has no heat; give its materials a section \"Heat\".");
    }

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
    dealii::SymmetricTensor<2, 3> stress(const Point<dim> &point, const double time) const
    {
      static constexpr unsigned int row[6] = {0, 1, 2, 1, 0, 0};
      static constexpr unsigned int column[6] = {0, 1, 2, 2, 2, 1};
      SymmetricTensor<2, 3> result;
      for (unsigned int c = 0; c < 6; ++c)
        result[row[c]][column[c]] = stress_function->value(point, time, c);
      return result;
    }

    double temperature(const dealii::Point<dim> &point, const double time) const
    {
      return temperature_function->value(point, time);
    }

    /** Errors at @p time of the stress of the parts and of the nodal velocities, which are those of
     * half a step before; so the exact velocity is taken at @p velocity_time. Collective. */
    ExactSolutionErrors errors(const std::vector<const Formulation<dim> *> &parts,
                               const NodalVector &initial_position, const NodalVector &velocity,
                               const NodalVector &mass, const double time,
                               const double velocity_time)
    {
      std::array<double, 6> sums{}; // squares of error and of exact: xx, all, velocity
      const auto add = [&]()
      {
        if (has_stress())
          for (const Formulation<dim> *part : parts)
          {
            const MaterialPoints &points = part->points();
            const double *const volume = points.component(MaterialPoints::volume, 0);
            const auto &positions = part->initial_point_positions();
            for (unsigned int i = 0; i < points.size(); ++i)
              for (unsigned int c = 0; c < 6 && volume[i] != 0.; ++c) // points of cells
              {
                const double exact = stress_function->value(positions[i], time, c);
                const double error = points.component(MaterialPoints::stress, c)[i] - exact;
                const double weight = volume[i] * (c < 3 ? 1. : 2.);
                if (c == 0)
                {
                  sums[0] += weight * error * error;
                  sums[1] += weight * exact * exact;
                }
                sums[2] += weight * error * error;
                sums[3] += weight * exact * exact;
              }
          }
        if (has_velocity())
          for (unsigned int i = 0; i < velocity.partition()->n_owned(); ++i)
          {
            const Point<dim> point = point_of<dim>(initial_position.node(i));
            for (unsigned int d = 0; d < dim; ++d)
            {
              const double exact = velocity_function->value(point, velocity_time, d);
              const double error = velocity.node(i)[d] - exact;
              sums[4] += *mass.node(i) * error * error;
              sums[5] += *mass.node(i) * exact * exact;
            }
          }
      };
      // A function can be without a value on one rank only.
      attempt_on_all_ranks<RunError>(velocity.partition()->communicator(), add);
      const std::array<double, 6> total = ordered_sum(sums, velocity.partition()->communicator());
      for (const auto &[exact, largest] :
           {std::pair<double, double &>{total[1], largest_axial_stress},
            {total[3], largest_stress},
            {total[5], largest_velocity}})
        largest = std::max(largest, exact);
      // Where waves cancel, the exact solution is zero but for round-off.
      const auto relative = [](const double error, const double exact, const double largest)
      {
        return exact > 1e-20 * largest ? std::sqrt(error / exact)
                                       : std::numeric_limits<double>::quiet_NaN();
      };
      return {relative(total[0], total[1], largest_axial_stress),
              relative(total[2], total[3], largest_stress),
              relative(total[4], total[5], largest_velocity)};
    }

    /** Relative L2 error at @p time of the temperatures in slot 0 at the nodes, weighted by @p
     * weights (scalar, owned: capacities). Collective. */
    double temperature_error(const NodalVector &initial_position, const NodalVector &temperature,
                             const NodalVector &weights, const double time) const
    {
      std::array<double, 2> sums{}; // squares of error and of exact
      attempt_on_all_ranks<RunError>(
          temperature.partition()->communicator(),
          [&]
          {
            for (unsigned int i = 0; i < temperature.partition()->n_owned(); ++i)
            {
              const double exact =
                  temperature_function->value(point_of<dim>(initial_position.node(i)), time);
              const double error = *temperature.node(i) - exact;
              sums[0] += *weights.node(i) * error * error;
              sums[1] += *weights.node(i) * exact * exact;
            }
          });
      sums = ordered_sum(sums, temperature.partition()->communicator());
      return sums[1] > 0. ? std::sqrt(sums[0] / sums[1]) : std::numeric_limits<double>::quiet_NaN();
    }

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
