// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/rigid_contacts.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_input.h>
#include <tombolo/model/moving_parts.h>
#include <tombolo/model/tangent.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/mechanics/contact_nodes.h>
#include <tombolo/physics/mechanics/named_parts.h>
#include <tombolo/physics/mechanics/nodal_yield_stress.h>
#include <tombolo/physics/mechanics/rigid_body.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>
#include <ostream>
#include <string>

namespace tombolo
{
  namespace
  {
    constexpr const char *corridor_entry = "Corridor";
  } // namespace

  /**
   * The intended region of a contact, its entry `Corridor`: a condition on the initial positions of
   * nodes, such as those of the particles or of the refined cells along the way of a tool. Cells
   * outside of it are not meant for its deformation.
   */
  template <int dim>
  class Corridor
  {
  public:
    /** Of the contact with this section; throws InputError where the condition cannot be read. */
    explicit Corridor(const Section &section) : section(section), is_inside(section, corridor_entry)
    {}

    /** Throws InputError where the condition has no value at a node that @p contact can touch, and
     * where no such node is inside. Collective. */
    void check(const SurfaceContact<dim> &contact, const NodalState &state) const
    {
      bool any = false;
      attempt_on_all_ranks<InputError>(
          state.partition()->communicator(),
          [&]
          {
            for (const unsigned int node : contact.candidate_nodes())
              any = is_inside(point_of<dim>(state.initial_position.node(node))) || any;
          });
      if (Utilities::MPI::max(any ? 1 : 0, state.partition()->communicator()) == 0)
        section.fail(corridor_entry, "no node that the surface can touch is there; allowed is a "
                                     "condition on x, y, z that some of them meet at the start.");
    }

    /** A sentence the first time that @p contact touches a node outside; else nothing. The same on
     * all ranks. Collective. */
    std::optional<std::string> find_exit(const SurfaceContact<dim> &contact,
                                         const NodalState &state, const Clock &clock)
    {
      if (was_left)
        return {};
      const std::vector<unsigned int> nodes = contact.nodes_in_contact();
      const auto outside =
          std::find_if(nodes.begin(), nodes.end(),
                       [&](const unsigned int node)
                       { return !is_inside(point_of<dim>(state.initial_position.node(node))); });
      std::string exit_text;
      if (outside != nodes.end())
        exit_text = position_text(vector_of<dim>(state.position.node(*outside)));
      exit_text = first_text(state.partition()->communicator(), exit_text);
      was_left = !exit_text.empty();
      if (!was_left)
        return {};
      return as_text(
          "At t = ", clock.time, " the contact \"", contact.name(), "\" touches a node at ",
          exit_text, " that is outside of its `Corridor`, \"", section.get(corridor_entry),
          "\". What is deformed there is not made for it: a shorter way of the tool, or a "
          "wider corridor with the particles or the refined cells in it, helps.");
    }

    void list(Records &records)
    {
      records.value("corridor was left", was_left);
    }

  private:
    Section section;
    Predicate<dim> is_inside;
    bool was_left = false;
  };

  namespace
  {
    /** Refuses errors in the part that a contact with `Surface = part` names, as far as they need
     * no mesh. */
    template <int dim>
    void validate_master_part(const Section &contact, const std::vector<Part<dim>> &parts)
    {
      if (contact.get("Surface") != surface_of_part || parts.empty())
        return;
      const Section section = contact.subsection(surface_of_part);
      const std::string name = section.get("Part");
      const Part<dim> &part = parts[part_of_entry(section, "Part", name, parts)];
      if (!has_motion(part))
        section.fail("Part", "the part \"" + name +
                                 "\" has no stresses and is not rigid, so that nothing moves it; "
                                 "allowed is a part of elements with a material that has stresses, "
                                 "or one with `Formulation = rigid`.");
      if (part.particles != nullptr)
        section.fail("Part",
                     "the part \"" + name +
                         "\" consists of particles, which have no surface that stays; "
                         "allowed is a part of elements, or one with `Formulation = rigid`.");
    }

