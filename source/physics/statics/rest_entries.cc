// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/statics/rest_entries.h>

#include <tombolo/physics/statics/static_solver.h>

namespace tombolo
{
  namespace
  {
    std::string integration_of(const Parameters &parameters)
    {
      return parameters.raw("Time integration", "explicit");
    }
  } // namespace

  template <int dim>
  bool has_bodies_at_rest(const Parameters &parameters)
  {
    return Registry<StaticSolver<dim>>::instance().has(integration_of(parameters));
  }

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
      const Section of_part = parameters.section("Part: " + part.name);
      const Section section = of_part.subsection(of_part.get("Formulation"));
      if (section.is_set(entry) && section.get_bool(entry))
        refuse_at_rest<dim>(section, entry, reason, "false, or no such entry");
    }
  }

  template bool has_bodies_at_rest<2>(const Parameters &);
  template bool has_bodies_at_rest<3>(const Parameters &);
  template void refuse_at_rest<2>(const Section &, const std::string &, const std::string &,
                                  const std::string &);
  template void refuse_at_rest<3>(const Section &, const std::string &, const std::string &,
                                  const std::string &);
  template void refuse_switch_at_rest(const Parameters &, const std::vector<Part<2>> &,
                                      const std::string &, const std::string &);
  template void refuse_switch_at_rest(const Parameters &, const std::vector<Part<3>> &,
                                      const std::string &, const std::string &);
} // namespace tombolo
