// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/mass_scaling.h>

#include <tombolo/model/moving_parts.h>

#include <set>

namespace tombolo
{
  ScalingSettings::ScalingSettings(const Entries &e)
  {
    mass_factor = e.number("Mass factor", "1", positive(), "1",
                           "Mass scaling: inertia is that of so many times the density, and steps "
                           "are larger by its root. Heat capacity and body forces stay.");
    process_time_factor = e.number(
        "Process time factor", "1", positive(), "1",
        "The process is run so many times faster, and conductivities, film and radiation "
        "coefficients and reference strain rates are carried along. All entries, functions and "
        "results stay in the time of the process: steps are so many times larger.");
    const double factor = inertia_factor();
    e.refuse(!(factor <= largest_factor && factor >= 1. / largest_factor),
             process_time_factor == 1. ? "Mass factor" : "Process time factor",
             "inertia would be multiplied by " + format_number(mass_factor) + " x " +
                 format_number(process_time_factor) +
                 "^2; allowed are factors from 1e-12 to 1e12.");
    if (!e.when(e.is_set("Target time step")))
      return;
    target_time_step =
        e.optional_number("Target time step", positive(), "T",
                          "Selective mass scaling: mass is added to each cell and particle whose "
                          "own stable step by eq. (41) of Pan et al. 2019 is smaller, so that it "
                          "becomes this one; empty for none.")
            .value_or(0.);
    interval = e.integer("Interval", "20", between(1, 1000000),
                         "With a target: after so many steps mass is added again where cells have "
                         "become smaller. It is never taken away.");
  }

  namespace
  {
    template <int dim>
    class MassScalingKind : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        declare_section<ScalingSettings>(parameters, "Scaling");
      }

      void prepare(const Parameters &parameters, std::vector<Part<dim>> &parts) const override
      {
        const double factor = ScalingSettings(parameters.section("Scaling")).inertia_factor();
        std::set<Material *> materials;
        for (const Part<dim> &part : parts)
          if (materials.insert(part.material.get()).second)
            part.material->scale_inertia(factor);
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        const Section scaling = parameters.section("Scaling");
        if (ScalingSettings(scaling).is_active() && !parts.empty() &&
            std::none_of(parts.begin(), parts.end(),
                         [](const Part<dim> &part) { return has_motion(part); }))
          scaling.fail("", "the scene has no mechanics, since its materials have no stresses; "
                           "scaled inertia would do nothing.");
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        const Section section = parameters.section("Scaling");
        const ScalingSettings settings(section);
        if (!settings.is_active())
          return nullptr;
        return std::make_unique<MassScaling<dim>>(section, settings, model);
      }
    };
  } // namespace

  TOMBOLO_REGISTER_PROCESS_KIND(MassScalingKind, process_order::mass_scaling)
} // namespace tombolo
