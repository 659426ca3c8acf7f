#pragma once

#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/tensor.h>

#include <tombolo/base/expression.h>
#include <tombolo/base/parameters.h>

#include <optional>

namespace tombolo
{
  /** How far a rigid body has moved, by functions of time. */
  template <int dim>
  class RigidTranslation
  {
  public:
    /** "Displacement". */
    static void declare_parameters(dealii::ParameterHandler &handler);

    /** Throws InputError. */
    explicit RigidTranslation(const Section &section);

    dealii::Tensor<1, dim> displacement(double time) const; ///< [L]

  private:
    std::optional<Expression<dim>> function;
  };
} // namespace tombolo
