// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/formulations/particles/self_contact.h>
#include <tombolo/formulations/particles/sphere_contact.h>
#include <tombolo/model/model.h>
#include <tombolo/model/process.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <iomanip>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /** Contact between particles: fragments of a part, bodies that no chain of bonds connects, and
   * bodies of different parts with self-contact push each other away, and rub and conduct where
   * their parts have such entries. Its stored and dissipated energies are among those of the parts.
   */
  template <int dim>
  class FragmentContact : public Process<dim>
  {
  public:
    explicit FragmentContact(const Model<dim> &model)
        : model(model), revision_of_cells(model.revisions.cells),
          contact(parts_in_contact(model), *model.nodes, *model.bodies),
          forces(this->actions.add("contact of fragments", ActsAt::positions))
    {
      if (!contact.rubs())
        forces.stays_on_rank();
      if (parts_in_contact(model).size() > 1)
      {
        this->roles.divided_cells = ProcessRole::is_refused;
        this->records.archived([](auto &archive) { refuse_earlier_records(archive); });
      }
      this->observed.step_limits.connect(
          [&](const double stable_step, double &fraction)
          { fraction = std::min(fraction, contact.stable_fraction(stable_step)); });
      const auto n_fragments = [&]
      { return Utilities::MPI::sum(contact.counts().n_fragments, model.communicator); };
      this->observed.column("fragments", "1", [=] { return static_cast<double>(n_fragments()); });
      this->observed.column("particles in self-contact", "1",
                            [&]
                            {
                              return static_cast<double>(Utilities::MPI::sum(
                                  contact.counts().n_touching, model.communicator));
                            });
      this->observed.result("fragments", [=] { return n_fragments(); });
      this->observed.warnings.connect(
          [this](const Clock &clock, const auto occasion, std::vector<std::string> &warnings)
          {
            if (occasion == Process<dim>::Occasion::row)
              warn_of_speed(clock, warnings);
          });
      if (!contact.rubs() || !model.heat)
        return;
      heat = &this->actions.add_heat("heat of fragments", "self-contact friction heat");
      heat->stays_on_rank();
    }

    void add_forces(const Model<dim> &, const Clock &clock, const NodalVector &) override
    {
      const MechanicalInput input{&model.state.position, &model.state.velocity,
                                  clock.previous_step};
      FragmentHeat node_heat;
      if (heat != nullptr)
        node_heat = {&model.heat->state.present_temperature, &model.heat->nodal_enthalpy,
                     &model.heat->state.pending, heat};
      if (revision_of_cells != model.revisions.cells)
        contact.reset_pairs();
      revision_of_cells = model.revisions.cells;
      contact.add_forces(input, model.element_mass,
                         contact.rubs() ? forces.at_all_nodes() : forces.at_touched_nodes(),
                         forces.touched_nodes(), node_heat);
    }

    SphereContact<dim> &between_particles()
    {
      return contact;
    }

    static void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts);

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      constexpr std::size_t most_parts = 50; // bits of an exact double
      const std::size_t n_parts = parts_in_contact(model).size();
      if (n_parts > most_parts)
        parameters.section("").fail("Parts", "allowed are 50 parts with self-contact.");
      return n_parts == 0 ? nullptr : std::make_unique<FragmentContact>(model);
    }

  private:
    /** The parts whose particles touch others. */
    static std::vector<typename SpherePairs<dim>::Part> parts_in_contact(const Model<dim> &model)
    {
      std::vector<typename SpherePairs<dim>::Part> result;
      for (ParticleFormulation<dim> *const particles : model.particle_parts())
        if (SelfContact<dim> *const contact = particles->fragment_contact())
          result.push_back({contact, particles});
      return result;
    }

    /** Forces between parts were kept beside those of the points before. */
    template <typename Archive>
    static void refuse_earlier_records(Archive &archive)
    {
      const std::string name = "contact between parts";
      if (archive.is_reading() && archive.has(name))
        archive.fail("it is of a version in which contact between particle parts kept forces and "
                     "energies of its own (\"" +
                     name +
                     "\"); this one keeps them with the particles. Its run can be finished with "
                     "that version.");
    }

    /** Once, where particles have met so fast that their springs cannot stop them before their
     * centres are nearer than one of two radii: from there on rows of particles pass through each
     * other. Collective. */
    void warn_of_speed(const Clock &clock, std::vector<std::string> &warnings)
    {
      constexpr double largest = 0.5;
      const double fastest = Utilities::MPI::max(contact.fastest_approach(), model.communicator);
      if (has_warned || !(fastest > largest))
        return;
      has_warned = true;
      warnings.push_back(as_text(
          std::setprecision(3), "Until t = ", clock.time, " fragments have met ", fastest / largest,
          " times as fast as the springs between their particles can stop them, and may pass "
          "through each other. A `Self-contact stiffness` ",
          fastest * fastest / (largest * largest), " times as large stops them."));
    }

    const Model<dim> &model;
    unsigned long revision_of_cells;
    bool has_warned = false; // of their speed
    SphereContact<dim> contact;
    Action &forces;
    HeatAction *heat = nullptr; // null where nothing heats
  };
} // namespace tombolo
