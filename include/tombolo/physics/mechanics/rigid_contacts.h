// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surface_contact.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/heated_friction.h>
#include <tombolo/physics/mechanics/kinematic_solver.h>

#include <map>
#include <memory>
#include <vector>

namespace tombolo
{
  template <int dim>
  class Corridor;
  template <int dim>
  class NodalYieldStress;

  /**
   * All contacts of a scene with rigid surfaces (the sections `Contact: NAME`). Their forces act at
   * positions and enter the nodal force by Φᵀ; those of kinematic contacts follow when all other
   * accelerations and the size of the coming step are computed. With heat, nodes exchange it with
   * the tools; all contacts have the same heat of a node in any order.
   */
  template <int dim>
  class RigidContacts : public Process<dim>
  {
  public:
    /** Throws InputError. Collective. */
    RigidContacts(const std::vector<Section> &sections, const Model<dim> &model);
    ~RigidContacts() override;

    void model_changed(const Model<dim> &model) override;
    void add_forces(const Model<dim> &model, const Clock &clock, const NodalVector &force) override;
    void constrain_acceleration(const Model<dim> &model, const Clock &clock,
                                NodalState &state) override;
    void after_acceleration(const Model<dim> &, const Clock &clock) override
    {
      for (const auto &contact : members)
        contact->complete_step(clock);
    }
    void after_motion(const Model<dim> &, const Clock &clock, NodalState &) override
    {
      for (const auto &contact : members)
        contact->advance(clock);
    }
    void linearize(const Model<dim> &model, const Clock &clock, Tangent<dim> &tangent) override;
    void add_heat(const Model<dim> &model, double, double) override
    {
      heated_friction->distribute_heat(model);
    }

    /** On an owned node [M L/T^2]. */
    dealii::Tensor<1, 3> nodal_force(const unsigned int node) const
    {
      return force.nodal_force(node) +
             (solver ? kinematic_force->nodal_force(node) : dealii::Tensor<1, 3>());
    }

    /** The sum of all contacts over all ranks; the largest penetration. Collective. */
    ContactBalance balance() const
    {
      ContactBalance sum;
      for (const auto &contact : members)
        sum.add(contact->balance(communicator));
      return sum;
    }

    const std::vector<std::unique_ptr<SurfaceContact<dim>>> &contacts() const
    {
      return members;
    }

  private:
    void create_contact(const Section &section, const Model<dim> &model,
                        const std::vector<double> &volume,
                        std::vector<KinematicContact<dim> *> &kinematic);
    void create_heat(bool has_heat);
    /** Connects to signals of the model, and adds outputs. */
    void observe(const Model<dim> &model);
    /** Fills tables and pictures. */
    void show(const Model<dim> &model);
    bool has_tool_mass() const
    {
      return std::any_of(members.begin(), members.end(),
                         [](const auto &contact) { return contact->has_tool_mass(); });
    }
    /** The heat at nodes, and where contacts add theirs. */
    NodalHeat present_heat(const Model<dim> &model);
    /** Exchanges heat after the forces of all contacts. Collective. */
    void exchange_heat(const Model<dim> &model);

    MPI_Comm communicator;
    std::vector<std::unique_ptr<SurfaceContact<dim>>> members;
    std::map<std::size_t, std::unique_ptr<Corridor<dim>>> corridors; ///< of members that have one
    std::vector<bool> is_gone;                    ///< removed_cells() at the last change
    std::unique_ptr<KinematicSolver<dim>> solver; ///< null where no contact is kinematic
    Action &force;
    Action *kinematic_force = nullptr; ///< where a contact is kinematic
    HeatAction *friction_heat = nullptr, *conducted_heat = nullptr; ///< where there is some
    NodalVector exposure; ///< buffer, scalar; only of several contacts that exchange heat
    std::unique_ptr<NodalYieldStress<dim>> yield_stress;  ///< null where no contact needs it
    std::unique_ptr<HeatedFriction<dim>> heated_friction; ///< where particles spread heat
    unsigned long revision_of_stencils = 0;               // at which isolated nodes were found
  };
} // namespace tombolo
