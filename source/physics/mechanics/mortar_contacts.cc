// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_contact.h>
#include <tombolo/model/process.h>

#include <tombolo/base/format.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/mesh/boundary_names.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_input.h>
#include <tombolo/model/moving_parts.h>
#include <tombolo/model/tangent.h>
#include <tombolo/physics/mechanics/contact_columns.h>
#include <tombolo/physics/mechanics/named_parts.h>
#include <tombolo/physics/mechanics/removed_cells.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <iterator>
#include <limits>
#include <ostream>
#include <utility>
#include <vector>

namespace tombolo
{
  namespace
  {
    /** Refuses a side without parts and boundary. */
    template <int dim>
    void check_side(const Section &section, const std::string &side,
                    const std::vector<Part<dim>> &parts)
    {
      parts_of_entry(section, side + " parts", parts);
      const std::string boundary = section.get(side + " boundary");
      if (section.get_list(side + " parts").empty() && boundary.empty())
        section.fail(side + " parts", "allowed are names of parts, or a `" + side + " boundary`.");
    }

    template <int dim>
    typename MortarContact<dim>::Selector selector(const Section &section, const std::string &side,
                                                   const Model<dim> &model, const bool is_tied)
    {
      const std::set<unsigned int> parts = parts_of_entry(section, side + " parts", model.parts);
      std::set<types::boundary_id> boundaries;
      if (!section.get(side + " boundary").empty())
        boundaries = boundary_ids(model.mesh, section, side + " boundary");
      for (unsigned int p = 0; p < model.parts.size(); ++p)
      {
        const Part<dim> &part = model.parts[p];
        const bool becomes_particles =
            std::any_of(model.parts.begin(), model.parts.end(),
                        [&](const Part<dim> &other) { return other.source == p; });
        if ((parts.empty() || parts.count(p) > 0) &&
            (becomes_particles || (is_tied && part.formulation->can_lose_cells())))
          section.fail(side + " parts",
                       "cells of the part \"" + part.name +
                           (becomes_particles ? "\" become particles, which have no faces"
                                              : "\" can be removed, with what is tied to them") +
                           "; allowed are other parts.");
      }
      return [parts, boundaries, &model](const typename Nodes<dim>::Cell &cell,
                                         const unsigned int face)
      {
        return (parts.empty() || parts.count(model.part_cells->part_of(cell)) > 0) &&
               (boundaries.empty() || !cell->at_boundary(face) ||
                boundaries.count(cell->face(face)->boundary_id()) > 0);
      };
    }

    /** Refuses two different sets of parts whose faces have nodes in common: these can neither come
     * apart nor slide. Collective. */
    template <int dim>
    void refuse_common_nodes(const Section &section, const MortarContact<dim> &contact,
                             const Model<dim> &model)
    {
      const std::set<unsigned int> slave_parts =
          parts_of_entry(section, "Slave parts", model.parts);
      const std::set<unsigned int> master_parts =
          parts_of_entry(section, "Master parts", model.parts);
      if (slave_parts.empty() || master_parts.empty() ||
          std::any_of(slave_parts.begin(), slave_parts.end(),
                      [&](const unsigned int part) { return master_parts.count(part) > 0; }))
        return;
      const std::vector<unsigned int> &slaves = contact.slave_faces().owned_nodes();
      const std::vector<unsigned int> &masters = contact.master_faces().owned_nodes();
      std::vector<unsigned int> common;
      std::set_intersection(slaves.begin(), slaves.end(), masters.begin(), masters.end(),
                            std::back_inserter(common));
      std::vector<std::array<double, dim>> positions;
      for (const unsigned int node : common)
      {
        positions.emplace_back();
        std::copy_n(model.state.initial_position.node(node), dim, positions.back().begin());
      }
      positions = from_all_ranks(positions, model.communicator);
      if (positions.empty())
        return;
      const std::array<double, dim> first = *std::min_element(positions.begin(), positions.end());
      Tensor<1, dim> position;
      std::copy_n(first.begin(), dim, position.begin_raw());
      section.fail("Master parts",
                   "the faces of both sides have " + std::to_string(positions.size()) +
                       (positions.size() == 1 ? " node" : " nodes") + " in common, the first at " +
                       position_text(position) +
                       ": the parts are one body there, and nothing comes apart or slides. Allowed "
                       "are parts that share no nodes, from `Meshes` or from a mesh file whose "
                       "nodes are not merged there; or, where other faces of one body shall touch, "
                       "a `Slave boundary` and a `Master boundary` without common nodes.");
    }

