// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/contact_history.h>

#include <tombolo/contact/mean_and_largest.h>

#include <tombolo/output/balance_rows.h>

#include <nlohmann/json.hpp>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr const char *axes[3] = {"x", "y", "z"};
    /** In two dimensions torques are about z alone. */
    template <int dim>
    constexpr unsigned int first_torque = dim == 2 ? 2 : 0;

    template <int dim>
    std::vector<ContactBalance> balances(const OutputView<dim> &view)
    {
      std::vector<ContactBalance> result;
      for (const SurfaceContact<dim> *contact : view.contacts)
        result.push_back(contact->balance(view.nodes->communicator()));
      for (const MortarContact<dim> *contact : view.body_contacts)
        result.push_back(contact->balance());
      return result;
    }

    /** Until which impulses are summed: the middle of the coming step. */
    template <int dim>
    double time_of_impulse(const OutputView<dim> &view)
    {
      return view.time + 0.5 * view.time_step;
    }
  } // namespace

  template <int dim>
  void ContactHistory<dim>::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry("Steps between rows", "10", Patterns::Integer(1, 1000000000),
                          "contact.csv has a row every so many steps.");
  }

  template <int dim>
  ContactHistory<dim>::ContactHistory(const Section &section)
      : steps_between(section.get_unsigned("Steps between rows"))
  {}

  template <int dim>
  void ContactHistory<dim>::start(const OutputView<dim> &view, const OutputDirectory &directory,
                                  const UnitLabels &unit_labels)
  {
    for (const SurfaceContact<dim> *contact : view.contacts)
      names.push_back(contact->name());
    for (const MortarContact<dim> *contact : view.body_contacts)
      names.push_back(contact->name());
    at_output.resize(names.size());
    if (!table.is_continued())
    {
      last.resize(names.size());
      largest_penetration.assign(names.size(), 0.);
      time_of_row = time_of_work = view.time;
    }
    add_row(view, balances(view));
    table.open(directory, unit_labels);
  }

  template <int dim>
  void ContactHistory<dim>::serialize(StateArchive &archive)
  {
    table.serialize(archive);
    archive("time of row", time_of_row);
    archive("largest penetration", largest_penetration);
    archive("time of work", time_of_work);
    serialize_last_row(archive, "works at row", &ContactBalance::work, "contacts", last);
    serialize_at_output(archive, {&ContactBalance::friction, &ContactBalance::damping}, at_output);
  }

  template <int dim>
  void ContactHistory<dim>::after_step(const OutputView<dim> &view)
  {
    if (!view.has_row(steps_between))
      return;
    const std::vector<ContactBalance> now = balances(view);
    add_row(view, now);
    table.write_row();
    time_of_row = time_of_impulse(view);
    time_of_work = view.time;
    last = now;
    for (std::size_t k = 0; k < names.size(); ++k)
      largest_penetration[k] = std::max(largest_penetration[k], now[k].penetration);
  }

  template <int dim>
  void ContactHistory<dim>::add_row(const OutputView<dim> &view,
                                    const std::vector<ContactBalance> &now)
  {
    table.begin_row(view.time, view.step);
    const double elapsed = time_of_impulse(view) - time_of_row;
    const std::size_t n_rigid = view.contacts.size();
    for (std::size_t k = 0; k < n_rigid; ++k)
    {
      add_columns(*view.contacts[k], now[k], last[k], elapsed, view.time - time_of_work);
      if (view.heat != nullptr)
        add_temperatures(
            view.contacts[k]->name() + " contact",
            mean_and_largest(view.heat->present_temperature, view.contacts[k]->nodes_in_contact()));
      if (view.contacts[k]->is_with_part() && view.contacts[k]->conducts())
        add_temperatures(view.contacts[k]->name() + " part",
                         view.contacts[k]->temperatures_of_part());
    }
    for (std::size_t k = 0; k < view.body_contacts.size(); ++k)
    {
      const MortarContact<dim> &contact = *view.body_contacts[k];
      add_columns(contact, now[n_rigid + k], last[n_rigid + k], elapsed);
      if (view.heat == nullptr)
        continue;
      add_temperatures(contact.name() + " slave",
                       contact.temperatures_in_contact(&view.heat->present_temperature));
      if (contact.knows_temperatures())
        add_temperatures(contact.name() + " master", contact.temperatures_in_contact(nullptr));
    }
  }

  template <int dim>
  void ContactHistory<dim>::add_temperatures(const std::string &of,
                                             const std::array<double, 2> &mean_and_largest)
  {
    table.add(of + " mean temperature", "temperature", mean_and_largest[0]);
    table.add(of + " largest temperature", "temperature", mean_and_largest[1]);
  }

  template <int dim>
  void ContactHistory<dim>::add_columns(const MortarContact<dim> &contact,
                                        const ContactBalance &now, const ContactBalance &before,
                                        const double elapsed)
  {
    const std::string energy = "M L^2/T^2";
    const auto add = [&](const std::string &what, const std::string &unit, const double value)
    { table.add(contact.name() + " " + what, unit, value); };
    for (unsigned int d = 0; d < dim; ++d)
      add(std::string("mean force ") + axes[d], "M L/T^2",
          elapsed > 0. ? (now.impulse[d] - before.impulse[d]) / elapsed : 0.);
    for (unsigned int d = 0; d < dim; ++d)
      add(std::string("impulse ") + axes[d], "M L/T", now.impulse[d]);
    add("friction heat", energy, now.friction);
    add("damping", energy, now.damping);
    add("stored energy", energy, now.elastic);
    add("nodes", "1", now.n_nodes);
    add("penetration", "L", now.penetration);
    add("area in contact", dim == 2 ? "L" : "L^2", now.area);
    if (contact.conducts())
      add("conducted heat", energy, now.conducted);
  }

  template <int dim>
  void ContactHistory<dim>::add_columns(const SurfaceContact<dim> &contact,
                                        const ContactBalance &now, const ContactBalance &before,
                                        const double elapsed, const double elapsed_of_work)
  {
    const std::string energy = "M L^2/T^2";
    const auto add = [&](const std::string &what, const std::string &unit, const double value)
    { table.add(contact.name() + " " + what, unit, value); };
    for (unsigned int d = 0; d < dim; ++d)
      add(std::string("mean force ") + axes[d], "M L/T^2",
          elapsed > 0. ? (now.impulse[d] - before.impulse[d]) / elapsed : 0.);
    for (unsigned int d = 0; d < dim; ++d)
      add(std::string("impulse ") + axes[d], "M L/T", now.impulse[d]);
    for (unsigned int c = first_torque<dim>; c < 3; ++c)
      add(std::string("mean torque ") + axes[c], energy,
          elapsed > 0. ? (now.angular_impulse[c] - before.angular_impulse[c]) / elapsed : 0.);
    add("friction heat", energy, now.friction);
    add("damping", energy, now.damping);
    add("stored energy", energy, now.elastic);
    add("work", energy, now.work);
    add("nodes", "1", now.n_nodes);
    add("penetration", "L", now.penetration);
    if (contact.has_areas())
      add("area in contact", dim == 2 ? "L" : "L^2", now.area);
    add("mean power", "M L^2/T^3",
        elapsed_of_work > 0. ? (now.work - before.work) / elapsed_of_work : 0.);
    for (unsigned int d = 0; d < dim; ++d)
      add(std::string("position ") + axes[d], "L", now.position[d]);
    for (unsigned int d = 0; d < dim && contact.has_tool_mass(); ++d)
      add(std::string("velocity ") + axes[d], "L/T", now.velocity[d]);
    if (contact.has_heat())
    {
      add("heat of bodies", energy, now.heat_of_bodies);
      add("heat of tool", energy, now.heat_of_tool);
    }
    if (contact.conducts())
      add("conducted heat", energy, now.conducted);
    if (contact.has_tool_temperature())
      add("tool temperature", "temperature", now.tool_temperature);
  }

  template <int dim>
  void ContactHistory<dim>::write(const OutputView<dim> &view, TimeTable & /*statistics*/)
  {
    at_output = balances(view);
    table.flush();
  }

  template <int dim>
  void ContactHistory<dim>::finish(Json &results)
  {
    table.flush();
    for (std::size_t c = 0; c < names.size(); ++c)
    {
      Json entry = Json::object();
      Json impulse = Json::array();
      for (unsigned int d = 0; d < dim; ++d)
        impulse.push_back(at_output[c].impulse[d]);
      entry["impulse"] = impulse;
      entry["friction_heat"] = at_output[c].friction;
      entry["damping"] = at_output[c].damping;
      entry["largest_penetration"] = largest_penetration[c];
      results["contact"][names[c]] = entry;
    }
  }

  template class ContactHistory<2>;
  template class ContactHistory<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Output, ContactHistory, "contact history",
      "Forces, impulses, heat and penetration of contacts (contact.csv); "
      "in every scene that has contacts.")
} // namespace tombolo
