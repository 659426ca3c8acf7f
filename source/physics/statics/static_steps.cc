// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/statics/rest_entries.h>
#include <tombolo/physics/statics/static_steps.h>

namespace tombolo
{
  namespace
  {
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
} // namespace tombolo