    /** How many slave nodes of a contact are tied, those with an area, how many are not, and where
     * the first of the others is, by x, y and z. The same on all ranks. Collective. */
    template <int dim>
    std::string text_of_tie(const MortarContact<dim> &contact, const NodalVector &position)
    {
      const MPI_Comm communicator = position.partition()->communicator();
      const std::vector<unsigned int> &slave_nodes = contact.slave_faces().owned_nodes();
      unsigned long n_tied = 0;
      std::vector<double> first; // of the free ones
      for (std::size_t k = 0; k < slave_nodes.size(); ++k)
      {
        const double *const x = position.node(slave_nodes[k]);
        if (contact.node_histories()[k].area > 0.)
          ++n_tied;
        else if (const std::vector<double> point(x, x + dim); first.empty() || point < first)
          first = point;
      }
      for (const std::vector<double> &rank_first : items_by_rank(first, communicator))
        if (!rank_first.empty() && (first.empty() || rank_first < first))
          first = rank_first;
      n_tied = Utilities::MPI::sum(n_tied, communicator);
      const unsigned long n_nodes = Utilities::MPI::sum(slave_nodes.size(), communicator);
      const std::string text =
          std::to_string(n_tied) + " of " + std::to_string(n_nodes) + " slave nodes are tied";
      return first.empty() ? text
                           : text + ", " + std::to_string(n_nodes - n_tied) +
                                 " not, where no master is near: the first at " +
                                 position_text(vector_of<dim>(first.data()));
    }

    /** Adds how the forces of the last evaluation change with positions, with the depth that motion
     * along the surfaces changes where they are inclined to each other. The effect of changes of
     * weights and normals on the direction and the position of the forces is left out: it is
     * smaller by the ratio of pressure and stiffness of the bodies. Collective. */
    template <int dim>
    void add_mortar_stiffness(const MortarContact<dim> &contact, const NodalVector &position,
                              std::vector<ContactStiffness<dim>> &result)
    {
      const std::shared_ptr<const NodePartition> &partition = position.partition();
      const std::vector<MortarHistory<dim>> &histories = contact.node_histories();
      const std::vector<unsigned int> &nodes = contact.slave_faces().owned_nodes();
      const NodalVector normals =
          nodal_field(partition, Quantity::vector, nodes,
                      [&](const std::size_t k, double *const value)
                      { std::copy_n(histories[k].normal.begin_raw(), dim, value); });
      // Zero across planes of symmetry, as what segments add there.
      const NodalVector kept =
          nodal_field(partition, Quantity::vector, nodes,
                      [](const std::size_t, double *const value) { std::fill_n(value, dim, 1.); });
      ContactRows<dim> rows;
      contact.mortar_segments().add_weights(normals, rows);
      if (!contact.is_tied())
      {
        const NodalVector pressed =
            nodal_field(partition, Quantity::vector, nodes,
                        [&](const std::size_t k, double *const value)
                        {
                          if (!histories[k].spring.is_closed())
                            return;
                          std::copy_n(histories[k].normal.begin_raw(), dim, value);
                          value[node_stride - 1] = -histories[k].gap;
                        });
        contact.mortar_segments().add_changes_of_weights(position, pressed, rows);
      }
      rows.collect(*partition);
      const auto holds = [&](const MortarHistory<dim> &history)
      {
        return history.spring.is_closed() && history.area > 0. &&
               (history.spring.depth > 0. || history.is_bonded || contact.is_tied());
      };
      // Nodes that touch and have no depth resist where nothing else does.
      const bool is_pressed = any_of_all_ranks(histories, holds, partition->communicator());
      for (std::size_t k = 0; k < histories.size(); ++k)
      {
        const MortarHistory<dim> &history = histories[k];
        if (!(is_pressed ? holds(history) : history.spring.is_closed() && history.area > 0.))
          continue;
        ContactStiffness<dim> stiffness;
        stiffness.node = nodes[k];
        stiffness.entries = rows.row(partition->global_index(stiffness.node));
        stiffness.direction = history.normal;
        stiffness.is_tied = contact.is_tied() || history.is_bonded;
        if (stiffness.is_tied)
        {
          stiffness.normal = history.spring.stiffness / history.area;
          for (unsigned int d = 0; d < dim; ++d)
            stiffness.along[d][d] = stiffness.normal;
          stiffness.along -= stiffness.normal * outer_product(history.normal, history.normal);
        }
        else
          add_spring(history.spring, 1. / history.area, stiffness);
        stiffness.keep(kept.node(stiffness.node));
        result.push_back(std::move(stiffness));
      }
    }
    /** A sentence where the sides of a contact move so fast against each other that its springs may
     * give way until faces are too deep to be seen; otherwise empty. Collective. */
    template <int dim>
    std::string text_of_speed(const MortarContact<dim> &contact, const NodalVector &velocity,
                              const double stable_step)
    {
      double thinnest = std::numeric_limits<double>::max();
      // For each side the largest components, and the largest of the opposite ones.
      std::vector<double> bounds(4 * dim, std::numeric_limits<double>::lowest());
      double *bound = bounds.data();
      for (const auto *const side : {&contact.slave_faces(), &contact.master_faces()})
      {
        for (const auto &face : side->faces())
          thinnest = std::min(thinnest, face.thickness);
        for (unsigned int d = 0; d < dim; ++d, bound += 2)
          for (const unsigned int node : side->owned_nodes())
          {
            bound[0] = std::max(bound[0], velocity.node(node)[d]);
            bound[1] = std::max(bound[1], -velocity.node(node)[d]);
          }
      }
      const MPI_Comm communicator = velocity.partition()->communicator();
      thinnest = Utilities::MPI::min(thinnest, communicator);
      Utilities::MPI::max(bounds, communicator, bounds);
      double squared = 0;
      for (unsigned int k = 0; k < 2 * dim; k += 2)
      {
        const double component = // below zero where a side has lost all of its faces
            std::max(
                {0., bounds[k] + bounds[k + 1 + 2 * dim], bounds[k + 1] + bounds[k + 2 * dim]});
        squared += component * component;
      }
      const double stiffness = contact.contact_settings().stiffness;
      const double share = std::sqrt(squared / stiffness) * stable_step / thinnest;
      constexpr double largest_share = 0.3; // bodies push on behind the cells at the surface
      if (!(share > largest_share))
        return "";
      return as_text(std::setprecision(3), "Body contact \"", contact.name(),
                     "\": its sides move against each other with a speed of up to ",
                     std::sqrt(squared), ", at which its springs give way by ", share,
                     " of the thinnest cell and more. Faces much deeper do not see each other, so "
                     "that bodies may pass through each other. A larger `Stiffness` than ",
                     stiffness, " helps.");
    }
  } // namespace

