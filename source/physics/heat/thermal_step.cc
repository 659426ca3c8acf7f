// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/heat/thermal_step.h>

namespace tombolo
{
  namespace
  {
    /** Declares the entries of the thermal step in section "Heat"; it is no process itself, since
     * it has a clock of its own and its steps are not those of the mechanics. */
    template <int dim>
    class ThermalStepEntries : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        declare_section<ThermalStep<dim>>(parameters, "Heat");
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        if (std::any_of(parts.begin(), parts.end(),
                        [](const Part<dim> &part) { return part.heat != nullptr; }))
          ThermalStep<dim> thermal_step(parameters.section("Heat"));
      }
    };
  } // namespace

  TOMBOLO_REGISTER_PROCESS_KIND(ThermalStepEntries, process_order::prescribed_motion)
} // namespace tombolo
