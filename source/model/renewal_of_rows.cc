// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/model.h>
#include <tombolo/model/renewal_of_rows.h>

namespace tombolo
{
  template <int dim>
  void watch_rows(Model<dim> &model)
  {
    if (!model.has_mechanics)
      return;
    for (ParticleFormulation<dim> *const particles : model.particle_parts())
      particles->set_before_change(
          [&model]()
          {
            // Once a step, before the first part changes: S is then that of all rows before.
            if (!model.renewal.has_begun)
              model.begin_change();
            model.renewal.has_begun = true;
            if (model.renewal.before)
              model.renewal.before();
          });
  }

  template void watch_rows(Model<2> &);
  template void watch_rows(Model<3> &);
} // namespace tombolo
