// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/output.h>

#include <tombolo/base/input/section_names.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void declare_outputs(const Entries &e)
  {
    e.flag("Write solution", "true", "Whether the fields are written for ParaView at each output.");
    e.text("Further outputs", "", "",
           "Names of output plug-ins that are called besides the visualization and the probes.");
    e.plugins<Output<dim>>();
  }

  namespace
  {
    bool has_mechanical_condition(const Parameters &parameters)
    {
      for (const std::string &name : section_names(parameters, "Conditions"))
      {
        std::string type;
        parameters.attempt([&] { type = parameters.section("Condition: " + name).get("Type"); });
        for (const char *const known :
             {"traction", "pressure", "body force", "gravity", "velocity", "displacement", "clamp"})
          if (type == known)
            return true;
      }
      return false;
    }

    bool has_rigid_part(const Parameters &parameters)
    {
      for (const std::string &name : parameters.raw_list("Parts"))
        if (parameters.raw("Part: " + name + "/Formulation") == "rigid")
          return true;
      return false;
    }

    /** Why an output is not to be named in `Further outputs`; empty where it is. */
    std::string switch_of(const std::string &name)
    {
      return name == "probes"               ? "its own Locations"
             : name == "visualization"      ? "Output/Write solution"
             : name == "contact history"    ? "the entries Contacts and Body contacts"
             : name == "condition history"  ? "conditions of mechanics"
             : name == "section history"    ? "the entry Sections"
             : name == "rigid body history" ? "the formulation rigid of a part"
                                            : "";
    }
  } // namespace

  template <int dim>
  std::vector<std::string> output_names(const Section &section)
  {
    const Registry<Output<dim>> &registry = Registry<Output<dim>>::instance();
    std::vector<std::string> names;
    if (section.get_bool("Write solution"))
      names.emplace_back("visualization");
    if (section.subsection("probes").is_set("Locations"))
      names.emplace_back("probes");
    if (!section.all().raw_list("Contacts").empty() ||
        !section.all().raw_list("Body contacts").empty())
      names.emplace_back("contact history");
    if (has_mechanical_condition(section.all()))
      names.emplace_back("condition history");
    if (!section.all().raw_list("Sections").empty())
      names.emplace_back("section history");
    if (has_rigid_part(section.all()))
      names.emplace_back("rigid body history");
    for (const std::string &name : section.get_list("Further outputs"))
    {
      if (!registry.has(name))
      {
        const std::string nearest = nearest_name(name, registry.names());
        section.fail("Further outputs",
                     "there is no output \"" + name + "\"" +
                         (nearest.empty() ? "" : ", did you mean \"" + nearest + "\"?") +
                         " Known: " + registry.selection());
      }
      if (const std::string other = switch_of(name); !other.empty())
        section.fail("Further outputs",
                     "\"" + name + "\" is switched by " + other + ": remove it here");
      names.push_back(name);
    }
    return names;
  }

  template <int dim>
  std::vector<std::unique_ptr<Output<dim>>> create_outputs(const Section &section)
  {
    std::vector<std::unique_ptr<Output<dim>>> outputs;
    for (const std::string &name : output_names<dim>(section))
      section.all().attempt(
          [&] {
            outputs.push_back(
                Registry<Output<dim>>::instance().create(name, section.subsection(name)));
          });
    return outputs;
  }

  template void declare_outputs<2>(const Entries &);
  template void declare_outputs<3>(const Entries &);
  template std::vector<std::string> output_names<2>(const Section &);
  template std::vector<std::string> output_names<3>(const Section &);
  template std::vector<std::unique_ptr<Output<2>>> create_outputs<2>(const Section &);
  template std::vector<std::unique_ptr<Output<3>>> create_outputs<3>(const Section &);
} // namespace tombolo