  /**
   * All contacts of a scene between bodies (the sections `Body contact: NAME`). Their forces act at
   * positions and enter the nodal force by Φᵀ; they are internal forces of the scene. With heat,
   * the bodies receive the heat of friction and exchange heat.
   */
  template <int dim>
  class MortarContacts : public Process<dim>
  {
  public:
    /** Throws InputError. Collective. */
    MortarContacts(const std::vector<Section> &sections, Model<dim> &model)
        : communicator(model.communicator),
          force(this->actions.add("contact between bodies", ActsAt::positions))
    {
      if (model.heat)
        heat = &this->actions.add_heat("heat between bodies", "friction heat of bodies");
      for (const Section &section : sections)
      {
        if (model.degree > 1)
          section.fail("", "elements have degree " + std::to_string(model.degree) +
                               "; contact between bodies needs degree 1.");
        auto pairing = Pairing<dim>::create(section);
        const bool is_tied = pairing->is_tied();
        selectors.push_back({{selector(section, "Slave", model, is_tied),
                              selector(section, "Master", model, is_tied)}});
        members.push_back(std::make_unique<MortarContact<dim>>(
            section, std::move(pairing), heat != nullptr, *model.nodes, model.state,
            selectors.back()[0], selectors.back()[1]));
        refuse_common_nodes(section, *members.back(), model);
        this->records.group("body contact " + section.name(), members.back()->records);
      }
      this->roles.divided_cells = ProcessRole::is_refused;
      if (std::any_of(members.begin(), members.end(),
                      [](const auto &contact) { return contact->is_tied(); }))
        this->roles.placed_nodes = ProcessRole::is_refused;
      this->records.on_continuation([this, &model]
                                    { last_position.copy_from(model.state.position); });
      Records &all_records = this->records.group("contact between bodies");
      all_records.nodal("last position", dim, last_position);
      all_records.archived([this](StateArchive &archive)
                           { archive.nodal("force", dim, force.at_all_nodes()); });
      observe(model);
    }

