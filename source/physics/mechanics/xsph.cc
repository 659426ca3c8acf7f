// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/ordered_sum.h>
#include <tombolo/formulations/particles/pair_interactions.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/rigid_contacts.h>

#include <cstdint>

namespace tombolo
{
  namespace
  {
    template <int dim>
    bool has_xsph(const ParticleFormulation<dim> &particles)
    {
      const PairInteractions<dim> *const pairs = particles.pairs();
      return pairs != nullptr && pairs->pair_terms().has_xsph();
    }
  } // namespace

  /**
   * XSPH of particle parts that have it (PairTerms): after the motion of a step positions are moved
   * further, by Δt times ε Σ_j m_j W_ij/ρ (v_j - v_i). It changes no velocities and no stresses
   * that follow from them, so that it has no energy; the work of the nodal forces on the added
   * motion is the column `XSPH work`, which is in no balance. Prescribed components, nodes of
   * elements, other nodes without such particles, and nodes on which a rigid surface acts stay.
   * Springs of contacts depend on positions: their work on the added motion, -½ (f_n + f_{n+1}) ·
   * Δx, is the change of their energy, and the energy `XSPH in contacts` is its opposite.
   */
  template <int dim>
  class Xsph : public Process<dim>
  {
  public:
    explicit Xsph(const Model<dim> &model)
    {
      Records &all = this->records.group("XSPH");
      all.sums("work", work, in_contacts);
      all.nodal("moved", dim, moved);
      this->observed.energy("XSPH in contacts", EnergyKind::artificial, in_contacts);
      this->observed.column("XSPH work", "M L^2/T^2",
                            [&] { return ordered_sum(work, model.communicator); });
      this->roles.divided_cells = ProcessRole::is_refused;
    }

    void model_changed(const Model<dim> &model) override
    {
      const auto &partition = model.state.partition();
      mass.reinit(partition, Quantity::scalar);
      momentum.reinit(partition);
      other_force.reinit(partition);
      if (moved.partition() == nullptr)
        moved.reinit(partition);
      else if (moved.partition() != partition)
        moved.move_to(partition);
      for (const ParticleFormulation<dim> *const particles : model.particle_parts())
        if (has_xsph(*particles))
          particles->add_mass(mass);
    }

    void add_forces(const Model<dim> &, const Clock &, const NodalVector &force) override
    {
      other_force.copy_from(force);
    }

    void constrain_acceleration(const Model<dim> &model, const Clock &, NodalState &state) override
    {
      // Forces of processes before this one that followed the acceleration depend on velocities.
      for (const auto &process : model.processes)
      {
        if (process.get() == this)
          break;
        process->actions.add_late_forces(other_force);
      }
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
        {
          // The forces of contacts, and of processes that a scene names.
          double &force = other_force.node(i)[d];
          force = state.force.node(i)[d] - force;
          in_contacts += 0.5 * force * moved.node(i)[d];
        }
    }

    void after_motion(const Model<dim> &model, const Clock &clock, NodalState &state) override
    {
      if (model.bridge->operators() != Bridge::Operators::identity)
        state.unsmoothed_velocity.update_ghosts(); // those who smooth read owned values only
      const auto add = [&]
      {
        for (const ParticleFormulation<dim> *const particles : model.particle_parts())
          if (has_xsph(*particles))
            particles->pairs()->pair_terms().add_exchanged_momentum(
                particles->pairs()->pair_rows(), state.position.data(),
                state.unsmoothed_velocity.data(), momentum.data());
      };
      add_up({&momentum}, add);
      moved.set_zero();
      const std::vector<std::uint8_t> &constrained = model.conditions->constrained_components();
      // A spring of contact stores energy by the position, which only the velocity can pay for.
      const auto *const contacts = model.template find_process<RigidContacts<dim>>();
      state.position.fill(
          [&](const unsigned int i, double *const coordinates)
          {
            if (*mass.node(i) == 0. || *model.element_mass.node(i) > 0. ||
                (contacts != nullptr && contacts->nodal_force(i).norm_square() != 0.))
              return;
            const double scale = clock.next_step / *mass.node(i);
            const std::uint8_t fixed = constrained.empty() ? std::uint8_t(0) : constrained[i];
            for (unsigned int d = 0; d < dim; ++d)
              if (((fixed >> d) & 1u) == 0)
              {
                const double added = scale * momentum.node(i)[d];
                coordinates[d] += added;
                work += added * state.force.node(i)[d];
                moved.node(i)[d] = added;
                in_contacts += 0.5 * other_force.node(i)[d] * added;
              }
          });
      model.bridge->positions_have_changed();
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &, Model<dim> &model)
    {
      if (!model.has_mechanics)
        return nullptr;
      for (const ParticleFormulation<dim> *const particles : model.particle_parts())
        if (has_xsph(*particles))
          return std::make_unique<Xsph>(model);
      return nullptr;
    }

  private:
    NodalVector mass;        // of particles of parts with XSPH, scalar, owned values [M]
    NodalVector momentum;    // that they exchange
    NodalVector other_force; // at t_n, before contacts [M L/T^2]
    NodalVector moved;       // by the last after_motion() [L]
    double work = 0;         // this rank's share
    double in_contacts = 0;  // this rank's share
  };

  TOMBOLO_REGISTER_PROCESS(Xsph, process_order::contact - 1)
} // namespace tombolo
