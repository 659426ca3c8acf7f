// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/surface_damping.h>

#include <tombolo/base/input/entries.h>

namespace tombolo
{
  namespace
  {
    constexpr const char *surface_section_name = "Surface damping";

    template <int dim>
    class SurfaceDampingKind : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        const Entries e = Entries(parameters.handler()).subsection(surface_section_name);
        e.number(
            "Coefficient", "0.3", between(0., 1.), "",
            "b of the viscosity b ρ c h between the layers at the surface of particles whose shape "
            "functions are cell averages: it takes away the oscillation of the outermost layer "
            "that a sudden load leaves there. Materials that flow are left alone. 0: there is "
            "none. The stable step of particles alone is 6 to 9 % longer without it.");
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        for (const Part<dim> &part : parts)
          if (part.particles != nullptr && part.material->has_mechanics())
            parameters.section(surface_section_name)
                .get_double("Coefficient"); // this scene reads it
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        const double coefficient =
            parameters.section(surface_section_name).get_double("Coefficient");
        if (!model.has_mechanics || coefficient == 0.)
          return nullptr;
        auto process = std::make_unique<SurfaceDamping<dim>>(coefficient, model);
        if (Utilities::MPI::max(process->has_fibres() ? 1 : 0, model.communicator) == 0)
          return nullptr;
        return process;
      }
    };
  } // namespace

  TOMBOLO_REGISTER_PROCESS_KIND(SurfaceDampingKind, process_order::damping)
} // namespace tombolo
