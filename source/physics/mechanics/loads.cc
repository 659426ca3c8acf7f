// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/loads.h>

namespace tombolo
{
  namespace
  {
    template <int dim>
    class LoadsKind : public ProcessKind<dim>
    {
    public:
      std::unique_ptr<Process<dim>> create_one(const Parameters &, Model<dim> &model) const override
      {
        if (!model.has_mechanics || !model.conditions->has_loads())
          return nullptr;
        return std::make_unique<Loads<dim>>(model);
      }
    };
  } // namespace

  TOMBOLO_REGISTER_PROCESS_KIND(LoadsKind, process_order::loads)
} // namespace tombolo
