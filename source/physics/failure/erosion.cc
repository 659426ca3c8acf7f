// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/failure/erosion.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    class ErosionKind : public ProcessKind<dim>
    {
    public:
      std::unique_ptr<Process<dim>> create_one(const Parameters &, Model<dim> &model) const override
      {
        if (Erosion<dim>::eroding_parts(model).empty())
          return nullptr;
        if (model.heat)
          model.heat->can_lose_heat = true;
        return std::make_unique<Erosion<dim>>(model);
      }
    };
  } // namespace

  TOMBOLO_REGISTER_PROCESS_KIND(ErosionKind, process_order::erosion)
} // namespace tombolo