    /** The part that a contact with `Surface = part` names; nothing for other surfaces. Throws
     * InputError where it cannot be touched. Collective. */
    template <int dim>
    MasterPart<dim> master_part(const Section &contact, const Model<dim> &model)
    {
      if (contact.get("Surface") != surface_of_part)
        return {};
      validate_master_part(contact, model.parts);
      const Section section = contact.subsection(surface_of_part);
      const std::string name = section.get("Part");
      const unsigned int number = part_of_entry(section, "Part", name, model.parts);
      const Part<dim> &part = model.parts[number];
      if (model.degree > 1)
        section.fail("Part", "elements have degree " + std::to_string(model.degree) +
                                 "; the surface of a part needs degree 1.");
      if (part.formulation->can_lose_cells())
        section.fail("Part", "cells of the part \"" + name +
                                 "\" can be removed, and what is below them has no faces; allowed "
                                 "are other parts.");
      MasterPart<dim> result;
      result.layer =
          std::make_unique<PartLayer<dim>>(*model.nodes, [&](const typename Nodes<dim>::Cell &cell)
                                           { return model.part_cells->part_of(cell) == number; });
      if (rigid_cells(part) != nullptr)
        result.is_driven =
            !RigidBodySettings<dim>(section.all().section("Part: " + name + "/rigid"))
                 .moves_by_forces();
      return result;
    }
  } // namespace

  template <int dim>
  RigidContacts<dim>::RigidContacts(const std::vector<Section> &sections, const Model<dim> &model)
      : communicator(model.communicator), force(this->actions.add("contact", ActsAt::positions))
  {
    force.comes_from_outside().stays_on_rank();
    const bool has_heat = model.heat != nullptr;
    const bool needs_volume =
        has_heat || std::any_of(sections.begin(), sections.end(),
                                [&](const Section &section)
                                {
                                  return section.get("Surface") == surface_of_part ||
                                         ContactSettings(section, has_heat).limits_shear();
                                });
    const std::vector<double> volume =
        needs_volume ? ContactNodes<dim>(model).volume_of_nodes() : std::vector<double>();
    std::vector<KinematicContact<dim> *> kinematic;
    for (const Section &section : sections)
      create_contact(section, model, volume, kinematic);
    yield_stress = NodalYieldStress<dim>::create(members);
    heated_friction = std::make_unique<HeatedFriction<dim>>(members, model, this->records);
    create_heat(has_heat);
    this->observed.step_limits.connect(
        [this](double, double &fraction)
        {
          for (const auto &contact : members)
            fraction = std::min(fraction, contact->stable_fraction());
        });
    observe(model);
    show(model);
    if (std::any_of(members.begin(), members.end(),
                    [](const auto &contact) { return contact->is_with_part(); }))
      this->roles.placed_nodes = ProcessRole::is_refused;
    if (kinematic.empty())
      return;
    solver = std::make_unique<KinematicSolver<dim>>(kinematic, model);
    kinematic_force = &this->actions.add("kinematic contact", ActsAt::positions)
                           .comes_from_outside()
                           .follows_acceleration()
                           .stays_on_rank();
  }

  template <int dim>
  RigidContacts<dim>::~RigidContacts() = default;

  template <int dim>
  void RigidContacts<dim>::create_contact(const Section &section, const Model<dim> &model,
                                          const std::vector<double> &volume,
                                          std::vector<KinematicContact<dim> *> &kinematic)
  {
    const bool has_heat = model.heat != nullptr;
    const ContactSettings settings(section, has_heat);
    ContactNodes<dim>(model).refuse_faces_of_void_cells(section, settings);
    ContactScene<dim> scene{
        section,
        model.mesh,
        *model.nodes,
        model.state,
        ContactNodes<dim>(model).nodes_that_can_be_exposed(settings.is_of_faces),
        has_heat,
        volume,
        {}};
    if (settings.is_of_faces)
      members.push_back(make_face_contact(scene));
    else if (settings.is_kinematic)
    {
      ContactNodes<dim>(model).refuse_blunt_smoothing(section);
      members.push_back(make_kinematic_contact(scene, kinematic));
    }
    else
    {
      scene.master = master_part(section, model);
      members.push_back(make_penalty_contact(scene));
    }
    this->records.group("contact " + section.name(), members.back()->records);
    if (section.get("Corridor").empty())
      return;
    auto &corridor = corridors[members.size() - 1] = std::make_unique<Corridor<dim>>(section);
    corridor->check(*members.back(), model.state);
    corridor->list(this->records.group("corridor of " + section.name()));
  }

