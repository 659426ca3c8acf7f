// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/moment.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/internal_power.h>
#include <tombolo/physics/remeshing/part_refill.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  namespace
  {
    /** The cells of a part, if they are to be refilled. */
    template <int dim>
    SmoothedCells<dim> *refilled_cells_of(const Part<dim> &part)
    {
      auto *const cells = part.template as<SmoothedCells>();
      return cells != nullptr && cells->refill().is_on() ? cells : nullptr;
    }
  } // namespace

  /**
   * Refills of parts of smoothed cells (PartRefill) before the forces at t_n. Mass, momentum,
   * enthalpy and dissipated energy stay where the remap is conservative; kinetic and elastic
   * energy that it removes is accounted for as `remap loss`, and heats where heat is modelled.
   * A ValueRemap keeps the mass alone: the change of momentum and angular momentum leaves as that
   * of removed mass, the change of all mechanical energies, dissipated ones too, is `remap loss`,
   * which does not heat, and the change of heat is `eroded heat`.
   */
  template <int dim>
  class Refill : public Process<dim>
  {
  public:
    /** @p end_time: of the run [T]. Removes conditions from the faces of void cells. Throws
     * InputError. Collective. */
    Refill(Model<dim> &model, const double end_time)
    {
      std::vector<std::vector<types::global_dof_index>> void_cells;
      for (unsigned int p = 0; p < model.parts.size(); ++p)
        if (SmoothedCells<dim> *const cells = refilled_cells_of(model.parts[p]))
        {
          parts.push_back({std::make_unique<PartRefill<dim>>(model, p, *cells, end_time)});
          for (unsigned int c = 0; c < cells->n_cells(); ++c)
            if (cells->is_removed(c))
              void_cells.push_back(cells->nodes_of_cell(c));
        }
      if (fills_cells())
        model.remove_faces(void_cells);
      this->structure.archived(
          [this, &model](StateArchive &archive)
          {
            bool has_read = false;
            for (Refilled &part : parts)
              has_read = part.refill->serialize(model, archive) || has_read;
            if (has_read && archive.is_reading())
              model.set_partition();
          });
      observe(model);
      Records &all = this->records.group("refills");
      all.sums("lost energy", lost);
      all.sums("lost momentum", lost_momentum, lost_angular_momentum);
      if (!model.heat)
        return;
      heat = &this->actions.add_heat("heat of refills", "remap loss heat");
      heat->stays_on_rank();
      if (std::any_of(parts.begin(), parts.end(),
                      [](const Refilled &part)
                      { return !part.refill->settings.is_conservative(); }))
        model.heat->can_lose_heat = true;
    }

    ModelChange change_model(Model<dim> &model, const Clock &clock) override
    {
      ModelChange change;
      for (Refilled &part : parts)
      {
        if (clock.step == 0 || clock.step % part.refill->settings.interval != 0)
          continue;
        model.bridge->smooth_velocity(model.state);
        const bool is_conservative = part.refill->settings.is_conservative();
        const Content before = content_of(model);
        const HeatContent heat_before =
            model.heat && !is_conservative ? heat_content_of(model) : HeatContent();
        const double power = internal_power(model, clock.previous_step);
        NodalVector former_positions;
        if (part.refill->settings.surface_slides)
          former_positions = model.state.position.copy();
        if (!part.refill->refill(model, clock))
          continue;
        const double given = part.refill->settings.surface_slides
                                 ? notify_placed_nodes(model, clock, former_positions)
                                 : 0.;
        if (is_conservative)
          restore_angular_momentum(model, part.refill->moved_nodes(), before);
        model.bridge->smooth_velocity(model.state);
        const Content after = content_of(model);
        const double energy = before.energy - after.energy - given +
                              energy_of_change(power, internal_power(model, clock.previous_step),
                                               clock.previous_step, model.communicator);
        lost += energy;
        for (unsigned int d = 0; d < 3; ++d)
        {
          lost_momentum[d] += before.momentum[d] - after.momentum[d];
          lost_angular_momentum[d] += before.angular_momentum[d] - after.angular_momentum[d];
        }
        if (model.heat && is_conservative)
        {
          heat_nodes(model, part.refill->touched_nodes(), energy,
                     [&](const unsigned int node, const double share)
                     { heat->add_heat(node, share); });
          heat->collect(model.heat->state.pending);
        }
        else if (model.heat)
          book_heat(model, heat_before);
        if (model.heat && part.refill->settings.fills_cells)
          carry_heat(model, part.refill->touched_nodes());
        ++model.revisions.stencils;
        change.cells = change.stencils = change.masses = true;
      }
      return change;
    }

    /** Nodes of void cells alone stay where they are. */
    void constrain_acceleration(const Model<dim> &, const Clock &, NodalState &state) override
    {
      for (const unsigned int node : massless)
        for (NodalVector *const vector :
             {&state.acceleration, &state.velocity, &state.unsmoothed_velocity})
          std::fill_n(vector->node(node), node_stride, 0.);
    }

    void model_changed(const Model<dim> &model) override
    {
      massless.clear();
      if (fills_cells())
        for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
          if (*model.state.mass.node(i) == 0.)
            massless.push_back(i);
      const bool follow = std::all_of(model.processes.begin(), model.processes.end(),
                                      [](const auto &process)
                                      { return process->roles.placed_nodes == ProcessRole::acts; });
      for (const Refilled &part : parts)
        if (part.refill->settings.surface_slides && !follow)
          part.refill->settings.refuse(
              "a contact between parts does not follow nodes that slide; allowed with it is held.",
              "Refill surface");
    }

    /** Over all parts. */
    unsigned long n_refills() const
    {
      unsigned long result = 0;
      for (const Refilled &part : parts)
        result += part.refill->n_refills();
      return result;
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      if (std::none_of(model.parts.begin(), model.parts.end(),
                       [](const Part<dim> &part) { return refilled_cells_of(part) != nullptr; }))
        return nullptr;
      return std::make_unique<Refill>(model, parameters.section("").get_positive("End time"));
    }

  private:
    using Vector = std::array<double, 3>;

    /** The content of nodes and parts: this rank's shares. */
    struct Content
    {
      double energy = 0;
      Vector momentum{}, angular_momentum{};
    };

    /** A part. */
    struct Refilled
    {
      std::unique_ptr<PartRefill<dim>> refill;
      bool has_reached_end = false; ///< metal, the end of the void cells
    };

    /** Heat of nodes at both ends of the thermal step, and that of plastic work: this rank's
     * shares. */
    struct HeatContent
    {
      double enthalpy = 0, next_enthalpy = 0, given = 0;
    };

    bool fills_cells() const
    {
      return std::any_of(parts.begin(), parts.end(),
                         [](const Refilled &part) { return part.refill->settings.fills_cells; });
    }

    void observe(const Model<dim> &model)
    {
      this->observed.energy("remap loss", EnergyKind::dissipated, lost);
      this->observed.energies.connect(
          [this](EnergyAccounts &accounts)
          { accounts.add_removed_momentum(lost_momentum, lost_angular_momentum); });
      this->observed.column("refills", "1", [this] { return static_cast<double>(n_refills()); });
      this->observed.result("refills", [this] { return n_refills(); });
      this->observed.result("remap_loss", [this, &model]
                            { return Utilities::MPI::sum(lost, model.communicator); });
      this->observed.warnings.connect(
          [this, &model](const Clock &clock, const auto occasion, std::vector<std::string> &result)
          {
            for (Refilled &part : parts)
            {
              if (occasion != Process<dim>::Occasion::row || part.has_reached_end ||
                  !part.refill->settings.fills_cells)
                continue;
              const auto end = part.refill->reached_end(model.communicator);
              if (!end)
                continue;
              part.has_reached_end = true;
              result.push_back(as_text(
                  "At t = ", clock.time, " the material of part \"",
                  model.parts[part.refill->part].name, "\" has reached void cells at ",
                  position_text(*end),
                  " that cannot be filled, at the end of the mesh or beside cells of another "
                  "size. A larger mesh with more void cells, all of one size, gives it room."));
            }
          });
    }

    static Content content_of(const Model<dim> &model)
    {
      Content result;
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      {
        const double mass = *model.bridge->mass().node(i);
        const double *const velocity = model.state.unsmoothed_velocity.node(i);
        Vector momentum{};
        for (unsigned int d = 0; d < dim; ++d)
        {
          momentum[d] = mass * velocity[d];
          result.energy += 0.5 * momentum[d] * velocity[d];
          result.momentum[d] += momentum[d];
        }
        add_moment(model.state.position_of_unsmoothed().node(i), momentum.data(),
                   result.angular_momentum);
      }
      for (const Part<dim> &part : model.parts)
      {
        const EnergyAccounts energies = part.formulation->energies();
        for (const auto &account : energies.accounts())
          if (is_held(account.kind))
            result.energy += account.value;
      }
      return result;
    }

    static HeatContent heat_content_of(const Model<dim> &model)
    {
      HeatContent result;
      const ThermalState &state = model.heat->state;
      for (unsigned int i = 0; i < state.enthalpy.partition()->n_owned(); ++i)
      {
        result.enthalpy += *state.enthalpy.node(i);
        result.next_enthalpy += *state.next_enthalpy.node(i);
      }
      for (const Part<dim> &part : model.parts)
        result.given += part.material->plastic_heat_fraction() *
                            part.formulation->energies()["plastic dissipation"] -
                        part.formulation->pending_plastic_heat();
      return result;
    }

    /** Accounts for the change of heat by a remap that does not conserve it. */
    static void book_heat(Model<dim> &model, const HeatContent &before)
    {
      const HeatContent after = heat_content_of(model);
      const double now = before.enthalpy - after.enthalpy;
      // Plastic heat that counts as external is that of the present work.
      model.heat->eroded_heat += now + after.given - before.given;
      model.heat->eroding_heat += before.next_enthalpy - after.next_enthalpy - now;
    }

    /** Notifies processes of the nodes that were at @p before. Returns this rank's share of the
     * increase of the energy that they store. Collective. */
    static double notify_placed_nodes(Model<dim> &model, const Clock &clock, NodalVector &before)
    {
      const auto stored = [&model]
      {
        EnergyAccounts accounts;
        for (const auto &process : model.processes)
          process->add_energies(accounts);
        accounts.sum_over_ranks(model.communicator);
        const bool counts = Utilities::MPI::this_mpi_process(model.communicator) == 0;
        return counts ? accounts.sum_of(EnergyKind::stored) : 0.;
      };
      if (before.partition() != model.state.partition())
        before.move_to(model.state.partition());
      const double former = stored();
      model.signals.nodes_placed(clock, before);
      return stored() - former;
    }

    /** Adds a rigid rotation of the nodes that have moved, which restores the angular momentum
     * before the remap. Collective. */
    static void restore_angular_momentum(Model<dim> &model, const std::vector<unsigned int> &nodes,
                                         const Content &before)
    {
      constexpr double smallest_determinant = 1e-6; // of the inertia, scaled
      NodalState &state = model.state;
      const Content now = content_of(model);
      std::array<double, 7> sums{};
      for (unsigned int d = 0; d < 3; ++d)
        sums[d] = before.angular_momentum[d] - now.angular_momentum[d];
      for (const unsigned int i : nodes)
      {
        const double mass = *model.bridge->mass().node(i);
        sums[3] += mass;
        for (unsigned int d = 0; d < dim; ++d)
          sums[4 + d] += mass * state.position.node(i)[d];
      }
      sums = ordered_sum(sums, model.communicator);
      if (!(sums[3] > 0.) || !state.partition()->images_of_body().empty())
        return;
      const auto arm_of = [&](const unsigned int i)
      {
        Tensor<1, 3> arm;
        for (unsigned int d = 0; d < dim; ++d)
          arm[d] = state.position.node(i)[d] - sums[4 + d] / sums[3];
        return arm;
      };
      std::array<double, 9> entries{};
      for (const unsigned int i : nodes)
      {
        const Tensor<1, 3> arm = arm_of(i);
        for (unsigned int a = 0; a < 3; ++a)
          for (unsigned int b = 0; b < 3; ++b)
            entries[3 * a + b] += *model.bridge->mass().node(i) *
                                  ((a == b ? arm.norm_square() : 0.) - arm[a] * arm[b]);
      }
      entries = ordered_sum(entries, model.communicator);
      const Tensor<2, 3> inertia(ArrayView<const double>(entries.data(), 9));
      const double scale = trace(inertia) / 3.;
      Tensor<1, 3> rotation;
      if (dim == 2 && inertia[2][2] > 0.)
        rotation[2] = sums[2] / inertia[2][2];
      else if (dim == 3 && determinant(inertia) > smallest_determinant * scale * scale * scale)
        rotation = invert(inertia) * Tensor<1, 3>({sums[0], sums[1], sums[2]});
      state.unsmoothed_velocity.fill(nodes,
                                     [&](const std::size_t k, double *const velocity)
                                     {
                                       const Tensor<1, 3> added =
                                           cross_product_3d(rotation, arm_of(nodes[k]));
                                       for (unsigned int d = 0; d < dim; ++d)
                                         velocity[d] += added[d];
                                     });
    }

    using HeatNode = std::function<void(unsigned int node, double heat)>;
    /** Distributes @p energy over the nodes of the patch, by their masses. Collective. */
    static void heat_nodes(const Model<dim> &model, const NodalVector &in_patch,
                           const double energy, const HeatNode &add)
    {
      std::array<double, 2> sums{{energy, 0.}};
      const unsigned int n_owned = model.state.partition()->n_owned();
      for (unsigned int i = 0; i < n_owned; ++i)
        if (*in_patch.node(i) > 0.)
          sums[1] += *model.bridge->mass().node(i);
      sums = ordered_sum(sums, model.communicator);
      for (unsigned int i = 0; i < n_owned; ++i)
        if (*in_patch.node(i) > 0.)
          add(i, sums[0] * *model.bridge->mass().node(i) / sums[1]);
    }

    /** Distributes the pending heat of nodes without mass over those of the patch. Collective. */
    void carry_heat(Model<dim> &model, const NodalVector &in_patch)
    {
      NodalVector &pending = model.heat->state.pending;
      double massless_heat = 0;
      for (const unsigned int node : massless)
        massless_heat += std::exchange(*pending.node(node), 0.);
      heat_nodes(model, in_patch, massless_heat,
                 [&](const unsigned int node, const double share)
                 { *pending.node(node) += share; });
    }

    std::vector<Refilled> parts;
    double lost = 0;
    Vector lost_momentum{}, lost_angular_momentum{};
    HeatAction *heat = nullptr;         // with heat only
    std::vector<unsigned int> massless; // owned nodes, where cells are filled and emptied
  };

  TOMBOLO_REGISTER_PROCESS(Refill, process_order::conversion + 5)

  template class CellFilling<2>;
  template class CellFilling<3>;
  template class PartRefill<2>;
  template class PartRefill<3>;
} // namespace tombolo
