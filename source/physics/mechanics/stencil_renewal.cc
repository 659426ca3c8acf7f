// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/model/internal_power.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/failure/bond_counts.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <string>

namespace tombolo
{
  /**
   * Neighbourhoods and rows of particle parts, renewed by their criterion.
   *
   * Where rows change between t_{n-1} and t_n, the former forces do work in the first half of the
   * step, and the new points advance over the whole step. The difference, ½ Δt (P_before - P_after)
   * with the powers P of the stresses at t_{n-1}, is booked: as failure dissipation where bonds
   * break, else as that of the renewal.
   */
  template <int dim>
  class StencilRenewal : public Process<dim>
  {
  public:
    /** @p breaks: whether bonds can break; @p renews: whether kernels are renewed now and then.
     * Where they are renewed in every step alone, nothing is booked: it would need two more
     * evaluations of the forces. */
    StencilRenewal(const bool breaks, const bool renews, Model<dim> &model)
        : breaks(breaks), renews(renews)
    {
      this->records.group("renewal of stencils").sums("taken", taken_by_breaks, taken_by_renewals);
      model.signals.change.connect([this, &model] { prepare_change(model); });
      if (breaks)
        this->observed.energy("failure dissipation", EnergyKind::dissipated, taken_by_breaks);
      if (renews)
        this->observed.energy("kernel renewal", EnergyKind::artificial, taken_by_renewals);
      const auto add_column = [&](const std::string &name, const auto &n_of_rows)
      {
        this->observed.column(name, "1",
                              [=, &model]
                              {
                                double n = 0;
                                for (ParticleFormulation<dim> *const part : model.particle_parts())
                                  n += static_cast<double>(n_of_rows(part->stencils()));
                                return Utilities::MPI::sum(n, model.communicator);
                              });
      };
      add_column("particles without a basis", [](const Stencils &rows)
                 { return rows.rank_deficient_rows.size() + rows.uncorrected_rows.size(); });
      add_column("particles kept from extrapolating",
                 [](const Stencils &rows) { return rows.non_negative_rows.size(); });
    }

    ModelChange change_model(Model<dim> &model, const Clock &clock) override
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
              energy_of_change(power, power_back(model), step, model.communicator);
        }
      }
      step = 0.;
      return change;
    }

    void model_changed(const Model<dim> &model) override
    {
      if (step == 0.) // else in change_model()
        n_broken = n_broken_bonds(model);
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      if (!model.has_mechanics || model.particle_parts().empty())
        return nullptr;
      bool breaks = false, renews = false;
      for (const Part<dim> &part : model.parts)
        if (part.particles != nullptr)
        {
          const Section section = parameters.section("Part: " + part.name);
          const Section method = section.subsection(section.get("Formulation"));
          breaks = breaks || part.particles->breaking_bonds() != nullptr;
          renews = renews || (method.is_declared("Configuration") &&
                              method.get("Configuration") == "updated Lagrangian");
        }
      return std::make_unique<StencilRenewal>(breaks, renews, model);
    }

  private:
    /** Finds the power before rows change. Collective. */
    void prepare_change(Model<dim> &model)
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

    /** internal_power() at the positions of nodes a time `back` ago. Collective. */
    double power_back(Model<dim> &model) const
    {
      if (back == 0.)
        return internal_power(model, step);
      NodalState &state = model.state;
      const NodalVector present = state.position.copy();
      state.position.fill(
          [&](const unsigned int i, double *const coordinates) {
            store_node(load_node(coordinates) - load_node(state.velocity.node(i)) * back,
                       coordinates);
          });
      model.bridge->positions_have_changed();
      const double result = internal_power(model, step);
      state.position.copy_from(present);
      model.bridge->positions_have_changed();
      return result;
    }

    /** Over all ranks; zero where none can break. Collective. */
    double n_broken_bonds(const Model<dim> &model) const
    {
      return breaks ? bond_counts(model).n_broken : 0.;
    }

    bool breaks, renews;
    double step = 0;        ///< that led to the renewal in progress; zero without one [T]
    bool is_booked = false; ///< that renewal
    double back = 0;  ///< zero, or the step where a particle is inside out now and is isolated [T]
    double power = 0; ///< before it, this rank's share [M L^2/T^3]
    double n_broken = 0; ///< before it
    double taken_by_breaks = 0, taken_by_renewals = 0;
  };

  TOMBOLO_REGISTER_PROCESS(StencilRenewal, process_order::renewal)
} // namespace tombolo