  template <int dim>
  void RigidContacts<dim>::create_heat(const bool has_heat)
  {
    if (!has_heat)
      return;
    const auto add = [&](const std::string &name)
    {
      HeatAction &heat = this->actions.add_heat(name + " of contact", name + " of bodies");
      heat.stays_on_rank();
      return &heat;
    };
    friction_heat = add("friction heat");
    if (std::any_of(members.begin(), members.end(),
                    [](const auto &contact) { return contact->conducts(); }))
      conducted_heat = add("conducted heat");
  }

  template <int dim>
  void RigidContacts<dim>::observe(const Model<dim> &model)
  {
    model.signals.nodes_move.connect(
        [this](const Clock &clock, const NodalVector &slides, const NodalVector &from,
               NodalVector &position, NodalVector &is_bound)
        {
          for (const auto &contact : members)
            contact->keep_outside(clock, slides, from, position, is_bound);
        });
    model.signals.nodes_placed.connect(
        [this, &model](const Clock &clock, const NodalVector &before)
        {
          for (const auto &contact : members)
            contact->place_nodes(model.state, before, clock);
        });
    model.signals.trials.connect(
        [this, &model](const Clock &clock, const double touch_distance)
        {
          for (const auto &contact : members)
          {
            contact->become_static(touch_distance);
            if (clock.step == 0)
              contact->reset_motion(model.state);
          }
        });
    this->observed.energies.connect(
        [this](EnergyAccounts &accounts)
        {
          const ContactBalance sum = balance();
          accounts.add_replicated("contact energy", EnergyKind::stored, sum.elastic);
          accounts.add_replicated("friction heat", EnergyKind::dissipated, sum.friction);
          accounts.add_replicated("contact damping", EnergyKind::dissipated, sum.damping);
          if (has_tool_mass())
            accounts.add_replicated("tool kinetic energy", EnergyKind::stored, sum.tool_kinetic);
          accounts.add_replicated("external work", EnergyKind::external, sum.external_work);
        });
    this->observed.columns.connect(
        [this, &model](TimeTable &table)
        {
          if (const auto count = ContactNodes<dim>(model).count_fast_particles(members))
            table.add("particles that fly off", "1", *count);
          for (unsigned int d = 0; d < dim && has_tool_mass(); ++d)
            table.add(std::string("tool momentum ") + "xyz"[d], "M L/T",
                      balance().tool_momentum[d]);
        });
    this->observed.results.connect(
        [this, &model](const TimeTable &, Json &summary)
        {
          if (const auto count = ContactNodes<dim>(model).count_fast_particles(members))
            summary["particles_that_fly_off"] = static_cast<unsigned long>(*count);
        });
    this->observed.audit.connect(
        [this](std::ostream &text)
        {
          for (const auto &contact : members)
            if (const auto description = contact->contact_surface().description();
                !description.empty())
              text << "  contact \"" << contact->name() << "\": " << description << "\n";
        });
    this->observed.warnings.connect(
        [this, &model, has_warned = std::vector<bool>(members.size())](
            const Clock &clock, const auto occasion, std::vector<std::string> &result) mutable
        {
          if (occasion == Process<dim>::Occasion::row)
            ContactNodes<dim>(model).add_depth_warnings(members, has_warned, result);
          for (const auto &contact : members)
            if (occasion == Process<dim>::Occasion::audit)
              for (const std::string &remark : contact->contact_surface().remarks())
                result.push_back("Surface of the contact \"" + contact->name() + "\": " + remark);
          for (auto &[member, corridor] : corridors)
            if (occasion == Process<dim>::Occasion::row)
              if (const auto exit = corridor->find_exit(*members[member], model.state, clock))
                result.push_back(*exit);
        });
  }

  template <int dim>
  void RigidContacts<dim>::model_changed(const Model<dim> &model)
  {
    ContactNodes<dim>(model).renew_faces(members, is_gone);
    for (const auto &contact : members)
      contact->set_partition(model.state.partition());
    heated_friction->invalidate_coefficients();
    if (yield_stress)
      yield_stress->invalidate_nodes();
    revision_of_stencils = model.revisions.stencils;
    ContactNodes<dim>(model).find_isolated_nodes(members);
  }

