// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/physics/remeshing/part_refill.h>

#include <array>
#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * Refills of parts of smoothed cells (PartRefill) before the forces at t_n. Mass, momentum,
   * enthalpy and what was dissipated stay where the remap is conservative; kinetic and elastic
   * energy that it takes is accounted for as `remap loss`, and heats where heat is modelled.
   * A ValueRemap keeps the mass alone: the change of momentum and angular momentum leaves as that
   * of removed mass, the change of all mechanical energies, dissipated ones too, is `remap loss`,
   * which does not heat, and the change of heat is `eroded heat`.
   */
  template <int dim>
  class Refill : public Process<dim>
  {
  public:
    /** @p end_time: of the run [T]. Takes conditions off the faces of void cells. Throws
     * InputError. Collective. */
    Refill(Model<dim> &model, double end_time);

    ModelChange change_model(Model<dim> &model, const Clock &clock) override;
    /** Nodes of void cells alone stay where they are. */
    void constrain_acceleration(Model<dim> &model, const Clock &clock) override;
    void model_changed(Model<dim> &model) override;
    void account(EnergyAccounts &accounts) const override;
    void report(const Model<dim> &model, TimeTable &table) const override;
    void summarize(const Model<dim> &model, const TimeTable &table, Json &summary) const override;
    std::vector<std::string> warnings(const Model<dim> &model, const Clock &clock,
                                      typename Process<dim>::Occasion occasion) override;

    /** Over all parts. */
    unsigned long n_refills() const;

  private:
    using Vector = std::array<double, 3>;

    /** What nodes and parts hold: this rank's shares. */
    struct Content
    {
      double energy = 0;
      Vector momentum{}, angular_momentum{};
    };

    /** A part, and how often its cells are looked at. */
    struct Refilled
    {
      std::unique_ptr<PartRefill<dim>> refill;
      unsigned int interval;
      bool has_reached_end = false; ///< metal, the end of the void cells
    };

    /** Heat of nodes at both ends of the thermal step, and what plastic work has given them: this
     * rank's shares. */
    struct HeatContent
    {
      double enthalpy = 0, next_enthalpy = 0, given = 0;
    };

    static Content content_of(const Model<dim> &model);
    static HeatContent heat_content_of(const Model<dim> &model);
    /** Books what a remap that does not conserve has made of @p before. */
    static void book_heat(Model<dim> &model, const HeatContent &before);

    /** Tells processes of the nodes that were at @p before. Returns this rank's share of the energy
     * that they store now beyond that of before. Collective. */
    static double place_nodes(Model<dim> &model, const Clock &clock, NodalVector &before);

    /** A rigid rotation of the nodes that have moved brings the angular momentum back that the
     * remap has taken. Collective. */
    static void restore_angular_momentum(Model<dim> &model, const std::vector<unsigned int> &nodes,
                                         const Content &before);

    using HeatNode = std::function<void(unsigned int node, double heat)>;
    /** Shares @p energy out to the nodes of the patch, by their masses. Collective. */
    static void heat_nodes(const Model<dim> &model, const NodalVector &in_patch, double energy,
                           const HeatNode &add);
    /** Gives the heat that waits at nodes without mass to those of the patch. Collective. */
    void carry_heat(Model<dim> &model, const NodalVector &in_patch);

    std::vector<Refilled> parts;
    double lost = 0;
    Vector lost_momentum{}, lost_angular_momentum{};
    HeatAction *heat = nullptr;         // with heat only
    std::vector<unsigned int> massless; // owned nodes, where cells are filled and emptied
  };
} // namespace tombolo
