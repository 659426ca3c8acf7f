// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/failure/bond_failure_process.h>

#include <tombolo/model/model.h>
#include <tombolo/output/time_table.h>

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
    model.renewal.after = [this, &model]()
    {
      redistribution.complete();
      // Broken bonds make larger gradients at the same lengths.
      if (model.heat)
        model.heat->limit_is_outdated = true;
    };
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

  template <int dim>
  void BondFailureProcess<dim>::report(const Model<dim> &model, TimeTable &table) const
  {
    const BondCounts bonds = bond_counts(model);
    table.add("broken bonds", "1", bonds.n_broken);
    table.add("debris particles", "1", static_cast<double>(bonds.n_debris));
  }

  template <int dim>
  void BondFailureProcess<dim>::summarize(const Model<dim> &model, const TimeTable &,
                                          Json &summary) const
  {
    const BondCounts bonds = bond_counts(model);
    summary["broken_bonds"] = bonds.n_broken;
    summary["debris_particles"] = bonds.n_debris;
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
