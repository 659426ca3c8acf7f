// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/failure/bonds.h>

namespace tombolo
{
  template <int dim>
  class Model;

  /** Over parts and ranks; the criterion of the first part that has one. Collective. */
  template <int dim>
  BondCounts bond_counts(const Model<dim> &model);
} // namespace tombolo
