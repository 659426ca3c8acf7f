// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/history.h>

#include <tombolo/contact/contact_balance.h>

namespace tombolo
{
  /**
   * What surfaces and bodies do to each other: `contact.csv`, with the mean force on the bodies
   * since the row before, the impulse since the start, the mean torque about the surface's
   * reference point since the row before, heat, stored energy, the work of the surface's motion and
   * its mean power since the row before, nodes in contact, penetration, the position of the
   * reference point of each contact; the velocity of a surface with a mass; in scenes with heat
   * what bodies and tool have got of it, conducted heat and the temperature of the tool where there
   * are, mean and largest temperature of the nodes in contact. Of a contact between bodies the
   * force is that on the slave, conducted heat is what has entered the slave, and there is no
   * surface. Part of every scene that has contacts.
   */
  template <int dim>
  class ContactHistory : public BalanceHistory<dim, ContactBalance>
  {
  public:
    explicit ContactHistory(const Entries &e)
        : BalanceHistory<dim, ContactBalance>(
              e, "contact.csv", {"works at row", &ContactBalance::work},
              {"contact", {&ContactBalance::friction, &ContactBalance::damping}})
    {
      this->records.value("time of row", time_of_row);
      this->records.value("largest penetration", largest_penetration);
      this->records.value("time of work", time_of_work);
    }

  private:
    std::vector<ContactBalance> balances(const OutputView<dim> &view) const override
    {
      std::vector<ContactBalance> result;
      for (const SurfaceContact<dim> *contact : view.contacts)
      {
        result.push_back(contact->balance(view.nodes->communicator()));
        result.back().name = contact->name();
      }
      for (const MortarContact<dim> *contact : view.body_contacts)
      {
        result.push_back(contact->balance());
        result.back().name = contact->name();
      }
      return result;
    }

    void begin(const OutputView<dim> &view) override
    {
      BalanceHistory<dim, ContactBalance>::begin(view);
      if (this->table.is_continued())
        return;
      largest_penetration.assign(this->last.size(), 0.);
      time_of_row = time_of_work = view.time;
    }

    void add_balance(const OutputView<dim> &view, const std::size_t k, const ContactBalance &now,
                     const ContactBalance &before) override
    {
      const std::size_t n_rigid = view.contacts.size();
      if (k < n_rigid)
      {
        const SurfaceContact<dim> &contact = *view.contacts[k];
        add_balance(view, &contact, contact.has_areas(), contact.conducts(), now, before);
        if (view.heat != nullptr)
          add_temperatures(now.name + " contact", mean_and_largest(view.heat->present_temperature,
                                                                   contact.nodes_in_contact()));
        if (contact.is_with_part() && contact.conducts())
          add_temperatures(now.name + " part", contact.temperatures_of_part());
        return;
      }
      const MortarContact<dim> &contact = *view.body_contacts[k - n_rigid];
      add_balance(view, nullptr, true, contact.conducts(), now, before);
      if (view.heat == nullptr)
        return;
      add_temperatures(now.name + " slave",
                       contact.temperatures_in_contact(&view.heat->present_temperature));
      if (contact.knows_temperatures())
        add_temperatures(now.name + " master", contact.temperatures_in_contact(nullptr));
    }

    /** @p tool is null for a contact between bodies. */
    void add_balance(const OutputView<dim> &view, const SurfaceContact<dim> *const tool,
                     const bool has_area, const bool conducts, const ContactBalance &now,
                     const ContactBalance &before)
    {
      const std::string energy = "M L^2/T^2";
      const auto add = [&](const std::string &what, const std::string &unit, const double value)
      { this->table.add(now.name + " " + what, unit, value); };
      const double elapsed = view.middle_of_next_step() - time_of_row;
      this->add_mean(now.name + " mean force", "M L/T^2", now.impulse, before.impulse, elapsed);
      this->add_vector(now.name + " impulse", "M L/T", now.impulse);
      if (tool != nullptr)
        this->add_mean(now.name + " mean torque", energy, now.angular_impulse,
                       before.angular_impulse, elapsed, true);
      add("friction heat", energy, now.friction);
      add("damping", energy, now.damping);
      add("stored energy", energy, now.elastic);
      if (tool != nullptr)
        add("work", energy, now.work);
      add("nodes", "1", now.n_nodes);
      add("penetration", "L", now.penetration);
      if (has_area)
        add("area in contact", dim == 2 ? "L" : "L^2", now.area);
      if (tool != nullptr)
      {
        const double since_work = view.time - time_of_work;
        add("mean power", "M L^2/T^3",
            since_work > 0. ? (now.work - before.work) / since_work : 0.);
        this->add_vector(now.name + " position", "L", now.position);
        if (tool->has_tool_mass())
          this->add_vector(now.name + " velocity", "L/T", now.velocity);
        if (tool->has_heat())
        {
          add("heat of bodies", energy, now.heat_of_bodies);
          add("heat of tool", energy, now.heat_of_tool);
        }
      }
      if (conducts)
        add("conducted heat", energy, now.conducted);
      if (tool != nullptr && tool->has_tool_temperature())
        add("tool temperature", "temperature", now.tool_temperature);
    }

    void add_temperatures(const std::string &of, const std::array<double, 2> &mean_and_largest)
    {
      this->table.add(of + " mean temperature", "temperature", mean_and_largest[0]);
      this->table.add(of + " largest temperature", "temperature", mean_and_largest[1]);
    }

    void end_row(const OutputView<dim> &view) override
    {
      BalanceHistory<dim, ContactBalance>::end_row(view);
      time_of_row = view.middle_of_next_step();
      time_of_work = view.time;
      for (std::size_t k = 0; k < this->present.size(); ++k)
        largest_penetration[k] = std::max(largest_penetration[k], this->present[k].penetration);
    }

    void add_to_summary(const std::size_t k, const ContactBalance &at_output, Json &entry) override
    {
      entry["friction_heat"] = at_output.friction;
      entry["damping"] = at_output.damping;
      entry["largest_penetration"] = largest_penetration[k];
    }

    double time_of_row = 0;                  ///< until which impulses of the last row go
    double time_of_work = 0;                 ///< until which its works go
    std::vector<double> largest_penetration; ///< of each contact, over the rows
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Output, ContactHistory, "contact history",
      "Forces, impulses, heat and penetration of contacts (contact.csv); "
      "in every scene that has contacts.")
} // namespace tombolo
