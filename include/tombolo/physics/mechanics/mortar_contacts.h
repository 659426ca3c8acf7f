// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/mortar_contact.h>
#include <tombolo/mesh/bodies.h>
#include <tombolo/model/process.h>
#include <tombolo/model/static_process.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * All contacts of a scene between bodies (the sections `Body contact: NAME`). Their forces act at
   * positions and enter the nodal force by Φᵀ; they are internal forces of the scene. With heat,
   * the bodies get the heat of friction and exchange heat.
   */
  template <int dim>
  class MortarContacts : public Process<dim>, public StaticProcess<dim>
  {
  public:
    /** Throws InputError. Collective. */
    MortarContacts(const std::vector<Section> &sections, Model<dim> &model);

    void model_changed(Model<dim> &model) override;
    bool keeps_one_mesh() const override
    {
      return true;
    }
    bool follows_placed_nodes() const override
    {
      return false;
    }
    void add_forces(Model<dim> &model, const Clock &clock, const NodalVector &force) override;
    void after_acceleration(Model<dim> &model, const Clock &clock) override;
    double stable_fraction(double stable_step) const override;
    bool heats() const override;
    void add_heat(Model<dim> &model, double begin, double end, NodalVector &heat) override;
    void account(EnergyAccounts &accounts) const override;
    void account_heat(EnergyAccounts &accounts) const override;
    void describe(const Model<dim> &model, std::ostream &text) const override;
    void show(OutputView<dim> &view) const override;
    void serialize(Model<dim> &model, StateArchive &archive) override;
    void continue_state(Model<dim> &model, StateArchive &archive) override;

    void become_static(double tolerance) override;
    void begin_trial(Model<dim> &model, const Clock &clock) override;
    void restart_trial() override;
    void find_stiffness(const Model<dim> &model, const Clock &clock,
                        std::vector<ContactStiffness<dim>> &result) override;
    void add_stiffness_bound(const Model<dim> &model, const Clock &clock,
                             NodalVector &sums) override;

    /** The bodies with faces of contacts on this rank, as Bodies::body_of() has them. */
    std::set<dealii::types::global_dof_index> bodies(const Bodies<dim> &of_model) const;

    const std::vector<std::unique_ptr<MortarContact<dim>>> &contacts() const
    {
      return members;
    }

  private:
    bool has_heat;
    MPI_Comm communicator;
    std::vector<std::unique_ptr<MortarContact<dim>>> members;
    std::vector<unsigned int> nodes; ///< owned, on faces of any contact
    NodalVector last_position;       ///< at t_{n-1}; empty before the first step
    Action &force;
    NodalVector new_heat, pending_heat; ///< scalar, of this step, until add_heat()
    /** The same at the start of a static step; empty in explicit ones. */
    NodalVector committed_position, committed_heat;
    std::vector<typename MortarContact<dim>::State> committed;
  };
} // namespace tombolo
