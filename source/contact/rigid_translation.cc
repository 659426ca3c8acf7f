#include <tombolo/contact/rigid_translation.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void RigidTranslation<dim>::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry("Displacement", "", Patterns::Anything(),
                          "How far the body has moved at time t: components separated by `;`, "
                          "functions of t; empty for a body at rest. Units: L.");
  }

  template <int dim>
  RigidTranslation<dim>::RigidTranslation(const Section &section)
  {
    if (!section.get("Displacement").empty())
      function.emplace(section, "Displacement", dim);
  }

  template <int dim>
  Tensor<1, dim> RigidTranslation<dim>::displacement(const double time) const
  {
    Tensor<1, dim> result;
    if (function)
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = function->value(Point<dim>(), time, d);
    return result;
  }

  template class RigidTranslation<2>;
  template class RigidTranslation<3>;
} // namespace tombolo
