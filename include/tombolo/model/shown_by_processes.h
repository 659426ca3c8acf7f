// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>
#include <tombolo/model/process.h>

#include <vector>

namespace tombolo
{
  /** The objects of type T that the processes of a model show, such as contacts, in their order. */
  template <typename T, int dim>
  std::vector<const T *> shown_by_processes(const Model<dim> &model)
  {
    std::vector<const T *> result;
    for (const auto &process : model.processes)
      for (const auto &[type, object] : process->observed.objects)
        if (type == typeid(T))
          result.push_back(static_cast<const T *>(object));
    return result;
  }
} // namespace tombolo
