// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /** The kind of processes of one class. Made<dim> has a static function make(), which does what
   * ProcessKind::create_one() describes, and may have others of the names below. */
  template <int dim, template <int> class Made>
  class PlainKind : public ProcessKind<dim>
  {
  public:
    void declare_parameters(Parameters &parameters) const override
    {
      Made<dim>::declare_parameters(parameters);
    }

    void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts) const override
    {
      Made<dim>::validate(parameters, parts);
    }

    void prepare(const Parameters &parameters, std::vector<Part<dim>> &parts) const override
    {
      Made<dim>::prepare(parameters, parts);
    }

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
