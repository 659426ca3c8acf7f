// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

namespace tombolo
{
  /** Neighbourhoods and rows of particle parts, renewed where their criterion asks for it. */
  template <int dim>
  class StencilRenewal : public Process<dim>
  {
  public:
    ModelChange change_model(Model<dim> &model, const Clock &clock) override;
    void report(const Model<dim> &model, TimeTable &table) const override;
  };
} // namespace tombolo
