// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/penalty_contact.h>
#include <tombolo/model/process.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * All contacts of a scene with rigid surfaces (the sections `Contact: NAME`). Their forces act at
   * positions and enter the nodal force by Φᵀ. With heat, nodes exchange it with the tools; all
   * contacts see the same heat of a node, whatever their order.
   */
  template <int dim>
  class RigidContacts : public Process<dim>
  {
  public:
    /** Throws InputError. Collective. */
    RigidContacts(const std::vector<Section> &sections, Model<dim> &model);

    void model_changed(Model<dim> &model) override;
    void add_forces(Model<dim> &model, const Clock &clock, NodalVector &force) override;
    void after_acceleration(Model<dim> &model, const Clock &clock) override;
    void after_motion(Model<dim> &model, const Clock &clock) override;
    double stable_fraction(double stable_step) const override;
    bool heats() const override;
    void add_heat(Model<dim> &model, double begin, double end, NodalVector &heat) override;
    void account(EnergyAccounts &accounts) const override;
    void account_heat(EnergyAccounts &accounts) const override;
    void report(const Model<dim> &model, TimeTable &table) const override;
    void describe(const Model<dim> &model, std::ostream &text) const override;
    std::vector<std::string> remarks() const override;
    void show(OutputView<dim> &view) const override;
    std::size_t memory_consumption() const override;
    void serialize(Model<dim> &model, StateArchive &archive) override;

    /** The forces of all contacts at t_n: force(). Collective. */
    void compute_force(Model<dim> &model, const Clock &clock);
    const NodalVector &force() const; ///< nodal force of owned nodes [M L/T^2]

    /** The sum of all contacts over all ranks; the largest penetration. Collective. */
    ContactBalance balance() const;

    const std::vector<std::unique_ptr<PenaltyContact<dim>>> &contacts() const;

  private:
    using Add = void (PenaltyContact<dim>::*)(NodalVector &) const;
    NodalVector *sum_of_contacts(const NodalVector &like, Add add, NodalVector &sum) const;

    MPI_Comm communicator;
    bool has_heat;
    std::vector<std::unique_ptr<PenaltyContact<dim>>> members;
    NodalVector loads;                          ///< at positions [M L/T^2]
    NodalVector nodal_force;                    ///< Φᵀ loads
    std::vector<unsigned int> nodes_in_contact; // buffer
    // Buffers, scalar; only of several contacts that exchange heat.
    NodalVector pending_heat, exposure;
  };
} // namespace tombolo