    void model_changed(const Model<dim> &model) override
    {
      const auto &partition = model.state.partition();
      renew_faces(model);
      for (const auto &contact : members)
        contact->set_partition(partition);
      nodes.clear();
      for (const auto &contact : members)
        for (const auto *const side : {&contact->slave_faces(), &contact->master_faces()})
          nodes.insert(nodes.end(), side->owned_nodes().begin(), side->owned_nodes().end());
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      if (last_position.partition() == nullptr)
        last_position = model.state.position.copy();
      else if (last_position.partition() != partition)
        last_position.move_to(partition);
    }

    void add_forces(const Model<dim> &model, const Clock &clock, const NodalVector &) override
    {
      NodalHeat nodal_heat;
      if (heat != nullptr)
      {
        nodal_heat.temperature = &model.heat->state.present_temperature;
        nodal_heat.enthalpy = &model.heat->nodal_enthalpy;
        nodal_heat.pending = &model.heat->state.pending;
        heat->touched_nodes() = nodes;
      }
      for (const auto &contact : members)
        contact->add_forces(model.state, last_position, clock, nodal_heat, force.at_touched_nodes(),
                            heat != nullptr ? &heat->at_touched_nodes() : nullptr);
      force.touched_nodes() = nodes;
      last_position.copy_from(model.state.position);
    }

    void after_acceleration(const Model<dim> &, const Clock &clock) override
    {
      for (const auto &contact : members)
        contact->complete_step(clock);
    }

    void linearize(const Model<dim> &model, const Clock &clock, Tangent<dim> &tangent) override
    {
      if (tangent.springs == nullptr)
        return;
      for (const auto &contact : members)
      {
        add_mortar_stiffness(*contact, model.state.position, *tangent.springs);
        for (const auto *const side : {&contact->slave_faces(), &contact->master_faces()})
          for (const unsigned int node : side->owned_nodes())
            tangent.add_bound(node, contact->contact_settings().law.stiffness(
                                        *model.state.mass.node(node), clock.stable_step));
      }
    }

    static void declare_parameters(Parameters &parameters)
    {
      parameters.handler().declare_entry(
          "Body contacts", "", Patterns::Anything(),
          "Names of contacts between bodies, each with a section `Body contact: "
          "NAME`.");
      for (const std::string &name : section_names(parameters, "Body contacts"))
      {
        const Entries e = Entries(parameters.handler()).subsection("Body contact: " + name);
        for (const std::string side : {"Slave", "Master"})
        {
          e.text(side + " parts", "", "",
                 "Names of the parts whose faces on the boundary of the mesh are this side, "
                 "separated by commas; empty for all. The side with the smaller faces is the "
                 "better slave.");
          e.text(side + " boundary", "", "",
                 "Names of the boundaries with the faces of this side, separated by commas; "
                 "empty for all boundaries of the parts.");
        }
        Pairing<dim>::create(e);
        declare<MortarSettings>(e);
      }
    }

    static void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts)
    {
      if (parts.empty()) // nothing can be checked
        return;
      bool has_mechanics = false, has_heat = false;
      for (const Part<dim> &part : parts)
      {
        has_mechanics = has_mechanics || has_motion(part);
        has_heat = has_heat || part.heat != nullptr;
      }
      for (const Section &section : named_sections(parameters, "Body contacts", "Body contact"))
      {
        if (!has_mechanics)
          section.fail("", "the scene has no mechanics, since its materials have no stresses; "
                           "nothing can touch.");
        const std::vector<std::string> rigid = parameters.raw_list("Contacts");
        if (std::find(rigid.begin(), rigid.end(), section.name()) != rigid.end())
          section.fail("", "an entry of `Contacts` has the same name; allowed is another one.");
        MortarSettings settings(section, Pairing<dim>::create(section)->is_tied(), has_heat);
        check_side(section, "Slave", parts);
        check_side(section, "Master", parts);
      }
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      const std::vector<Section> sections =
          named_sections(parameters, "Body contacts", "Body contact");
      if (sections.empty())
        return nullptr;
      return std::make_unique<MortarContacts>(sections, model);
    }

