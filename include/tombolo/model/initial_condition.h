// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>

#include <deal.II/base/tensor.h>

#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  template <int dim>
  class Model;
  template <int dim>
  struct Physics;

  /** The content of a section "Initial condition: NAME". */
  template <int dim>
  struct InitialCondition
  {
    explicit InitialCondition(const Entries &e);

    /** A rigid rotation about an axis through a point. */
    struct Spin
    {
      dealii::Tensor<1, 3> rate; ///< angular velocity [1/T]
      dealii::Tensor<1, dim> centre;
    };

    std::optional<Predicate<dim>> where;
    std::vector<std::string> parts; ///< empty: all
    std::optional<Expression<dim>> velocity;
    std::optional<Spin> spin; ///< adds to the velocity
    std::optional<Expression<dim>> stress;
    std::optional<Expression<dim>> temperature;
  };

  /** Throws InputError where initial conditions do not fit what there is of mechanics and heat. */
  template <int dim>
  void validate_initial_conditions(const Parameters &parameters, const Physics<dim> &physics);

  /** Sets velocities, temperatures and stresses of @p model by all initial conditions, then the
   * velocities that conditions prescribe. Throws InputError. Collective. */
  template <int dim>
  void set_initial_conditions(const Parameters &parameters, Model<dim> &model);

  /** An interval that is short against the first step; a thousandth of 1e300 where nothing limits
   * that. Collective. */
  template <int dim>
  double short_interval(const Model<dim> &model);
} // namespace tombolo
