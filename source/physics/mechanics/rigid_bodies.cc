// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/rigid_bodies.h>

#include <tombolo/base/input/section_names.h>
#include <tombolo/model/model_input.h>
#include <tombolo/model/moving_parts.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** After all others, since what they add to the forces moves the bodies. */
    constexpr int after_all_forces = process_order::named + 100;

    template <int dim>
    class RigidBodiesKind : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        for (const std::string &name : section_names(parameters, "Parts"))
          declare<RigidBodySettings<dim>>(
              Entries(parameters.handler()).subsection("Part: " + name).subsection("rigid"));
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        const std::vector<Section> sections = named_sections(parameters, "Parts", "Part");
        for (std::size_t p = 0; p < parts.size(); ++p)
          if (rigid_cells(parts[p]) != nullptr)
            RigidBodySettings<dim>(sections[p].subsection("rigid"));
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        if (std::none_of(model.parts.begin(), model.parts.end(),
                         [](const Part<dim> &part) { return rigid_cells(part) != nullptr; }))
          return nullptr;
        return std::make_unique<RigidBodies<dim>>(parameters, model);
      }
    };
  } // namespace

  TOMBOLO_REGISTER_PROCESS_KIND(RigidBodiesKind, after_all_forces)
} // namespace tombolo
