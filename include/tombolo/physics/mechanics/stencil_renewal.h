// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/at_rest.h>
#include <tombolo/model/process.h>

namespace tombolo
{
  /** Neighbourhoods and rows of particle parts, renewed where their criterion asks for it. */
  template <int dim>
  class StencilRenewal : public Process<dim>, public AtRest
  {
  public:
    ModelChange change_model(Model<dim> &model, const Clock &clock) override;
    /** Rows stay those of the start. */
    bool acts_at_rest() const override
    {
      return false;
    }
    void report(const Model<dim> &model, TimeTable &table) const override;
  };
} // namespace tombolo
