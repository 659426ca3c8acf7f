#include <tombolo/formulations/formulation.h>

#include <tombolo/base/exceptions.h>

namespace tombolo
{
  template <int dim>
  void Formulation<dim>::add_conduction(const NodalVector & /*position*/,
                                        const NodalVector & /*of_conductivity*/,
                                        const NodalVector & /*temperature*/,
                                        NodalVector & /*heat_rate*/) const
  {
    throw InputError("A part has a formulation that conducts no heat, but its material has heat.");
  }

  template <int dim>
  StepLimit Formulation<dim>::diffusion_limit(const NodalVector & /*position*/) const
  {
    return {};
  }

  template class Formulation<2>;
  template class Formulation<3>;
} // namespace tombolo
