// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/failure/bond_failure_process.h>

#include <tombolo/model/model.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  BondFailureProcess<dim>::BondFailureProcess(Model<dim> &model) : redistribution(model)
  {
    this->roles.rest = ProcessRole::is_idle; // bonds stay those of the start
    model.stencils_change_for_good = true;
    model.signals.rows_changed.connect(
        [this, &model]
        {
          redistribution.complete();
          // Broken bonds make larger gradients at the same lengths.
          if (model.heat)
            model.heat->limit_is_outdated = true;
        });
    const auto n_broken = [&model] { return bond_counts(model).n_broken; };
    this->observed.column("broken bonds", "1", n_broken);
    this->observed.column("debris particles", "1",
                          [&model] { return static_cast<double>(bond_counts(model).n_debris); });
    this->observed.result("broken_bonds", n_broken);
    this->observed.result("debris_particles", [&model] { return bond_counts(model).n_debris; });
  }

  template <int dim>
  BondCounts BondFailureProcess<dim>::bond_counts(const Model<dim> &model)
  {
    BondCounts sum;
    for (const ParticleFormulation<dim> *const particles : model.particle_parts())
    {
      const BondCounts counts = particles->bond_counts();
      if (sum.criterion.empty())
        sum.criterion = counts.criterion;
      sum.n_broken += counts.n_broken;
      sum.n_debris += counts.n_debris;
    }
    sum.n_broken = Utilities::MPI::sum(sum.n_broken, model.communicator);
    sum.n_debris = Utilities::MPI::sum(sum.n_debris, model.communicator);
    return sum;
  }

  namespace
  {
    template <int dim>
    class BondFailureKind : public ProcessKind<dim>
    {
    public:
      std::unique_ptr<Process<dim>> create_one(const Parameters &, Model<dim> &model) const override
      {
        const auto particles = model.particle_parts();
        if (std::none_of(particles.begin(), particles.end(),
                         [](const auto *part) { return !part->bond_counts().criterion.empty(); }))
          return nullptr;
        return std::make_unique<BondFailureProcess<dim>>(model);
      }
    };
  } // namespace

  template class BondFailureProcess<2>;
  template class BondFailureProcess<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(BondFailureKind, process_order::bond_failure)
} // namespace tombolo
