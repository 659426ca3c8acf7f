// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/stencil_renewal.h>

#include <tombolo/model/model.h>
#include <tombolo/output/time_table.h>

#include <deal.II/base/mpi.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  ModelChange StencilRenewal<dim>::change_model(Model<dim> &model, const Clock &)
  {
    return model.update_stencils();
  }

  template <int dim>
  void StencilRenewal<dim>::report(const Model<dim> &model, TimeTable &table) const
  {
    double n_deficient = 0, n_non_negative = 0;
    for (ParticleFormulation<dim> *const particles : model.particle_parts())
    {
      const Stencils &stencils = particles->stencils();
      n_deficient += static_cast<double>(stencils.rank_deficient_rows.size() +
                                         stencils.uncorrected_rows.size());
      n_non_negative += static_cast<double>(stencils.non_negative_rows.size());
    }
    table.add("particles without a basis", "1",
              Utilities::MPI::sum(n_deficient, model.communicator));
    table.add("particles kept from extrapolating", "1",
              Utilities::MPI::sum(n_non_negative, model.communicator));
  }

  namespace
  {
    template <int dim>
    class StencilRenewalKind : public ProcessKind<dim>
    {
    public:
      std::unique_ptr<Process<dim>> create_one(const Parameters &, Model<dim> &model) const override
      {
        if (!model.has_mechanics || model.particle_parts().empty())
          return nullptr;
        return std::make_unique<StencilRenewal<dim>>();
      }
    };
  } // namespace

  template class StencilRenewal<2>;
  template class StencilRenewal<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(StencilRenewalKind, process_order::renewal)
} // namespace tombolo
