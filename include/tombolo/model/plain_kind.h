// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

#include <memory>

namespace tombolo
{
  /** The kind of processes of a class that has no entries of its own. Made<dim> has a static
   * function make(), which does what ProcessKind::create_one() describes. */
  template <int dim, template <int> class Made>
  class PlainKind : public ProcessKind<dim>
  {
  public:
    std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                             Model<dim> &model) const override
    {
      return Made<dim>::make(parameters, model);
    }
  };
} // namespace tombolo

/** Registers the class template Made<dim> as a process by PlainKind. Once, in a source
 * file. */
#define TOMBOLO_REGISTER_PROCESS(Made, order)                                                      \
  namespace                                                                                        \
  {                                                                                                \
    template <int dim>                                                                             \
    using KindOf##Made = ::tombolo::PlainKind<dim, Made>;                                          \
  }                                                                                                \
  TOMBOLO_REGISTER_PROCESS_KIND(KindOf##Made, order)
