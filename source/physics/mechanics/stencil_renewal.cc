// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/stencil_renewal.h>

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/model/internal_power.h>
#include <tombolo/model/model.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/failure/bond_failure_process.h>

#include <deal.II/base/mpi.h>

#include <cmath>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  StencilRenewal<dim>::StencilRenewal(const bool breaks, const bool renews)
      : breaks(breaks), renews(renews)
  {
    this->roles.rest = ProcessRole::is_idle; // rows stay those of the start
    this->records.group("renewal of stencils").sums("taken", taken_by_breaks, taken_by_renewals);
  }

  template <int dim>
  ModelChange StencilRenewal<dim>::change_model(Model<dim> &model, const Clock &clock)
  {
    step = clock.previous_step;
    is_booked = false;
    const ModelChange change = model.update_stencils();
    if (change.stencils)
    {
      const double n_before = n_broken;
      n_broken = n_broken_bonds(model);
      if (is_booked)
      {
        model.bridge->smooth_velocity(model.state);
        (n_broken > n_before ? taken_by_breaks : taken_by_renewals) +=
            taken_by_change(power, power_back(model), step, model.communicator);
      }
    }
    step = 0.;
    return change;
  }

  template <int dim>
  void StencilRenewal<dim>::prepare_change(Model<dim> &model)
  {
    // Bonds that break are counted before they leave the rows.
    is_booked = step > 0. && (renews || n_broken_bonds(model) > n_broken);
    if (!is_booked)
      return;
    back = 0.;
    power = power_back(model);
    if (std::isfinite(Utilities::MPI::sum(power, model.communicator)))
      return;
    back = step;
    power = power_back(model);
  }

  template <int dim>
  void StencilRenewal<dim>::model_changed(Model<dim> &model)
  {
    if (step == 0.) // else in change_model()
      n_broken = n_broken_bonds(model);
  }

  template <int dim>
  double StencilRenewal<dim>::power_back(Model<dim> &model) const
  {
    if (back == 0.)
      return internal_power(model, step);
    NodalState &state = model.state;
    const NodalVector present = state.position.copy();
    state.position.fill(
        [&](const unsigned int i, double *const place)
        { store_node(load_node(place) - load_node(state.velocity.node(i)) * back, place); });
    model.bridge->positions_have_changed();
    const double result = internal_power(model, step);
    state.position.copy_from(present);
    model.bridge->positions_have_changed();
    return result;
  }

  template <int dim>
  double StencilRenewal<dim>::n_broken_bonds(const Model<dim> &model) const
  {
    return breaks ? BondFailureProcess<dim>::bond_counts(model).n_broken : 0.;
  }

  template <int dim>
  void StencilRenewal<dim>::account(EnergyAccounts &accounts) const
  {
    if (breaks)
      accounts.add("failure dissipation", EnergyKind::dissipated, taken_by_breaks);
    if (renews)
      accounts.add("kernel renewal", EnergyKind::artificial, taken_by_renewals);
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
      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        if (!model.has_mechanics || model.particle_parts().empty())
          return nullptr;
        bool breaks = false, renews = false;
        for (const Part<dim> &part : model.parts)
          if (part.particles != nullptr)
          {
            const Section section = parameters.section("Part: " + part.name);
            const Section method = section.subsection(section.get("Formulation"));
            breaks = breaks || !part.particles->bond_counts().criterion.empty();
            renews = renews || (method.is_declared("Configuration") &&
                                method.get("Configuration") == "updated Lagrangian");
          }
        return std::make_unique<StencilRenewal<dim>>(breaks, renews);
      }
    };
  } // namespace

  template class StencilRenewal<2>;
  template class StencilRenewal<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(StencilRenewalKind, process_order::renewal)
} // namespace tombolo
