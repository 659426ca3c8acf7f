// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/contact_history.h>

#include <tombolo/state/state_archive.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr const char *contact_file = "contact.csv";
    constexpr const char *axes[3] = {"x", "y", "z"};
    /** In two dimensions torques are about z alone. */
    template <int dim>
    constexpr unsigned int first_torque = dim == 2 ? 2 : 0;
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
    this->directory = std::make_unique<OutputDirectory>(directory);
    std::string header = unit_labels.heading("time", "T") + ",step";
    for (const PenaltyContact<dim> *contact : view.contacts)
    {
      names.push_back(contact->name());
      const auto add = [&](const std::string &what, const std::string &unit)
      { header += "," + csv_field(unit_labels.heading(contact->name() + " " + what, unit)); };
      for (unsigned int d = 0; d < dim; ++d)
        add(std::string("mean force ") + axes[d], "M L/T^2");
      for (unsigned int d = 0; d < dim; ++d)
        add(std::string("impulse ") + axes[d], "M L/T");
      for (unsigned int c = first_torque<dim>; c < 3; ++c)
        add(std::string("mean torque ") + axes[c], "M L^2/T^2");
      add("friction heat", "M L^2/T^2");
      add("damping", "M L^2/T^2");
      add("stored energy", "M L^2/T^2");
      add("work", "M L^2/T^2");
      add("nodes", "1");
      add("penetration", "L");
      add("mean power", "M L^2/T^3");
      for (unsigned int d = 0; d < dim; ++d)
        add(std::string("position ") + axes[d], "L");
      for (unsigned int d = 0; d < dim && contact->has_tool_mass(); ++d)
        add(std::string("velocity ") + axes[d], "L/T");
      if (contact->has_heat())
      {
        add("heat of bodies", "M L^2/T^2");
        add("heat of tool", "M L^2/T^2");
      }
      if (contact->conducts())
        add("conducted heat", "M L^2/T^2");
      if (contact->has_tool_temperature())
        add("tool temperature", "temperature");
    }
    at_output.resize(names.size());
    if (bytes_at_checkpoint > 0)
    {
      directory.truncate(contact_file, bytes_at_checkpoint);
      return;
    }
    last.resize(names.size());
    largest_penetration.assign(names.size(), 0.);
    directory.write(contact_file, [&](std::ostream &out) { out << header << '\n'; });
    time_of_row = time_of_work = view.time;
  }

  template <int dim>
  void ContactHistory<dim>::serialize(StateArchive &archive)
  {
    if (!archive.is_reading())
    {
      flush();
      bytes_at_checkpoint = directory->size(contact_file);
    }
    std::vector<double> impulses, works; // the rest of the last row is not used again
    for (const ContactBalance &balance : last)
    {
      for (const auto &impulse : {balance.impulse, balance.angular_impulse})
        impulses.insert(impulses.end(), impulse.begin(), impulse.end());
      works.push_back(balance.work);
    }
    archive("bytes", bytes_at_checkpoint);
    archive("time of row", time_of_row);
    archive("largest penetration", largest_penetration);
    archive("impulses at row", impulses);
    archive("time of work", time_of_work);
    archive("works at row", works);
    if (impulses.size() != 6 * works.size())
      archive.fail("\"impulses at row\" and \"works at row\" are not of as many contacts.");
    last.resize(works.size());
    for (std::size_t k = 0; k < works.size(); ++k)
      last[k].work = works[k];
    auto next = impulses.begin();
    for (ContactBalance &balance : last)
      for (auto *impulse : {&balance.impulse, &balance.angular_impulse})
      {
        std::copy_n(next, 3, impulse->begin());
        next += 3;
      }
  }

  template <int dim>
  void ContactHistory<dim>::after_step(const OutputView<dim> &view)
  {
    if (view.step % steps_between != 0)
      return;
    // Forces are booked until the middle of the coming step.
    const double time = view.time + 0.5 * view.time_step;
    const double elapsed = time - time_of_row;
    const double elapsed_of_work = view.time - time_of_work;
    time_of_row = time;
    time_of_work = view.time;
    rows += format_number(view.time) + "," + std::to_string(view.step);
    const auto add = [&](const double value) { rows += "," + format_number(value); };
    for (std::size_t k = 0; k < names.size(); ++k)
    {
      const ContactBalance now = view.contacts[k]->balance(view.nodes->communicator());
      for (unsigned int d = 0; d < dim; ++d)
        add(elapsed > 0. ? (now.impulse[d] - last[k].impulse[d]) / elapsed : 0.);
      for (unsigned int d = 0; d < dim; ++d)
        add(now.impulse[d]);
      for (unsigned int c = first_torque<dim>; c < 3; ++c)
        add(elapsed > 0. ? (now.angular_impulse[c] - last[k].angular_impulse[c]) / elapsed : 0.);
      for (const double value :
           {now.friction, now.damping, now.elastic, now.work, now.n_nodes, now.penetration})
        add(value);
      add(elapsed_of_work > 0. ? (now.work - last[k].work) / elapsed_of_work : 0.);
      for (unsigned int d = 0; d < dim; ++d)
        add(now.position[d]);
      const PenaltyContact<dim> &contact = *view.contacts[k];
      for (unsigned int d = 0; d < dim && contact.has_tool_mass(); ++d)
        add(now.velocity[d]);
      if (contact.has_heat())
      {
        add(now.heat_of_bodies);
        add(now.heat_of_tool);
      }
      if (contact.conducts())
        add(now.conducted);
      if (contact.has_tool_temperature())
        add(now.tool_temperature);
      largest_penetration[k] = std::max(largest_penetration[k], now.penetration);
      last[k] = now;
    }
    rows += '\n';
  }

  template <int dim>
  void ContactHistory<dim>::write(const OutputView<dim> &view, Statistics & /*statistics*/)
  {
    for (std::size_t c = 0; c < names.size(); ++c)
      at_output[c] = view.contacts[c]->balance(view.nodes->communicator());
    flush();
  }

  template <int dim>
  void ContactHistory<dim>::finish(Json &results)
  {
    flush();
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

  template <int dim>
  void ContactHistory<dim>::flush()
  {
    if (!rows.empty())
      directory->append(contact_file, rows);
    rows.clear();
  }

  template class ContactHistory<2>;
  template class ContactHistory<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Output, ContactHistory, "contact history",
      "Forces, impulses, heat and penetration of contacts (contact.csv); "
      "in every scene that has contacts.")
} // namespace tombolo