  template <int dim>
  NodalHeat RigidContacts<dim>::present_heat(const Model<dim> &model)
  {
    if (friction_heat == nullptr)
      return {};
    return {&model.heat->state.present_temperature, &model.heat->nodal_enthalpy,
            &model.heat->state.pending, nullptr, friction_heat};
  }

  template <int dim>
  void RigidContacts<dim>::exchange_heat(const Model<dim> &model)
  {
    if (friction_heat == nullptr)
      return;
    friction_heat->collect(model.heat->state.pending); // all contacts have the same heat of a node
    NodalHeat nodal_heat = present_heat(model);
    if (members.size() > 1 && conducted_heat != nullptr)
    {
      exposure.fit_to(model.state.partition(), Quantity::scalar);
      exposure.set_zero();
      for (const auto &contact : members)
        contact->add_exposure(exposure);
      nodal_heat.exposure = &exposure;
    }
    for (const auto &contact : members)
    {
      // Heat that one of two bodies receives by conduction is lost by the other.
      nodal_heat.conduction = contact->is_with_part() ? friction_heat : conducted_heat;
      contact->exchange_heat(nodal_heat);
    }
  }

  template <int dim>
  void RigidContacts<dim>::add_forces(const Model<dim> &model, const Clock &clock,
                                      const NodalVector &)
  {
    if (revision_of_stencils != model.revisions.stencils)
      ContactNodes<dim>(model).find_isolated_nodes(members);
    revision_of_stencils = model.revisions.stencils;
    if (yield_stress)
      yield_stress->update(model, members);
    heated_friction->update(model);
    const NodalHeat nodal_heat = present_heat(model);
    for (const auto &contact : members)
      contact->add_forces(model.state, clock, force.at_touched_nodes(), force.touched_nodes(),
                          nodal_heat);
    if (!solver)
      exchange_heat(model);
  }

  template <int dim>
  void RigidContacts<dim>::constrain_acceleration(const Model<dim> &model, const Clock &clock,
                                                  NodalState &state)
  {
    if (!solver)
      return;
    state.acceleration.update_ghosts();
    solver->solve(model, clock, present_heat(model), kinematic_force->at_touched_nodes(),
                  kinematic_force->touched_nodes());
    exchange_heat(model);
  }

  template <int dim>
  void RigidContacts<dim>::linearize(const Model<dim> &model, const Clock &clock,
                                     Tangent<dim> &tangent)
  {
    if (tangent.springs == nullptr)
      return;
    for (const auto &contact : members)
    {
      contact->find_stiffness(model.state, clock, *tangent.springs);
      for (const unsigned int node : contact->candidate_nodes())
        tangent.add_bound(node, contact->contact_settings().law.stiffness(
                                    *model.state.mass.node(node), clock.stable_step));
    }
  }

  namespace
  {
    template <int dim>
    class RigidContactsKind : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        parameters.handler().declare_entry(
            "Contacts", "", Patterns::Anything(),
            "Names of contacts with rigid surfaces, each with a section `Contact: NAME`.");
        for (const std::string &name : section_names(parameters, "Contacts"))
          ContactScene<dim>::declare(Entries(parameters.handler()).subsection("Contact: " + name));
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        bool has_mechanics = parts.empty(),
             has_heat = parts.empty(); // without parts nothing can be checked
        for (const Part<dim> &part : parts)
        {
          has_mechanics = has_mechanics || has_motion(part);
          has_heat = has_heat || part.heat != nullptr;
        }
        for (const Section &section : named_sections(parameters, "Contacts", "Contact"))
          parameters.attempt(
              [&]
              {
                if (!has_mechanics)
                  section.fail("", "the scene has no mechanics, since its materials have no "
                                   "stresses; nothing can touch.");
                ContactScene<dim>::validate(section, has_heat);
                if (!section.get("Corridor").empty())
                  parameters.attempt([&] { Corridor<dim> corridor(section); });
                parameters.attempt([&] { validate_master_part(section, parts); });
                NodalYieldStress<dim>::validate(section, parts);
              });
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        const std::vector<Section> sections = named_sections(parameters, "Contacts", "Contact");
        if (sections.empty())
          return nullptr;
        return std::make_unique<RigidContacts<dim>>(sections, model);
      }
    };
  } // namespace

  template class RigidContacts<2>;
  template class RigidContacts<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(RigidContactsKind, process_order::contact)
} // namespace tombolo
