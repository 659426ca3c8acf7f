// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/output.h>

#include <tombolo/base/input/text.h>

#include <algorithm>

namespace tombolo
{
  template <int dim>
  void declare_outputs(const Entries &e)
  {
    e.flag("Write solution", "true", "Whether the fields are written for ParaView at each output.");
    declare<TableFormat>(e);
    e.text("Further outputs", "", "",
           "Names of output plug-ins that are called besides the visualization and the probes.");
    e.plugins<Output<dim>>();
  }

  std::multimap<int, OutputOfScene> &OutputOfScene::all()
  {
    static std::multimap<int, OutputOfScene> outputs;
    return outputs;
  }

  template <int dim>
  std::vector<std::string> output_names(const Section &section)
  {
    const Registry<Output<dim>> &registry = Registry<Output<dim>>::instance();
    std::vector<std::string> names;
    std::map<std::string, std::string> switched_by;
    for (const auto &[order, output] : OutputOfScene::all())
    {
      switched_by[output.name] = output.switched_by;
      if (output.is_requested(section))
        names.push_back(output.name);
    }
    for (const std::string &name : section.get_list("Further outputs"))
    {
      if (!registry.has(name))
      {
        const std::string nearest = nearest_name(name, registry.names());
        section.fail("Further outputs",
                     "there is no output \"" + name + "\"" +
                         (nearest.empty() ? "." : ", did you mean \"" + nearest + "\"?") +
                         " Known in " + std::to_string(dim) +
                         " dimensions: " + joined(registry.names(), ", "));
      }
      if (const auto other = switched_by.find(name); other != switched_by.end())
        section.fail("Further outputs",
                     "\"" + name + "\" is switched by " + other->second + ": remove it here");
      if (std::count(names.begin(), names.end(), name) > 0)
        section.fail("Further outputs", "\"" + name + "\" stands twice: remove one of them");
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
