// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>
#include <tombolo/output/output.h>

namespace tombolo
{
  /** What the processes of a model have for outputs and for each other, such as contacts: refers to
   * them. */
  template <int dim>
  OutputView<dim> shown_by_processes(const Model<dim> &model)
  {
    OutputView<dim> view;
    for (const auto &process : model.processes)
      process->observed.views(view);
    return view;
  }
} // namespace tombolo