  private:
    /** Connects to signals of the model, and adds outputs. */
    void observe(Model<dim> &model)
    {
      model.signals.nodes_placed.connect([this, &model](const Clock &, const NodalVector &before)
                                         { follow_placed_nodes(before, model); });
      model.signals.trials.connect(
          [this, &model](const Clock &clock, const double touch_distance)
          {
            for (const auto &contact : members)
            {
              contact->become_static(touch_distance);
              contact->find_stiffness(model.state, clock); // one for all evaluations of the step
            }
            if (clock.step == 0)
              last_position.copy_from(model.state.position);
          });
      this->observed.step_limits.connect(
          [this](double, double &fraction)
          {
            for (const auto &contact : members)
              fraction = std::min(fraction, contact->stable_fraction());
          });
      this->observed.energies.connect(
          [this](EnergyAccounts &accounts)
          {
            ContactBalance sum;
            for (const auto &contact : members)
              sum.add(contact->balance());
            accounts.add_replicated("contact energy", EnergyKind::stored, sum.elastic);
            accounts.add_replicated("friction heat", EnergyKind::dissipated, sum.friction);
            accounts.add_replicated("contact damping", EnergyKind::dissipated, sum.damping);
          });
      this->observed.audit.connect(
          [this, &model](std::ostream &text)
          {
            for (const auto &contact : members)
              if (contact->is_tied())
                text << "  contact \"" << contact->name()
                     << "\": " << text_of_tie(*contact, model.state.initial_position) << "\n";
          });
      this->observed.warnings.connect(
          [this, &model, has_warned = std::vector<bool>(members.size())](
              const Clock &clock, const auto occasion, std::vector<std::string> &result) mutable
          {
            for (std::size_t k = 0; k < members.size(); ++k)
              if (occasion == Process<dim>::Occasion::row && !has_warned[k] &&
                  !members[k]->is_tied())
                if (auto text = text_of_speed(*members[k], model.state.velocity, clock.stable_step);
                    !text.empty())
                {
                  has_warned[k] = true;
                  result.push_back(std::move(text));
                }
          });
      for (const auto &contact : members)
        this->observed.object(*contact);
      this->observed.history(
          contact_history, [this, &model](BalanceHistory<dim> &row) { fill_row(model, row); }, 1);
      this->observed.views.connect(
          [this](OutputView<dim> &view)
          {
            view.nodal_forces[contact_force].emplace_back(
                [this](NodalVector &sum)
                {
                  for (unsigned int node = 0; node < sum.partition()->n_owned(); ++node)
                    for (unsigned int d = 0; d < dim; ++d)
                      sum.node(node)[d] += force.given().node(node)[d];
                });
          });
    }

    /** Collective. */
    void fill_row(const Model<dim> &model, BalanceHistory<dim> &row) const
    {
      for (const auto &contact : members)
      {
        add_contact_columns<dim>(contact->balance(), nullptr, true,
                                 contact->contact_settings().conducts(), row);
        if (heat == nullptr)
          continue;
        add_temperatures(
            "slave", contact->temperatures_in_contact(&model.heat->state.present_temperature), row);
        if (contact->contact_settings().needs_temperature())
          add_temperatures("master", contact->temperatures_in_contact(nullptr), row);
      }
    }

    void renew_faces(const Model<dim> &model)
    {
      if (!removed_cells_differ(model, is_gone))
        return;
      for (std::size_t k = 0; k < members.size(); ++k)
        members[k]->renew_faces(*model.nodes, selectors[k][0], selectors[k][1],
                                [&](const typename Nodes<dim>::Cell &cell)
                                { return is_gone[cell->active_cell_index()]; });
    }

    /** Notifies contacts of nodes that were moved from @p before without motion. Collective. */
    void follow_placed_nodes(const NodalVector &before, Model<dim> &model)
    {
      const NodalVector stationary_positions =
          nodal_field(model.state.partition(), Quantity::position,
                      [&](const unsigned int i, double *const coordinates)
                      { std::copy_n(before.node(i), dim, coordinates); });
      last_position.fill(
          [&](const unsigned int i, double *const coordinates)
          {
            for (unsigned int d = 0; d < dim; ++d)
              coordinates[d] += model.state.position.node(i)[d] - before.node(i)[d];
          });
      model.state.position.update_ghosts();
      for (const auto &contact : members)
        contact->place_nodes(stationary_positions, model.state.position);
    }

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

  TOMBOLO_REGISTER_PROCESS(MortarContacts, process_order::contact)
} // namespace tombolo
