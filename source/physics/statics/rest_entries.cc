// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/statics/rest_entries.h>

#include <tombolo/contact/contact_settings.h>
#include <tombolo/model/model_input.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/statics/static_steps.h>

namespace tombolo
{
  namespace
  {
    std::string integration_of(const Parameters &parameters)
    {
      return parameters.raw("Time integration", "explicit");
    }

    /** Whether the steps of the scene are those of bodies at rest (`Time integration`). */
    template <int dim>
    bool has_bodies_at_rest(const Parameters &parameters)
    {
      return Registry<StaticSolver<dim>>::instance().has(integration_of(parameters));
    }
  } // namespace

  template <int dim>
  void refuse_at_rest(const Section &section, const std::string &entry, const std::string &reason,
                      const std::string &allowed)
  {
    if (has_bodies_at_rest<dim>(section.all()))
      section.fail(entry, reason + ", which `" + integration_of(section.all()) +
                              "` steps (entry \"Time integration\") do not have; allowed is " +
                              allowed + ".");
  }

  template <int dim>
  void refuse_switch_at_rest(const Parameters &parameters, const std::vector<Part<dim>> &parts,
                             const std::string &entry, const std::string &reason)
  {
    for (const Part<dim> &part : parts)
    {
      const Section part_section = parameters.section("Part: " + part.name);
      const Section section = part_section.subsection(part_section.get("Formulation"));
      if (section.is_set(entry) && section.get_bool(entry))
        refuse_at_rest<dim>(section, entry, reason, "false, or no such entry");
    }
  }

  template void refuse_at_rest<2>(const Section &, const std::string &, const std::string &,
                                  const std::string &);
  template void refuse_at_rest<3>(const Section &, const std::string &, const std::string &,
                                  const std::string &);
  template void refuse_switch_at_rest(const Parameters &, const std::vector<Part<2>> &,
                                      const std::string &, const std::string &);
  template void refuse_switch_at_rest(const Parameters &, const std::vector<Part<3>> &,
                                      const std::string &, const std::string &);

  namespace
  {
    template <int dim>
    void refuse_acceleration(const Section &section)
    {
      if (section.get("Method") == "kinematic")
        refuse_at_rest<dim>(section, "Method", "nodes are put onto the surface by accelerations",
                            "penalty or surface");
      const std::string surface = section.get("Surface");
      if (surface == surface_of_part)
        refuse_at_rest<dim>(section, "Surface",
                            "springs between nodes and a part act on several nodes of it, and "
                            "need a stiffness",
                            "another surface, or a body contact");
      if (const Section surface_section = section.subsection(surface);
          surface_section.is_set("Mass") && !surface_section.get("Mass").empty())
        refuse_at_rest<dim>(surface_section, "Mass",
                            "a surface with a mass is moved by accelerations", "a `Displacement`");
    }

    /** No process of its own: refuses entries of contacts that need an acceleration. */
    template <int dim>
    class ContactsAtRest : public ProcessKind<dim>
    {
    public:
      void validate(const Parameters &parameters, const std::vector<Part<dim>> &) const override
      {
        if (!has_bodies_at_rest<dim>(parameters))
          return;
        for (const Section &section : named_sections(parameters, "Contacts", "Contact"))
          parameters.attempt([&] { refuse_acceleration<dim>(section); });
      }
    };

    /** No process of its own: refuses supports and drives that end or begin in the run. */
    template <int dim>
    class TimesAtRest : public ProcessKind<dim>
    {
    public:
      void validate(const Parameters &parameters, const std::vector<Part<dim>> &) const override
      {
        if (!has_bodies_at_rest<dim>(parameters))
          return;
        for (const Section &section : named_sections(parameters, "Conditions", "Condition"))
          parameters.attempt(
              [&]
              {
                const std::string type = section.get("Type");
                for (const char *const entry : {"Start", "End"})
                  if (section.is_set(entry) && !section.get(entry).empty() &&
                      (type == "velocity" || type == "displacement" || type == "clamp"))
                    refuse_at_rest<dim>(section, entry,
                                        "nodes are set free or held while the body moves",
                                        "a stage of its own (`Stages`) with other conditions");
              });
      }
    };

    /** No process of its own: refuses what static steps do not support, before there is a mesh. */
    template <int dim>
    class StaticStepsKind : public ProcessKind<dim>
    {
    public:
      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        if (has_bodies_at_rest<dim>(parameters))
          StaticSteps<dim>::refuse_unfit(parameters, parts);
      }
    };
  } // namespace

  TOMBOLO_REGISTER_PROCESS_KIND(StaticStepsKind, process_order::prescribed_motion)
  TOMBOLO_REGISTER_PROCESS_KIND(TimesAtRest, process_order::prescribed_motion)
  TOMBOLO_REGISTER_PROCESS_KIND(ContactsAtRest, process_order::contact)
} // namespace tombolo
