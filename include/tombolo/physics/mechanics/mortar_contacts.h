// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/mortar_contact.h>
#include <tombolo/model/process.h>

#include <array>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * All contacts of a scene between bodies (the sections `Body contact: NAME`). Their forces act at
   * positions and enter the nodal force by Φᵀ; they are internal forces of the scene. With heat,
   * the bodies get the heat of friction and exchange heat.
   */
  template <int dim>
  class MortarContacts : public Process<dim>
  {
  public:
    /** Throws InputError. Collective. */
    MortarContacts(const std::vector<Section> &sections, Model<dim> &model);

    void model_changed(const Model<dim> &model) override;
    void add_forces(const Model<dim> &model, const Clock &clock, const NodalVector &force) override;
    void after_acceleration(const Model<dim> &model, const Clock &clock) override;
    void linearize(const Model<dim> &model, const Clock &clock, Tangent<dim> &tangent) override;

    const std::vector<std::unique_ptr<MortarContact<dim>>> &contacts() const
    {
      return members;
    }

  private:
    /** Connects to signals of the model, and shows what there is. */
    void observe(Model<dim> &model);
    /** For nodes that were @p before where no motion has led them from. Collective. */
    void place_nodes(const NodalVector &before, Model<dim> &model);
    void renew_faces(const Model<dim> &model);

    MPI_Comm communicator;
    /** Of slave and master of each contact. */
    std::vector<std::array<typename MortarContact<dim>::Selector, 2>> selectors;
    std::vector<bool> is_gone; ///< active cells, ghosts among them; empty: none can
    std::vector<std::unique_ptr<MortarContact<dim>>> members;
    std::vector<unsigned int> nodes; ///< owned, on faces of any contact
    NodalVector last_position;       ///< at t_{n-1}; empty before the first step
    Action &force;
    HeatAction *heat = nullptr; ///< null without heat
  };
} // namespace tombolo
